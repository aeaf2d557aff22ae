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

"""Kinds of joints, read from a robot description."""

from __future__ import annotations

from contact_estimation.kinematics.joint_kinds import turning_joint
import pytest
from small_arm import urdf

ONE = '<robot name="r"><joint name="mount" type="fixed"/><joint name="only" type="{}"/></robot>'


@pytest.mark.parametrize('names, found', [
    (['elbow'], 'elbow'), (['finger_joint', 'wrist'], 'wrist'), (['finger_joint'], ''),
    (['mount'], ''), (['unknown'], ''), ([''], '')])
def test_a_joint_turns_or_slides_as_described(names: list[str], found: str) -> None:
    assert turning_joint(urdf(), names) == found


@pytest.mark.parametrize('kind, found', [
    ('revolute', 'only'), ('continuous', 'only'), ('prismatic', '')])
def test_an_unnamed_joint_is_the_only_one_that_moves(kind: str, found: str) -> None:
    assert turning_joint(ONE.format(kind), ['']) == found


def test_a_text_that_is_no_description_has_no_joint_that_turns() -> None:
    assert turning_joint('', ['elbow']) == turning_joint('<robot', ['elbow']) == ''
