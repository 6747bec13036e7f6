"""Links and motions of the measurements, and the measuring itself; standard library only."""

import math
import os
import platform
import resource
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PERIOD_S = 8.192
DURATION_S = 1.7
DISTANCE_M = 0.5


def write_link(path, elements):
    """The paper's link, a tenth of the elements in its stiff root.

    The motion's own rest is long enough for this tolerance, also at half the stiffness, so that
    nothing is padded.
    """
    root = max(1, elements // 10)
    path.write_text(
        f"""title = "Bayo (1987), example 1, {elements} elements"
[[segments]]
name = "root"
length = 0.15
EI = 50
mass_per_length = 0.8
elements = {root}
[[segments]]
name = "beam"
length = 1.35
EI = 5
mass_per_length = 0.8
elements = {elements - root}
[hub]
inertia = 0.1
[damping]
model = "hysteretic"
ratio = 0.02
[analysis]
tolerance = 1e-4
"""
    )


def write_motion(path, samples):
    """A smooth bump of the velocity: half a metre in 1.7 s amid 8.192 s, from rest to rest.

    v ~ exp(-1/(1 - s^2)), |s| < 1; its spectrum falls below 1e-15 of its peak at 265 Hz.
    """
    step = PERIOD_S / samples
    # 8.192 s over a power of two: its decimal expansion ends.
    decimals = max(3, samples.bit_length() - 11)
    half = DURATION_S / 2
    # The integral of the bump over -1 < s < 1.
    scale = DISTANCE_M / (0.443993816168079 * half)
    with path.open("w") as file:
        file.write("time,acceleration\n")
        for k in range(samples):
            s = (k * step - PERIOD_S / 2) / half
            a = 0.0
            if abs(s) < 1:
                rest = 1 - s * s
                a = scale * math.exp(-1 / rest) * -2 * s / rest**2 / half
            file.write(f"{k * step:.{decimals}f},{a:.17g}\n")


def machine():
    """Name of the processor and number of cores."""
    name = platform.processor() or platform.machine()
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    except OSError:
        pass
    try:
        cores = len(os.sched_getaffinity(0))
    except AttributeError:
        cores = os.cpu_count()
    return name, cores


def find_program(given):
    """The program to measure: what is given, or the release build of this checkout."""
    if given:
        found = shutil.which(given)
        if not found:
            raise SystemExit(f"no program at {given}")
        return str(Path(found).resolve())
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    built = target / "release" / "flexlink"
    if not built.exists():
        raise SystemExit(f"no program at {built}: cargo build --release, or --flexlink PATH")
    return str(built)


def run(command, log, environment=None):
    """Runs a whole process; its wall time in s. What it prints goes into `log`."""
    with log.open("w") as file:
        start = time.perf_counter()
        done = subprocess.run(
            command, stdout=file, stderr=subprocess.STDOUT, env=environment, check=False
        )
        wall = time.perf_counter() - start
    if done.returncode:
        words = " ".join(map(str, command))
        raise SystemExit(f"{words}\nfailed with {done.returncode}:\n{log.read_text()}")
    return wall


def peak_memory_mb(command, log, environment=None):
    """Runs a whole process; its peak resident memory in MB, with a < where only a bound is known.

    A child inherits the peak of the process that starts it, hence GNU time, which is small, where
    it is there.
    """
    gnu_time = shutil.which("time")
    if gnu_time:
        with tempfile.NamedTemporaryFile("r") as told:
            run([gnu_time, "-f", "%M", "-o", told.name, *command], log, environment)
            return f"{1024 * int(told.read().split()[-1]) / 1e6:.0f}"
    with log.open("w") as file:
        process = subprocess.Popen(
            command, stdout=file, stderr=subprocess.STDOUT, env=environment
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{command[0]} failed with {process.returncode}:\n{log.read_text()}")
    unit = 1 if platform.system() == "Darwin" else 1024
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    bound = "< " if usage.ru_maxrss <= own else ""
    return f"{bound}{unit * usage.ru_maxrss / 1e6:.0f}"


def seconds(value):
    """A time with three digits and its unit."""
    if value >= 9.995:
        return f"{value:.1f} s"
    if value >= 0.9995:
        return f"{value:.2f} s"
    milliseconds = 1e3 * value
    digits = 0 if milliseconds >= 99.95 else 1 if milliseconds >= 9.995 else 2
    return f"{milliseconds:.{digits}f} ms"
