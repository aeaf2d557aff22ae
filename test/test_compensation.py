# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Known extra physics: estimators that compensate an effect find K_e and B_e, and the surface."""

from functools import lru_cache
from math import isfinite, nan
from typing import Any

from contact_estimation.estimators.estimate import Estimate, EstimateStatus
from contact_estimation.parameters import build
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.compensation import Compensation
from contact_estimation.physics.viscoelastic_relaxation import ViscoelasticRelaxation
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.pipeline.known_physics import compensation_of
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.plant.closed_loop import run_closed_loop
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.plant.simulation import run_open_loop
from contact_estimation.reference.experiment import Experiment, Segment
from contact_estimation.reference.experiments import FORCE_EXCITATION
from contact_estimation.reference.reference_generator import quintic
from contact_estimation.signals.contact_sample import CompensatedSample, ContactSample
from effect_examples import example, switched_on
import numpy as np
import pytest
from world_reference import B_e, K_e

GUESS = 4000.0
WANTED: dict[str, Any] = {'force': 50.0, 'force_excitation': FORCE_EXCITATION['multisine']}
TOUCH = Experiment('touch', -0.02, (
    Segment(0.3, -0.02), Segment(0.7, 0.02, **WANTED), Segment(1.3, 0.02, **WANTED),
    Segment(0.6, -0.02), Segment(0.2, -0.02),
))
SINES = ((1e-3, 12.0), (1e-3, 20.0), (5e-4, 33.0), (3e-4, 50.0))

BOUNDS = {
    # Percent of K_e and B_e where 1 and 2 are not kept. The feed-forward of a closed loop steps
    # at every sample, and with it the acceleration, which then leads its mean by half a sample.
    # On a smooth command the bounds of all others hold, see below.
    'hunt_crossley_damping': (0.2, 4.0), 'environment_inertia': (4.0, 8.0),
    'tool_inertia': (0.5, 4.0), 'power_law_damping': (0.1, 4.0),
}
WITHOUT_STIFFNESS = {'power_law_stiffness'}
WITHOUT_DAMPING = {'hunt_crossley_damping', 'power_law_damping'}
JOINTED = 'joint_flexibility'  # its compliance alone is taken out

ONE_OF_FAMILY = {cls.family: name for name, cls in reversed(EFFECTS.items())}.values()
IN_CLOSED_LOOP = [n for n in dict.fromkeys((*ONE_OF_FAMILY, *BOUNDS)) if n != JOINTED]


ONE_PRESS = {'force_saturation': {'physics.force_saturation.limit': 45.0},
             'tool_inertia': {'physics.tool_inertia.mass': 4.0}}
TWO_PRESSES = {'force_saturation': {'physics.force_saturation.limit': 60.0}}
"""Effects that are switched on such that they are felt and something is left to learn from."""


def physics_of(name: str, sizes: Any = ONE_PRESS) -> dict[str, float]:
    """Switch an effect on."""
    return sizes.get(name) or switched_on(name)


def command(t: float) -> tuple[float, float, float, float]:
    """Approach, press with sines on top, withdraw: smooth everywhere."""
    x, v, a = quintic(-0.02, 0.02, 0.7, min(t - 0.3, 0.7)) if t > 0.3 else (-0.02, 0.0, 0.0)
    if t > 2.3:
        x, v, a = quintic(0.02, -0.02, 0.6, min(t - 2.3, 0.6))
    return with_sines(t, x, v, a)


def with_sines(t: float, x: float, v: float, a: float) -> tuple[float, float, float, float]:
    """Add sines to a motion."""
    for amplitude, w in SINES:
        x += amplitude * np.sin(w * t)
        v += amplitude * w * np.cos(w * t)
        a -= amplitude * w * w * np.sin(w * t)
    return float(x), float(v), float(a), 0.0


def parameters_of(
    known: str, sizes: Any = ONE_PRESS, **estimation: Any
) -> EstimationParameters:
    """Return parameters of an estimator that knows an effect; '' for none."""
    names = {key.replace('__', '.'): value for key, value in estimation.items()}
    return build(EstimationParameters, {
        'environment.initial_stiffness': GUESS,
        **(physics_of(known, sizes) if known else {}), **names,
    })


def plant_with(name: str, sizes: Any = ONE_PRESS, **changes: Any) -> PlantParameters:
    """Make a noisy world with an effect; coarser steps suffice, see test_effect_worlds.py."""
    return build(PlantParameters, {
        **physics_of(name, sizes), 'sensors.force_noise': 0.3, 'integration_rate': 2000.0,
        **changes})


@lru_cache(maxsize=None)
def in_closed_loop(name: str) -> tuple[Estimate, float]:
    """Give the estimate at the last instant of contact, and the greatest pressing force."""
    session = ContactSession(parameters_of(
        name, estimator='kalman', reference_law='series',
        tuning__kalman__location_std=0.0, environment__location_std=0.0))  # else x_e mends it
    plant = plant_with(name)
    run = run_closed_loop(plant, session, TOUCH, TOUCH.duration)
    assert run.last_contact is not None
    return run.results[run.last_contact].estimate, -min(t.force for t in run.truths)


@lru_cache(maxsize=None)
def recorded(name: str) -> tuple[list[ContactSample], int]:
    """Record a touch on the smooth command, and count the samples to the end of contact."""
    plant = plant_with(name, **{'sensors.position_noise': 1e-6})
    truths, recording = run_open_loop(plant, command, -0.02, 3.0)
    return list(recording), max(k for k, t in enumerate(truths) if t.force < 0.0) + 1


def errors(estimate: Estimate) -> tuple[float, float]:
    """Signed errors of K_hat and B_hat [%]."""
    return 100.0 * (estimate.stiffness / K_e - 1.0), 100.0 * (estimate.damping / B_e - 1.0)


def assert_found(name: str, estimate: Estimate, bounds: tuple[float, float]) -> None:
    """Check K_hat and B_hat against K_e and B_e beside an effect."""
    K, B = errors(estimate)
    if name in WITHOUT_STIFFNESS:
        assert estimate.stiffness == pytest.approx(GUESS, rel=0.01)
    else:
        assert abs(K) < bounds[0]
    if name in WITHOUT_DAMPING:
        assert estimate.damping < 0.02 * B_e
    else:
        assert abs(B) < bounds[1]


@pytest.mark.slow
def test_estimator_in_closed_loop_that_knows_the_effect_is_right() -> None:
    for name in IN_CLOSED_LOOP:
        estimate, force = in_closed_loop(name)
        assert 30.0 < force < 200.0, name
        assert_found(name, estimate, BOUNDS.get(name, (1.0, 2.0)))


def test_stiffness_behind_a_known_joint_is_that_of_the_wall() -> None:
    def slowly(t: float) -> tuple[float, float, float, float]:
        return (*quintic(-0.02, 0.02, 3.0, min(t, 3.0)), 0.0)

    _, samples = run_open_loop(plant_with(JOINTED), slowly, -0.02, 3.0)
    compliance = physics_of(JOINTED)['physics.joint_flexibility.compliance']
    both = 1.0 / (1.0 / K_e + compliance)
    for known, expected in ((JOINTED, K_e), ('', both)):
        pipeline = EstimationPipeline(parameters_of(known, estimator='multiple_model'))
        estimate = pipeline.process(list(samples))[-1]
        assert estimate.stiffness == pytest.approx(expected, rel=0.02)
    assert both < 0.85 * K_e


@pytest.mark.parametrize('name, moved', [
    ('contact_offset', -0.0015), ('moving_environment', None), ('plastic_set', None)])
def test_location_is_where_the_surface_is_known_to_be(name: str, moved: float | None) -> None:
    samples, end = recorded(name)
    estimates = EstimationPipeline(parameters_of(name, estimator='rls')).process(samples)
    t = np.array([s.stamp_ns for s in samples]) * 1e-9
    depth = np.maximum.accumulate([max(s.position, 0.0) for s in samples])
    expected = {
        'contact_offset': np.full(len(t), -0.0015),
        'plastic_set': 0.3 * np.maximum(depth - 0.001, 0.0),
        'moving_environment': 0.001 * np.sin(4.0 * np.pi * t + 0.7),
    }[name]
    found = np.array([e.location for e in estimates])
    np.testing.assert_allclose(found[:300], expected[:300], atol=1e-9)  # before the contact
    np.testing.assert_allclose(found[-300:], expected[-300:], atol=2e-5)  # as it has shown


def test_a_relaxation_that_is_faster_than_the_samples_is_a_damper() -> None:
    known = Compensation([ViscoelasticRelaxation(1e5, 1e-4)], 3000.0, 0.3, 500.0)
    found = [known.take(ContactSample(2 * 10**6 * k, 1e-4 * k, nan, 0.0), 0.0, 0.0)
             for k in range(200)]
    assert found[-1].pressing - found[-1].rest == pytest.approx(1e5 * 1e-4 * 0.05, rel=1e-6)


def test_nothing_is_learned_at_the_end_of_the_sensor_s_range() -> None:
    samples, _ = recorded('force_saturation')
    estimates = EstimationPipeline(parameters_of('force_saturation')).process(samples)
    clipped = [e.status for e, s in zip(estimates, samples) if s.force < -44.5]
    assert len(clipped) > 300 and EstimateStatus.ESTIMATING not in clipped


def test_the_mass_of_a_tool_brings_little_noise_of_the_position_into_the_force() -> None:
    x = 1e-5 * np.random.default_rng(1).standard_normal(400)  # 15 m/s^2 between samples
    p = build(EstimationParameters, {'physics.tool_inertia.mass': 0.5})
    compensation = compensation_of(p)
    felt = [compensation.take(ContactSample(2_000_000 * k, x_k, nan, 0.0), nan, 0.0).pressing
            for k, x_k in enumerate(x.tolist())]
    assert 0.0 < np.std(felt) < 0.2


CYCLE_S = 0.7
FELT = [name for name, cls in EFFECTS.items() if cls.port != 'robot']
AT_FIRST_TOUCH = {
    # Percent of K_e and B_e where 4 and 4 are not kept: 0.1 mm of the surface are 3 % of K_e here,
    # and where B_e is replaced the lag that a sensor may have, 1.2 ms, is all that is left of it.
    'backlash': (6.0, 6.0), 'power_law_damping': (5.0, 6.0), 'hunt_crossley_damping': (4.0, 7.0),
    'force_decay': (4.0, 5.0),
}


def two_presses(t: float) -> tuple[float, float, float, float]:
    """Press twice for 0.3 s, with sines on top."""
    s = t % CYCLE_S
    x, v, a = quintic(-0.006, 0.012, 0.25, min(s, 0.25))
    if s > 0.45:
        x, v, a = quintic(0.012, -0.006, 0.2, min(s - 0.45, 0.2))
    return with_sines(t, x, v, a)


@lru_cache(maxsize=None)
def recorded_twice(name: str) -> tuple[list[ContactSample], list[int]]:
    """Record two contacts, and the last sample of each."""
    plant = plant_with(name, TWO_PRESSES, **{
        'sensors.position_noise': 1e-6, 'integration_rate': 1000.0})
    truths, recording = run_open_loop(plant, two_presses, -0.006, 2.0 * CYCLE_S)
    half = len(truths) // 2
    touching = [k for k, truth in enumerate(truths) if truth.force < -5.0]  # above a weight
    ends = [max(k for k in touching if (k < half) == first) for first in (True, False)]
    return list(recording), ends


def compensation(*names: str) -> Compensation:
    """Compensate effects of their usual sizes."""
    return Compensation([example(name) for name in names], GUESS, 0.3, 500.0)


def compensated(
    known: Compensation, samples: list[ContactSample], location: float
) -> list[CompensatedSample]:
    """Pass samples through a compensation."""
    return [known.take(sample, location, -sample.force) for sample in samples]


def still(stamps_ns: list[int]) -> list[ContactSample]:
    """Return samples of a robot at rest, with noise of its positions alone."""
    noise = 1e-6 * np.random.default_rng(3).standard_normal(len(stamps_ns))
    return [ContactSample(t, x, nan, 0.0) for t, x in zip(stamps_ns, (noise - 0.01).tolist())]


def truth_of(name: str) -> tuple[float, float]:
    """Return what K_hat and B_hat are to be."""
    return (GUESS if name in WITHOUT_STIFFNESS else K_e, 0.0 if name in WITHOUT_DAMPING else B_e)


@pytest.mark.slow
def test_first_contact_beside_a_known_effect_gives_the_wall() -> None:
    for name in FELT:
        samples, ends = recorded_twice(name)
        estimates = EstimationPipeline(
            parameters_of(name, TWO_PRESSES, environment__location=nan)).process(
            [s._replace(velocity=nan) for s in samples])
        for end in ends:
            found = estimates[end]
            (K, B), (stiffness, damping) = AT_FIRST_TOUCH.get(name, (4.0, 4.0)), truth_of(name)
            assert found.stiffness == pytest.approx(stiffness, rel=0.01 * K), name
            assert found.damping == pytest.approx(damping, abs=0.01 * B * B_e), name
            assert all(isfinite(e.stiffness_std) for e in estimates[end - 25:end + 1]), name
        first = next(k for k, e in enumerate(estimates) if e.status is EstimateStatus.ESTIMATING)
        assert first < ends[0] - 25, name
        assert all(isfinite(estimate.location) for estimate in estimates[first:]), name


def test_irregular_stamps_make_no_force_of_the_noise_of_positions() -> None:
    for steps_ns in [
        [2_000_000] * 50 + [1] + [2_000_000] * 50, [1] + [2_000_000] * 50,
        [2_000_000] * 50 + [3_000_000_000] + [2_000_000] * 50, ([2_000] * 7 + [16_000_000]) * 20,
    ]:
        for name in ['tool_inertia', 'environment_inertia', 'coulomb_friction']:
            samples = still([0, *np.cumsum(steps_ns).tolist()])
            regular = compensated(
                compensation(name), still([2_000_000 * k for k in range(len(samples))]), -0.011)
            found = compensated(compensation(name), samples, -0.011)
            for column in ('pressing', 'rest'):
                bound = 1.5 * max(abs(getattr(now, column)) for now in regular) + 0.1
                usable = [abs(getattr(now, column)) for now in found if not now.hindrance]
                assert max(usable, default=0.0) < bound, (steps_ns, name)
                assert max(abs(now.pressing) for now in found) < bound + 10.0, (steps_ns, name)
