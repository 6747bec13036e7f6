"""The torques of an arm of two flexible links whose tip follows a path, linear or with all terms.

The links are solved from the last inward, each on its chord with what the next one does to its tip.
Second-order terms are loads that follow from the last answer; the fixed point is the inextensible
elastica.
"""

from typing import NamedTuple

import numpy as np

from chords import amplitudes, axes, bar, derivatives, frequencies, history, reach
from link import Recursion, bent, second_order

# Second-order terms are made of deflections up to where the torques beyond are this share of all; what
# links shorten by moves the chords up to twice the bins of another share: it is a square of deflections.
NEGLIGIBLE, NEGLIGIBLE_SHORTENING = 1e-8, 1e-10
# Products of three reach three times as far; in so many bins those of five have no alias.
REACH, RESOLVED = 3, 2 / 5
# Shares of the torques' ranges.
SETTLED, DIVERGED, MOST_ITERATIONS = 1e-9, 1e-7, 30


class Answer(NamedTuple):
    """At the samples that the arm is solved at; links first."""

    torques: np.ndarray
    # Amplitudes of (w, w') of all nodes of each link.
    deflections: list
    # On the inner end of each link, along its chord and across it.
    forces: np.ndarray
    # Amplitudes of what each chord is shorter by than its link.
    shortened: np.ndarray
    iterations: int = 0


def counting(histories, share):
    """Bins up to the last one that counts: all beyond together are this share of a history."""
    sizes = np.abs(amplitudes(histories))
    beyond = np.cumsum(sizes[:, ::-1], axis=1)[:, ::-1]
    return np.max(np.sum(beyond > share * beyond[:, :1], axis=1))


def onto(vector, unit):
    return (vector * unit).sum(0)


class Arm:
    """An arm whose unbent chords move as given over a period; it is solved at `few` samples of it."""

    def __init__(self, links, gravity, chords, step, few=None):
        self.links, self.gravity, self.unbent = links, gravity, chords
        self.samples, self.few = chords.shape[-1], few
        self.step, self.omega = step, frequencies(self.samples, step)
        self.lengths = np.array([[link.length, 0, 0] for link in links])[:, :, None]
        # Where the tip is kept while links shorten.
        lengths = self.lengths + np.zeros((1, 1, self.samples))
        self.tip = np.array([sum(map(bar, lengths, chords, [n, n])) for n in range(3)])

    def refined(self):
        links = [link.refined() for link in self.links]
        return Arm(links, self.gravity, self.unbent, self.step, self.few)

    def to_bins(self, values):
        return amplitudes(values)[..., : self.bins]

    def to_all(self, values):
        """At all samples of the period what is given at few."""
        return history(self.to_bins(values), self.samples)

    def chords(self, shortened, samples):
        """Chords and their lengths, (2, 3, samples) with two derivatives, of links that shorten."""
        stride = self.samples // samples
        if not shortened.any():
            return self.unbent[..., ::stride], self.lengths + np.zeros((1, 1, samples))
        by = history(derivatives(shortened, self.omega), samples)
        lengths = self.lengths - by.swapaxes(0, 1)
        return reach(self.tip[..., ::stride], lengths), lengths

    def swept(self, shortened, shapes=None):
        """All links from the last inward, with the loads of these shapes; without shapes linear."""
        chords, lengths = self.chords(shortened, self.few)
        base = -self.gravity[:, None] + np.zeros((2, self.few))
        axis = [base, base + bar(lengths[0], chords[0], 2)]
        force, torque = np.zeros((2, self.few)), np.zeros(self.few)
        torques, deflections, forces = [None] * 2, [None] * 2, [None] * 2
        for i in (1, 0):
            link, (angle, rate, turning) = self.links[i], chords[i]
            e, n = axes(angle)
            tip_along, tip_across, held = -onto(force, e), -onto(force, n), onto(axis[i], e)
            if shapes is None:
                mass, moment, _ = link.inertia()
                along = mass * held - moment * rate**2 - tip_along
                nodal = np.zeros((link.elements + 1, 2, self.bins), complex)
            else:
                moving = rate, turning, held, tip_along, torque
                loads, along = second_order(link, shapes[i], moving)
                nodal = self.to_bins(loads)
            nodal[-1] += self.to_bins(np.array([tip_across, -torque]))
            moved = self.to_bins(np.array([onto(axis[i], n), turning]))
            deflections[i], *root = self.recursions[i].solved(*moved, nodal)
            torque, across = history(np.array(root), self.few)
            if shapes is not None:
                # The hub turns by the angle of its slope.
                torque *= np.sqrt(1 - history(deflections[i][0, 1], self.few) ** 2)
            torques[i], forces[i] = torque, (along, across)
            force = along * e + across * n
        return Answer(np.array(torques), deflections, np.array(forces), shortened)

    def shapes(self, deflections, band):
        """The links' shapes in time, of deflections up to a band."""
        spectra = (derivatives(own[..., :band], self.omega) for own in deflections)
        return [bent(link, history(own, self.few)) for link, own in zip(self.links, spectra)]

    def linear(self, times):
        """The linear answer, at as few samples as resolve so many times the bins of its torques."""
        none, few = np.zeros((2, 1)), self.few
        if few is None:
            few, band = self.samples, counting(self.unbent[:, 2], NEGLIGIBLE)
            while few % 4 == 0 and RESOLVED * few / 2 > times * band:
                few //= 2
        while True:
            self.few, self.bins = few, int(RESOLVED * few)
            self.recursions = [Recursion(link, self.omega[: self.bins]) for link in self.links]
            found = self.swept(none)
            if self.bins > times * counting(found.torques, NEGLIGIBLE) or 2 * few > self.samples:
                return found
            few *= 2

    def full(self):
        """The answer with all terms."""
        found = self.linear(REACH)
        band = counting(found.torques, NEGLIGIBLE)
        moving = min(self.bins, 2 * counting(found.torques, NEGLIGIBLE_SHORTENING))
        change = np.inf
        for iterations in range(1, MOST_ITERATIONS + 1):
            shapes = self.shapes(found.deflections, band)
            shortened = -np.array([shape.u_nodes[0, -1] for shape in shapes])
            latest = self.swept(amplitudes(shortened)[:, :moving], shapes)
            off = np.max(np.abs(latest.torques - found.torques), axis=1)
            last, change = change, np.max(off / np.ptp(latest.torques, axis=1))
            found = latest._replace(iterations=iterations)
            # What all further iterations would change if each did by the same factor.
            further = change * change / (last - change) if change < last else change
            if iterations > 1 and (further < SETTLED or change >= last):
                break
        if not further < DIVERGED:
            raise ArithmeticError(f"the second-order terms do not converge: {further:.1e}")
        return found

    def solved(self, level):
        return self.full() if level == "full" else self.linear(1)
