# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The report as data, text, and corrected model file; schema in the interface contract."""

from __future__ import annotations

from math import isfinite
from typing import Any

import yaml

from ..conclude.location import Location
from ..conclude.result import Diagnosis, Errors, NamedEffect, Value
from ..fit.free_run import plant_of
from ..observe.model import Model
from ...parameters.values import flatten
from ...plant.plant_parameters import PlantParameters

_PHASES = {
    'free': 'in free flight', 'entry': 'just after touch-down', 'hold': 'while holding',
    'loading': 'while pressing further', 'unloading': 'while letting go',
    'all': 'in all phases of the contact',
}
_BETWEEN = {'smooth': 'goes on smoothly: straight lines explain less',
            'held': 'is held: straight lines explain less'}
_MOST_NAMED = 4
PORTS = {'contact': 'in the contact', 'force_sensor': 'in the force sensor',
         'robot': 'in the robot'}


def as_dict(diagnosis: Diagnosis, experiment_file: str | None = None) -> dict[str, Any]:
    """
    Give the report's data.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.
    experiment_file : str, optional
        Where the next experiment was written.

    Returns
    -------
    report : dict
        Of the contract's schema; numbers that are not finite become null.

    """
    d = diagnosis
    effects = [_effect(effect) for effect in d.effects]
    stiffness: dict[str, float | None] = _value(d.stiffness)
    damping: dict[str, float | None] = _value(d.damping)
    if not d.corrected.free[0]:
        stiffness = {'value': None, 'std': None}
    if not d.corrected.free[1]:
        damping = {'value': 0.0, 'std': None}
    return _finite({
        'verdict': d.verdict,
        'effects': effects,
        'location': None if d.location is None else d.location.as_dict(),
        'located_in': d.shown,
        'nominal': _base(d.nominal),
        'recalibrated': _base(d.recalibrated),
        'corrected': {'stiffness': stiffness, 'damping': damping},
        'fit': {
            'noise_floor_n': d.noise_floor,
            'force_rmse_n': vars(d.force),
            'motion_rmse_m': vars(d.motion) if d.motion.nominal is not None else None,
            'improvement_interval': None if d.improvement is None else list(d.improvement),
            'holdouts': [
                {'name': part.name, 'force_rmse_n': vars(part.force),
                 'motion_rmse_m': vars(part.motion) if part.motion.nominal is not None else None}
                for part in d.holdouts
            ],
            'force_between_samples': d.between_samples,
            'left_over_noise': d.residual_power,
            'left_predictable': d.predictable,
        },
        'evidence': d.evidence,
        'dependence': {
            name: [{'port': one.channel, 'on': one.on, 'share': one.share, 'chance': one.chance}
                   for one in found]
            for name, found in d.dependences.items()
        },
        'next_experiment': {'text': d.next_experiment, 'file': experiment_file},
    })


def _effect(effect: NamedEffect) -> dict[str, Any]:
    return {
        'name': effect.name, 'port': effect.port, 'probability': effect.probability,
        'equation': effect.equation,
        'parameters': {name: {**_value(value), 'unit': value.unit}
                       for name, value in effect.parameters.items()},
        'indistinguishable_from': effect.indistinguishable_from,
        'location': effect.location.as_dict(),
    }


def _value(value: Value) -> dict[str, float | None]:
    return {'value': value.value, 'std': value.std}


def _base(model: Model) -> dict[str, float]:
    base = {'stiffness': model.stiffness, 'damping': model.damping}
    return {**base, 'inertia': model.values[2]} if model.with_inertia else base


def _finite(data: Any) -> Any:
    """Replace what JSON cannot say by null."""
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_finite(value) for value in data]
    if isinstance(data, float):
        return data if isfinite(data) else None
    return data


def as_text(diagnosis: Diagnosis) -> str:
    """
    Say the result in words.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    text : str
        A dozen lines.

    """
    d = diagnosis
    lines = [_headline(d), '']
    for effect in d.effects:
        lines += _effect_lines(effect)
    if d.location is not None and (d.verdict == 'unexplained' or not d.effects):
        where = f'{PORTS[d.location.port]}, {place_of(d.location)}'
        lines += [f'What no effect explains sits {where}.']
    if d.location is not None and len(d.recordings) > 1:
        lines += [f'Times are those of {d.shown}, the recording that is explained worst.']
    if d.location is not None:
        lines += _dependence_lines(d)
    lines += _fit_lines(d)
    if d.next_experiment:
        lines += ['', 'Next: ' + d.next_experiment]
    return '\n'.join(lines)


def _dependence_lines(d: Diagnosis) -> list[str]:
    """Say on what the rest depends before the correction, and after it."""
    said = []
    for name in d.pair:
        tested = [one for one in d.dependences[name] if one.channel == d.located_channel]
        if not tested:
            return []  # the recording is too short to tell
        found = sorted((one for one in tested if one.is_real),
                       key=lambda one: -one.share)[:_MOST_NAMED]
        said.append(', '.join(f'{one.on} ({100.0 * one.share:.0f} %)' for one in found)
                    or 'nothing beyond chance')
    before, after = d.pair
    return [f'What the {before} model leaves in the {d.located_channel} depends on {said[0]}; '
            f'what the {after} one leaves, on {said[1]}.']


def _headline(d: Diagnosis) -> str:
    K, B = d.recalibrated.stiffness, d.recalibrated.damping
    nominal = f'K_e {d.nominal.stiffness:.5g} N/m, B_e {d.nominal.damping:.4g} N s/m'
    if d.verdict == 'consistent':
        return f'consistent: the model ({nominal}) explains the recording to its noise.'
    if d.verdict == 'recalibrate':
        return (f'recalibrate: the physics are right, the values are not. K_e {K:.5g} N/m, B_e '
                f'{B:.4g} N s/m instead of {nominal}; nothing is missing.')
    names = ' and '.join(effect.name for effect in d.effects)
    if d.verdict == 'physics_missing':
        return f'physics missing: {names}. Other values of K_e and B_e would not do.'
    known = f' {names} explains part of it.' if names else ''
    return f'unexplained: something is missing that the library has no name for.{known}'


def _effect_lines(effect: NamedEffect) -> list[str]:
    values = ', '.join(
        f'{name} = {_known(value)}' + ('' if value.unit == '1' else f' {value.unit}')
        for name, value in effect.parameters.items()
    )
    lines = [
        f'  {effect.name} ({PORTS[effect.port]}), probability {effect.probability:.3f}',
        f'    {effect.equation}',
        f'    {values}',
        f'    seen {place_of(effect.location)}',
    ]
    if effect.indistinguishable_from:
        lines.append('    this recording cannot tell it from '
                     + ' or '.join(effect.indistinguishable_from))
    return lines


def _known(value: Value) -> str:
    """Say a value with its standard deviation, which the end of a range has not."""
    return f'{value.value:.6g}' + (f' +- {value.std:.2g}' if isfinite(value.std) else '')


def place_of(location: Location) -> str:
    """
    Say where a mismatch sits, but for its port.

    Parameters
    ----------
    location : Location
        It.

    Returns
    -------
    text : str
        Phase, times, region and band.

    """
    where = location
    times = ', '.join(f'{a:.1f}-{b:.1f} s' for a, b in where.intervals_s[:4])
    times += ', ...' if len(where.intervals_s) > 4 else ''
    strongest = 'strongest at ' if where.region.startswith(('small', 'large')) else ''
    return (f'{_PHASES.get(where.phase, where.phase)} ({times}), {strongest}{where.region}, '
            f'{where.band_hz[0]:.1f} to {where.band_hz[1]:.1f} Hz')


def _fit_lines(d: Diagnosis) -> list[str]:
    lines = []
    if d.effects:
        stiffness_is_free, damping_is_free = d.corrected.free[:2]
        stiffness = (f'K_e {_known(d.stiffness)} N/m' if stiffness_is_free
                     else 'no K_e (the effect takes its place)')
        damping = (f'B_e {_known(d.damping)} N s/m' if damping_is_free
                   else 'B_e 0 (the effect takes its place)')
        lines += ['', f'With it: {stiffness}, {damping}; without: K_e '
                  f'{d.recalibrated.stiffness:.6g}, B_e {d.recalibrated.damping:.5g}.']
    held = ', '.join(part.name for part in d.holdouts)
    lines += ['', f'On what no fit has seen ({held}):',
              _row('', 'nominal', 'recalibrated', 'corrected')]
    lines.append(_row('force error [N]', *_numbers(d.force, 1.0)))
    if d.motion.nominal is not None:
        lines.append(_row('motion, free run [um]', *_numbers(d.motion, 1e6)))
    lines.append(f'  noise floor of the force {d.noise_floor:.3g} N')
    if d.between_samples in _BETWEEN:
        lines.append(f'  between its samples the force {_BETWEEN[d.between_samples]}')
    if d.improvement is not None and d.effects:
        low, high = (100.0 * value for value in d.improvement)
        lines.append(
            f'  the correction takes {low:.0f} to {high:.0f} % off the force error (95 %)')
    return lines


def _row(*cells: str) -> str:
    return f'  {cells[0]:<22}' + ''.join(f'{cell:>14}' for cell in cells[1:])


def _numbers(errors: Errors, factor: float) -> list[str]:
    values = (errors.nominal, errors.recalibrated, errors.corrected)
    return ['-' if value is None else f'{factor * value:.4g}' for value in values]


def model_file(diagnosis: Diagnosis) -> str:
    """
    Write the corrected model as a parameter file for plant and estimator.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    text : str
        YAML with sections `plant_node` and `estimator_node`.

    """
    plant = plant_of(diagnosis.corrected)
    default = dict(flatten(PlantParameters()))
    given = dict(flatten(diagnosis.nominal.nominal))
    changed = {
        name: value for name, value in flatten(plant).items()
        if name.startswith(('environment.', 'robot.'))
        or (value == value and (value != default[name] or value != given[name]))
    }
    physics = {name: value for name, value in changed.items() if name.startswith('physics.')}
    estimator = {
        'environment.location': changed['environment.location'],
        **physics,
    }
    nodes = {
        'plant_node': {'ros__parameters': _nested(changed)},
        'estimator_node': {'ros__parameters': _nested(estimator)},
    }
    return str(yaml.safe_dump(nodes, sort_keys=False, default_flow_style=False))


def _nested(values: dict[str, Any]) -> dict[str, Any]:
    tree: dict[str, Any] = {}
    for name, value in values.items():
        *groups, last = name.split('.')
        branch = tree
        for group in groups:
            branch = branch.setdefault(group, {})
        branch[last] = float(f'{value:.10g}') if isinstance(value, float) else value
    return tree
