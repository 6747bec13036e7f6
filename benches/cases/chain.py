"""The link in numpy: its elements, and the elimination from tip to hub at many frequencies at once.

Each element's outer end is described relative to the rigid motion of its inner end, so that no
digit is lost at low frequency. Every quantity is an array over frequencies (and cases); 2x2 blocks
are written out, which is several times faster than numpy's stacked small matrices.
"""

import tomllib


class Element:
    """A uniform Hermite element; slopes are scaled by its length, so that all entries are in kg."""

    def __init__(self, length, stiffness, mass_per_length):
        m = mass_per_length * length
        self.length = length
        self.k = stiffness / length**3
        self.dd = (156 * m / 420, -22 * m / 420, 4 * m / 420)
        self.ud = (m / 2, -m / 12, 7 * m / 20, -m / 20)
        self.uu = (m, m / 2, m / 3)


class Link:
    """What the measured links have: uniform segments, a hub, hysteretic damping."""

    def __init__(self, path):
        with open(path, "rb") as file:
            told = tomllib.load(file)
        self.elements, self.nodes, self.names = [], [0.0], [told["segments"][0]["name"]]
        for segment in told["segments"]:
            count = segment["elements"]
            length = segment["length"] / count
            element = Element(length, segment["EI"], segment["mass_per_length"])
            start = self.nodes[-1]
            self.nodes += [start + length * k for k in range(1, count + 1)]
            self.names += [segment["name"]] * count
            self.elements += [element] * count
        self.length = self.nodes[-1]
        self.hub_inertia = told["hub"]["inertia"]
        self.stiffness_factor = 1 + 2j * told["damping"]["ratio"]
        self.rigid_inertia = self.hub_inertia + sum(
            x * x * e.uu[0] + 2 * x * e.length * e.uu[1] + e.length**2 * e.uu[2]
            for x, e in zip(self.nodes, self.elements)
        )


def eliminate(link, mu, keep):
    """From tip to hub. `mu` is the complex stiffness factor over the squared frequency.

    Returns the apparent inertia of the link about the axis, the tip's excess displacement for a
    unit hub angle, and with `keep` the four gains of every element from the hub outward.
    """
    a11 = a12 = a22 = 0.0  # apparent inertia of all that is outboard
    t1 = t2 = 0.0  # tip's excess over rigid motion, per displacement and slope
    rest = 0.0  # distance to the tip
    gains = []
    last = None
    for element in reversed(link.elements):
        if element is not last:
            if last is not None:
                scale = element.length / last.length
                a12, a22, t2 = a12 * scale, a22 * scale**2, t2 * scale
            h = element.length
            d1, d2, d3 = element.dd
            u1, u2, u3, u4 = element.ud
            w1, w2, w3 = element.uu
            k11 = mu * (12 * element.k)
            k12 = mu * (-6 * element.k) - d2
            k22 = mu * (4 * element.k) - d3
            k11 -= d1
            last = element
        c11, c12, c22 = k11 - a11, k12 - a12, k22 - a22
        r, s = a11 + a12, a12 + a22
        b11, b12, b21, b22 = a11 + u1, a12 + u2, r + u3, s + u4
        inverse = 1.0 / (c11 * c22 - c12 * c12)
        c11, c12, c22 = c11 * inverse, c12 * inverse, c22 * inverse
        # d = G u, G = C^-1 B^T
        g11, g12 = c22 * b11 - c12 * b12, c22 * b21 - c12 * b22
        g21, g22 = c11 * b12 - c12 * b11, c11 * b22 - c12 * b21
        a22 = r + s + (b21 * g12 + b22 * g22 + w3)
        a12 = r + (b11 * g12 + b12 * g22 + w2)
        a11 = a11 + (b11 * g11 + b12 * g21 + w1)
        if keep:
            gains.append((g11, g12, g21, g22))
        else:
            # (1, rest) + t is the tip's displacement per (displacement, slope) of the outer end.
            p, q = t1 + 1.0, t2 + rest / h
            t2 = t1 + t2 + (p * g12 + q * g22)
            t1 = t1 + (p * g11 + q * g21)
            rest += h
    gains.reverse()
    return a22 * h**2, t2 * h if not keep else None, gains


def deflect(link, gains, out):
    """From hub to tip: rows of `out` become the deflections of the nodes for a unit hub angle."""
    v = phi = 0.0
    out[0] = 0.0
    last = link.elements[0].length
    for k, (element, (g11, g12, g21, g22)) in enumerate(zip(link.elements, gains)):
        h = element.length
        if h != last:
            phi, last = phi * (h / last), h
        x, y = v + link.nodes[k], phi + h
        v = v + phi + (g11 * x + g12 * y)
        phi = phi + (g21 * x + g22 * y)
        out[k + 1] = v
