"""The chords of an arm of two links, the lines from joint to joint, whose tip follows a path.

The path is taken over a period, up to the frequency that its tolerance asks for.
"""

import numpy as np

# End of the roll-off over the cut-off.
ROLL_OFF = 1.5
# How often the bracket of a cut-off is halved, on a scale of octaves.
HALVINGS = 16


def amplitudes(history):
    return np.fft.rfft(history, norm="forward")


def history(spectrum, samples):
    return np.fft.irfft(spectrum, samples, norm="forward")


def frequencies(samples, step):
    return 2 * np.pi * np.fft.rfftfreq(samples, step)


def derivatives(spectrum, omega):
    """Amplitudes of a quantity and of its two derivatives."""
    omega = omega[: spectrum.shape[-1]]
    return np.array([spectrum, 1j * omega * spectrum, -(omega**2) * spectrum])


def axes(angle):
    """Unit vectors along a chord and across it, (2, 2, samples)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, sine], [-sine, cosine]])


def bar(length, angle, order):
    """Place, velocity or acceleration of a bar's outer end against its inner one; length and angle have
    their two derivatives."""
    l, l1, l2 = length
    _, rate, turning = angle
    along, across = [
        (l, 0 * l),
        (l1, l * rate),
        (l2 - l * rate**2, 2 * l1 * rate + l * turning),
    ][order]
    e, n = axes(angle[0])
    return along * e + across * n


def reach(tip, lengths):
    """Angles of two bars, (2, 3, samples) with rates and accelerations, whose end moves as given; the
    second turns left of the first."""
    (x, y), (l1, l2) = tip[0], lengths[:, 0]
    elbow = np.arccos((x * x + y * y - l1**2 - l2**2) / (2 * l1 * l2))
    first = np.unwrap(np.arctan2(y, x) - np.arctan2(l2 * np.sin(elbow), l1 + l2 * np.cos(elbow)))
    angles = np.zeros((2, 3, len(x)))
    angles[:, 0] = first, first + elbow
    n1, n2 = (axes(angle[0])[1] for angle in angles)
    determinant = n1[0] * n2[1] - n1[1] * n2[0]
    for order in (1, 2):
        # What the rates found so far leave: the bars' own turning makes up for it.
        left = tip[order] - bar(lengths[0], angles[0], order) - bar(lengths[1], angles[1], order)
        angles[0, order] = (left[0] * n2[1] - left[1] * n2[0]) / (determinant * l1)
        angles[1, order] = (n1[0] * left[1] - n1[1] * left[0]) / (determinant * l2)
    return angles


def weight(omega, cutoff):
    """1 up to the cut-off, then a raised cosine over half of it."""
    beyond = np.clip((omega / cutoff - 1) / (ROLL_OFF - 1), 0, 1)
    return 0.5 * (1 + np.cos(np.pi * beyond))


def lowest_cutoff(displacement, omega, samples, allowed):
    """The lowest cut-off that leaves at most `allowed` of a displacement out at any time."""
    low, high = omega[1], omega[-1] / ROLL_OFF
    for _ in range(HALVINGS):
        middle = np.sqrt(low * high)
        left = np.max(np.abs(history(displacement * (1 - weight(omega, middle)), samples)))
        low, high = (low, middle) if left <= allowed else (middle, high)
    return high


def band_limited(rows, step, samples, tolerance):
    """Place, velocity and acceleration, (3, 2, samples), of a tip that rests before and after its rows;
    the rest before them is at the end of the period."""
    given, travel = rows.shape[1], rows[:, -1:] - rows[:, :1]
    second = np.zeros((2, samples))
    second[:, 1 : given - 1] = np.diff(rows, 2) / step**2
    omega = frequencies(samples, step)
    # The second difference of a sine is (sin z / z)² of its second derivative.
    acceleration = amplitudes(second) / np.sinc(omega * step / (2 * np.pi)) ** 2
    displacement = np.zeros_like(acceleration)
    displacement[:, 1:] = -acceleration[:, 1:] / omega[1:] ** 2
    allowed = tolerance * np.max(np.abs(rows - rows[:, :1])) / 2
    for own in displacement:
        own *= weight(omega, lowest_cutoff(own, omega, samples, allowed))
    parts = derivatives(displacement, omega)
    parts[1, :, :1] = travel / (samples * step)
    tip = history(parts, samples)
    # The displacement is periodic but for its travel, and begins at rest in the middle of the rest.
    seam = (given + samples) // 2
    since = (np.arange(samples) - seam) % samples
    tip[0] += rows[:, :1] - tip[0, :, seam : seam + 1] + travel * since / samples
    return tip


def smooth_step(x):
    """The step of ninth order from 0 to 1."""
    return x**5 * (126 - 420 * x + 540 * x**2 - 315 * x**3 + 70 * x**4)


def returned(chords, given):
    """Chords that return to where they start, at rest behind the path's rows, so that all is periodic.

    What the cut-off leaves of the motion rings in the rest: it fades out and in again.
    """
    chords, samples = chords.copy(), chords.shape[-1]
    quiet = (samples - given) // 8
    begin, count = given + quiet, samples - given - 2 * quiet
    x = np.arange(1, count + 1) / (count + 1)
    part = chords[..., begin : begin + count]
    end, start = chords[:, 0, begin - 1, None], chords[:, 0, begin + count, None]
    fade = smooth_step(np.abs(1 - 2 * x))
    ringing = fade * (part[:, 0] - np.where(x < 0.5, end, start))
    part[:, 0] = end + (start - end) * smooth_step(x) + ringing
    part[:, 1:] *= fade
    return chords
