# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Soft materials: an elastic law and a loss of which neither predicts parts left out alone."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import diagnosed, nominal
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
from scipy.signal import lfilter

MODEL = nominal(environment__stiffness=15.0, environment__damping=50.0,
                environment__unilateral=False)
RATE_HZ, DEPTH, TAU_S = 20.0, 0.04, 10.0


@lru_cache(maxsize=None)
def pulled(elastic: bool, loss: bool, back_s: float = 30.0, stray: float = 0.004) -> Signals:
    """Stretch a strip once in 45 s and let it back; its force also strays, by 1 % of its range."""
    t = np.arange(round((45.0 + back_s) * RATE_HZ)) / RATE_HZ
    x = DEPTH * np.interp(t, (0.0, 45.0, 45.0 + back_s), (0.0, 1.0, 0.0))
    branch = lfilter([1.0, -1.0], [1.0, -np.exp(-1.0 / (RATE_HZ * TAU_S))], x)
    force = 2.2 * x**0.5 if elastic else 15.0 * x
    force = force + (20.0 * branch if loss else 0.0)
    random = np.random.default_rng(2)
    force += stray * np.sin(0.4 * t) * np.sin(1.1 * t) + random.normal(0.0, 5e-4, len(t))
    return Signals(t, -force, t, x, np.empty(0), np.empty((4, 0)))


@lru_cache(maxsize=None)
def diagnosis(
    elastic: bool = True, loss: bool = True, back_s: float = 30.0, stray: float = 0.004
) -> Diagnosis:
    return diagnosed(pulled(elastic, loss, back_s, stray), MODEL)


def families(found: Diagnosis) -> set[str]:
    return {effect.family for effect in found.effects}


def test_both_laws_are_named() -> None:
    found = diagnosis()
    assert families(found) == {'elastic_law', 'relaxation'}
    assert found.verdict == 'physics_missing'


def test_a_loss_is_named_beside_the_law_if_both_ways_are_as_fast() -> None:
    found = diagnosis(back_s=45.0)
    law, loss = sorted(found.effects, key=lambda effect: effect.family)
    assert law.family == 'elastic_law'
    assert loss.name in {'presliding_friction', 'viscoelastic_relaxation'}
