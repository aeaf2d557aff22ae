# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulated samples for the benchmarks: the sine manoeuvre, and permanent contact."""

from __future__ import annotations

from math import pi

from ...parameters.values import build
from ...pipeline.axes import Result
from ...pipeline.parameters import EstimationParameters
from ...pipeline.session import ContactSession
from ...plant.closed_loop import run_closed_loop
from ...plant.plant_parameters import PAPER_NOISE, PlantParameters
from ...reference.experiment import Experiment, Sine
from ...reference.experiments import experiment_named, manoeuvre

RATE = 500.0
PERIOD_S = 1.0 / RATE
_SETTLED_S = 8.6
"""Two seconds into the hold [s]."""


def sine_manoeuvre() -> list[Result]:
    """Simulate the sine experiment once; it ends at rest at its start position."""
    return _simulate(experiment_named('sine'), experiment_named('sine').duration)


def pressing(seconds: float) -> tuple[list[Result], list[Result]]:
    """
    Simulate an approach and a contact with 3 Hz excitation.

    seconds: duration of the contact; a multiple of 1 s has whole periods [s]
    """
    experiment = manoeuvre('pressing', Sine(8.0, 6.0 * pi), hold_s=seconds + 3.0)
    results = _simulate(experiment, _SETTLED_S + seconds)
    begin = round(_SETTLED_S * RATE)
    return results[:begin], results[begin:]


def _simulate(experiment: Experiment, duration: float) -> list[Result]:
    plant = build(PlantParameters, PAPER_NOISE)
    session = ContactSession(build(EstimationParameters, {'sample_rate': RATE}))
    return run_closed_loop(plant, session, experiment, duration).results
