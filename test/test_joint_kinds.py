# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

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
