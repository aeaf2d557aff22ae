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

"""Rivals of a named effect beside a zero that the model lacks."""

from __future__ import annotations

from concealed_worlds import nominal, prepared_from
from contact_estimation.diagnosis.conclude.rivals import beside_zeros
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.fit.selection import Selection
from contact_estimation.diagnosis.observe.signals import Signals
import numpy as np
import pytest


@pytest.mark.parametrize('explained, found', [(0.8, True), (0.3, False)])
def test_friction_beside_a_bias_is_a_rival_of_a_memory(explained: float, found: bool) -> None:
    t = np.asarray(np.arange(0.0, 10.0, 0.02), np.float64)
    x = np.asarray(1e-3 * np.sin(np.pi * t), np.float64)
    v = 1e-3 * np.pi * np.cos(np.pi * t)
    noise = 2e-3 * np.random.default_rng(1).standard_normal(len(t))
    force = -500.0 * x - 0.5 * np.tanh(v / 1e-4) + 0.4 + noise
    recording, model = prepared_from(
        Signals(t, force, t, x, np.empty(0), np.empty((4, 0))),
        nominal(environment__unilateral=False, environment__stiffness=500.0,
                environment__damping=0.0))
    base = fit([recording], model)
    best = fit([recording], model.with_effect('viscoelastic_relaxation', (500.0, 0.5)))
    selection = Selection([recording], base, best, {}, {'force_bias': explained})
    rivals = beside_zeros(selection, 'viscoelastic_relaxation', [recording])
    assert bool(rivals) is found
    if found:
        assert rivals[0].model.effects[0] == 'force_bias'
        assert rivals[0].model.effects[1] in ('coulomb_friction', 'presliding_friction')
        assert rivals[0].cost < 0.1 * best.cost
