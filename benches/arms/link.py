"""One flexible link on its chord, the line from its inner joint to its outer end.

In frequency the link is solved by a recursion over its elements, all frequencies at once; in time its
second-order terms are summed up at Gauss points, all elements and samples at once.
"""

from typing import NamedTuple

import numpy as np

PLACES, WEIGHTS = np.polynomial.legendre.leggauss(5)
PLACES, WEIGHTS = (1 + PLACES) / 2, WEIGHTS / 2
# Integrals from 0 to each place of the polynomials that are 1 at one place and 0 at the others.
POWERS = np.arange(5)
WITHIN = PLACES[:, None] ** (POWERS + 1) / (POWERS + 1) @ np.linalg.inv(PLACES[:, None] ** POWERS)


class Link(NamedTuple):
    """A uniform link of equal elements with a mass on its outer end; SI units."""

    length: float
    stiffness: float
    mass_per_length: float
    tip_mass: float
    beta: float
    elements: int

    def refined(self):
        return self._replace(elements=2 * self.elements)

    def element_m(self):
        return self.length / self.elements

    def inertia(self):
        """Mass, first moment and rotary inertia about the inner joint."""
        l, beam = self.length, self.mass_per_length * self.length
        return (
            beam + self.tip_mass,
            beam * l / 2 + self.tip_mass * l,
            beam * l**2 / 3 + self.tip_mass * l**2,
        )


def onto(a, v):
    """Product of a 2 x 2 matrix and a vector whose entries are arrays."""
    return a[:, 0] * v[0] + a[:, 1] * v[1]


def times(a, b):
    """Product of two such matrices."""
    return a[:, :1] * b[:1] + a[:, 1:] * b[1:]


def inverse_of(a):
    """Inverse of a symmetric one."""
    adjoint = np.array([[a[1, 1], -a[0, 1]], [-a[0, 1], a[0, 0]]])
    return adjoint / (a[0, 0] * a[1, 1] - a[0, 1] ** 2)


def element_matrices(link):
    """A beam element whose deformation d is seen from the tangent line of its inner node: its stiffness
    on d, R that takes a rigid motion along, and the consistent masses of d, d and motion, motion."""
    l = link.element_m()
    stiffness = link.stiffness / l**3 * np.array([[12, -6 * l], [-6 * l, 4 * l**2]])
    m = link.mass_per_length * l / 420 * np.array(
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
    parts = stiffness, carry, outer, cross + carry.T @ outer, whole
    return [part[:, :, None] for part in parts]


class Recursion:
    """What does not depend on motion and loads: computed once for all iterations."""

    def __init__(self, link, omega):
        self.link, self.square = link, omega**2
        factor = 1 + 1j * omega * link.beta
        stiffness, carry, outer, cross, whole = element_matrices(link)
        apparent = np.zeros((2, 2, len(omega)), complex)
        apparent[0, 0] = link.tip_mass
        self.inverse, self.gain = np.empty((2, link.elements, *apparent.shape), complex)
        for e in reversed(range(link.elements)):
            self.inverse[e] = inverse_of(factor * stiffness - self.square * (outer + apparent))
            carried = times(carry.swapaxes(0, 1), apparent)
            b = cross + carried
            self.gain[e] = times(self.inverse[e], b.swapaxes(0, 1))
            apparent = whole + times(carried, carry) + self.square * times(b, self.gain[e])
        self.apparent = apparent
        self.onward = carry + self.square * self.gain
        # The deflections of a root that turns by 1 while the chord rests.
        zero = np.zeros_like(self.square)
        self.turned = self.expanded(np.array([zero, -self.square]), np.zeros_like(self.gain[:, 0]))
        self.turned += np.arange(link.elements + 1)[:, None, None] * [[[link.element_m()], [0]]]
        self.turned[:, 1] += 1

    def expanded(self, acceleration, held):
        """Deflections of all nodes from the root's tangent line, of the root's acceleration and of what
        the loads hold each element bent by."""
        inner = np.empty_like(held)
        for e in range(len(held)):
            inner[e] = acceleration
            acceleration = onto(self.onward[e], acceleration) + self.square * held[e]
        bent = -self.gain[:, :, 0] * inner[:, :1] - self.gain[:, :, 1] * inner[:, 1:] - held
        nodes = np.zeros((len(held) + 1, *held.shape[1:]), complex)
        np.cumsum(bent[:, 1], axis=0, out=nodes[1:, 1])
        np.cumsum(bent[:, 0] + self.link.element_m() * nodes[:-1, 1], axis=0, out=nodes[1:, 0])
        return nodes

    def solved(self, axis, turning, nodal):
        """Deflections (w, w') of all nodes from the chord, torque, and force across the chord on the root.

        `axis` is the acceleration of the inner joint across the chord, `turning` the chord's angular
        acceleration, `nodal` a force and a moment on every node, those on the tip included.
        """
        bias = np.empty_like(nodal)
        bias[-1] = -nodal[-1]
        for e in reversed(range(self.link.elements)):
            bias[e] = onto(self.onward[e].swapaxes(0, 1), bias[e + 1]) - nodal[e]
        held = self.inverse[:, :, 0] * bias[1:, :1] + self.inverse[:, :, 1] * bias[1:, 1:]
        free = self.expanded(np.array([axis, turning]), held)
        root = -free[-1, 0] / self.turned[-1, 0]
        force, torque = onto(self.apparent, [axis, turning - self.square * root]) + bias[0]
        return free + root * self.turned, torque, force


class Bent(NamedTuple):
    """A link's shape in time at the Gauss points of its elements, (elements, 5, samples)."""

    w: np.ndarray
    w_rate: np.ndarray
    sine: np.ndarray
    sine_rate: np.ndarray
    secant: np.ndarray
    curvature: np.ndarray
    curvature_rate: np.ndarray
    # How much farther along the chord than along the link, and its two derivatives.
    u: np.ndarray
    u_nodes: np.ndarray
    tip_secant: np.ndarray


def shapes(l):
    """Hermite's cubics on (w, w') of both nodes at the Gauss points, and their derivatives."""
    x = PLACES
    shape = [(1 - x) ** 2 * (1 + 2 * x), l * x * (1 - x) ** 2, x * x * (3 - 2 * x), l * x * x * (x - 1)]
    slope = [-6 * x * (1 - x) / l, (1 - x) * (1 - 3 * x), 6 * x * (1 - x) / l, x * (3 * x - 2)]
    curvature = [(12 * x - 6) / l**2, (6 * x - 4) / l, (6 - 12 * x) / l**2, (6 * x - 2) / l]
    return [np.array(rows).T for rows in (shape, slope, curvature)]


def bent(link, histories):
    """The shape that follows from (w, w') of all nodes and two derivatives, (3, nodes, 2, samples)."""
    l = link.element_m()
    shape, slope, curvature = shapes(l)
    dofs = np.concatenate([histories[:, :-1], histories[:, 1:]], axis=2)
    w, w_rate = shape @ dofs[:2]
    sine, rate, acceleration = slope @ dofs
    bending, bending_rate = curvature @ dofs[:2]
    cosine = np.sqrt(1 - sine**2)
    secant, turn = 1 / cosine, sine * rate
    # u' = cos - 1 without cancellation.
    stretch = np.array(
        [
            -(sine**2) / (1 + cosine),
            -turn * secant,
            -(rate**2 + sine * acceleration) * secant - turn**2 * secant**2 * secant,
        ]
    )
    u_nodes = np.zeros((3, link.elements + 1, sine.shape[-1]))
    np.cumsum(l * WEIGHTS @ stretch, axis=1, out=u_nodes[:, 1:])
    u = l * WITHIN @ stretch + u_nodes[:, :-1, None]
    tip_secant = 1 / np.sqrt(1 - histories[0, -1, 1] ** 2)
    return Bent(w, w_rate, sine, rate, secant, bending, bending_rate, u, u_nodes, tip_secant)


def second_order(link, own, moving):
    """Forces and moments on all nodes, (nodes, 2, samples), that make the linear link an inextensible
    elastica, without the tip's own load; and the force along the chord on its root.

    `moving` are rate and acceleration of the chord's direction, the inner joint's acceleration along the
    chord, the force on the tip along the chord, and the torque of the next joint.
    """
    rate, turning, axis, tip_force, tip_torque = moving
    l, mass = link.element_m(), link.mass_per_length
    s = l * (np.arange(link.elements)[:, None, None] + PLACES[:, None])
    u, u_rate, u_acceleration = own.u
    along = axis - rate**2 * (s + u) - turning * own.w - 2 * rate * own.w_rate + u_acceleration
    tip_u, tip_u_rate, tip_u_acceleration = own.u_nodes[:, -1]
    tip_along = axis - rate**2 * (link.length + tip_u) + tip_u_acceleration
    # The axial force, with the transpose of what integrates u'.
    forces = -mass * l * WEIGHTS[:, None] * along
    outer = np.cumsum(forces.sum(1)[::-1], axis=0)[::-1] + tip_force - link.tip_mass * tip_along
    beyond = np.concatenate([outer[1:], [tip_force - link.tip_mass * tip_along]])
    axial = beyond[:, None] + (WITHIN / WEIGHTS).T @ forces

    secant, cubed = own.secant, own.secant**2 * own.secant
    strain = own.curvature * secant
    strain_rate = own.curvature_rate * secant + own.curvature * own.sine * own.sine_rate * cubed
    bending = link.stiffness * (strain + link.beta * strain_rate)
    f = mass * (rate**2 * own.w - 2 * rate * u_rate - turning * u)
    m = -axial * own.sine * secant - bending * own.curvature * own.sine * cubed
    b = link.stiffness * (own.curvature + link.beta * own.curvature_rate) - bending * secant
    shape, slope, curvature = (l * WEIGHTS * part.T for part in shapes(l))
    loads = shape @ f + slope @ m + curvature @ b
    nodal = np.zeros((link.elements + 1, 2, len(rate)))
    nodal[:-1] += loads[:, :2]
    nodal[1:] += loads[:, 2:]
    nodal[-1, 0] -= link.tip_mass * (2 * rate * tip_u_rate + turning * tip_u)
    nodal[-1, 1] -= tip_torque * (own.tip_secant - 1)
    return nodal, -outer[0]
