# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Samples of three axes at once: three walls, touched at different times."""

from typing import Any, NamedTuple

from contact_estimation.parameters import build
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples, PERIOD_NS

AXES = 'xyz'
WALLS = {'x': (4800.0, 200.0), 'y': (3000.0, 120.0), 'z': (7000.0, 90.0)}
LOCATIONS = {'x': 0.0, 'y': 0.25, 'z': -0.5}
JOINTS = {axis: f'contact_{axis}' for axis in AXES}
DELAYS = {'x': 0, 'y': 60, 'z': 150}  # samples by which an axis touches later
PARAMETERS: dict[str, Any] = {
    'axis': 'x', 'joint': JOINTS['x'],
    'further_axes.y.joint': JOINTS['y'], 'further_axes.y.location': LOCATIONS['y'],
    'further_axes.z.joint': JOINTS['z'], 'further_axes.z.location': LOCATIONS['z'],
}


class Instant(NamedTuple):
    """One instant of all axes."""

    stamp_ns: int
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    forces: tuple[float, ...]

    def of_axis(self, axis: str) -> ContactSample:
        """Take one axis alone."""
        k = AXES.index(axis)
        return ContactSample(self.stamp_ns, self.positions[k], self.velocities[k], self.forces[k])


def instants(contact_s: float = 0.8) -> list[Instant]:
    """Make samples in which each axis meets a wall of its own."""
    columns = [_axis_samples(axis, contact_s) for axis in AXES]
    return [
        Instant(s[0].stamp_ns, *(tuple(c) for c in zip(*(one[1:] for one in s))))
        for s in zip(*columns)]


def _axis_samples(axis: str, contact_s: float) -> list[ContactSample]:
    K_e, B_e = WALLS[axis]
    delay, seed = DELAYS[axis], AXES.index(axis)
    moving = contact_samples(
        contact_s, K_e=K_e, B_e=B_e, force_noise=0.3, seed=seed, omega=20.0 + 7.0 * seed)
    samples = moving[:1] * delay + moving[:len(moving) - delay]
    return [
        s._replace(stamp_ns=k * PERIOD_NS, position=s.position + LOCATIONS[axis])
        for k, s in enumerate(samples)]


def moved_instants(samples: list[Instant], begin_ns: int) -> list[Instant]:
    """Shift stamps."""
    return [sample._replace(stamp_ns=sample.stamp_ns + begin_ns) for sample in samples]


def session_of_axes(generate_reference: bool = True, **estimation: Any) -> ContactSession:
    """Make a session of all three axes; double underscores stand for dots."""
    names = {name.replace('__', '.'): value for name, value in estimation.items()}
    parameters = build(EstimationParameters, {**PARAMETERS, **names})
    return ContactSession(parameters, generate_reference)


def session_of_axis(
    axis: str, generate_reference: bool = True, **estimation: Any
) -> ContactSession:
    """Make a session of one axis alone, with the same wall."""
    names = {name.replace('__', '.'): value for name, value in estimation.items()}
    own = {'axis': axis, 'joint': JOINTS[axis], 'environment.location': LOCATIONS[axis]}
    return ContactSession(build(EstimationParameters, {**names, **own}), generate_reference)


def feed_axes(session: ContactSession, samples: list[Instant]) -> list[Result]:
    """Pass samples to a session of all axes."""
    results: list[Result] = []
    for stamp_ns, positions, velocities, forces in samples:
        results += session.add_motion(stamp_ns, *positions, *velocities)
        results += session.add_wrench(stamp_ns, *forces)
    return results


def feed_axis(session: ContactSession, samples: list[ContactSample]) -> list[Result]:
    """Pass samples to a session of one axis."""
    results: list[Result] = []
    for stamp_ns, position, velocity, force in samples:
        results += session.add_motion(stamp_ns, position, velocity)
        results += session.add_wrench(stamp_ns, force)
    return results
