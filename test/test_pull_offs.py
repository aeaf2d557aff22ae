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

"""Adhesion that is named by the pull at the end of contacts, though something else is larger."""

from concealed_worlds import (
    diagnosed,
    FORCE_NOISE,
    named,
    nominal,
    physics,
    prepared_from,
    recorded,
)
from contact_estimation.diagnosis.fit.pull_offs import is_pulled_off, pull_offs, PullOffs
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.report.text_report import as_text
import numpy as np
import pytest

PULL, RANGE_N = 8.0, 70.0


def pulled(size: float, swing: float = 0.0, drawn_at: float = 0.0) -> Signals:
    """
    Press a curved soft thing once at 1 mm/s, which holds on to the tool while it leaves.

    Half as hard it draws the tool in within 0.5 mm of a position.
    """
    t = np.asarray(0.01 * np.arange(2400), np.float64)
    x = 1e-3 * np.interp(t, [0.0, 2.0, 10.0, 18.0, 24.0], [-4.0, -4.0, 4.0, -4.0, -4.0])
    generator = np.random.default_rng(1)
    loaded = RANGE_N * np.clip(x / 4e-3, 0.0, None) ** 1.7
    force = -np.where(t < 10.0, loaded, 0.6 * loaded + 0.4 * loaded**2 / RANGE_N)
    leaving = (t > 10.0) & (x > -2e-3)
    pull = np.interp(x, [-2e-3, -1e-3, 2e-3, 4e-3], [0.0, 1.0, 0.3, 0.0])
    force += size * leaving * pull + swing * np.sin(6.0 * t)
    force += 0.5 * size * ((t < 10.0) & (x > drawn_at) & (x < min(drawn_at + 5e-4, 0.0)))
    force += 0.05 * generator.standard_normal(len(t))
    return Signals(t, force, t, x + 1e-7 * generator.standard_normal(len(t)), np.empty(0),
                   np.empty((4, 0)))


SOFT = nominal(environment__stiffness=15000.0, environment__damping=100.0)


def pulls_of(signals: Signals) -> PullOffs:
    """Measure the pulls with the nominal model."""
    recording, model = prepared_from(signals, SOFT)
    return pull_offs([recording], model)


def test_pull_at_the_end_of_the_contact_is_measured() -> None:
    pulls = pulls_of(pulled(PULL))
    assert pulls.are_clear
    assert pulls.sizes == pytest.approx([PULL], rel=0.05)


@pytest.mark.parametrize('size, swing', [(0.0, 0.0), (0.5, 0.0), (0.0, PULL), (PULL, PULL)])
def test_a_trifle_and_a_force_that_swings_are_no_pull(size: float, swing: float) -> None:
    assert not pulls_of(pulled(size, swing)).are_clear


def test_a_wall_may_draw_the_tool_in_where_it_pulls_but_not_farther() -> None:
    assert pulls_of(pulled(PULL, drawn_at=-0.9e-3)).are_clear
    assert not pulls_of(pulled(PULL, drawn_at=-2.5e-3)).are_clear


@pytest.mark.parametrize('size, clear', [(PULL, True), (0.0, False)])
def test_a_recording_may_begin_in_contact(size: float, clear: bool) -> None:
    whole = pulled(size)
    late = whole.wrench_t > 5.0
    t, x = whole.wrench_t[late], whole.position[late]
    pulls = pulls_of(Signals(t, whole.force[late], t, x, np.empty(0), np.empty((4, 0))))
    assert pulls.are_clear is clear
    if clear:
        assert pulls.sizes == pytest.approx([PULL], rel=0.05)


def test_pulls_of_several_contacts_must_be_alike() -> None:
    sizes = np.array([4.0, 5.0, 6.0])
    assert PullOffs(sizes, 1.0).are_clear
    assert PullOffs(sizes, 1.0).words == (
        'the wall pulls by 5 +- 1 N at the end of each of 3 contacts')
    assert not PullOffs(sizes, 4.5).are_clear
    assert not PullOffs(np.array([1.0, 1.0, 9.0]), 0.5).are_clear
    assert not PullOffs(np.empty(0), 0.0).are_clear


def test_robot_and_wall_without_adhesion_show_none() -> None:
    recording, model = prepared_from(recorded(**physics('force_lag', 0.006)))
    assert not pull_offs([recording], model).are_clear
    sticky, model = prepared_from(recorded(**physics('adhesion', 8.0)))
    found = pull_offs([sticky], model)
    assert found.are_clear and np.all(found.sizes < 8.0 + 6.0 * FORCE_NOISE)


def test_a_pull_after_each_contact_tells_an_adhesion_and_nothing_else() -> None:
    recording, model = prepared_from(pulled(PULL), SOFT)
    assert is_pulled_off([recording], model, 'dmt_adhesion')
    assert not is_pulled_off([recording], model, 'power_law_stiffness')
    rest, _ = prepared_from(pulled(0.0), SOFT)
    assert not is_pulled_off([rest], model, 'adhesion')


def test_adhesion_is_named_beside_something_larger() -> None:
    found = diagnosed(pulled(PULL), SOFT)
    adhesion = found.effects[named(found).index('adhesion')]
    assert adhesion.mark is not None and 'dmt_adhesion' in (
        adhesion.name, *adhesion.indistinguishable_from)
    assert 'signature: the wall pulls by 7.9' in as_text(found).replace('\n', ' ')
