#!/usr/bin/env python3
"""The linear torques of an arm of two links in numpy, all frequencies of one element at once.

    python3 solve.py ARM.toml PATH.csv SAMPLES BINS FOLDER

writes torques.csv, joint_angles.csv (angles alone) and nodal_deflections.csv, and prints the time of
the torques alone. The recursion is that of flexlink: from the last link inward, each on its chord,
its outboard part condensed element by element. Without its checks, the mesh's own error, window,
the terms that are left out, and the other tables.
"""

import sys
import time
import tomllib
from pathlib import Path

import numpy as np


def element(length, stiffness, mass):
    """Stiffness and consistent mass of a beam element, the inner node's motion taken along."""
    k = stiffness / length**3 * np.array([[12, -6 * length], [-6 * length, 4 * length**2]])
    l = length
    m = mass * l / 420 * np.array(
        [
            [156, 22 * l, 54, -13 * l],
            [22 * l, 4 * l * l, 13 * l, -3 * l * l],
            [54, 13 * l, 156, -22 * l],
            [-13 * l, -3 * l * l, -22 * l, 4 * l * l],
        ]
    )
    carry = np.array([[1, l], [0, 1.0]])
    inner, cross, outer = m[:2, :2], m[:2, 2:], m[2:, 2:]
    whole = inner + cross @ carry + carry.T @ cross.T + carry.T @ outer @ carry
    return k, carry, outer, cross + carry.T @ outer, whole


def times(a, b):
    """Products of 2 x 2 matrices whose entries are arrays."""
    return [[a[i][0] * b[0][j] + a[i][1] * b[1][j] for j in (0, 1)] for i in (0, 1)]


def onto(a, v):
    return [a[i][0] * v[0] + a[i][1] * v[1] for i in (0, 1)]


def turned(a):
    return [[a[0][0], a[1][0]], [a[0][1], a[1][1]]]


def condensed(link, omega, force):
    """Mass and force of the whole link at its root, and what each element needs on the way back."""
    square, factor = omega**2, 1 + 1j * omega * link["beta"]
    zero = 0j * omega
    a, p, steps = [[link["tip_mass"] + zero, zero], [zero, zero]], force, []
    k, carry, outer, cross, whole = link["element"]
    for _ in range(link["elements"]):
        dynamic = [
            [factor * k[i][j] - square * (outer[i][j] + a[i][j]) for j in (0, 1)] for i in (0, 1)
        ]
        share = 1 / (dynamic[0][0] * dynamic[1][1] - dynamic[0][1] * dynamic[1][0])
        inverse = [
            [dynamic[1][1] * share, -dynamic[0][1] * share],
            [-dynamic[1][0] * share, dynamic[0][0] * share],
        ]
        carried = times(carry.T, a)
        b = [[cross[i][j] + carried[i][j] for j in (0, 1)] for i in (0, 1)]
        gain, held = times(inverse, turned(b)), onto(inverse, p)
        steps.append((gain, held))
        x, y = times(carried, carry), times(b, gain)
        a = [[whole[i][j] + x[i][j] + square * y[i][j] for j in (0, 1)] for i in (0, 1)]
        inward, bent = onto(carry.T, p), onto(b, held)
        p = [inward[i] + square * bent[i] for i in (0, 1)]
    return a, p, steps


def expanded(link, omega, steps, moved):
    """Deflections of the nodes from the chord, and the angle of the root that keeps the tip on it."""
    square, carry = omega**2, link["element"][1]
    a, w = moved, [0j * omega, 0j * omega]
    a_turned, u = [0 * omega, -square], [0 * omega, 1 + 0 * omega]
    free, turn = [w], [u]
    for gain, held in reversed(steps):
        bent = [-x - h for x, h in zip(onto(gain, a), held)]
        a = [x - square * d for x, d in zip(onto(carry, a), bent)]
        w = [x + d for x, d in zip(onto(carry, w), bent)]
        bent = [-x for x in onto(gain, a_turned)]
        a_turned = [x - square * d for x, d in zip(onto(carry, a_turned), bent)]
        u = [x + d for x, d in zip(onto(carry, u), bent)]
        free.append(w)
        turn.append(u)
    root = -free[-1][0] / turn[-1][0]
    return root, [[f[i] + t[i] * root for i in (0, 1)] for f, t in zip(free, turn)]


def solve(links, gravity, path, samples, bins):
    """Torques, angles of the joints, and deflections of all nodes over the period."""
    t, x, y = path
    step, rows = (t[-1] - t[0]) / (len(t) - 1), len(t)
    l1, l2 = (link["length"] for link in links)
    elbow = np.arccos((x * x + y * y - l1**2 - l2**2) / (2 * l1 * l2))
    first = np.arctan2(y, x) - np.arctan2(l2 * np.sin(elbow), l1 + l2 * np.cos(elbow))
    angle = np.empty((2, samples))
    angle[:, :rows] = np.unwrap(first), np.unwrap(first) + elbow
    # Back to the start at rest.
    s = (np.arange(samples - rows) + 1) / (samples - rows)
    s = s**5 * (126 - 420 * s + 540 * s**2 - 315 * s**3 + 70 * s**4)
    end, begin = angle[:, rows - 1 : rows].copy(), angle[:, :1].copy()
    angle[:, rows:] = end + (begin - end) * s
    omega = 2 * np.pi * np.fft.rfftfreq(samples, step)
    second = np.zeros((2, samples))
    second[:, 1 : rows - 1] = np.diff(angle[:, :rows], 2) / step**2
    # The second difference of a sine is (sin z / z)² of its derivative.
    z = omega * step / 2
    turning = np.fft.rfft(second) / np.sinc(z / np.pi) ** 2
    turning[:, bins:] = 0
    rate = np.zeros_like(turning)
    rate[:, 1:] = turning[:, 1:] / (1j * omega[1:])
    rate[:, 0] = (end - begin)[:, 0] / step
    acceleration, rate = np.fft.irfft(turning, samples), np.fft.irfft(rate, samples)
    along = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-along[1], along[0]])
    axis = [np.repeat(-gravity[:, None], samples, 1)]
    axis.append(axis[0] - l1 * rate[0] ** 2 * along[:, 0] + l1 * acceleration[0] * across[:, 0])

    omega = omega[:bins]

    def to_bins(history):
        return np.fft.rfft(history)[:bins]

    def to_time(amplitudes):
        return np.fft.irfft(np.asarray(amplitudes), samples)

    force, torque, found = np.zeros((2, samples)), np.zeros(bins, complex), [None, None]
    for i in (1, 0):
        link, e, n = links[i], along[:, i], across[:, i]
        on_tip = [-to_bins((force * n).sum(0)), torque]
        mass, load, steps = condensed(link, omega, on_tip)
        moved = [to_bins((axis[i] * n).sum(0)), turning[i, :bins]]
        root, nodes = expanded(link, omega, steps, moved)
        f = onto(mass, [moved[0], moved[1] - omega**2 * root])
        shear, torque = f[0] + load[0], f[1] + load[1]
        held = (axis[i] * e).sum(0)
        axial = link["mass"] * held - link["moment"] * rate[i] ** 2 - (force * e).sum(0)
        force = -(axial * e + to_time(shear) * n)
        deflections = to_time([node[0] for node in nodes])
        found[i] = (to_time(torque), to_time(root), to_time(nodes[-1][1]), deflections)
    (torque1, root1, tip1, w1), (torque2, root2, _, w2) = found
    joints = [angle[0] + root1, angle[1] - angle[0] + root2 - tip1]
    return np.array([torque1, torque2]), np.array(joints), np.vstack([w1, w2])


def read(file):
    arm = tomllib.loads(Path(file).read_text())
    links = []
    for own in arm["links"]:
        [segment] = own["segments"]
        length, mass, elements = segment["length"], segment["mass_per_length"], segment["elements"]
        tip_mass = own.get("tip", own.get("payload"))["mass"]
        links.append(
            {
                "length": length,
                "elements": elements,
                "element": element(length / elements, segment["EI"], mass),
                "tip_mass": tip_mass,
                "mass": mass * length + tip_mass,
                "moment": mass * length**2 / 2 + tip_mass * length,
                "beta": own["damping"]["beta"],
            }
        )
    return links, np.array(arm["gravity"])


def main(arm, path, samples, bins, folder):
    links, gravity = read(arm)
    path = np.loadtxt(path, delimiter=",", skiprows=1).T
    begin = time.perf_counter()
    tables = solve(links, gravity, path, int(samples), int(bins))
    print(time.perf_counter() - begin)
    Path(folder).mkdir()
    step = (path[0][-1] - path[0][0]) / (len(path[0]) - 1)
    t = path[0][0] + step * np.arange(int(samples))
    for name, table in zip(["torques", "joint_angles", "nodal_deflections"], tables):
        np.savetxt(f"{folder}/{name}.csv", np.vstack([t, table]).T, fmt="%.10g", delimiter=",")


if __name__ == "__main__":
    main(*sys.argv[1:])
