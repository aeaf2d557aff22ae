# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The next experiment: within reach, without jumps, and it separates what it promises to."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from contact_estimation.diagnosis.candidates import candidates, Reach, scaling_test
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.next_experiment import choose, reach_of
from contact_estimation.diagnosis.result import Diagnosis
from contact_estimation.reference.experiment import Experiment
from contact_estimation.reference.experiments import experiment_named, experiment_text, EXPERIMENTS
from diagnosed_worlds import diagnosed
import numpy as np
import pytest

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


def test_a_friction_that_yields_within_micrometres_is_simulated_in_short_steps() -> None:
    d = open_question()
    yielding = d.corrected.without('coulomb_friction').with_effect(
        'bouc_wen_hysteresis', (4e5, 800.0, 4e4))
    proposal = choose(replace(d, corrected=yielding))
    assert proposal is not None and 'nan' not in proposal.text
