"""`flexlink solve` in numpy, scipy and polars: python solve.py LINK MOTION CUTOFF_HZ DIR [EVERY].

Left out: the search of the cut-off, the slow tail of hysteretic damping, the mesh's own error, periods
and zeros, summary.json, and all checks of the inputs.
"""

import os
import sys

import numpy as np

import tables
from chain import Link, deflect, eliminate

# Frequencies at a time: what the elimination of one element touches stays in the cache.
BLOCK = 1024
# From here on the transforms are worth the import of scipy, which has threads.
MANY_SAMPLES = 1_000_000


def transfers(link, omega, v_tip):
    """Spectra of torque, excess hub angle and displacements at the nodes beyond x/L of the tip's."""
    torque, excess = np.empty_like(v_tip), np.empty_like(v_tip)
    nodes = np.array(link.nodes)[:, None]
    moved = np.empty((len(link.nodes), len(omega)), dtype=complex)
    for start in range(0, len(omega), BLOCK):
        part = slice(start, min(start + BLOCK, len(omega)))
        square = omega[part] ** 2
        inertia, _, gains = eliminate(link, link.stiffness_factor / square, True)
        e = moved[:, part]
        deflect(link, gains, e)
        angle = v_tip[part] / (link.length + e[-1])
        torque[part] = -square * (inertia + link.hub_inertia) * angle
        excess[part] = -e[-1] / link.length * angle
        e *= angle
        e += nodes * excess[part]
    return torque, excess, moved


def inverse(spectra, samples):
    if spectra.shape[0] * samples < MANY_SAMPLES:
        return np.fft.irfft(spectra, samples, norm="forward")
    from scipy import fft

    # As many at a time as the cache holds once they are padded with zeros.
    histories = np.empty((spectra.shape[0], samples))
    step = max(2, (1 << 18) // samples)
    for start in range(0, len(spectra), step):
        part = slice(start, start + step)
        histories[part] = fft.irfft(
            spectra[part], samples, norm="forward", workers=os.cpu_count(), overwrite_x=True
        )
    return histories


def main(link_file, motion_file, cutoff_hz, folder, every=1):
    link = Link(link_file)
    time, a = tables.read(motion_file)
    samples = len(a)
    step = (time[-1] - time[0]) / (samples - 1)
    wanted = np.fft.rfft(a, norm="forward")
    first_rate, first = tables.at_rest(wanted, samples * step)
    omega, spectrum = tables.rolled_off(wanted, samples * step, cutoff_hz)
    band = len(omega) + 1
    rate = 1j * omega
    v_tip = -spectrum / omega**2

    torque, excess, moved = transfers(link, omega, v_tip)

    def filled(rows):
        rows = np.atleast_2d(rows)
        full = np.zeros((rows.shape[0], band), dtype=complex)
        full[:, 1:] = rows
        return full

    # The wanted tip rests at the start: that gives the mean velocity and the displacement's origin.
    rows = [spectrum, spectrum / rate, v_tip, torque, excess, excess * rate, excess * rate**2]
    a, rate_tip, tip, torque, angle, angle_rate, angle_acceleration = inverse(
        filled(np.array(rows)), samples
    )
    rate_tip = rate_tip - first_rate
    tip = tip - first - first_rate * (time - time[0])
    length = link.length

    os.mkdir(folder)
    times = tables.time_decimals(step)

    def write(name, columns, groups=None):
        names, values = zip(*columns)
        places = [tables.decimals(v) for v in values] if groups is None else groups
        tables.write(
            os.path.join(folder, name), ("time_s", *names), (time, *values), (times, *places)
        )

    write("torque.csv", [("torque_n_m", torque)])
    write("rigid_torque.csv", [("rigid_torque_n_m", link.rigid_inertia / length * a)])
    angle += tip / length
    angle_rate += rate_tip / length
    angle_acceleration += a / length
    write(
        "hub_angle.csv",
        [
            ("hub_angle_rad", angle),
            ("hub_rate_rad_s", angle_rate),
            ("hub_acceleration_rad_s2", angle_acceleration),
            ("rigid_hub_angle_rad", tip / length),
        ],
    )
    columns = [("displacement_m", tip), ("velocity_m_s", rate_tip), ("acceleration_m_s2", a)]
    write("tip.csv", [("tip_" + name, values) for name, values in columns])
    with open(os.path.join(folder, "nodes.csv"), "w") as file:
        file.write("node,x_m,segment\n")
        file.writelines(f"{k},{x:.10f},{n}\n" for k, (x, n) in enumerate(zip(link.nodes, link.names)))

    # Every K-th sample of a band that stays below the new Nyquist frequency is a shorter transform.
    if samples % every == 0 and band <= samples // every // 2:
        moved = inverse(filled(moved), samples // every)
    else:
        moved = np.ascontiguousarray(inverse(filled(moved), samples)[:, ::every])
    time, tip = time[::every], tip[::every]
    for row, x in zip(moved, link.nodes):
        row += x / length * tip
    columns = [(f"v{k}_m", row) for k, row in enumerate(moved)]
    write("nodal_displacements.csv", columns, [tables.decimals(moved)] * len(columns))


if __name__ == "__main__":
    main(*sys.argv[1:3], float(sys.argv[3]), sys.argv[4], *map(int, sys.argv[5:]))
