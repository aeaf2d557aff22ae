# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Remedies of an arm, rejected messages and stamps, and checks that never raise."""

from collections import Counter
from math import degrees, inf, nan
from types import SimpleNamespace
from typing import Any, Mapping

from arm_contact import instants, JOINTS, NORMAL, PARAMETERS, swung, urdf
from contact_estimation.parameters import build
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.pipeline.checks.check import AxisState, Forces, Window
from contact_estimation.pipeline.checks.input_checks import CHECKS, InputChecks
from contact_estimation.pipeline.checks.rejections import Rejections
from contact_estimation.pipeline.inputs import MessageInputs
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.stamp_screen import BEFORE_ANY, StampScreen
from hypothesis import given, settings, strategies as st
import numpy as np
from numpy.typing import NDArray
import pytest
from reference_messages import joint_state_bytes, wrench_bytes

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


@pytest.mark.parametrize('measured_in, configured, mass, zero, told', [
    ('base', 'sensor', 1.2, (0.0, 0.0, 0.0), 'set force_sensor.axes to base'),
    ('base', 'sensor', 1.2, (1.0, -2.0, 3.0), 'set force_sensor.axes to base'),
    ('sensor', 'base', 1.2, (1.0, -2.0, 3.0), 'set force_sensor.axes to sensor'),
    ('base', 'base', 1.2, (1.0, -2.0, 3.0), ''),
    ('sensor', 'sensor', 1.2, (3.0, 2.0, -8.0), ''),
    ('sensor', 'sensor', 0.0, (3.0, 2.0, -8.0), '')])
def test_a_weight_that_turns_with_other_axes_is_the_headline(
    measured_in: str, configured: str, mass: float, zero: tuple[float, ...], told: str
) -> None:
    session = ContactSession(build(EstimationParameters, {
        **PARAMETERS, 'tool.mass': 0.0, 'force_sensor.axes': configured,
        'sample_rate': 200.0,
        'estimator': 'multiple_model'}))
    session.describe(urdf())
    inputs = MessageInputs(session)
    for k in range(1200):
        q, force = swung(k, mass, zero, measured_in)
        inputs.process_motion(joint_state_bytes(
            JOINTS, q.tolist(), stamp_ns=10**9 + 5_000_000 * k))
        inputs.process_wrench(wrench_bytes(
            force.tolist(), [0.0] * 3, stamp_ns=10**9 + 5_000_000 * k, frame_id='sensor'))
    first, *_ = [*session.checks.warnings(), None]
    assert told in first.text if told and first else not told
    assert (first is not None and first.name == 'wrench_axes') == bool(told)


@pytest.mark.parametrize('counts, name, part', [
    ({'wrench_zero_stamp': 5}, 'zero_stamps', 'header.stamp'),
    ({'joint_invalid_stamp': 5}, 'invalid_stamps', 'of joint_states: their stamps are negative'),
    ({'wrench_future_stamp': 2, 'wrench_past_stamp': 2}, 'stamps_of_another_clock',
     '4 messages of wrench: their stamps are further ahead of those before and'),
    ({'wrench_frame_id': 3, 'joint_missing': 3}, 'frame', 'set frame_id'),
    ({'joint_states_joint_unknown': 4, 'joint_missing': 9}, 'joint', 'choose one of these'),
    ({'joint_gap': 4}, 'joint_gap', 'maximum_gap_s'),
    ({'joint_missing': 4}, 'joint_missing', '3 s behind'),
    ({'joint_duplicate': 4}, 'rejected', 'joint_duplicate')])
def test_rejections_say_the_main_reason(counts: dict[str, int], name: str, part: str) -> None:
    texts = {'wrench_frame_id': 'set frame_id',
             'joint_states_joint_unknown': 'choose one of these'}
    rejections = Rejections(lambda reason: texts.get(reason, ''), lambda: '3 s behind')
    found, text = rejections.new_warnings(counts, 0)
    assert found == name and part in text
    assert rejections.new_warnings(counts, 0) == ('', '')


def test_zero_stamps_are_counted_as_such() -> None:
    session = ContactSession(EstimationParameters())
    for _ in range(3):
        session.add_wrench(0, 1.0)
        session.add_motion(0, 1.0, 0.0)
    assert session.rejected == {'wrench_zero_stamp': 2, 'joint_zero_stamp': 2}


GAP_NS, JUMP_NS, LAST_NS = 50, 500, 10_000


def admitted(
    stamps: list[Any], last_ns: int = LAST_NS, other_ns: int = LAST_NS
) -> tuple[list[int], dict[str, int]]:
    """Screen stamps after others; return those that are used, and the rejections."""
    rejected: Counter[str] = Counter()
    screen, used = StampScreen('wrench', rejected), list[int]()
    screen.before_ns = last_ns - 2 if last_ns != BEFORE_ANY else last_ns
    for stamp in stamps:
        for stamp_ns, _ in screen.admit((stamp, None), last_ns, other_ns, GAP_NS, JUMP_NS):
            used.append(stamp_ns)
            screen.before_ns, last_ns = last_ns, stamp_ns
    return used, dict(rejected)


def test_a_stamp_of_no_measurement_is_rejected_at_once() -> None:
    for stamp, reason in [
        (0, 'zero_stamp'), (-1, 'invalid_stamp'), (-2**63, 'invalid_stamp'),
        (2**63, 'invalid_stamp'),
        (nan, 'invalid_stamp'), (inf, 'invalid_stamp'), (-inf, 'invalid_stamp'),
        (LAST_NS, 'duplicate'), (LAST_NS - 1, 'out_of_order'),
    ]:
        assert admitted([stamp]) == ([], {f'wrench_{reason}': 1}), (stamp, reason)
        later = [LAST_NS + k for k in range(1, 9)]
        assert admitted([stamp, *later])[0] == later, (stamp, reason)


ARM = {'kinematics.base': 'base_link', 'kinematics.tip': 'tool',
       'contact.normal': [0.0, 0.0, -1.0]}
SHAPES = ('constant', 'line', 'noise', 'alternating', 'steps', 'sine')
STEPS = (0.0, 1e-9, 2e-6, 2e-3, 1e-1, 10.0)


def signal(draw: Any, count: int) -> NDArray[np.float64]:
    """Draw a signal of some shape and size."""
    size = draw(st.sampled_from([0.0, 1e-300, 1e-12, 1e-3, 1.0, 50.0, 1e6, 1e160, 1e300]))
    shape, k = draw(st.sampled_from(SHAPES)), np.arange(count)
    noise = np.random.default_rng(draw(st.integers(0, 9))).standard_normal(count)
    values = {'constant': np.ones(count), 'line': k / max(count, 1), 'noise': noise,
              'alternating': (-1.0)**k, 'steps': np.floor(k / 100.0), 'sine': np.sin(0.05 * k)}
    return np.asarray(size * values[shape] + draw(st.sampled_from([0.0, -1.0, 1e-6])) * noise)


@st.composite
def evidence(draw: Any) -> Window:
    """Draw evidence: tiny windows, stamps that repeat, constant and huge signals."""
    count = draw(st.sampled_from([0, 1, 2, 3, 4, 17, 100, 250, 1000]))
    random = np.random.default_rng(draw(st.integers(0, 9)))
    steps = random.choice(draw(st.lists(st.sampled_from(STEPS), min_size=1)), size=count)
    t = np.cumsum(steps) - (steps[0] if count else 0.0)
    x, force = signal(draw, count), signal(draw, count)
    v = np.full(count, np.nan) if draw(st.booleans()) else signal(draw, count)
    contact = random.uniform(size=count) < draw(st.sampled_from([0.0, 0.5, 1.0]))
    parameters = build(EstimationParameters, ARM if draw(st.booleans()) else {})
    few = min(count, draw(st.sampled_from([0, 1, 1000])))
    return Window(
        'x', parameters, AxisState.of(EstimationPipeline()), t, x, v, force, contact,
        (Forces('y', signal(draw, few), x[:few]),),
        draw(st.sampled_from([float('nan'), 0.0, 1e-9, 50.0, 500.0, 1e9])),
        float(np.ptp(x)) if count else 0.0, t[:few], draw(st.sampled_from([0.0, 1.7e9])),
        draw(st.sampled_from([(), (90.0,), (0.1,)])), {0: ('elbow', -3.0, 3.0)})


@given(evidence())
@settings(derandomize=True, deadline=None, max_examples=100)
def test_every_check_returns_a_text_or_none(seen: Window) -> None:
    with np.errstate(all='ignore'):
        for check in CHECKS:
            assert isinstance(check.judge(seen), (str, type(None)))


@pytest.mark.parametrize('change', [
    lambda k, s: s._replace(force=-27.0), lambda k,
    s: s._replace(position=0.003, velocity=0.0, force=-27.0), lambda k,
    s: s._replace(stamp_ns=s.stamp_ns - s.stamp_ns % 10_000_000 + 2000 * (k % 5))])
def test_a_session_judges_frozen_signals_and_bursts(change: Any) -> None:
    pipeline = EstimationPipeline()
    checks = InputChecks(EstimationParameters(), {'x': pipeline})
    noise = np.random.default_rng(0).normal(0.0, 0.6, 1500).tolist()
    for k, force in enumerate(noise):
        sample = ContactSample(10**9 + 2_000_000 * k, 1e-3 * np.sin(0.04 * k), 0.0, force - 20.0)
        sample = change(k, sample)
        estimate = SimpleNamespace(status=None)
        checks.add((sample,), ((0,) * 7 + (estimate,),))  # type: ignore[arg-type]
    assert all(isinstance(one.text, str) for one in checks.warnings())
