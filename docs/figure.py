#!/usr/bin/env python3
"""Draws docs/torque.svg from result folders of the paper's two examples.

    flexlink solve specs/bayo1987_example1.toml trajectories/sine_0.88s.csv -o out/1
    flexlink solve specs/bayo1987_example2.toml trajectories/sine_0.88s.csv -o out/2
    python3 docs/figure.py out/1 out/2 > docs/torque.svg
"""
import csv
import sys

WIDTH, HEIGHT, GAP = 420, 250, 56
LEFT, TOP, BOTTOM = 52, 40, 46
FROM, TO = -0.6, 1.5


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))[1:]
    return [(float(row[0]), float(row[1])) for row in rows]


def panel(folder, title, x0, limit):
    def x(t):
        return x0 + (t - FROM) / (TO - FROM) * WIDTH

    def y(v):
        return TOP + (1 - (v + limit) / (2 * limit)) * HEIGHT

    def curve(name, style):
        points = [(t, v) for t, v in read(f"{folder}/{name}") if FROM <= t <= TO]
        path = " ".join(f"{x(t):.1f},{y(v):.1f}" for t, v in points[::4])
        return f'<polyline points="{path}" fill="none" {style}/>'

    torque = read(f"{folder}/torque.csv")
    peak = max(abs(v) for _, v in torque)
    acts = [t for t, v in torque if abs(v) > 0.02 * peak]
    out = [f'<text x="{x0}" y="{TOP - 14}" font-weight="bold">{title}</text>']
    for a, b in [(acts[0], 0.0), (0.88, acts[-1])]:
        out.append(f'<rect x="{x(a):.1f}" y="{TOP}" width="{x(b) - x(a):.1f}" height="{HEIGHT}" fill="#f2d9a6" fill-opacity="0.6"/>')
    for k in range(-3, 4):
        out.append(f'<path d="M{x0} {y(k):.1f}h{WIDTH}" stroke="#888" stroke-opacity="{0.9 if k == 0 else 0.25}"/>')
        out.append(f'<text x="{x0 - 8}" y="{y(k) + 4:.1f}" text-anchor="end">{k}</text>')
    for k in range(-1, 4):
        t = k * 0.5
        if FROM <= t <= TO:
            out.append(f'<path d="M{x(t):.1f} {TOP + HEIGHT}v5" stroke="#888"/>')
            out.append(f'<text x="{x(t):.1f}" y="{TOP + HEIGHT + 19}" text-anchor="middle">{t:g}</text>')
    out.append(curve("rigid_torque.csv", 'stroke="#4477aa" stroke-width="1.5" stroke-dasharray="6 4"'))
    out.append(curve("torque.csv", 'stroke="#aa3344" stroke-width="2.2"'))
    out.append(f'<text x="{x0 + WIDTH / 2}" y="{TOP + HEIGHT + 37}" text-anchor="middle">time [s]; the tip moves from 0 to 0.88 s</text>')
    return out


def main(first, second):
    total = LEFT + 2 * WIDTH + GAP + 12
    height = TOP + HEIGHT + BOTTOM
    print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {total} {height}" font-family="sans-serif" font-size="12" fill="#222">')
    print("<title>Hub torque for the same tip motion, two stiffnesses: flexible link (solid) and rigid link (dashed)</title>")
    print(f'<rect width="{total}" height="{height}" fill="#fff"/>')
    for line in panel(first, "I = 0.25e-2 cm⁴: torque [N m]", LEFT, 3.2):
        print(line)
    for line in panel(second, "I = 1e-2 cm⁴, four times stiffer", LEFT + WIDTH + GAP, 3.2):
        print(line)
    x = LEFT + WIDTH - 150
    print(f'<g transform="translate({x},{TOP + 14})"><path d="M0 0h28" stroke="#aa3344" stroke-width="2.2"/><text x="34" y="4">flexible link</text>')
    print('<path d="M0 18h28" stroke="#4477aa" stroke-width="1.5" stroke-dasharray="6 4"/><text x="34" y="22">rigid link</text></g>')
    print("</svg>")


main(*sys.argv[1:3])
