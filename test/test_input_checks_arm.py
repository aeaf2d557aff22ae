# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is wrong with an arm is told with the remedy of an arm."""

from __future__ import annotations

from math import degrees, nan
from typing import Any, Mapping

from arm_contact import instants, NORMAL, PARAMETERS
from contact_estimation.parameters.values import build
from contact_estimation.pipeline.inputs import MessageInputs
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
import pytest
from reference_messages import joint_state_bytes, wrench_bytes
from small_arm import JOINTS, urdf

pytest.importorskip('pinocchio')

MISTAKES: list[tuple[Mapping[str, Any], str, str]] = [
    ({'force_sign': -1.0}, 'force_sign', 'set force_sign to 1'),
    ({'contact.normal': (-NORMAL).tolist(), 'environment.location': nan}, 'force_sign',
     'reverse contact.normal'),
    ({'contact.normal': [0.8, 0.0, 0.6], 'environment.location': nan}, 'force_axis',
     'check contact.normal, and force_sensor.frame and force_sensor.rpy'),
    ({'degrees': True}, 'joint_units', 'publish joint states in radians'),
    ({}, '', ''),
]


@pytest.mark.parametrize('mistake, name, remedy', MISTAKES, ids=[
    'flipped sign', 'reversed normal', 'permuted axes', 'degrees', 'healthy'])
def test_an_arm_has_the_remedies_of_an_arm(
    mistake: Mapping[str, Any], name: str, remedy: str
) -> None:
    changes = dict(mistake)
    in_degrees = changes.pop('degrees', False)
    session = ContactSession(build(EstimationParameters, {**PARAMETERS, **changes}))
    session.describe(urdf())
    inputs = MessageInputs(session)
    for contact, q, q_dot, wrench in instants():
        turned, rates = (
            list(map(degrees, one)) if in_degrees else list(one) for one in (q, q_dot))
        inputs.process_motion(joint_state_bytes(JOINTS, turned, rates, stamp_ns=contact.stamp_ns))
        inputs.process_wrench(wrench_bytes(
            wrench[:3].tolist(), wrench[3:].tolist(), stamp_ns=contact.stamp_ns,
            frame_id='sensor'))
    told = session.checks.warnings()
    assert (told[0].name if told else '') == name, told
    assert not told or remedy.lower() in told[0].text.lower()
