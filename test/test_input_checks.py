# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Each common mistake is named with its remedy, and no confident estimate is given beside it."""

from math import isfinite, isnan, nan
import re
from typing import Any, Callable, Sequence

from contact_estimation.estimators import MULTIPLE_MODEL
from contact_estimation.estimators.estimate import AxesEstimates, EstimateStatus
from contact_estimation.parameters import build
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.pipeline.checks.check import AxisState, Window
from contact_estimation.pipeline.checks.input_checks import CHECKS
from contact_estimation.pipeline.checks.rejections import REJECTIONS
from contact_estimation.pipeline.events import (
    apply_event, EstimationEvent, event_now, LOCATION, set_location)
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.stream_faults import courses_of
from contact_estimation.studies import online_contacts
from contact_estimation.studies.online_row import follow
from contact_estimation.studies.online_worlds import Sensor, simulate, Wall
from contact_estimation.studies.paths import cruise, start
from core_runs import contact_samples
import numpy as np
import pytest

K_E, B_E = 5000.0, 100.0
HEALTHY = contact_samples(2.0, K_E, B_E, force_noise=0.6, position_noise=1e-6)
SOFT = contact_samples(1.5, 200.0, 4.0, depth=0.08, amplitude=0.01, force_noise=0.6)
HEALTHY_WORLDS = online_contacts.ROWS['healthy']  # with a plant and sensors of their own
MILLISECOND = 1_000_000
Change = Callable[[ContactSample], ContactSample]


def at(metres: float) -> Change:
    return lambda sample: sample._replace(position=sample.position + metres)


def fed(
    samples: Sequence[ContactSample] = HEALTHY, change: Change = lambda sample: sample,
    wrench_late_ms: int = 0, **parameters: Any,
) -> tuple[ContactSession, list[AxesEstimates]]:
    """Pass samples to a new session; double underscores stand for dots."""
    names = {name.replace('__', '.'): value for name, value in parameters.items()}
    session = ContactSession(build(EstimationParameters, names), generate_reference=False)
    results = []
    for sample in map(change, samples):
        stamp = sample.stamp_ns + 1000 * MILLISECOND
        results += session.add_motion(stamp, sample.position, sample.velocity)
        session.checks.wrenches.append((stamp, sample.force, 0.0, 0.0))
        results += session.add_wrench(stamp + wrench_late_ms * MILLISECOND, sample.force)
    return session, [result.estimates for result in results]


def headline(session: ContactSession) -> tuple[str, str]:
    """Return name and text of the first warning."""
    first = next(iter(session.checks.warnings()), None)
    return (first.name, first.text) if first else ('', '')


MISTAKES: list[tuple[str, str, dict[str, Any]]] = [
    ('force_sign', 'set force_sign to -1',
     {'change': lambda s: s._replace(force=-s.force)}),
    ('force_sign', 'change the sign of the position',
     {'change': lambda s: s._replace(position=-s.position, velocity=-s.velocity)}),
    ('stamp_skew', '1[01] ms late .*offset to [+]0.01[01]', {'wrench_late_ms': 10}),
    ('stamp_skew', ' [56] ms late .*offset to [+]0.00[56]', {'wrench_late_ms': 5}),
    ('stamp_skew', '5[01] ms late .*offset to [+]0.05', {'wrench_late_ms': 50}),
    ('stamp_skew', '(49|50) ms early .*offset to -0.0(49|50)', {'wrench_late_ms': -50}),
    ('force_still', 'exactly -27 N for', {'change': lambda s: s._replace(force=-27.0)}),
    ('two_forces', 'two publishers or two sensors',
     {'change': lambda s: s if s.stamp_ns // (2 * MILLISECOND) % 2 else s._replace(force=0.0)}),
    ('joint_still', 'has not changed since the start',
     {'change': lambda s: s._replace(position=0.01, velocity=0.0)}),
    ('position_unit', 'publish positions in metres',
     {'change': lambda s: s._replace(position=1e3 * s.position, velocity=1e3 * s.velocity)}),
    ('joint_velocity', '57 times the rate',
     {'change': lambda s: s._replace(velocity=57.0 * s.velocity)}),
    ('joint_velocity', '-1 times the rate',
     {'change': lambda s: s._replace(velocity=-s.velocity)}),
    ('joint_velocity', ' 0 times the rate', {'change': lambda s: s._replace(velocity=0.0)}),
]


def test_mistake_is_the_headline_and_its_estimate_is_withheld() -> None:
    for name, text, options in MISTAKES:
        session, estimates = fed(**options)
        found, said = headline(session)
        assert found == name, (name, text, options)
        assert re.search(text, said), said
        last = estimates[-1][0]
        assert isnan(last.stiffness_std) and isnan(last.damping_std), (name, text, options)
        assert last.status is not EstimateStatus.ESTIMATING, (name, text, options)
        numbers = re.compile(r'[-+.0-9]+')
        assert numbers.sub('#', last.reason) == numbers.sub('#', said), (name, text, options)


def test_neighbouring_counts_of_a_coarse_sensor_are_one_signal() -> None:
    noisy = 13_384.0 + np.random.default_rng(0).normal(0.0, 2.0, 1000)
    coarse = 5.37 * np.round(noisy / 5.37)
    filled = np.where(np.arange(1000) % 2, coarse, 0.0)
    assert courses_of(coarse, 4.8) is None
    assert courses_of(filled, 4.8) == pytest.approx((0.0, 13_384.0), rel=1e-3)
    two = np.where(np.arange(1000) % 2, -46.0, 0.0)
    assert courses_of(two, 4.8) == pytest.approx((-46.0, 0.0))


def yielding(force: float, position: float) -> Change:
    """Return the change to a wall that yields at 20 N and then by 1 kN/m, with signs."""
    def change(sample: ContactSample) -> ContactSample:
        seconds = sample.stamp_ns * 1e-9
        x, rate = 4e-3 * (seconds - 3.0), 4e-3
        pressed = min(4e4 * max(x, 0.0), 20.0 - 1e3 * (x - 5e-4))
        return sample._replace(force=-force * pressed, position=position * x,
                               velocity=position * rate)
    return change


@pytest.mark.parametrize('force, position, text', [
    (1.0, 1.0, ''), (-1.0, 1.0, 'set force_sign to -1'),
    (1.0, -1.0, 'presses with .* change the sign of the position'),
    (-1.0, -1.0, 'is pulled with .* change the sign of the position and set force_sign to -1')])
def test_signs_of_a_wall_that_yields_are_told_by_its_touch(
    force: float, position: float, text: str
) -> None:
    samples = [ContactSample(stamp, 0.0, 0.0, 0.0) for stamp in range(0, 7_000 * MILLISECOND,
                                                                      2 * MILLISECOND)]
    session, _ = fed(samples, yielding(force, position), environment__location=nan)
    found = [warned.text for warned in session.checks.warnings() if warned.name == 'force_sign']
    assert bool(found) == bool(text) and re.search(text, ''.join(found)), found


@pytest.mark.parametrize('metres, side', [(0.4, 'inside'), (0.01, 'inside'), (-0.1, 'outside')])
def test_a_wall_elsewhere_is_followed_and_told(metres: float, side: str) -> None:
    session, estimates = fed(change=at(metres))
    name, text = headline(session)
    assert name == 'surface'
    told = re.search(f'([0-9.]+) mm {side} the wall; set environment.location to (.*), or', text)
    assert told and float(told[1]) == pytest.approx(1e3 * abs(metres), abs=0.2)
    assert float(told[2]) == pytest.approx(metres, abs=2e-4)
    last = estimates[-1][0]
    assert last.status is EstimateStatus.ESTIMATING
    assert last.location == pytest.approx(metres, abs=2e-4)
    assert abs(last.stiffness - K_E) < 3.0 * last.stiffness_std < 0.05 * K_E


@pytest.mark.parametrize('apart_ns', [0, 2_000, 200_000])
def test_stamps_of_the_wrench_in_bursts_are_told_whatever_their_steps(apart_ns: int) -> None:
    session = ContactSession(EstimationParameters(), generate_reference=False)
    samples = contact_samples(3.5, K_E, B_E, force_noise=0.6, position_noise=1e-6)
    for k, (stamp, x, v, F) in enumerate(samples):
        begin = samples[k - k % 5].stamp_ns
        session.add_motion(stamp + 10**9, x, v)
        burst_ns = begin + 10**9 + apart_ns * (k % 5)
        session.checks.wrenches.append((burst_ns, F, 0.0, 0.0))
        session.add_wrench(burst_ns, F)
    found = {one.warned.name for one in session.checks.ordered_warnings()}
    assert headline(session)[0] == 'stamp_bursts'
    assert not found & {'stamp_skew', 'joint_velocity'}


def flight(begin_ns: int, level: float, count: int = 600) -> list[ContactSample]:
    """Rest before the wall, where the sensor reads a level and noise."""
    noise = np.random.default_rng(begin_ns % 1000).normal(level, 0.6, count).tolist()
    return [ContactSample(begin_ns + k * 2 * MILLISECOND, -0.01, 0.0, F)
            for k, F in enumerate(noise)]


@pytest.mark.parametrize('after_s, size, when', [
    (0.5, -8.0, 'at 1.500 s'), (2.5, -4.0, r'between 2.5\d and 4.7\d s')])
def test_a_step_of_the_zero_is_told_with_its_time_until_a_tare(
    after_s: float, size: float, when: str
) -> None:
    contact = [s._replace(stamp_ns=s.stamp_ns + 1200 * MILLISECOND) for s in HEALTHY]
    whole = [*flight(0, 0.0), *contact, *flight(contact[-1].stamp_ns + 2 * MILLISECOND, 0.0)]
    session, _ = fed(whole, lambda s: s._replace(
        force=s.force + (size if s.stamp_ns >= after_s * 1e9 else 0.0)))
    told = [one.text for one in session.checks.warnings() if one.name == 'zero_step']
    assert told and re.search(f'by (.*) N {when}', told[0]), told
    assert float(told[0].split()[8]) == pytest.approx(size, abs=0.3)
    assert session.tare()[0]
    for stamp, x, v, F in flight(whole[-1].stamp_ns + 1002 * MILLISECOND, size):
        session.add_motion(stamp, x, v)
        session.add_wrench(stamp, F)
    assert 'zero_step' not in {one.name for one in session.checks.warnings()}


@pytest.mark.parametrize('milliseconds', [-50, -10, 10, 50])
def test_offset_corrects_the_stamps_either_way(milliseconds: int) -> None:
    session, estimates = fed(
        wrench_late_ms=milliseconds, synchronisation__offset=milliseconds * 1e-3)
    _, expected = fed()
    assert not session.checks.warnings()
    last = estimates[-1][0]
    assert last.damping == pytest.approx(B_E, abs=2.0 * last.damping_std)
    assert last.stiffness == pytest.approx(expected[-1][0].stiffness, rel=1e-3)


@pytest.mark.parametrize('samples', [HEALTHY, SOFT])
def test_location_nan_takes_the_surface_at_the_first_touch(samples: list[ContactSample]) -> None:
    session, estimates = fed(samples, at(0.4), environment__location=nan)
    last = estimates[-1][0]
    assert abs(last.location - 0.4) < 3.0 * session.pipeline.surface.std < 4e-3
    K = K_E if samples is HEALTHY else 200.0
    assert abs(last.stiffness - K) < 3.0 * last.stiffness_std
    assert all(isnan(axes[0].location) for axes, sample in zip(estimates, samples)
               if sample.position < 0.0)
    assert not {w.name for w in session.checks.warnings()} - {'surface_unchecked'}


def test_set_location_ends_the_warning_and_replays_as_an_event() -> None:
    session, _ = fed(HEALTHY[:400], at(0.4))
    done, _, changes = set_location(session)
    x = HEALTHY[399].position + 0.4
    assert done and changes == {'environment.location': x}
    event = event_now(session, LOCATION, changes)
    apply_event(session, EstimationEvent.from_text(event.to_text()))
    assert session.parameters.environment.location == x
    assert not session.checks.warnings()


@pytest.mark.parametrize('index', [2, 3, 4, 5, 10, 17])
def test_nothing_is_said_of_healthy_worlds_with_a_noisy_velocity(index: int) -> None:
    found = HEALTHY_WORLDS.run(np.random.default_rng(index), index)
    assert found.more['warned'] == []
    assert isfinite(found.K_error) and abs(found.K_error) < 0.1


@pytest.mark.parametrize('first, text', [(0, 'relies on environment.location'),
                                         (300, 'stiffness and surface yet')])
def test_a_soft_press_and_hold_is_told_what_it_does_not_show(first: int, text: str) -> None:
    hold = contact_samples(2.0, 1000.0, 40.0, depth=0.003, amplitude=0.0, force_noise=0.6)
    session, _ = fed(hold[first:])
    assert headline(session)[0] == 'surface_unchecked' and text in headline(session)[1]


def test_every_check_and_rejection_is_documented() -> None:
    names = [check.name for check in CHECKS] + [rejection.name for rejection in REJECTIONS]
    assert len(set(names)) == len(names)
    assert all(check.message and check.cause and check.remedy for check in CHECKS)


def test_skew_after_a_long_free_flight_is_reported_within_2_s_of_contact() -> None:
    noise = np.random.default_rng(0).normal(0.0, 0.6, 8000)
    first, period = HEALTHY[0], HEALTHY[1].stamp_ns - HEALTHY[0].stamp_ns
    flight = [first._replace(stamp_ns=k * period, force=force, velocity=0.0)
              for k, force in enumerate(noise.tolist())]
    later = [one._replace(stamp_ns=one.stamp_ns + len(flight) * period) for one in HEALTHY]
    session, _ = fed([*flight, *later], wrench_late_ms=10)
    touch_ns = next(one.stamp_ns for one in later if one.force < -4.0) + 1000 * MILLISECOND
    assert session.checks.found['stamp_skew', 'x'].first_ns - touch_ns < 2000 * MILLISECOND


def test_friction_that_ends_with_a_press_is_told_as_no_skew() -> None:
    draw, t = np.random.default_rng(1), np.arange(0.0, 5.6, 0.01)
    x = np.interp(t, [0.0, 2.0], [-0.01, 0.0])  # at 5 mm/s, then slower and slower to a stop
    x += 0.0015 * (1.0 - np.square(1.0 - np.clip((t - 2.0) / 0.6, 0.0, 1.0)))
    v = np.gradient(x, t)
    force = np.where(x > 0.0, -1e4 * x - 3.0 * np.tanh(v / 4e-4), 0.0)
    signals = [values + std * draw.standard_normal(len(t)) for values, std in (
        (x, 1e-5), (v, 1e-4), (force, 0.05))]
    samples = [ContactSample(round(1e9 * stamp), *rest) for stamp, *rest in zip(
        t.tolist(), *(values.tolist() for values in signals))]
    session, _ = fed(samples, sample_rate=100.0, conditioning__cutoff_frequency=0.0,
                     environment__location=nan)
    assert not {warned.name for warned in session.checks.warnings()} - {'surface_unchecked'}


@pytest.mark.parametrize('late_s', [0.0, 0.009])
def test_checks_use_a_measured_velocity_unless_a_driver_filters_it(late_s: float) -> None:
    draw, t = np.random.default_rng(1), np.arange(0.0, 2.0, 0.002)
    x = 2e-3 * np.sin(30.0 * t) + 4e-6 * draw.standard_normal(len(t))
    v = 0.06 * np.cos(30.0 * (t - late_s)) + 3e-4 * draw.standard_normal(len(t))
    seen = Window('x', EstimationParameters(), AxisState.of(EstimationPipeline()), t, x, v,
                  np.zeros(len(t)), np.zeros(len(t), bool))
    assert (seen.rate is v) == (late_s == 0.0)


@pytest.mark.parametrize('stiffness, speed, v_noise, told, seed', [
    (8000.0, 0.01, nan, 0.3, 5), (4000.0, 0.03, 1e-4, nan, 2)])
def test_a_press_and_a_rest_tell_friction_and_no_skew(
    stiffness: float, speed: float, v_noise: float, told: float, seed: int
) -> None:
    depth, wall = 32.0 / stiffness, Wall(stiffness, 0.016 * stiffness, 0.3, friction=2.0)
    still = 1.0 + (0.005 + depth) / speed
    world = simulate('', {'environment.location': told}, [
        start(-0.005), cruise(1.0, still, speed, 0.1)], still + 2.5, wall,
        Sensor(6e-4, noise=0.15, velocity_noise=v_noise), np.random.default_rng(seed))
    trace = follow(world, MULTIPLE_MODEL)
    assert 'stamp_skew' not in {name for _, name, _ in trace.warnings}
    assert trace.laws[-1][1]['friction'] > 0.9
    assert abs(trace.K[-1] - stiffness) < min(3.0 * trace.K_std[-1], 0.01 * stiffness)
    assert abs(trace.B[-1] - wall.damping) < min(3.0 * trace.B_std[-1], 0.5 * wall.damping)
