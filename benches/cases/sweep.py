"""`flexlink sweep --vary 'segments.*.EI*=FROM:TO:COUNT:log'` in numpy:
python sweep.py LINK MOTION CUTOFF_HZ FROM TO COUNT TABLE.

All frequencies of some cases at a time, on all cores. Left out: the search of the cut-off, the slow
tail of hysteretic damping, periods, zeros, the mesh's own error, the error at the window's edge, and
all checks of the inputs.
"""

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from copy import copy

import numpy as np

import tables
from chain import Link, eliminate

# Cases at a time.
BLOCK = 4
# Share of the peak acceleration, and of the peak torque, above which the tip moves and torque acts.
MOVES, ACTS = 1e-6, 0.02
COLUMNS = (
    "peak_torque_n_m,rms_torque_n_m,peak_rigid_torque_n_m,torque_ratio,lead_s,lag_s,"
    "peak_hub_rate_rad_s,peak_power_w,peak_root_moment_n_m,peak_deflection_m"
)


def stiffer(link, factors):
    """The link with stiffnesses for several cases."""
    varied = copy(link)
    known = {id(e): copy(e) for e in link.elements}
    for element in known.values():
        element.k = element.k * factors[:, None]
    varied.elements = [known[id(e)] for e in link.elements]
    return varied


def main(link_file, motion_file, cutoff_hz, start, stop, count, table):
    link = Link(link_file)
    time, a = tables.read(motion_file)
    samples = len(a)
    step = (time[-1] - time[0]) / (samples - 1)
    wanted = np.fft.rfft(a, norm="forward")
    first_rate, _ = tables.at_rest(wanted, samples * step)
    omega, spectrum = tables.rolled_off(wanted, samples * step, cutoff_hz)
    band = len(omega) + 1
    square = omega**2
    followed = np.fft.irfft(np.append(0, spectrum), samples, norm="forward")
    mu = link.stiffness_factor / square
    rigid_rate = np.fft.irfft(np.append(0, spectrum / (1j * omega)), samples, norm="forward")
    rigid_rate = (rigid_rate - first_rate) / link.length
    peak_rigid = np.abs(followed).max() * link.rigid_inertia / link.length
    moving = np.flatnonzero(np.abs(a) > MOVES * np.abs(a).max())
    moves_from, moves_until = time[moving[0] - 1], time[moving[-1] + 1]
    factors = np.geomspace(start, stop, count)

    def rows(begin):
        part = factors[begin : begin + BLOCK]
        inertia, e_tip, _ = eliminate(stiffer(link, part), mu, False)
        spectra = np.zeros((4, len(part), band), dtype=complex)
        angle = (spectrum / -square) / (e_tip + link.length)
        force = angle * -square
        np.multiply(inertia, force, out=spectra[0, :, 1:])
        spectra[1, :, 1:] = spectra[0, :, 1:] + link.hub_inertia * force
        np.multiply(e_tip, angle, out=spectra[2, :, 1:])
        np.multiply(spectra[2, :, 1:], omega * (-1j / link.length), out=spectra[3, :, 1:])
        moment, torque, deflection, rate = np.fft.irfft(spectra, samples, norm="forward")
        rate += rigid_rate
        size = np.abs(torque)
        peak = size.max(axis=1)
        acts = size > ACTS * peak[:, None]
        first, last = acts.argmax(axis=1), samples - 1 - acts[:, ::-1].argmax(axis=1)
        # The level is crossed on the straight line between two samples.
        level = ACTS * peak
        case = np.arange(len(part))
        before = (size[case, first] - level) / (size[case, first] - size[case, first - 1])
        after = (size[case, last] - level) / (size[case, last] - size[case, last + 1])
        rms = [np.sqrt(np.mean(t[i : j + 1] ** 2)) for t, i, j in zip(torque, first, last)]
        return np.column_stack(
            [
                part,
                peak,
                rms,
                np.full(len(part), peak_rigid),
                peak / peak_rigid,
                moves_from - time[first] + before * step,
                time[last] + after * step - moves_until,
                np.abs(rate).max(axis=1),
                np.abs(torque * rate).max(axis=1),
                np.abs(moment).max(axis=1),
                np.abs(deflection).max(axis=1),
            ]
        )

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = np.vstack(list(pool.map(rows, range(0, count, BLOCK))))
    with open(table, "w") as file:
        file.write("segments.*.EI," + COLUMNS + "\n")
        file.write((",".join(["%.12g"] * found.shape[1]) + "\n") * count % tuple(found.ravel()))


if __name__ == "__main__":
    main(*sys.argv[1:3], *map(float, sys.argv[3:6]), int(sys.argv[6]), sys.argv[7])
