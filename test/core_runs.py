# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Closed-loop runs and synthetic samples that several test files share, and rows one at a time."""

from functools import lru_cache
from math import nan
from typing import Any, Mapping, NamedTuple, Sequence

from contact_estimation.estimators.estimate import Estimate, Frozen, ParameterEstimate
from contact_estimation.parameters import build
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.plant.closed_loop import run_closed_loop
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.plant.world import Truth
from contact_estimation.reference.experiments import experiment_named
from contact_estimation.reference.reference_generator import quintic
from contact_estimation.signals.contact_sample import ContactSample
import numpy as np

FREE = Frozen(False, False)


def known(estimator: Any) -> ParameterEstimate:
    """Ask an estimator what it knows now."""
    return ParameterEstimate(*estimator.current())


def learn(
    estimator: Any, dt: float, row: Sequence[float], variance: float = 0.0, frozen: Frozen = FREE
) -> None:
    """Let an estimator learn from one row."""
    estimator.update([(dt, row)], variance, frozen)


def filtered(bank: Any, rows: Sequence[Sequence[float]]) -> list[Sequence[float]]:
    """Pass rows through a filter bank, one at a time."""
    return [bank.take(row) for row in rows]


def row_of(
    relation: Any, dt: float, delta: float, velocity: float, pressing: float, contact: bool
) -> Sequence[float] | None:
    """Build the row of one sample; None outside contact."""
    if contact:
        return relation.row(dt, delta, velocity, pressing)  # type: ignore[no-any-return]
    relation.leave()
    return None


def estimate_after(pipeline: Any, sample: ContactSample) -> Any:
    """Pass one sample through a pipeline."""
    return pipeline.process((sample,))[0]


PAPER_SENSORS = {'sensors.force_noise': 1.0, 'sensors.distribution': 'uniform'}
PERIOD_NS = 2_000_000
FREE_S, APPROACH_S = 0.2, 0.3
INTEGRATION_HZ = 2000.0  # fine enough for what is asserted, see test_plant_world.py


class Run(NamedTuple):
    """What a closed-loop run has given."""

    session: ContactSession
    truths: list[Truth]
    results: list[Result]

    @property
    def last(self) -> Estimate:
        """Return the estimate at the last instant of contact."""
        touching = [r for t, r in zip(self.truths, self.results) if t.force < 0.0]
        return touching[-1].estimate

    def force_at(self, begin: float, end: float) -> float:
        """Mean pressing force over an interval [N]."""
        return -float(np.mean([t.force for t in self.truths if begin <= t.t < end]))


def closed_loop(
    estimation: Mapping[str, Any] | None = None, plant: Mapping[str, Any] | None = None,
    experiment: str = 'sine', duration: float = 10.0,
) -> Run:
    """Run plant and session closed over the reference; equal requests share one run."""
    return _closed_loop(
        tuple((estimation or {}).items()), tuple((plant or {}).items()), experiment, duration)


@lru_cache(maxsize=None)
def _closed_loop(
    estimation: tuple[Any, ...], plant: tuple[Any, ...], experiment: str, duration: float
) -> Run:
    session = ContactSession(build(EstimationParameters, dict(estimation)))
    world = build(PlantParameters, {'integration_rate': INTEGRATION_HZ, **dict(plant)})
    run = run_closed_loop(world, session, experiment_named(experiment), duration)
    return Run(session, run.truths, run.results)


def contact_samples(
    contact_s: float = 1.0, K_e: float = 4800.0, B_e: float = 200.0, depth: float = 0.008,
    amplitude: float = 0.002, omega: float = 20.0, force_noise: float = 0.0,
    position_noise: float = 0.0, with_velocity: bool = True, seed: int = 0, rate: float = 500.0,
) -> list[ContactSample]:
    """Rest 10 mm before the wall, approach, then depth + amplitude (1 - cos(omega t))."""
    noise = np.random.default_rng(seed)
    samples = []
    for k in range(round((FREE_S + APPROACH_S + contact_s) * rate)):
        t = k / rate - FREE_S
        x, v, _ = quintic(-0.01, depth, APPROACH_S, t)
        if t > APPROACH_S:
            phase = omega * (t - APPROACH_S)
            x += amplitude * (1.0 - np.cos(phase))
            v += amplitude * omega * np.sin(phase)
        force = min(-float(K_e * x + B_e * v), 0.0) if x > 0.0 else 0.0
        force_error, position_error = noise.standard_normal(2).tolist()
        samples.append(ContactSample(
            round(k * 1e9 / rate), float(x) + position_noise * position_error,
            float(v) if with_velocity else nan, force + force_noise * force_error))
    return samples


def pipeline_with(**estimation: Any) -> EstimationPipeline:
    """Make a pipeline; double underscores stand for the dots of parameter names."""
    names = {name.replace('__', '.'): value for name, value in estimation.items()}
    return EstimationPipeline(build(EstimationParameters, names))


def estimates_of(samples: list[ContactSample], pipeline: EstimationPipeline) -> list[Estimate]:
    """Pass samples through a pipeline."""
    return [estimate_after(pipeline, sample) for sample in samples]
