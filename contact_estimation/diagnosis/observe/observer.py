# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Motion of second-order dynamics under a force, and the innovations of an observer of it.

A model's misfit in position, run free, keeps every error for as long as the dynamics remember it.
The innovations x - x_predicted of an observer with cut-off omega_o forget it after 1 / omega_o,
and are white if the model is correct. Behind an elastic joint the link moves on its own.
"""

from functools import lru_cache
from math import exp
from typing import Sequence

import numpy as np
from scipy.signal import freqz, lfilter

from ...physics.contact_law import ContactLaw
from ...physics.numeric import Array, discretise, Flags, SecondOrder, stretches
from ...physics.robot_effect import Joint
from ...physics.robot_law import RobotLaw

_FREQUENCIES = 4096  # at which spectra are averaged

OBSERVER_CUTOFF = 50.0
"""omega_o [rad/s] at a pace of 1: errors in the time of an impact are forgotten in 40 ms."""

FORGOTTEN = 12.0
"""Times 1 / omega_o: the observer has forgotten any error."""


def run(system: SecondOrder, force: Array, position: float, stiffness: float) -> Array:
    """Simulate the dynamics from rest."""
    moved = lfilter(system.position, system.denominator, force - stiffness * position)
    return np.asarray(moved + position)


def run_velocity(system: SecondOrder, force: Array, position: float, stiffness: float) -> Array:
    """Simulate the dynamics from rest; parameters as `run`."""
    return np.asarray(lfilter(system.velocity, system.denominator, force - stiffness * position))


def run_from(system: SecondOrder, force: Array, state: Array) -> Array:
    """Simulate the dynamics from a state."""
    # The first force has acted up to the first sample, and is in the state already.
    poles, known = system.denominator, np.array([system.position[0], system.velocity[0]])
    inherited = state - force[0] * known
    rows = zip((system.position, system.velocity), inherited, system.transition @ inherited)
    return np.array([
        lfilter(row, poles, force, zi=[first, second + poles[1] * first])[0]
        for row, first, second in rows])


def coast(system: SecondOrder, count: int) -> Array:
    """Simulate the dynamics without a force."""
    rest = np.zeros(count)
    return np.array([run_from(system, rest, state) for state in np.eye(2)])


def innovations(misfit: Array, system: SecondOrder, cutoff: float, h: float) -> Array:
    """Filter the misfit of a free run to the innovations of an observer."""
    pole = exp(-cutoff * h)
    return np.asarray(lfilter(system.denominator, [1.0, -2.0 * pole, pole * pole], misfit))


def innovations_of(
    force: Array, system: SecondOrder, observer: SecondOrder, cutoff: float, h: float
) -> Array:
    """Filter the motion that a force causes to the innovations of an observer."""
    if not np.array_equal(system.denominator, observer.denominator):
        return innovations(run(system, force, 0.0, 0.0), observer, cutoff, h)
    pole = exp(-cutoff * h)  # the poles of the dynamics are zeros of the observer
    return np.asarray(lfilter(system.position, [1.0, -2.0 * pole, pole * pole], force))


def innovations_under(
    force: Array, position: Array, start: float, system: SecondOrder, denominator: Array,
    stiffness: float,
) -> Array:
    """Filter the misfit of a run from rest under a force, without running it."""
    # The poles of the dynamics are zeros of the filter a / c, with a their denominator: what is
    # left is (a x - b f) / c, with b the numerator of the position.
    x, f = position - start, force - stiffness * start
    (_, a_1, a_2), (b_0, b_1, b_2) = system.denominator.tolist(), system.position.tolist()
    left = x - b_0 * f
    left[1:] += a_1 * x[:-1] - b_1 * f[:-1]
    left[2:] += a_2 * x[:-2] - b_2 * f[:-2]
    return np.asarray(lfilter([1.0], denominator, left))


def kalman_filter(
    system: SecondOrder, force_noise: float, position_noise: float,
    weights: Sequence[float] = (1.0,),
) -> tuple[Array, float]:
    """Design the stationary Kalman filter of dynamics driven by a noisy force."""
    # With a and b the polynomials of the position's transfer function, the spectra of both noises
    # add up to S |c|^2 = force_noise^2 |b|^2 + position_noise^2 |a|^2; the misfit of a free run
    # filtered by a / c is the innovation (spectral factorisation; Ljung 1999, section 4.3).
    a, b = system.denominator, np.convolve(system.position, weights)
    a = np.pad(a, (0, len(b) - len(a)))
    spectrum = (force_noise**2 * np.correlate(b, b, 'full')
                + position_noise**2 * np.correlate(a, a, 'full'))
    if not np.isfinite(spectrum).all():  # values far from the optimum
        return a, np.inf
    roots = np.roots(spectrum)
    count = len(b) - 1
    c = np.real(np.poly(roots[np.argsort(np.abs(roots))[:count]]))
    return c, float(np.sqrt(spectrum[count] / (c @ c)))


def innovation_std(
    system: SecondOrder, denominator: Array, force_noise: float, position_noise: float,
    weights: Sequence[float], block: int,
) -> float:
    """Compute what the noise of force and position leaves in innovations of any filter."""
    c = freqz([1.0], denominator, worN=_FREQUENCIES)[1]
    a = freqz(system.denominator, [1.0], worN=_FREQUENCIES)[1]
    b = freqz(np.convolve(system.position, weights), [1.0], worN=_FREQUENCIES)[1]
    averaged = freqz(np.full(block, block**-0.5), [1.0], worN=_FREQUENCIES)[1] * c
    spectrum = (force_noise * np.abs(b)) ** 2 + (position_noise * np.abs(a)) ** 2
    return float(np.sqrt(np.mean(spectrum * np.abs(averaged) ** 2)))


def at_touch_down(force: Array, d: Array) -> Array:
    """Keep the impulse of a force that begins between two samples."""
    # The force straight between samples would begin at the sample before touch-down. Its value
    # there is set so that the area under the two lines that meet there is that of the true force.
    inside = d > 0.0
    begins = np.flatnonzero(inside[1:] > inside[:-1])
    begins = begins[force[begins] == 0.0]
    d_0, d_1 = d[begins], d[begins + 1]
    share = d_1 / (d_1 - d_0)  # of the step that is spent in contact
    changed = force.copy()
    # The damper's part is there at once, the spring's grows from 0; the measured force at the
    # first sample is nearly all damper.
    changed[begins] = force[begins + 1] * (share - 0.5)
    return changed


def link_motion(
    joint: Joint, x: Array, v: Array, a: Array, force: Array, h: float, bent: float = 0.0
) -> tuple[Array, Array, Array]:
    """Compute the motion of the link from that of the motor and the force at the wall."""
    # z = y - x obeys m z'' + c z' + z / C = F_e - m x'': of a stiff joint it vanishes, however
    # coarse the samples.
    push, start = force - joint.mass * a, joint.compliance * bent
    system = discretise(joint.mass, joint.damping, joint.stiffness, h)
    z = run(system, push, start, joint.stiffness)
    rate = run_velocity(system, push, start, joint.stiffness)
    return x + z, v + rate, (force - joint.force(z, rate)) / joint.mass


def link_against_wall(
    joint: Joint, law: ContactLaw, t: Array, x: Array, v: Array, a: Array, force: Array
) -> tuple[Array, Array, Array]:
    """Compute the motion of the link from that of the motor alone."""
    # The link under the measured force would follow its noise. One Newton step from there solves
    # m y'' = (x - y) / C + c (x' - y') + F_e(y, y') for a wall of K_e and B_e while it is touched.
    h = float(t[1] - t[0])
    begins = float(force[0]) if law.contact(t, x, v)[0] else 0.0  # else it is noise
    y, w, b = link_motion(joint, x, v, a, force, h, begins)
    expected, d = law.force_and_depth(t, y, w, b)
    touching = d > 0.0 if law.unilateral else np.ones(len(d), bool)
    if law.unilateral:
        expected = at_touch_down(expected, d)
    moved, rate = _deflection(joint, law, touching, expected - force, h)
    y, w = y + moved, w + rate
    return y, w, (joint.force(x - y, v - w) + law.force(t, y, w, b)) / joint.mass


def _deflection(joint: Joint, law: ContactLaw, touching: Flags, push: Array, h: float) -> Array:
    """Simulate a link on its joint, and on the wall's spring while it touches; shape (2, N)."""
    motion = np.zeros((2, len(push)))
    for first, stop in stretches(touching):
        on, begin = float(touching[first]), max(first - 1, 0)
        m, c, k = (own + on * wall for own, wall in zip(
            (joint.mass, joint.damping, joint.stiffness),
            (law.inertia, law.damping, law.stiffness)))
        motion[:, begin:stop] = run_from(
            discretise(m, c, k, h), push[begin:stop], motion[:, begin])
    return motion


def run_jointed(robot: RobotLaw, push: Array, force: Array, position: float, h: float) -> Array:
    """Simulate motor and link from rest."""
    assert robot.joint is not None
    modes = _modes(robot.mass, robot.damping, robot.stiffness, robot.joint, h)
    pushes = (push - robot.stiffness * position, force)
    moved = [lfilter(row, poles, one) for rows, poles in modes for row, one in zip(rows, pushes)]
    return position + np.asarray(sum(moved))


@lru_cache(maxsize=64)
def _modes(
    mass: float, damping: float, stiffness: float, joint: Joint, h: float
) -> list[tuple[tuple[Array, Array], Array]]:
    """Return the filters from both forces to x, mode by mode."""
    # One filter of fourth order loses all digits at high rates. Partial fractions in s leave two
    # of second order, alpha s + beta over a quadratic each.
    m, c, k, motor = joint.mass, joint.damping, joint.stiffness, mass - joint.mass
    det = np.polysub(np.polymul([motor, damping + c, stiffness + k], [m, c, k]),
                     np.polymul([c, k], [c, k]))
    quadratics = _quadratics(det)
    columns = [np.convolve(power, other)  # s and 1 times the other's quadratic
               for other in quadratics[::-1] for power in ([1.0, 0.0], [0.0, 1.0])]
    wanted = np.array([[0.0, m, c, k], [0.0, 0.0, c, k]]) / det[0]
    weights = np.linalg.solve(np.array(columns).T, wanted.T)
    modes = []
    for place, quadratic in enumerate(quadratics):
        system = discretise(1.0, quadratic[1], quadratic[2], h)
        alpha, beta = weights[2 * place:2 * place + 2]
        rows = tuple(a * system.velocity + b * system.position for a, b in zip(alpha, beta))
        modes.append(((rows[0], rows[1]), system.denominator))
    return modes


def _quadratics(quartic: Array) -> list[Array]:
    """Factor a real polynomial into two of second order, s^2 first."""
    roots = np.roots(quartic)
    pairs = [(root, root.conjugate()) for root in roots if root.imag > 0.0]
    real = sorted(root.real for root in roots if root.imag == 0.0)
    pairs += zip(real[::2], real[1::2])
    return [np.array([1.0, -(a + b).real, (a * b).real]) for a, b in pairs]
