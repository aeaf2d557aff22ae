# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Eq. (6) and its recursive estimation against forms written in another way.

A tool with a front and a rear foot and a nose goes down on a floor, slides to a wall, along both,
and leaves them.
"""

from functools import lru_cache
from math import cos, hypot, pi, sin, tanh
from typing import Any, Sequence

from contact_estimation.estimators.contact_points import (
    ContactGeometry, force_regressor, point_motions, ToolMotion)
from contact_estimation.estimators.contact_points_estimator import (
    ContactPointsEstimate, ContactPointsEstimator, ContactPointsParameters, ContactPointsSample)
from contact_estimation.estimators.estimate import EstimateStatus
from contact_estimation.reference.reference_generator import quintic
import numpy as np
import pytest
from scipy.optimize import least_squares

K_E, B_E, MU = 4800.0, 200.0, 0.3
INSTANTS = (1.3, 2.55, 3.7, 4.55, 5.9, 7.5, 8.65, 8.75)  # all that can happen
GEOMETRY = ContactGeometry(
    points=np.array([[0.03, 0.0, -0.04], [-0.03, 0.0, -0.04], [0.05, 0.0, 0.01]]),
    surfaces=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.15, 0.0, 0.0]]),
    normals=np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]))

BEGIN = (0.0, 0.0, 0.055)
PITCH = 0.12  # [rad]: the front foot touches first
# (axis, begin [s], duration [s], way [m or rad]); axis 3 is the pitch
MOVES = (
    (2, 0.4, 1.2, -0.0165),  # down: the front foot touches
    (3, 2.2, 0.8, -PITCH),  # level: the rear foot touches too
    (0, 3.2, 1.6, 0.106),  # slide along the floor until the nose touches the wall
    (1, 5.2, 1.6, 0.08),  # slide along both
    (0, 7.4, 0.6, -0.04),  # away from the wall
    (2, 8.6, 0.8, 0.04),  # up
)
# (axis, begin, end [s], amplitude [m], angular frequency [rad/s]): begins and ends at rest
SWINGS = (
    (2, 1.7, 1.7 + 4.0 * pi / 10.0, 1e-3, 20.0),
    (2, 3.0, 3.0 + 18.0 * pi / 10.0, 1e-3, 20.0),
    (0, 5.0, 5.0 + 16.0 * pi / 23.0, 1e-3, 23.0),
)


def motion_at(t: float) -> ToolMotion:
    """Return the prescribed pose and twist of the tool; t: time [s]."""
    place, rate = [*BEGIN, PITCH], [0.0] * 4
    for axis, begin, duration, way in MOVES:
        x, v, _ = quintic(0.0, way, duration, t - begin)
        place[axis] += x
        rate[axis] += v
    for axis, begin, end, amplitude, omega in SWINGS:
        if begin < t < end:
            phase = omega * (t - begin)
            place[axis] += amplitude * (1.0 - cos(phase)) * (1.0 if axis == 0 else -1.0)
            rate[axis] += amplitude * omega * sin(phase) * (1.0 if axis == 0 else -1.0)
    c, s = cos(place[3]), sin(place[3])
    rotation = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return ToolMotion(
        np.array(place[:3]), rotation, np.array(rate[:3]), np.array([0.0, rate[3], 0.0]))


def force_of(motion: ToolMotion) -> np.ndarray:
    """Compute the force of eq. (6)."""
    points = point_motions(GEOMETRY, motion)
    pressing = (points.delta > 0.0) & (K_E * points.delta + B_E * points.delta_dot > 0.0)
    return force_regressor(GEOMETRY, points, pressing) @ (K_E, B_E, MU * K_E, MU * B_E)


def scalar_force(t: float) -> list[float]:
    """Write eq. (6) for the example out point by point, axis by axis, without vectors."""
    motion = motion_at(t)
    (x, _, z), (vx, vy, vz), w = motion.position, motion.velocity, motion.angular_velocity[1]
    c, s = motion.rotation[0, 0], motion.rotation[0, 2]
    total = [0.0, 0.0, 0.0]
    for px, pz, normal_axis in ((0.03, -0.04, 2), (-0.03, -0.04, 2), (0.05, 0.01, 0)):
        rx, rz = c * px + s * pz, -s * px + c * pz
        ux, uz = vx + w * rz, vz - w * rx  # of the point: the tool turns about y alone
        if normal_axis == 2:
            depth, rate, slide = -(z + rz), -uz, {0: ux, 1: vy}
        else:
            depth, rate, slide = x + rx - 0.15, ux, {1: vy, 2: uz}
        F_n = max(0.0, K_E * depth + B_E * rate) if depth > 0.0 else 0.0
        total[normal_axis] += F_n if normal_axis == 2 else -F_n
        speed = hypot(*slide.values())
        for axis, part in slide.items():
            total[axis] -= MU * F_n * tanh(speed / 4e-4) * (part / speed if speed else 0.0)
    return total


@pytest.mark.parametrize('t', INSTANTS)
def test_force_equals_eq_6_written_out_in_scalars(t: float) -> None:
    assert force_of(motion_at(t)).tolist() == pytest.approx(scalar_force(t), rel=1e-9, abs=1e-9)


PERIOD_S = 0.004


@lru_cache(maxsize=None)
def samples(begin: float, end: float) -> tuple[ContactPointsSample, ...]:
    """Take a stretch of the example, with force noise alone."""
    source, made = np.random.default_rng(3), []
    for t in np.arange(begin, end, PERIOD_S):
        motion = motion_at(float(t))
        felt = force_of(motion) + source.normal(0.0, 0.5, 3)
        made.append(ContactPointsSample(round(t * 1e9), felt, motion))
    return tuple(made)


def estimator_with(**tuning: Any) -> ContactPointsEstimator:
    """Make an estimator for the tool of the example."""
    return ContactPointsEstimator(GEOMETRY, ContactPointsParameters(**tuning))


def run(
    estimator: ContactPointsEstimator, stretch: Sequence[ContactPointsSample]
) -> list[ContactPointsEstimate]:
    """Pass samples through an estimator."""
    return [estimator.update(sample) for sample in stretch]


def stacked(
    stretch: Sequence[ContactPointsSample], estimates: Sequence[ContactPointsEstimate]
) -> tuple[np.ndarray, np.ndarray]:
    """Stack the rows of all samples that were learned, of points that all slide and press."""
    touching = np.array([True, True, True])
    learned = [s for s, e in zip(stretch, estimates) if all(e.touching)]
    # Begun amid the swing, it waits until all three go deeper at once.
    assert len(learned) > 0.5 * len(stretch)
    rows = [force_regressor(GEOMETRY, point_motions(GEOMETRY, s.motion), touching)
            for s in learned]
    return np.vstack(rows), np.concatenate([s.force for s in learned])


# From the front foot alone to the rear foot; then all three points slide without a pause.
FIRST, SLIDING = (1.0, 3.1), (5.4, 6.6)


@pytest.mark.parametrize('mu, forgetting', [(0.0, 1.0), (0.3, 1.0), (0.3, 0.98)])
def test_with_known_friction_it_is_weighted_least_squares_over_all_rows(
    mu: float, forgetting: float
) -> None:
    wide = {'stiffness_std': 1e9, 'damping_std': 1e9, 'forgetting_factor': forgetting}
    estimator = estimator_with(initial_friction=mu, friction_std=0.0, **wide)
    stretch = samples(*SLIDING)
    estimates = run(estimator, stretch)
    last = estimates[-1]
    Phi, force = stacked(stretch, estimates)
    known = Phi[:, :2] + mu * Phi[:, 2:]
    age = np.arange(len(force))[::-1] // 3
    weight = forgetting ** (0.5 * age)
    gain = np.linalg.pinv(known * weight[:, None]) * weight  # (2, rows): theta = gain F
    assert (last.stiffness, last.damping) == pytest.approx(tuple(gain @ force), rel=1e-6)
    spread = 0.6 * np.linalg.norm(gain, axis=1)  # of that linear function of the noise
    assert (last.stiffness_std, last.damping_std) == pytest.approx(spread, rel=1e-6)


def test_with_unknown_friction_it_is_nonlinear_least_squares_over_all_rows() -> None:
    wide = {'stiffness_std': 1e9, 'damping_std': 1e9, 'friction_std': 1e3}
    estimates = run(estimator_with(forgetting_factor=1.0, **wide), samples(*SLIDING))
    last = estimates[-1]
    Phi, force = stacked(samples(*SLIDING), estimates)

    def residuals(theta: np.ndarray) -> np.ndarray:
        """Write eq. (6) with K in 1000 N/m and B in 100 N s/m."""
        K, B, mu = theta * (1e3, 1e2, 1.0)
        return Phi @ np.array([K, B, mu * K, mu * B]) - force

    K, B, mu = least_squares(residuals, [3.0, 1.0, 0.1], xtol=1e-14, ftol=1e-14).x
    assert (last.stiffness, last.damping) == pytest.approx((1e3 * K, 1e2 * B), rel=1e-5)
    assert last.friction == pytest.approx(mu, rel=1e-5)


def test_stiffness_damping_and_friction_are_true_after_the_last_contact() -> None:
    last = run(estimator_with(), samples(0.0, 10.0))[-1]
    assert last.stiffness == pytest.approx(K_E, rel=0.003)
    assert last.damping == pytest.approx(B_E, rel=0.01)
    assert last.friction == pytest.approx(MU, abs=0.003)


def resting(depths: Sequence[float], velocity: tuple[float, float, float]) -> ContactPointsSample:
    """Press the feet and the nose so deep, level, under the force that this takes."""
    place = np.array([0.1 + depths[1], 0.0, 0.04 - depths[0]])
    motion = ToolMotion(place, np.eye(3), np.array(velocity), np.zeros(3))
    return ContactPointsSample(0, force_of(motion), motion)


@pytest.mark.parametrize('sample, reason', [
    (resting((0.005, -0.02), (0.0, 0.0, 0.05)), 'a point may touch or not'),  # withdraws
    (resting((1e-6, -0.02), (0.0, 0.0, -0.1)), 'a point may touch or not'),  # at the surface
    (resting((0.005, 0.005), (0.0, 0.0, 0.0)), 'points stick: their friction is unknown')])
def test_what_cannot_be_told_from_the_motion_is_not_learned(
    sample: ContactPointsSample, reason: str
) -> None:
    estimator = estimator_with()
    before = estimator.update(samples(0.0, 0.1)[0])
    after = estimator.update(sample)
    assert (after.status, after.reason) == (EstimateStatus.FROZEN, reason)
    assert after[1:7] == before[1:7]
