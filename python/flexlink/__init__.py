"""Torques that make the tip of a flexible link or arm follow a motion exactly.

>>> import flexlink
>>> link = flexlink.Link(
...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
...     hub={"inertia": 0.1},
...     damping={"ratio": 0.02},
... )
>>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.88, step=0.004)
>>> solution = flexlink.solve(link, **motion)
>>> bool(abs(solution.torque).max() < abs(solution.rigid_torque).max())
True

Numbers are SI: m, kg, s, rad, N m. The functions do what the commands of the same names do, with the same results;
``flexlink help`` and the book describe these.
"""

from ._files import compare, report
from ._flexlink import (
    Comparison,
    Fit,
    Learned,
    Link,
    Motion,
    Page,
    Robustness,
    Run,
    SetPoints,
    Simulation,
    Solution,
    StateSpace,
    Verification,
    __version__,
    fit,
    frf,
    learn,
    modes,
    read,
    robust,
    simulate,
    solve,
    sweep,
    trajectory,
    verify,
)
from ._messages import (
    FlexlinkError,
    FlexlinkWarning,
    InputError,
    NotSolvableError,
    OutOfMemoryError,
    WriteError,
)
from ._results import add_methods

add_methods()
del add_methods

# A link is an arm of one link.
Arm = Link

__all__ = [
    "Arm",
    "Comparison",
    "Fit",
    "FlexlinkError",
    "FlexlinkWarning",
    "InputError",
    "Learned",
    "Link",
    "Motion",
    "NotSolvableError",
    "OutOfMemoryError",
    "Page",
    "Robustness",
    "Run",
    "SetPoints",
    "Simulation",
    "Solution",
    "StateSpace",
    "Verification",
    "WriteError",
    "compare",
    "fit",
    "frf",
    "learn",
    "modes",
    "read",
    "report",
    "robust",
    "simulate",
    "solve",
    "sweep",
    "trajectory",
    "verify",
    "__version__",
]
