# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Experiments: the frozen manoeuvre, repetition and YAML files."""

from __future__ import annotations

from math import sin
from pathlib import Path
from typing import Any

from contact_estimation.exceptions import ContactEstimationError, ModelFileError, UnknownNameError
from contact_estimation.reference.experiment import Experiment, PseudoRandomBinary, Segment
from contact_estimation.reference.experiments import experiment_named, EXPERIMENTS, read_experiment
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
         {'kind': 'multisine', 'amplitude': 4.0, 'angular_frequencies': [5.0, 11.0]}},
    ],
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


def test_unknown_experiment_names_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="unknown experiment 'sin'; did you mean 'sine'"):
        experiment_named('sin')


def test_yaml_gives_the_experiment_written_in_python(tmp_path: Path) -> None:
    read = experiment_named(str(written(GOOD, tmp_path)))
    prbs = PseudoRandomBinary(0.002, 10.0)
    for t in (1.01, 1.3, 2.0, 2.97):
        wanted = read.desired(t)
        base = Experiment('b', -0.05, (Segment(1.0, -0.05), Segment(2.0, 0.01))).desired(t)
        assert wanted.force == pytest.approx(30.0 + 8.0 * sin(20.0 * t))
        assert wanted.position == pytest.approx(base.position + prbs.value(t))


def test_missing_file_is_an_error_that_names_it(tmp_path: Path) -> None:
    with pytest.raises(ModelFileError, match='none.yaml cannot be read: No such file'):
        experiment_named(str(tmp_path / 'none.yaml'))


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
                                    'angular_frequencies': []}), 'at least one frequency'),
])
def test_mistake_in_the_file_is_an_error_that_says_which(
    content: Any, message: str, tmp_path: Path
) -> None:
    with pytest.raises(ContactEstimationError, match=message):
        read_experiment(written(content, tmp_path))
