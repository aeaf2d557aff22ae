# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Known extra physics of a wall whose surface is taken at the first touch."""

from functools import lru_cache
from math import isfinite, nan

from contact_estimation.estimators.estimate import EstimateStatus
from contact_estimation.parameters import build
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.compensation import Compensation
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.plant.simulation import run_open_loop
from contact_estimation.reference.reference_generator import quintic
from contact_estimation.signals.contact_sample import CompensatedSample, ContactSample
from effect_examples import example, switched_on
import numpy as np
import pytest
from world_reference import B_e, K_e

GUESS = 4000.0
CYCLE_S = 0.7
SINES = ((1e-3, 12.0), (1e-3, 20.0), (5e-4, 33.0), (3e-4, 50.0))
FELT = [name for name, cls in EFFECTS.items() if cls.port != 'robot']
WITHOUT_STIFFNESS = {'power_law_stiffness'}
WITHOUT_DAMPING = {'hunt_crossley_damping', 'power_law_damping'}
BOUNDS = {
    # Percent of K_e and B_e where 4 and 4 are not kept: 0.1 mm of the surface are 3 % of K_e here,
    # and where B_e is replaced the lag that a sensor may have, 1.2 ms, is all that is left of it.
    'backlash': (6.0, 6.0), 'power_law_damping': (5.0, 6.0), 'hunt_crossley_damping': (4.0, 7.0),
    'force_decay': (4.0, 5.0),
}


def physics_of(name: str) -> dict[str, float]:
    """Switch an effect on such that it is felt and something is left to learn from."""
    felt = {'force_saturation': {'physics.force_saturation.limit': 60.0}}
    return felt.get(name) or switched_on(name)


def command(t: float) -> tuple[float, float, float, float]:
    """Press twice for 0.3 s, with sines on top."""
    s = t % CYCLE_S
    x, v, a = quintic(-0.006, 0.012, 0.25, min(s, 0.25))
    if s > 0.45:
        x, v, a = quintic(0.012, -0.006, 0.2, min(s - 0.45, 0.2))
    for amplitude, w in SINES:
        x += amplitude * np.sin(w * t)
        v += amplitude * w * np.cos(w * t)
        a -= amplitude * w * w * np.sin(w * t)
    return float(x), float(v), float(a), 0.0


@lru_cache(maxsize=None)
def recorded(name: str) -> tuple[list[ContactSample], list[int]]:
    """Record two contacts, and the last sample of each."""
    plant = build(PlantParameters, {
        **physics_of(name), 'sensors.force_noise': 0.3, 'sensors.position_noise': 1e-6,
        'integration_rate': 1000.0})
    truths, recording = run_open_loop(plant, command, -0.006, 2.0 * CYCLE_S)
    half = len(truths) // 2
    touching = [k for k, truth in enumerate(truths) if truth.force < -5.0]  # above a weight
    ends = [max(k for k in touching if (k < half) == first) for first in (True, False)]
    return list(recording), ends


def parameters_of(name: str, **estimation: object) -> EstimationParameters:
    """Tell an estimator of an effect and of no location."""
    return build(EstimationParameters, {
        'environment.initial_stiffness': GUESS, 'environment.location': nan,
        **physics_of(name), **estimation})


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
        samples, ends = recorded(name)
        estimates = EstimationPipeline(parameters_of(name)).process(
            [s._replace(velocity=nan) for s in samples])
        for end in ends:
            found = estimates[end]
            (K, B), (stiffness, damping) = BOUNDS.get(name, (4.0, 4.0)), truth_of(name)
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
