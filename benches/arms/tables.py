"""The tables of a solved arm: flexlink's files and columns."""

import numpy as np

from chords import axes, bar, derivatives, history

ORDERS = range(3)


def rigid_torques(links, gravity, chords):
    """Those of the rigid arm by the recursive Newton-Euler method."""
    axis, moved = -gravity[:, None] + 0 * chords[0, :1], []
    for link, (angle, rate, turning) in zip(links, chords):
        e, n = axes(angle)
        per_m = turning * n - rate**2 * e
        moved.append((axis, per_m, n, turning))
        axis = axis + link.length * per_m
    force, torque, torques = 0 * axis, 0, []
    for link, (axis, per_m, n, turning) in zip(links[::-1], moved[::-1]):
        mass, moment, inertia = link.inertia()
        torque = torque + inertia * turning + ((moment * axis + link.length * force) * n).sum(0)
        force = force + mass * axis + moment * per_m
        torques.insert(0, torque)
    return np.array(torques)


def relative(chords):
    """What each link does against the one before."""
    return np.array([chords[0], chords[1] - chords[0]])


def joint_angles(arm, answer, chords):
    """Angle, rate and acceleration of each joint: of a link's root against the tip of the one before."""
    slopes = np.array([history(own[[0, -1], 1], arm.few) for own in answer.deflections])
    if answer.iterations:
        slopes = np.arcsin(slopes)
    (root1, tip1), (root2, _) = slopes
    spectra = arm.to_bins(np.array([root1, root2 - tip1]))
    bent = history(derivatives(spectra, arm.omega), arm.samples)
    return bent.swapaxes(0, 1) + relative(chords)


def positions(arm, answer, chords, joints):
    """x and y of all nodes of each link."""
    shapes = arm.shapes(answer.deflections, arm.bins) if answer.iterations else [None, None]
    found = []
    for link, own, shape, chord, joint in zip(arm.links, answer.deflections, shapes, chords, joints):
        e, n = axes(chord[0])
        x = link.element_m() * np.arange(link.elements + 1)[:, None]
        if shape is not None:
            x = x + arm.to_all(shape.u_nodes[0])
        w = history(own[:, 0], arm.samples)
        found.append(joint + x[:, None] * e + w[:, None] * n)
    return np.concatenate(found)


def histories(arm, answer, torques, rigid):
    """The columns of each table beside time, link after link; `rigid` are the rigid arm's chords."""
    chords, lengths = arm.chords(answer.shortened, arm.samples)
    ends = np.array([[bar(*own, order) for order in ORDERS] for own in zip(lengths, chords)])
    joints = np.array([0 * ends[0, 0], ends[0, 0]])
    e, n = np.array([axes(chord[0]) for chord in chords]).swapaxes(0, 1)
    along, across = arm.to_all(answer.forces).swapaxes(0, 1)[:, :, None]
    angles = joint_angles(arm, answer, chords)
    return {
        "torques": torques,
        "rigid_torques": rigid_torques(arm.links, arm.gravity, rigid),
        "joint_angles": np.concatenate([angles, relative(rigid[:, :1])], axis=1),
        "chord_angles": np.concatenate([chords, lengths[:, :1]], axis=1),
        "tip": ends.sum(0),
        "reactions": along * e + across * n,
        "nodal_positions": positions(arm, answer, chords, joints),
    }


def names(links):
    """The names of those columns."""

    def numbered(*columns):
        return [column.format(link) for link in (1, 2) for column in columns]

    turning = "{}_rad", "{}_rate_rad_s", "{}_acceleration_rad_s2"
    nodes = [(i + 1, node) for i, link in enumerate(links) for node in range(link.elements + 1)]
    return {
        "torques": numbered("torque{}_n_m"),
        "rigid_torques": numbered("rigid_torque{}_n_m"),
        "joint_angles": numbered(*("joint" + name for name in turning), "rigid_joint{}_rad"),
        "chord_angles": numbered(
            "angle{}_rad", "rate{}_rad_s", "acceleration{}_rad_s2", "length{}_m"
        ),
        "tip": ["x_m", "y_m", "velocity_x_m_s", "velocity_y_m_s"]
        + ["acceleration_x_m_s2", "acceleration_y_m_s2"],
        "reactions": numbered("force{}_x_n", "force{}_y_n"),
        "nodal_positions": [f"{axis}{i}_{node}_m" for i, node in nodes for axis in "xy"],
    }


def write(folder, time_s, rows, tables, links):
    """Writes these rows of all tables, and the places of the nodes on the unbent links."""
    folder.mkdir()
    for name, columns in names(links).items():
        table = np.vstack([time_s, tables[name].reshape(len(columns), -1)[:, rows]])
        header = ",".join(["time_s", *columns])
        np.savetxt(folder / f"{name}.csv", table.T, "%.11g", ",", header=header, comments="")
    lines = [
        f"{i + 1},{node},{link.element_m() * node:.17g},link{i + 1}\n"
        for i, link in enumerate(links)
        for node in range(link.elements + 1)
    ]
    (folder / "nodes.csv").write_text("link,node,x_m,name\n" + "".join(lines))
