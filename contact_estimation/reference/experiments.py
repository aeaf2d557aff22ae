# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Experiments by name, and from and to YAML files."""

from math import isfinite, nan, pi
from pathlib import Path
from typing import Any, Callable, Mapping

import yaml

from .experiment import Excitation, Experiment, Multisine, PseudoRandomBinary, Segment, Sine, START
from ..exceptions import ModelFileError, UnknownNameError
from ..texts import yaml_file

_LONGEST_S = 86400.0
_SEGMENT_KEYS = {'duration', 'position', 'force', 'force_excitation', 'position_excitation'}
_EXCITATIONS: dict[str, tuple[Callable[..., Excitation], dict[str, str]]] = {
    'sine': (Sine, {'amplitude': 'amplitude', 'angular_frequency': 'omega'}),
    'multisine': (Multisine, {'amplitude': 'amplitude', 'angular_frequencies': 'omegas'}),
    'prbs': (PseudoRandomBinary, {'amplitude': 'amplitude', 'shift_rate': 'shift_rate'}),
}


def read_experiment(path: Path) -> Experiment:
    """Read an experiment from a YAML file; doc/commands.md gives the schema."""
    try:
        content = yaml_file(path)
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise ModelFileError(f'experiment file {path} cannot be read: {reason}') from error
    _expect(isinstance(content, Mapping), path, 'a mapping with `start` and `segments`', content)
    _expect_keys(content, {'name', 'start', 'segments'}, path)
    segments = content.get('segments')
    _expect(isinstance(segments, list) and bool(segments), path, 'a list `segments`', segments)
    start = _number(content.get('start', START), path, 'start')
    made = tuple(_segment(entry, path) for entry in segments)
    return Experiment(str(content.get('name', path.stem)), start, made)


def experiment_text(experiment: Experiment) -> str:
    """Return an experiment as YAML text that `read_experiment` reads."""
    segments = [_segment_entry(segment) for segment in experiment.segments]
    content = {'name': experiment.name, 'start': float(experiment.start), 'segments': segments}
    return str(yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=99))


def _segment_entry(segment: Segment) -> dict[str, Any]:
    entry: dict[str, Any] = {'duration': float(segment.duration),
                             'position': float(segment.position)}
    if segment.force == segment.force:
        entry['force'] = float(segment.force)
    for name in ('force_excitation', 'position_excitation'):
        excitation = getattr(segment, name)
        if excitation is not None:
            entry[name] = _excitation_entry(excitation)
    return entry


def _excitation_entry(excitation: Excitation) -> dict[str, Any]:
    kind, names = next(
        (kind, names) for kind, (make, names) in _EXCITATIONS.items() if type(excitation) is make)
    return {'kind': kind, **{key: getattr(excitation, name) for key, name in names.items()}}


def _segment(entry: Any, path: Path) -> Segment:
    _expect(isinstance(entry, Mapping), path, 'segments that are mappings', entry)
    _expect_keys(entry, _SEGMENT_KEYS, path)
    duration = _number(entry.get('duration'), path, 'duration')
    _expect(1e-3 <= duration <= _LONGEST_S, path, 'a duration of 0.001 s to one day', duration)
    return Segment(
        duration,
        _number(entry.get('position'), path, 'position'),
        _number(entry['force'], path, 'force') if 'force' in entry else nan,
        _excitation(entry.get('force_excitation'), path),
        _excitation(entry.get('position_excitation'), path))


def _excitation(entry: Any, path: Path) -> Excitation | None:
    if entry is None:
        return None
    _expect(isinstance(entry, Mapping) and 'kind' in entry, path, 'an excitation with `kind`',
            entry)
    if not isinstance(entry['kind'], str) or entry['kind'] not in _EXCITATIONS:
        raise UnknownNameError.among(f'excitation in {path}', entry['kind'], _EXCITATIONS)
    make, names = _EXCITATIONS[entry['kind']]
    _expect_keys(entry, {'kind', *names}, path)
    _expect('amplitude' in entry, path, 'an excitation with `amplitude`', entry)
    values = {names[key]: _numbers(value, path, key) for key, value in entry.items()
              if key != 'kind'}
    try:
        return make(**values)
    except TypeError as error:
        raise ModelFileError(
            f'experiment file {path}: excitation {entry["kind"]!r} needs {", ".join(names)}, '
            f'got {dict(entry)!r}'
        ) from error


def _numbers(value: Any, path: Path, key: str) -> float | list[float]:
    if key.endswith('frequencies'):
        _expect(isinstance(value, list), path, f'`{key}` as a list', value)
        return [_number(entry, path, key) for entry in value]
    return _number(value, path, key)


def _number(value: Any, path: Path, key: str) -> float:
    if isinstance(value, str):  # PyYAML reads 1e5 as text
        try:
            value = float(value)
        except ValueError:
            pass
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    _expect(number and isfinite(value), path, f'`{key}` as a number', value)
    return float(value)


def _expect(holds: bool, path: Path, expected: str, received: Any) -> None:
    if not holds:
        raise ModelFileError(
            f'experiment file {path}: expected {expected}, got {received!r}; see doc/commands.md')


def _expect_keys(entry: Mapping[str, Any], known: set[str], path: Path) -> None:
    for key in entry:
        if key not in known:
            raise UnknownNameError.among(f'key in experiment file {path}', key, known)


DEPTH = 0.0204
"""Final x_d [m]: 50 N under eq. (1) with the nominal values."""
DESIRED_FORCE = 50.0

FORCE_EXCITATION: dict[str, Excitation | None] = {
    'sine': Sine(8.0, 20.0),  # eq. (40)
    'prbs': PseudoRandomBinary(8.0),
    'multisine': Multisine(8.0, [2.0 * pi * f for f in (0.8, 1.9, 3.2, 5.3, 8.1)]),
    'none': None,
}


def manoeuvre(
    name: str, force_excitation: Excitation | None = None,
    position_excitation: Excitation | None = None, hold_s: float = 2.0,
    force: float = DESIRED_FORCE,
) -> Experiment:
    """
    Return the manoeuvre of the paper, 10 s and a hold: approach, press, withdraw.

    Excitations add to F_d while a force is prescribed, eq. (40), and to x_d, eq. (41). A force
    that is NaN is not prescribed: eq. (1) alone.
    """
    pressing: dict[str, Any] = {'force': force, 'position_excitation': position_excitation}
    if force == force:
        pressing['force_excitation'] = force_excitation
    return Experiment(
        name,
        START,
        (
            Segment(4.4, START),
            Segment(2.2, DEPTH, **pressing),
            Segment(hold_s, DEPTH, **pressing),
            Segment(2.2, START, position_excitation=position_excitation),
            Segment(1.2, START)))


def rich() -> Experiment:
    """Return three episodes, 15.8 s, of other speed, depth and excitation; no force is set."""
    away = -0.02

    def touch(approach_s: float, depth: float, amplitude: float, *omegas: float) -> list[Segment]:
        excitation = Multisine(amplitude, list(omegas))
        return [
            Segment(approach_s, depth), Segment(0.3, depth),
            Segment(3.0, depth, position_excitation=excitation), Segment(0.8, away)]

    return Experiment('rich', away, (
        Segment(0.5, away),
        *touch(0.8, 0.012, 0.002, 5.0, 11.0, 23.0),
        *touch(0.5, 0.020, 0.003, 4.0, 9.0, 17.0),
        *touch(1.5, 0.024, 0.002, 6.0, 13.0, 27.0),
        Segment(0.3, away)))


EXPERIMENTS: dict[str, Callable[[], Experiment]] = {
    'sine': lambda: manoeuvre('sine', FORCE_EXCITATION['sine']),
    'prbs': lambda: manoeuvre('prbs', FORCE_EXCITATION['prbs']),
    'multisine': lambda: manoeuvre('multisine', FORCE_EXCITATION['multisine']),
    'none': lambda: manoeuvre('none'),
    'long': lambda: manoeuvre('long', FORCE_EXCITATION['sine'], hold_s=12.0),
    'rich': rich,
}


def experiment_named(name: str) -> Experiment:
    """
    Return an experiment by name, or read it from a YAML file.

    Parameters
    ----------
    name : str
        Key of EXPERIMENTS, or path of a file ending in .yaml or .yml.

    Returns
    -------
    experiment : Experiment
        The experiment.

    Raises
    ------
    UnknownNameError
        If the name is unknown.
    ModelFileError
        If the file is missing or does not follow the schema.

    """
    if name in EXPERIMENTS:
        return EXPERIMENTS[name]()
    if Path(name).suffix in ('.yaml', '.yml'):
        return read_experiment(Path(name))
    raise UnknownNameError.among('experiment', name, [*EXPERIMENTS, 'FILE.yaml'])
