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

"""A sensor that is not tared hides no law behind its bias."""

from __future__ import annotations

from functools import lru_cache

from concealed_worlds import nominal, prepared_from
from contact_estimation.diagnosis.conclude.shares import Shares, shares_of
from contact_estimation.diagnosis.fit.discrepancy import weighed
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.fit.zeros import without_laws
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest

BIAS, F_C, B_E, PERIOD = 250.0, 6.0, 600.0, 5.0
LAW = 'coulomb_friction'


@lru_cache(maxsize=None)
def piston(bias: float) -> tuple[PreparedRecording, Model]:
    """Push a piston to and fro: a damper that rubs, with a trifle that no law has."""
    t = np.arange(0.0, 60.0, 0.02)
    x = 0.01 * np.sin(2.0 * np.pi * t / PERIOD) + 0.004 * np.sin(2.0 * np.pi * t / 3.7)
    v = np.gradient(x, t)
    force = bias - B_E * v - F_C * np.tanh(v / 1e-4) + 0.8 * np.sin(900.0 * x)
    noise = np.random.default_rng(3).normal(0.0, 0.02, len(t))
    return prepared_from(
        Signals(t, force + noise, t, x, t[:0], np.empty((4, 0))),
        nominal(environment__unilateral=False, environment__stiffness=1000.0,
                environment__damping=B_E))


def shares(bias: float, *zeros: str) -> Shares:
    """Compute the shares of friction, beside zeros."""
    recording, model = piston(bias)
    base = fit([recording], model)
    start = model
    for zero in zeros:
        start = start.with_effect(zero, (bias,))
    recordings = weighed([recording], base.model)
    best = fit(recordings, start.with_effect(LAW, (F_C,)))
    return shares_of(recordings, base.model, best.model)


def test_share_of_a_law_beside_the_bias_is_that_of_the_tared_recording() -> None:
    tared, untared = shares(0.0), shares(BIAS, 'force_bias')
    assert tared.beside_zeros is None and tared.of_rest(LAW) is None
    assert untared.of[LAW].share < 0.01 and tared.of[LAW].share > 0.9
    beside = untared.of_rest(LAW)
    assert beside is not None
    assert beside.share == pytest.approx(tared.of[LAW].share, abs=0.02)
    assert untared.most(LAW) == pytest.approx(tared.most(LAW), abs=0.02)
    assert untared.sure(LAW) == pytest.approx(tared.sure(LAW), abs=0.05)


def test_a_zero_has_no_share_of_what_the_zeros_leave() -> None:
    found = shares(BIAS, 'force_bias')
    assert found.of_rest('force_bias') is None
    assert found.beside_zeros is not None and list(found.beside_zeros.of) == [LAW]


def test_what_the_zeros_leave_is_fitted_from_where_the_laws_were() -> None:
    recording, model = piston(BIAS)
    recordings = weighed([recording], fit([recording], model).model)
    both = fit(recordings, model.with_effect('force_bias', (BIAS,)).with_effect(LAW, (F_C,)))
    found = without_laws(recordings, both.model)
    assert found.model.effects == ('force_bias',)
    o = recording.observed
    columns = np.column_stack((-o.x, -o.v, np.ones(len(o.x))))[recording.use]
    direct = np.linalg.lstsq(columns, o.force[recording.use], rcond=None)[0]
    assert found.model.values == pytest.approx(direct, rel=0.05, abs=20.0)
