# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What every registered effect owes: registering one tests it."""

from __future__ import annotations

import dataclasses
from functools import lru_cache
import math
from math import isnan
from typing import Any

from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.parameters import optional_parameter, specifications
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.contact_effect import ContactEffect
from contact_estimation.physics.force_sensor_effect import ForceSensorEffect
from contact_estimation.physics.robot_effect import RobotEffect
from contact_estimation.plant.world import Truth
from effect_examples import example
import numpy as np
import pytest
from world_reference import K_e, plant_with, simulate

VANISHING = {  # where 0 or the neutral value is out of range, or another has to fit
    'stribeck_friction': {'physics__stribeck_friction__v_s': 1.0},
    'power_law_stiffness': {'physics__power_law_stiffness__K_n': K_e},
    'exponential_stiffness': {'physics__exponential_stiffness__depth': 1.0},
    'viscoelastic_relaxation': {'physics__viscoelastic_relaxation__tau': 1.0},
    'fractional_relaxation': {'physics__fractional_relaxation__alpha': 0.5},
    'settling_bias': {'physics__settling_bias__tau': 1.0},
    'joint_flexibility': {'physics__joint_flexibility__link_share': 0.5,
                          'physics__joint_flexibility__damping_ratio': 0.5},
    'environment_resonance': {'physics__environment_resonance__frequency': 5.0,
                              'physics__environment_resonance__damping_ratio': 0.1},
    'force_creep': {'physics__force_creep__tau': 1.0},
    'force_decay': {'physics__force_decay__tau': 1.0},
    'dmt_adhesion': {'physics__dmt_adhesion__reach': 1.0},
    'force_saturation': {'physics__force_saturation__limit': 1e9},
    'actuator_saturation': {'physics__actuator_saturation__limit': 1e5},
    'torque_saturation': {'physics__torque_saturation__limit': 1e9},
}
WITHOUT_DAMPING = {name for name, cls in EFFECTS.items()
                   if 'damper' in cls.changes}
PORTS = {'contact': ContactEffect, 'force_sensor': ForceSensorEffect, 'robot': RobotEffect}


@lru_cache(maxsize=None)
def without_effects(**wall: Any) -> list[Truth]:
    """Simulate the world without effects once."""
    return simulate(350, plant_with(**wall))


@dataclasses.dataclass(frozen=True)
class NeedsTwo(ContactEffect):
    """An effect with two parameters."""

    first: float = optional_parameter('One', 'N')
    second: float = optional_parameter('Other', 'N')


def test_name_is_the_key_and_port_that_of_the_base() -> None:
    for name, effect in EFFECTS.items():
        assert effect.name == name and issubclass(effect, PORTS[effect.port]), name


def test_parameters_are_off_by_default_and_described() -> None:
    for name, effect in EFFECTS.items():
        assert not effect().is_on(), name
        for spec in specifications(effect):
            assert isinstance(spec.default, float) and isnan(spec.default), (name, spec.name)
            assert spec.nan_is_off, (name, spec.name)
            assert spec.unit and len(spec.description) > 8, (name, spec.name)
            assert spec.name in effect.equation, (name, spec.name)


def test_effect_with_neutral_parameters_changes_nothing() -> None:
    for name in EFFECTS:
        wall: Any = {'environment__damping': 0.0} if name in WITHOUT_DAMPING else {}
        neutral: Any = {f'physics__{name}__{key}': value
                        for key, value in EFFECTS[name].neutral().items()}
        neutral.update(VANISHING.get(name, {}))
        got = np.array(simulate(350, plant_with(**wall, **neutral)))
        nominal = np.array(without_effects(**wall))
        np.testing.assert_allclose(got, nominal, rtol=1e-9, atol=1e-9, err_msg=name)


def test_law_gives_the_same_for_numbers_and_arrays() -> None:
    d, v = np.linspace(1e-4, 1e-2, 20), np.linspace(-0.1, 0.1, 20)
    for name in EFFECTS:
        effect = example(name)
        if isinstance(effect, ContactEffect) and not effect.states:
            arrays = effect.resistance(0.0, d, v, (), np)
            numbers = [
                effect.resistance(0.0, x, y, (), math) for x, y in zip(d.tolist(), v.tolist())]
            np.testing.assert_allclose(arrays, numbers, rtol=1e-12, err_msg=name)


def test_effect_with_only_some_of_its_parameters_is_refused() -> None:
    with pytest.raises(ParameterRangeError, match='needs_two needs all of first, second; missing'):
        NeedsTwo(first=1.0).is_on()
