# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The report as plain data for JSON."""

from math import isfinite
from typing import Any

import yaml

from ..fit.free_run import plant_of
from ..observe.model import Model, names_of
from ..result import Diagnosis, Errors, NamedEffect, Value
from ...parameters import flatten
from ...plant.plant_parameters import PlantParameters


def as_dict(diagnosis: Diagnosis, experiment_file: str | None = None) -> dict[str, Any]:
    """Return the report as nested dictionaries."""
    d = diagnosis
    return finite({
        'verdict': d.verdict,
        'effects': [_effect(effect) for effect in d.effects],
        'location': None if d.location is None else d.location.as_dict(),
        'located_in': d.shown or None,
        'checks': [{'name': check.name, 'ok': check.ok, 'text': check.text}
                   for check in d.checks],
        'remainder': None if d.remainder is None else {
            'share': d.remainder.share, **d.remainder.location.as_dict(),
            'text': d.remainder.text},
        'nominal': _base(d.nominal),
        'recalibrated': _base(d.recalibrated),
        'corrected': _corrected(d),
        'fit': {
            'noise_floor_n': d.noise_floor,
            **_errors(d.force, d.motion),
            'improvement_interval': None if d.improvement is None else list(d.improvement),
            'holdouts': [{'name': part.name, **_errors(part.force, part.motion)}
                         for part in d.holdouts],
            'force_between_samples': d.between_samples,
            'reference_held': d.holds_reference, 'rests_left_out': d.rests_left_out,
            'held_out_chose': d.held_out_chose,
            'left_over_noise': d.residual_power,
        },
        'evidence': d.evidence,
        'dependence': {
            name: [{'port': one.channel, 'on': one.on, 'share': one.share, 'chance': one.chance}
                   for one in found]
            for name, found in d.dependences.items()
        },
        'untried': [{'family': family, 'reason': reason} for family, reason in d.untried],
        'nearly': d.nearly,
        'next_experiment': {'text': d.next_experiment, 'file': experiment_file},
    })


def _effect(effect: NamedEffect) -> dict[str, Any]:
    return {
        'name': effect.name, 'family': effect.family, 'port': effect.port,
        'probability': effect.probability, 'equation': effect.equation,
        'share': effect.share, 'share_interval': list(effect.share_interval),
        'share_beside_zeros': None if effect.beside_zeros is None else effect.beside_zeros.share,
        'parts': [vars(part) for part in effect.parts],
        'parameters': {name: vars(value) for name, value in effect.parameters.items()},
        'indistinguishable_from': effect.indistinguishable_from,
        'location': effect.location.as_dict(),
    }


def _corrected(d: Diagnosis) -> dict[str, dict[str, float | None]]:
    """Return K_e and B_e; an effect that replaces them leaves null and 0."""
    stiffness_is_fitted, damping_is_fitted = d.corrected.free[:2]
    return {
        'stiffness': (_value(d.stiffness) if stiffness_is_fitted
                      else {'value': None, 'std': None}),
        'damping': _value(d.damping) if damping_is_fitted else {'value': 0.0, 'std': None},
    }


def _errors(force: Errors, motion: Errors) -> dict[str, Any]:
    return {'force_rmse_n': vars(force),
            'motion_rmse_m': vars(motion) if motion.nominal is not None else None}


def _value(value: Value) -> dict[str, float | None]:
    return {'value': value.value, 'std': value.std}


def _base(model: Model) -> dict[str, Any]:
    base: dict[str, Any] = {'stiffness': model.stiffness, 'damping': model.damping}
    if model.with_inertia:
        base['inertia'] = model.values[2]
    given = {f'{effect}.{key}': value for effect in model.given
             for key, value in zip(names_of(effect), model.values[model.place(effect)])}
    return {**base, **({'physics': given} if given else {})}


def finite(data: Any) -> Any:
    """Replace numbers that JSON cannot represent by null."""
    if isinstance(data, dict):
        return {key: finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [finite(value) for value in data]
    if isinstance(data, float):
        return data if isfinite(data) else None
    return data


def model_file(diagnosis: Diagnosis) -> str:
    """Return the corrected model as a parameter file for plant and estimator."""
    plant = plant_of(diagnosis.corrected)
    default = dict(flatten(PlantParameters()))
    given = dict(flatten(diagnosis.nominal.nominal))
    changed = {
        name: value for name, value in flatten(plant).items()
        if name.startswith(('environment.', 'robot.'))
        or (value == value and (value != default[name] or value != given[name]))
    }
    physics = {name: value for name, value in changed.items() if name.startswith('physics.')}
    estimator = {'environment.location': changed['environment.location'], **physics}
    if plant.environment.stiffness > 0.0:  # what relaxes of a curved elastic force goes by it
        estimator['environment.initial_stiffness'] = plant.environment.stiffness
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
