# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Where searches begin: at a recording's own magnitudes, whatever its size and length."""

from __future__ import annotations

from contact_estimation.parameters.specification import specifications
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.scales import Scales
from effect_examples import SCALES
import pytest

PRESS = SCALES._replace(sample_period=0.002)
NO_SLOWER = {'force_delay', 'force_lag', 'command_delay', 'actuator_lag'}
"""Sensors and buses are no slower where the motion is."""

TIMES, LENGTHS, FORCES = 100.0, 1e-3, 10.0
"""How much longer and stronger a second recording is."""

UNITS = {'s': TIMES, 'm': LENGTHS, 'N': FORCES, 'kg': FORCES * TIMES**2 / LENGTHS,
         'Hz': 1.0 / TIMES, 'rad': 1.0, '1': 1.0}


def enlarged(scales: Scales) -> Scales:
    """Give the scales of the same recording at another size, length and force."""
    return scales._replace(
        depth=LENGTHS * scales.depth, speed=LENGTHS / TIMES * scales.speed,
        force=FORCES * scales.force, control=FORCES * scales.control,
        greatest_pull=FORCES * scales.greatest_pull, duration=TIMES * scales.duration,
        stiffness=FORCES / LENGTHS * scales.stiffness,
        damping=FORCES * TIMES / LENGTHS * scales.damping, mass=UNITS['kg'] * scales.mass,
        sample_period=TIMES * scales.sample_period,
    )


def factor(unit: str, values: dict[str, float]) -> float:
    """Say how much larger a value in a unit is there; exponents may be parameters."""
    result, sign = 1.0, 1.0
    for part in unit.split('/'):
        for term in part.split():
            base, _, power = term.partition('^')
            exponent = values[power] if power in values else float(power or 1.0)
            result *= UNITS[base] ** (sign * exponent)
        sign = -1.0
    return result


def test_starts_grow_with_the_recording() -> None:
    for name in [name for name in EFFECTS if name not in NO_SLOWER]:
        effect = EFFECTS[name]
        specs = list(specifications(effect.Parameters))
        here, there = effect.starts(PRESS), effect.starts(enlarged(PRESS))
        assert len(here) == len(there), name
        for old, new in zip(here, there):
            values = dict(zip((spec.name for spec in specs), old))
            expected = [value * factor(spec.unit, values) for value, spec in zip(old, specs)]
            assert new == pytest.approx(tuple(expected), rel=1e-9, abs=0.0), name
