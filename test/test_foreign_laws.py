# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws of the literature: what each owes to the studies that conceal it."""

from __future__ import annotations


from contact_estimation.physics import EFFECTS
from contact_estimation.studies.foreign_laws import ALL_LAWS, FOREIGN_LAWS, UNKNOWN_LAWS
from contact_estimation.studies.foreign_laws.law import (
    ContactLaw, ForeignLaw, Magnitudes, RobotLaw, SensorLaw)
import numpy as np

WORLD = Magnitudes(depth=0.02, speed=0.1, force=80.0, control=150.0, duration=15.0,
                   stiffness=4000.0, damping=100.0, mass=20.0)


def test_a_law_grows_with_its_strength_from_nothing() -> None:
    for name in ALL_LAWS:
        strength = ALL_LAWS[name].draw(WORLD, np.random.default_rng(1))
        weak, strong = strength(0.1), strength(0.8)
        assert set(weak) == set(strong), name
        assert any(weak[key] != strong[key] for key in weak), name
        assert all(np.isfinite(value) for value in strength(1e-4).values()), name


def test_a_law_states_its_port_and_known_families() -> None:
    for name in ALL_LAWS:
        cls: type[ForeignLaw] = ALL_LAWS[name]
        bases = {'contact': ContactLaw, 'force_sensor': SensorLaw, 'robot': RobotLaw}
        assert issubclass(cls, bases[cls.port]), name
        assert set(cls.families) <= {effect.family for effect in EFFECTS.values()}, name
        assert bool(cls.families) == (name in FOREIGN_LAWS) != (name in UNKNOWN_LAWS), name
        assert cls.__doc__ and any(f'{year}' in cls.__doc__ for year in range(1890, 2027)), name
