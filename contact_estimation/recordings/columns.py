# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Columns of tables as signals of the contract: found by name, in SI units."""

from os.path import commonprefix
import re
from shlex import quote
from typing import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .text_table import Columns
from ..exceptions import RecordingError

Signals = dict[str, NDArray[np.float64]]

_LAST_NS = 1e9 * 2**31  # stamps have 32 bits for seconds
_FIRST_DATE_NS = 1e18  # of 2001: numbers since 1970, or dates
_LONGEST_STEP_NS = 5e8  # synchronisation.time_jump_s: each row would be a jump of the clock
_FRACTIONS = {'nano': 1, 'n': 1, 'micro': 1000, 'u': 1000}  # names of parts of a second, in ns
_SMALL = {'': 1.0, 'm': 1e-3, 'u': 1e-6, 'µ': 1e-6, 'μ': 1e-6, 'n': 1e-9, 'p': 1e-12}
_UNITS: dict[str, tuple[str, float]] = {
    **{f'{prefix}{name}': (kind, factor) for prefix, factor in _SMALL.items()
       for name, kind in (('m', 'motion'), ('N', 'force'), ('s', 'time'), ('sec', 'time'))},
    'cm': ('motion', 1e-2), 'in': ('motion', 0.0254), 'inch': ('motion', 0.0254),
    'rad': ('motion', 1.0), 'deg': ('motion', np.pi / 180.0), '°': ('motion', np.pi / 180.0),
    'kN': ('force', 1e3), 'daN': ('force', 10.0),
    'kgf': ('force', 9.80665), 'gf': ('force', 9.80665e-3),
    'lbf': ('force', 4.4482216152605), 'lb': ('force', 4.4482216152605),
    # A load cell that reads as a scale.
    **dict.fromkeys(('g', 'gram', 'grams'), ('force', 9.80665e-3)), 'kg': ('force', 9.80665),
    'Nm': ('torque', 1.0), 'Nmm': ('torque', 1e-3),
    # What an Arduino counts.
    'millis': ('time', 1e-3), 'micros': ('time', 1e-6),
}
"""What a unit measures, and its factor to SI."""

_SPELLED = {'meter': 'm', 'metre': 'm', 'millimeter': 'mm', 'newton': 'N', 'second': 's',
            'radian': 'rad', 'degree': 'deg'}

# At the end of a name: z [mm], v (mm/s), z / mm, z in mm, z_mm; or all of it: millis.
_UNIT = re.compile(r'[\[(]\s*([^\d\s\[\]()/]+)(?:/s\S*)?\s*[\])]$'
                   rf'|(?:\s*[/,_]\s*|\s+in\s+|^)({"|".join(_UNITS)})$', re.IGNORECASE)

_RATES = ('velocity', 'acceleration', 'effort')
_KEY = re.compile(
    r't|wrench\.(force|torque)\.[xyz]|joint\.(.+?)(\.velocity|\.effort)?'
    rf'|reference\.(.+?)(\.({"|".join(_RATES)}))?')
KEYS = ('t', 'wrench.force.x', 'wrench.torque.x', 'joint.NAME', 'joint.NAME.velocity',
        'joint.NAME.effort', 'reference.NAME', *(f'reference.NAME.{rate}' for rate in _RATES))
"""Signals of a table; x likewise y and z."""

_AXIS = {'0': 'x', '1': 'y', '2': 'z', '12': 'x', '13': 'y', '14': 'z'}  # 12: of a 4 x 4 matrix
_POSITION = (r'pos|position|disp|displacement|distance|deflection|depth|indentation|penetration|'
             r'stroke|travel|extension|crosshead')
_MEASURED = r'(?!.*(?:desired|target|ref|goal|cmd|command|set)).+'
# Normalised names, in lower case with underscores: pandas, MATLAB, testing machines, libfranka
# (O_F_ext_hat_K[2], q[0], q_d[0]) and RTDE (actual_TCP_force_2, actual_q_0); the first
# that matches counts.
_NAMES: tuple[tuple[str, str], ...] = (
    (r't|time|timestamp', 't'),
    (r'(?:.*_)?(?:time|timestamp|stamp|sec|secs|seconds|millis|micros)', 't'),
    (rf'(?:{_MEASURED}_)?(?:f_?|force_)([xyz])', 'wrench.force.{0}'),
    (r'(?:(?:actual_)?tcp_)?force_([0-2])|(?:o|k)_f_ext_hat_k_([0-2])'
     rf'|(?:wrench|ft)(?:_{_MEASURED})?_([0-2])', 'wrench.force.{0}'),
    (r'(?:.*_)?(?:torque_|moment_|[tm]_?)([xyz])', 'wrench.torque.{0}'),
    (r'f|fn|force|load|(?:contact|normal)_force', 'wrench.force.x'),
    (r'(?:q_d|target_q)_?(\d+)', 'reference.q{0}'),
    (r'(?:x|pos|position)_(?:d|r|ref|des|desired|reference|cmd|command)|setpoint',
     'reference.x'),
    (r'(?:actual_|current_)?(?:q|joint)_?(\d+)(?:_pos|_position)?', 'joint.q{0}'),
    (r'(?:dq|qd|actual_qd)_?(\d+)', 'joint.q{0}.velocity'),
    (r'joint_states_(.+)_position', 'joint.{0}'),
    (r'joint_states_(.+)_velocity', 'joint.{0}.velocity'),
    (r'joint_states_(.+)_effort', 'joint.{0}.effort'),
    (r'(?:tau_j|tau|joint_torque|joint_effort)_?(\d+)', 'joint.q{0}.effort'),
    (rf'x|{_POSITION}', 'joint.x'),
    (r'v|velocity|vel|x_dot|xdot|speed', 'joint.x.velocity'),
    (r'([yz])', 'joint.{0}'),
    (r'o_t_ee_(12|13|14)', 'joint.{0}'),
    (r'target_tcp_pose_([0-2])|o_t_ee_d_(12|13|14)'
     r'|(?:goal|target|desired|command|reference)_(?:p|pos|position|pose)_?([xyz])',
     'reference.{0}'),
    (rf'(?:actual_|current_|ee_|eef_|tool_|tcp_)?(?:p|pose|{_POSITION}|tcp_pose|tcp)_?([xyz0-2])',
     'joint.{0}'),
    (rf'{_MEASURED}_(?:force|load)', 'wrench.force.x'),
    (rf'{_MEASURED}_(?:{_POSITION})', 'joint.x'),
    (rf'{_MEASURED}_position_([xyz])', 'joint.{0}'),  # rostopic echo -p
)


def is_key(name: str) -> bool:
    """Return whether a name is that of a signal, see `KEYS`."""
    return bool(_KEY.fullmatch(name))


def is_effort(name: str) -> bool:
    """Return whether a name is that of a joint's torque, from which a force may be found."""
    return name.startswith('joint.') and name.endswith('.effort')


def signals_of_columns(
    columns: Columns, chosen: Mapping[str, str], units: Sequence[str], where: str
) -> tuple[NDArray[np.int64], Signals]:
    """
    Find the signals of a table.

    columns (N,): as of `read_columns`
    chosen: column by signal, one of `KEYS`; a minus before the column changes its sign. `t` may be
    a rate, such as '500Hz'. Signals that are not given are found by name
    units: units of all columns whose name has none in brackets, such as 'mm'; SI by default
    where: name of the table, for errors
    Returns stamp_ns (N,): time of each row [ns]
    Returns signals (N,): by key without `t`, in SI units; NaN where a row has none
    """
    general = _general(units)
    sources = columns_of_signals(columns, chosen, units, where)
    there = f'{where} has the columns: {columns}'
    axis = next((axis for axis in 'yz' if f'joint.{axis}' in sources), 'x')
    needed = {'t': 't', 'wrench.force.': f'wrench.force.{axis}', 'joint.': 'joint.x'}
    for need, key in needed.items():
        has_efforts = need == 'wrench.force.' and any(map(is_effort, sources))
        if not has_efforts and not any(found.startswith(need) for found in sources):
            raise RecordingError(
                f'no column for {key} found by name; {there}; choose with --columns {key}=COLUMN'
                + {'t': ' or, without a column of time, t=500Hz', 'joint.x': ''}.get(
                    key, f', or {key}=-COLUMN where the force is positive while pressing'))
    signals = {}
    for key, source in sources.items():
        if key != 't':
            name = source.removeprefix('-') if source not in columns else source
            count, text = columns.odd.get(name, (0, ''))
            if 2 * count > len(columns[name]):
                raise RecordingError(
                    f'column {name!r} of {where} must hold numbers, got {count} other texts, the '
                    f'first {text[:40]!r}; choose another with --columns {key}=COLUMN')
            if foreign := _foreign_unit(key, name, general):
                known = [unit for unit, (kind, _) in _UNITS.items() if kind == _kind(key)]
                raise RecordingError(
                    f'column {name!r} of {where} must be in a unit of {key}, such as '
                    f'{", ".join(known)}, got {foreign!r}; choose another with --columns '
                    f'{key}=COLUMN, or give its unit with --units')
            factor = _factor(key, name, general) * (1.0 if source in columns else -1.0)
            values = columns[name].astype(np.float64, copy=False)
            signals[key] = values if factor == 1.0 else factor * values
    for kind in ('wrench.', 'joint.'):
        own = [key for key in signals if key.startswith(kind)]
        if own and not any(np.isfinite(signals[key]).any() for key in own):
            raise RecordingError(
                f'columns of {where} must hold finite numbers, got none in '
                f'{", ".join(repr(sources[key]) for key in own)}; choose others with --columns '
                f'{own[0]}=COLUMN')
    stamp_ns = _stamps(sources['t'], columns, general, len(next(iter(columns.values()))))
    if (rows := stamp_ns >= 0).all():
        return stamp_ns, signals
    return stamp_ns[rows], {key: values[rows] for key, values in signals.items()}


def columns_of_signals(
    columns: Columns, chosen: Mapping[str, str], units: Sequence[str], where: str
) -> dict[str, str]:
    """Choose the column of each signal; none is found by name whose unit measures another."""
    general = _general(units)
    there = f'{where} has the columns: {columns}'
    chosen = {key: _full_name(column, columns) for key, column in chosen.items()}
    for key, column in chosen.items():
        if not is_key(key):
            raise RecordingError(
                f'--columns knows no signal {key!r}; expected one of {", ".join(KEYS)} (x '
                'likewise y, z)')
        is_rate = key == 't' and re.fullmatch(r'[\d.]+ ?[hH]z', column)
        if not is_rate and column not in columns and column.removeprefix('-') not in columns:
            raise RecordingError(f'--columns {key}={column}: {there}; choose one of these')
    found: dict[str, list[str]] = {}
    taken = {column if column in columns else column[1:] for column in chosen.values()}
    ranks: dict[str, int] = {}
    struct = '' if any(map(is_key, columns)) else commonprefix(list(columns)).rpartition('.')[0]
    for rank, key, name in sorted(
            (*_rank_and_key(name[len(struct):].removeprefix('.')), name) for name in columns):
        if key and key not in chosen and name not in taken and not _foreign_unit(
                key, name, general):
            same = [twin for twin in found.get(key, ())
                    if np.array_equal(columns[name], columns[twin], equal_nan=True)]
            if rank == ranks.setdefault(key, rank) and not same:
                found.setdefault(key, []).append(name)
    # Whoever chooses joints or a reference wants no others.
    kinds = {key.split('.')[0] for key in chosen} & {'joint', 'reference'}
    found = {key: names for key, names in found.items() if key.split('.')[0] not in kinds}
    for key, names in found.items():
        if len(names) > 1:
            raise RecordingError(
                f'several columns of {where} may be {key}: {", ".join(map(repr, names))}; choose '
                f'with --columns {quote(f"{key}={names[0]}")}')
    return {**{key: names[0] for key, names in found.items()}, **chosen}


def _full_name(name: str, columns: Columns) -> str:
    """Return the name of a column that was given without its unit, or by its place from 1."""
    bare = name.removeprefix('-')
    if name in columns or bare in columns:
        return name
    same = [column for place, column in enumerate(columns, 1)
            if bare in (_UNIT.sub('', column.strip()).strip(), str(place))]
    return name if len(same) != 1 else same[0] if bare == name else f'-{same[0]}'


def _rank_and_key(name: str) -> tuple[int, str]:
    """Return the place in `_NAMES` of what a name means, and the signal; '' for none."""
    if is_key(name):
        return -1, name
    name = re.sub(r'^column \d+: ', '', name).strip()  # one of several of that name
    name = _UNIT.sub('', name) or name
    for words in (name, re.sub(r'(?<=[a-z])(?=[A-Z])', '_', name)):  # bagTimestamp
        rank, key = _rank_of(re.sub(r'\W+', '_', words.lower()).strip('_'))
        if key:
            break
    return rank, key


def _rank_of(plain: str) -> tuple[int, str]:
    """Return the place in `_NAMES` of what a normalised name means, and the signal."""
    plain = re.sub(r'(_(?:measurement|measured|value|reading|signal|channel))+$', '', plain)
    for rank, (pattern, key) in enumerate(_NAMES):
        match = re.fullmatch(pattern, plain)
        if match:
            parts = [part for part in match.groups() if part]
            part = parts[0] if parts else ''
            return rank, key.format(_AXIS.get(part, part) if '.{0}' in key else part)
    return len(_NAMES), ''


def _general(units: Sequence[str]) -> dict[str, float]:
    """Return the factor of each quantity from the units given for all columns."""
    general = {}
    for unit in units:
        found = _unit(unit)
        if found is None:
            raise RecordingError(
                f'--units must list units such as mm,N,s, got {unit!r}; known: '
                f'{", ".join(_UNITS)}')
        general[found[0]] = found[1]
    return general


def _unit(name: str, kind: str = '') -> tuple[str, float] | None:
    """Return what a unit measures, and its factor; case counts only where nm is not Nm."""
    name = re.sub('[.·*-]', '', name)  # N.m
    name = _SPELLED.get(name.lower().removesuffix('s'), name)
    names = [one for one in _UNITS if one.lower() == name.lower() and kind in ('', _UNITS[one][0])]
    return _UNITS[name if name in names else names[0]] if names else None


def _kind(key: str) -> str:
    """Return what a signal measures, as of `_UNITS`."""
    return ('time' if key == 't' else 'torque' if key.startswith('wrench.torque') or is_effort(key)
            else 'force' if key.startswith('wrench') or key.endswith('.effort') else 'motion')


def _own_unit(name: str) -> str:
    """Return the unit in the name of a column, '' for none."""
    match = None if is_key(name) else _UNIT.search(name.strip())
    return (match[1] or match[2]) if match else ''


def _factor(key: str, name: str, general: Mapping[str, float]) -> float:
    """Return the factor of a column to SI: by the unit in its name, else the general one."""
    kind, own = _kind(key), _own_unit(name)
    unit = _unit(own, kind) if own else None
    return unit[1] if unit else general.get(kind, 1.0)


def _foreign_unit(key: str, name: str, general: Mapping[str, float]) -> str:
    """Return the unit of a column if it does not measure the signal: force in V, '' if it does."""
    kind, own = _kind(key), _own_unit(name)
    measures = not own or kind == 'time' or kind in general
    return '' if measures or _unit(own, kind) else own


def _stamps(
    source: str, columns: Columns, general: Mapping[str, float], count: int
) -> NDArray[np.int64]:
    """Return the stamps [ns], -1 where a row has none; negative times begin at 0 instead."""
    if source not in columns:  # a rate
        return np.rint(np.arange(count) * 1e9 / float(source[:-2])).astype(np.int64)
    column = columns[source]
    stated = _factor('t', source, {'time': np.nan, **general})
    factor = 1e9 * (1.0 if np.isnan(stated) else stated)
    time = np.where(np.abs(column) < 1e22, column, np.inf)
    while 1e20 < factor * np.median(time) < np.inf:
        factor /= 1000.0  # ms, us or ns: no recording is of the year 5000
    near = time * factor
    near -= min(0.0, near.min(where=np.abs(near) < _LAST_NS, initial=0.0))
    known = (near >= 0.0) & (near < _LAST_NS)
    if not known.any():
        got = columns.odd.get(source, (0, ''))[1][:40]
        raise RecordingError(
            f'column {source!r} holds no time: expected seconds or dates such as 2026-01-31 '
            f'12:00:00.5{f", got {got!r}" if got else ""}; choose with --columns t=COLUMN, or '
            'without one t=500Hz')
    exact = column.dtype.kind == 'i' and abs(factor - round(factor)) < 1e-6
    stamp_ns: NDArray[np.int64] = column * round(factor) if exact else np.rint(
        np.where(known, column, 0.0) * factor).astype(np.int64)
    for prefix, unit_ns in _FRACTIONS.items():  # the sec and nanosec of ROS
        name = re.sub(r'(?=(?:sec|second)s?$)', prefix, source)
        part = np.nan_to_num(columns[name] if name in columns and name != source else 0) * unit_ns
        if np.all((part >= 0) & (part < 1e9)):
            stamp_ns, near = stamp_ns + np.rint(part).astype(np.int64), near + part
    near = np.sort(near[np.isfinite(near)])
    step = float(np.median(np.diff(near))) if len(near) > 1 else 0.0
    if np.isnan(stated) and near[0] < _FIRST_DATE_NS and step >= _LONGEST_STEP_NS:
        raise RecordingError(
            f'column {source!r} has no unit, and rises by {1e-9 * step:.6g} a row: expected less '
            f'than {1e-9 * _LONGEST_STEP_NS:g} s; give its unit, such as --units ms, or --units s')
    stamp_ns = stamp_ns - min(0, int(stamp_ns[known].min()))
    return np.where(known, stamp_ns, -1)
