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

"""Joint states that are stamped late are told from a command that arrives late."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

from contact_estimation.diagnosis.conclude.diagnose import diagnose
from contact_estimation.diagnosis.conclude.result import Diagnosis
from contact_estimation.diagnosis.fit import joint_clock
from contact_estimation.diagnosis.fit.fitting import Fit
from contact_estimation.diagnosis.fit.joint_clock import JointClock
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.signals import Recording
from diagnosed_worlds import nominal, recorded
import numpy as np
import pytest

LATE_S = 0.01


def diagnosed(late: float, **physics: Any) -> Diagnosis:
    """Diagnose a recording whose joint states are stamped late."""
    signals = recorded(**{f'physics__{name}': value for name, value in physics.items()})
    late_ones = signals._replace(joint_t=signals.joint_t + late)
    return diagnose(Recording('late.mcap', late_ones), nominal())


@pytest.mark.parametrize('physics', [{}, {'cubic_stiffness__K_3': 2e7}])
def test_late_joint_states_are_no_delay_of_the_command(physics: dict[str, float]) -> None:
    found = diagnosed(LATE_S, **physics)
    failed = {check.name: check.text for check in found.checks if not check.ok}
    assert (list(failed), found.effects, found.verdict) == (['clock_offset'], [], 'unexplained')
    remedy = re.search(r'set synchronisation.offset to (-[\d.]+) s', failed['clock_offset'])
    assert remedy and float(remedy[1]) == pytest.approx(-LATE_S, rel=0.1)


def test_a_command_that_arrives_late_is_named() -> None:
    found = diagnosed(0.0, command_delay__delay=LATE_S)
    assert [effect.name for effect in found.effects] == ['command_delay']
    assert all(check.ok for check in found.checks)


@pytest.mark.parametrize('damping, late', [(150.0, LATE_S), (0.0, 0.0)])
def test_a_shift_that_takes_the_place_of_damping_is_none(
    monkeypatch: pytest.MonkeyPatch, damping: float, late: float
) -> None:
    base = Model.of(nominal())
    left = base.at((4800.0, damping))
    misfits = iter((100.0, 1.0))  # as stamped, and shifted
    monkeypatch.setattr(joint_clock, 'fit', lambda recordings, model: Fit(
        model, 1000.0 + next(misfits), np.ones(2), 1000))
    monkeypatch.setattr(joint_clock, 'leaves_noise', lambda found: False)
    monkeypatch.setattr(JointClock, '_tried', lambda self: [LATE_S])
    raw = [Recording('late.mcap', recorded())]
    clock = JointClock(raw, [], base, base, 0)
    of_shifted: Any = SimpleNamespace(best=Fit(left, 0.0, np.ones(2), 1000))
    assert clock.lateness(lambda earlier: ([], of_shifted)) == late
