# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Run inside a package extended by `toy_effect` and `toy_estimator`: print facts as JSON."""

import json
from pathlib import Path
import sys
from types import SimpleNamespace
from typing import Any

from contact_estimation.commands.write_config import config_files
from contact_estimation.diagnosis.fit.candidates import candidates_in
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.parameters import build
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.plant.closed_loop import ClosedLoopRun, run_closed_loop
from contact_estimation.plant.plant_parameters import PlantParameters, read_model
from contact_estimation.reference.experiment import Experiment, Segment, Sine
from contact_estimation.studies.blind_trials.command import plan_effects
import numpy as np

KNOWN = {'physics.toy_effect.K_5': 1e12}
FIXED = {'estimator': 'toy_estimator', 'environment.initial_damping': 200.0}
MODEL_FILE = 'plant_node: {ros__parameters: {physics: {toy_effect: {K_5: 1.0e+12}}}}'
TOUCH = Experiment('touch', -0.002, (
    Segment(0.2, -0.002), Segment(0.3, 0.02),
    Segment(0.7, 0.02, position_excitation=Sine(0.002, 20.0))))


def run(plant: PlantParameters, **parameters: Any) -> ClosedLoopRun:
    """Press against the wall while an estimator runs."""
    chosen = {'reference_law': 'pass_through', **parameters}
    session = ContactSession(build(EstimationParameters, chosen))
    return run_closed_loop(plant, session, TOUCH, TOUCH.duration)


def facts(folder: Path) -> dict[str, Any]:
    """Return what the package does with the toys."""
    (folder / 'model.yaml').write_text(MODEL_FILE)
    model = read_model(str(folder / 'model.yaml'))
    plain = run(PlantParameters(), **FIXED)
    uncompensated, compensated = run(model), run(model, **KNOWN)
    x = np.array([0.0, 1.0, 0.9, 0.0])
    touched: Any = SimpleNamespace(observed=SimpleNamespace(
        reference=np.zeros((4, 4)), x=x, force=-x, force_range=1.0))
    return {
        'force': [-min(t.force for t in r.truths) for r in (plain, uncompensated)],
        'toy_estimator': plain.results[-1].estimate.stiffness,
        'uncompensated': uncompensated.results[-1].estimate.stiffness,
        'compensated': compensated.results[-1].estimate.stiffness,
        'candidates': candidates_in([touched], Model.of(PlantParameters())),
        'trials': plan_effects(100, 0),
        'config': config_files(),
    }


if __name__ == '__main__':
    print(json.dumps(facts(Path(sys.argv[1]))))
