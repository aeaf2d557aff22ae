# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The next experiment: within reach, without jumps, and it separates what it promises to."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Sequence

from contact_estimation.diagnosis.conclude.candidates import candidates, Reach, scaling_test
from contact_estimation.diagnosis.conclude.next_experiment import choose, Judge, reach_of
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.fit.fitting import fit, residual_function
from contact_estimation.diagnosis.fit.model_uncertainty import discounted
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.usable_samples import default_block, usable
from contact_estimation.reference.experiment import Experiment
from contact_estimation.reference.experiment_file import experiment_text
from contact_estimation.reference.experiments import experiment_named, EXPERIMENTS
from diagnosed_worlds import diagnosed, recorded
import numpy as np
import pytest
from scipy.optimize import least_squares

REACH = Reach(0.1, 0.02, 0.008, 3.0, 0.15, 0.06)
STEP = 5e-4
PROPOSED = [*candidates(REACH), scaling_test(REACH)]


@lru_cache(maxsize=None)
def open_question() -> Diagnosis:
    """Take the recording with friction, and say that it could be drag as well."""
    d = diagnosed('friction')
    start = d.corrected.without('coulomb_friction').with_effect('quadratic_damping', (10.0,))
    rival = fit(d.recordings, start).model
    effect = replace(d.effects[0], indistinguishable_from=['quadratic_damping'])
    return replace(d, effects=[effect], rivals={'quadratic_damping': rival})


def least_cost(recordings: Sequence[PreparedRecording], model: Model) -> float:
    """Fit a model without bending large residuals, by scipy alone."""
    function = residual_function(recordings, model, robust=False)
    start = np.array(model.values)[model.free]
    found = least_squares(function, start, x_scale=np.abs(start), diff_step=1e-4)
    return float(2.0 * found.cost)


def motion(experiment: Experiment) -> np.ndarray:
    """Sample x_d with its derivatives, shape (3, N)."""
    t = np.arange(0.0, experiment.duration, STEP)
    return np.array([experiment.desired(now)[:3] for now in t.tolist()]).T


def written(experiment: Experiment, folder: Path) -> Experiment:
    """Write an experiment to a file and read it."""
    path = folder / 'an.experiment.yaml'
    path.write_text(experiment_text(experiment))
    return experiment_named(str(path))


@pytest.mark.parametrize('experiment', [
    *(make() for make in EXPERIMENTS.values()), *(c.experiment for c in PROPOSED),
], ids=lambda experiment: experiment.name)
def test_experiment_file_gives_the_same_experiment_to_the_bit(
    experiment: Experiment, tmp_path: Path
) -> None:
    again = written(experiment, tmp_path)
    assert (again.name, again.start, again.duration) == (
        experiment.name, experiment.start, experiment.duration)
    for t in np.linspace(-0.1, experiment.duration + 0.1, 1000).tolist():
        assert repr(again.desired(t)) == repr(experiment.desired(t))


def test_proposals_stay_within_reach_and_do_not_jump() -> None:
    for candidate in PROPOSED:
        x, v, a = motion(candidate.experiment)
        assert x.min() >= REACH.location - REACH.gap - 1e-9, candidate
        assert x.max() <= REACH.position(REACH.depth) + 1e-9, candidate
        assert np.abs(v).max() <= REACH.gain * REACH.speed * 1.001, candidate
        assert np.abs(np.diff(x) - 0.5 * STEP * (v[1:] + v[:-1])).max() < 1e-6, candidate
        assert np.abs(np.diff(v) - 0.5 * STEP * (a[1:] + a[:-1])).max() < 1e-3, candidate
        assert np.abs(a[[0, -1]]).max() == 0.0, candidate


def test_proposal_names_pair_and_experiment() -> None:
    proposal = choose(open_question())
    assert proposal is not None
    assert 'coulomb_friction from quadratic_damping' in proposal.text
    assert 'times the noise' in proposal.text and ' mm deep' in proposal.text
    assert proposal.experiment.duration == pytest.approx(
        3.0 * next(c.experiment.duration for c in candidates(reach_of(open_question()))
                   if c.words in proposal.text))


@pytest.mark.slow
@pytest.mark.parametrize('index', [0, 3, 6])
def test_predicted_difference_is_about_what_fits_to_a_new_recording_leave(index: int) -> None:
    d = open_question()
    (rival,) = d.rivals.values()
    experiment = candidates(reach_of(d))[index].experiment
    predicted = Judge(d).least_difference(experiment).strength
    F_c = d.effects[0].parameters['F_c'].value
    observed = observe(recorded(experiment, seed=7, physics__coulomb_friction__F_c=F_c),
                       d.nominal.nominal)
    old = d.recordings[0]
    new = discounted(replace(
        old, observed=observed, use=usable(d.nominal, observed), held_out=None,
        block=default_block(observed)), d.corrected)
    both, before = ([*d.recordings, new], d.recordings)
    gained = least_cost(both, rival) - least_cost(both, d.corrected)
    already = least_cost(before, rival) - least_cost(before, d.corrected)
    # The prediction is linear, and knows the old recording by its curvature alone.
    assert 0.5 < (gained - already) / new.residual_count / predicted < 2.0


def test_unexplained_gets_two_depths_at_two_speeds(tmp_path: Path) -> None:
    proposal = choose(diagnosed('unknown'))
    assert proposal is not None
    assert 'half and twice the speed' in proposal.text
    assert proposal.text.startswith('No effect of the library explains this. Press ')
    reach = reach_of(diagnosed('unknown'))
    positions = {segment.position for segment in written(proposal.experiment, tmp_path).segments}
    assert positions == {reach.start, reach.position(reach.depth),
                         reach.position(0.5 * reach.depth)}
