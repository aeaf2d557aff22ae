# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Experiments: played, and proposed next."""

from dataclasses import replace
from functools import lru_cache
from math import sin
from pathlib import Path
from typing import Any

from contact_estimation.diagnosis.candidate_experiments import candidates, Reach, scaling_test
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.next_experiment import choose, reach_of
from contact_estimation.diagnosis.result import Diagnosis
from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.reference.experiment import Experiment, PseudoRandomBinary, Segment
from contact_estimation.reference.experiments import (
    experiment_named, experiment_text, EXPERIMENTS, read_experiment)
from diagnosed_worlds import diagnosed
import numpy as np
import pytest
import yaml

MANOEUVRES = [name for name in EXPERIMENTS if name != 'rich']
NAMED = pytest.mark.parametrize('name', MANOEUVRES)
SINE = {'kind': 'sine', 'amplitude': 8.0, 'angular_frequency': 20.0}
GOOD: dict[str, Any] = {
    'name': 'test', 'start': -0.05,
    'segments': [
        {'duration': 1.0, 'position': -0.05},
        {'duration': 2.0, 'position': 0.01, 'force': 30.0, 'force_excitation': SINE,
         'position_excitation': {'kind': 'prbs', 'amplitude': 0.002, 'shift_rate': 10.0}},
        {'duration': 1.5, 'position': 0.01, 'force_excitation':
         {'kind': 'multisine', 'amplitude': 4.0, 'angular_frequencies': [5.0, 11.0]}}],
}


def written(content: Any, folder: Path) -> Path:
    """Write a YAML file."""
    path = folder / 'experiment.yaml'
    path.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
    return path


def with_segment(**changes: Any) -> dict[str, Any]:
    """Give a good experiment of one segment with some keys changed; None removes a key."""
    segment = {'duration': 1.0, 'position': 0.0, **changes}
    return {'segments': [{k: v for k, v in segment.items() if v is not None}]}


def test_approach_is_the_frozen_quintic() -> None:
    for name in MANOEUVRES:
        for t, x_d in [(0.0, -0.1), (4.4, -0.1), (5.5, -0.0398), (6.6, 0.0204)]:
            assert experiment_named(name).desired(t).position == pytest.approx(x_d, abs=1e-12)


@NAMED
def test_experiment_ends_after_12_seconds_or_22(name: str) -> None:
    assert experiment_named(name).duration == pytest.approx(22.0 if name == 'long' else 12.0)


@pytest.mark.parametrize('name', ['sine', 'long'])
def test_wanted_force_is_eq_40(name: str) -> None:
    experiment = experiment_named(name)
    for t in np.arange(4.5, 8.5, 0.037).tolist():
        assert experiment.desired(t).force == pytest.approx(50.0 + 8.0 * sin(20.0 * t))


def test_cycle_repeats_the_motion_for_ever() -> None:
    cycle, once = experiment_named('sine').cyclic(), experiment_named('sine')
    for t in (0.0, 5.0, 7.0, 11.9):
        assert cycle.desired(1200.0 + t)[:3] == pytest.approx(once.desired(t)[:3], abs=1e-9)


def test_yaml_gives_the_experiment_written_in_python(tmp_path: Path) -> None:
    read = experiment_named(str(written(GOOD, tmp_path)))
    prbs = PseudoRandomBinary(0.002, 10.0)
    for t in (1.01, 1.3, 2.0, 2.97):
        wanted = read.desired(t)
        base = Experiment('b', -0.05, (Segment(1.0, -0.05), Segment(2.0, 0.01))).desired(t)
        assert wanted.force == pytest.approx(30.0 + 8.0 * sin(20.0 * t))
        assert wanted.position == pytest.approx(base.position + prbs.value(t))


@pytest.mark.parametrize('content, message', [
    ('a: [', 'cannot be read: while parsing'),
    ('just text', 'a mapping with `start` and `segments`'),
    ('', 'a mapping with `start` and `segments`'),
    ({'start': 0.0}, 'a list `segments`'),
    ({'segments': []}, 'a list `segments`'),
    ({'segments': [3]}, 'segments that are mappings'),
    ({'start': 'left', **with_segment()}, '`start` as a number'),
    ({'stat': 0.0, **with_segment()}, "'stat'; did you mean 'start'"),
    (with_segment(duration=None), '`duration` as a number, got None'),
    (with_segment(duration=0.0), 'duration of 0.001 s'),
    (with_segment(duration=True), '`duration` as a number, got True'),
    (with_segment(position=None), '`position` as a number'),
    (with_segment(position=float('nan')), '`position` as a number'),
    (with_segment(force='much'), '`force` as a number'),
    (with_segment(dept=1.0), "unknown key in experiment file .*'dept'"),
    (with_segment(force_excitation=3), 'an excitation with `kind`'),
    (with_segment(force_excitation={'kind': 'sin', 'amplitude': 1.0}), "did you mean 'sine'"),
    (with_segment(force_excitation={'kind': ['sine'], 'amplitude': 1.0}), 'unknown excitation'),
    (with_segment(force_excitation={'kind': 'prbs'}), 'an excitation with `amplitude`'),
    (with_segment(force_excitation={'kind': 'sine', 'amplitude': 1.0}), 'needs amplitude, ang'),
    (with_segment(force_excitation={**SINE, 'phase': 1.0}), "unknown key .*'phase'"),
    (with_segment(force_excitation={**SINE, 'amplitude': 'big'}), 'amplitude'),
    (with_segment(force_excitation={**SINE, 'angular_frequency': 'high'}), 'angular_frequency'),
    (with_segment(force_excitation={'kind': 'multisine', 'amplitude': 1.0,
                                    'angular_frequencies': 5.0}), 'angular_frequencies'),
    (with_segment(force_excitation={'kind': 'multisine', 'amplitude': 1.0,
                                    'angular_frequencies': []}), 'at least one frequency')])
def test_mistake_in_the_file_is_an_error_that_says_which(
    content: Any, message: str, tmp_path: Path
) -> None:
    with pytest.raises(ContactEstimationError, match=message):
        read_experiment(written(content, tmp_path))


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


def as_file(experiment: Experiment, folder: Path) -> Experiment:
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
    again = as_file(experiment, tmp_path)
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


def test_without_a_robot_x_d_is_the_motion_itself() -> None:
    d = open_question()
    bench = [replace(one, observed=replace(one.observed, reference=None)) for one in d.recordings]
    assert reach_of(d).gain > 1.5
    assert reach_of(replace(d, recordings=bench)).gain == 1.0
