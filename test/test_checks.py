# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Each check fires on the wrong use it is for, alone, and on nothing else."""

from typing import Any, Callable, Mapping

from concealed_worlds import nominal, physics, recorded
from contact_estimation.diagnosis.checks import check, CHECKS, examine
from contact_estimation.diagnosis.checks.check import Check
from contact_estimation.diagnosis.diagnose import diagnose
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.report.json_report import as_dict
from contact_estimation.diagnosis.report.page import as_html
from contact_estimation.diagnosis.report.text_report import as_text
from contact_estimation.physics import EFFECTS
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np
import pytest

Change = Callable[[Signals], Signals]


def scaled(position: float, reference: float) -> Change:
    """Multiply all positions and rates."""
    def change(s: Signals) -> Signals:
        factors = np.array([[reference], [reference], [reference], [1.0]])
        return s._replace(position=position * s.position, reference=factors * s.reference)
    return change


def forced(factor: float, noise: float = 0.0) -> Change:
    """Multiply the force, and add noise."""
    def change(s: Signals) -> Signals:
        more = noise * np.random.default_rng(1).normal(size=len(s.force))
        return s._replace(force=factor * s.force + more)
    return change


def late(wrench: float, joints: float = 0.0) -> Change:
    """Shift stamps, counted from the first wrench."""
    def change(s: Signals) -> Signals:
        return s._replace(joint_t=s.joint_t + joints - wrench, reference_t=s.reference_t - wrench)
    return change


def late_reference(seconds: float) -> Change:
    """Stamp the reference later than the robot follows it."""
    return lambda s: s._replace(reference_t=s.reference_t + seconds)


def without_rates(s: Signals) -> Signals:
    """Record the positions of the reference alone."""
    return s._replace(reference=s.reference * [[1.0], [0.0], [0.0], [1.0]])


def slow_clock(factor: float) -> Change:
    """Multiply all stamps."""
    def change(s: Signals) -> Signals:
        return s._replace(wrench_t=factor * s.wrench_t, joint_t=factor * s.joint_t,
                          reference_t=factor * s.reference_t)
    return change


def in_bursts(s: Signals) -> Signals:
    """Stamp ten wrenches when a buffer is read."""
    n = np.arange(len(s.wrench_t))
    return s._replace(wrench_t=s.wrench_t[n - n % 10] + 2e-5 * (n % 10))


def with_second(force: float, at_random: bool = False) -> Change:
    """Let a second sensor publish on the topic, every other time or at random."""
    def change(s: Signals) -> Signals:
        draw = np.random.default_rng(3).uniform(size=len(s.force))
        mine = draw < 0.3 if at_random else np.arange(len(s.force)) % 2 == 1
        return s._replace(force=np.where(mine, force, s.force))
    return change


def second_position(s: Signals) -> Signals:
    """Let a second publisher send zeros for every other position."""
    return s._replace(position=s.position * (np.arange(len(s.position)) % 2))


def zeroed(seconds: float) -> Change:
    """Let the driver zero a sensor that read 5 N."""
    return lambda s: s._replace(force=s.force + 5.0 * (s.wrench_t < seconds))


def cut_short(s: Signals) -> Signals:
    """Lose the last third of the joint states."""
    count = 2 * len(s.joint_t) // 3
    return s._replace(joint_t=s.joint_t[:count], position=s.position[:count])


def thinned(step: int) -> Change:
    """Keep one of so many samples."""
    def change(s: Signals) -> Signals:
        return Signals(*(np.ascontiguousarray(row[..., ::step]) for row in s))
    return change


def measured_reference(s: Signals) -> Signals:
    """Take the measured position for the reference."""
    rows = np.zeros((4, len(s.joint_t)))
    rows[0], rows[1] = s.position, np.gradient(s.position, s.joint_t)
    return s._replace(reference_t=s.joint_t, reference=rows)


def other_reference(s: Signals) -> Signals:
    """Take another axis for the reference."""
    rows = np.zeros_like(s.reference)
    rows[0] = 0.01 * np.sin(7.0 * s.reference_t)
    return s._replace(reference=rows)


def goal_as_reference(s: Signals) -> Signals:
    """Take the goal of the first motion for the reference, as a planner publishes it."""
    rows = np.zeros_like(s.reference)
    rows[0] = s.reference[0].max()
    return s._replace(reference=rows)


def paused(s: Signals) -> Signals:
    """Leave out two seconds of all topics."""
    kept = (s.wrench_t < 2.0) | (s.wrench_t > 4.0)
    t = s.wrench_t[kept]
    return Signals(t, s.force[kept], t, s.position[kept], t, s.reference[:, kept])


def spiked(signals: Signals) -> Signals:
    """Put five positions a metre off."""
    wild = signals.position.copy()
    wild[100:1100:200] += 1.0
    return signals._replace(position=wild)


def rounded(s: Signals) -> Signals:
    """Round positions to a tenth of a millimetre."""
    return s._replace(position=1e-4 * np.round(s.position / 1e-4))


WRONG: Mapping[str, tuple[str, Change]] = {
    'force of the robot on the wall': ('force_sign', forced(-1.0)),
    'position out of the wall': ('position_sign', scaled(-1.0, 1.0)),
    'all positions out of the wall': ('position_sign', scaled(-1.0, -1.0)),
    'positions in mm': ('length_unit', scaled(1e3, 1.0)),
    'positions and reference in mm': ('length_unit', scaled(1e3, 1e3)),
    'reference in mm': ('length_unit', scaled(1.0, 1e3)),
    'positions in um': ('length_unit', scaled(1e6, 1.0)),
    'positions in inches': ('length_unit', scaled(39.37, 39.37)),
    'force in kN': ('force_unit', forced(1e-3)),
    'force in kgf': ('force_unit', forced(1.0 / 9.80665)),
    'force in lbf': ('force_unit', forced(1.0 / 4.44822)),
    'force in grams': ('force_unit', forced(1e3 / 9.80665)),
    'five per cent of the force': ('axis', forced(0.05, 0.3)),
    'minus ten per cent of the force': ('axis', forced(-0.1, 0.3)),
    'sensor not connected': ('excitation', forced(0.0, 0.3)),
    'wrench early': ('clock_offset', late(-0.3)),
    'wrench late': ('clock_offset', late(0.4)),
    'joints on another day': ('clock_offset', late(0.0, 1e5)),
    'wrench in bursts': ('stamp_bursts', in_bursts),
    'every second force zero': ('two_sources', with_second(0.0)),
    'a second sensor': ('two_sources', with_second(-3.0, at_random=True)),
    'every second position zero': ('two_sources', second_position),
    'a sensor zeroed in free flight': ('zero_steps', zeroed(0.5)),
    'a sensor zeroed in contact': ('zero_steps', zeroed(1.8)),
    'stamps of a clock that is a twentieth slow': ('sampling_rate', slow_clock(1.05)),
    'stamps in milliseconds': ('sampling_rate', slow_clock(1e3)),
    'stamps of a fast clock': ('sampling_rate', slow_clock(1e-3)),
    'reference measured': ('command_topic', measured_reference),
    'reference that is only the goal': ('command_topic', goal_as_reference),
    'reference of another axis': ('command_topic', other_reference),
    'reference stamped late': ('reference_clock', late_reference(0.05)),
}
COARSE: Mapping[str, tuple[str, Change]] = {
    'ten hertz': ('sampling_rate', thinned(25)),
    'a pause': ('gaps', paused),
    'joints that end early': ('common_time', cut_short),
    'positions of the reference alone': ('reference_rates', without_rates),
    'rounded': ('quantisation', rounded),
    'wild positions': ('spikes', spiked),
    'clipped': ('force_clipping', lambda s: s._replace(
        force=np.maximum(s.force, 0.6 * float(np.min(s.force))))),
}

OF_FILES: Mapping[str, Mapping[str, Any]] = {
    'complete_file': {'damage': 'it ends within its data'}, 'stamp_order': {'stamps_back_s': 3.0},
    'wrench_axes': {'foreign_axes': 'set force_sensor.axes to base'}}


def failed(signals: Signals, model: PlantParameters) -> list[Check]:
    """Return the checks that fail."""
    return [one for one in check(Recording('file', signals), model)[0] if not one.ok]


@pytest.mark.parametrize('wrong', WRONG)
def test_wrong_use_fails_its_check_alone(wrong: str) -> None:
    name, change = WRONG[wrong]
    (found,) = failed(change(recorded()), nominal())
    assert (found.name, found.fatal, found.could_cause) == (name, True, frozenset(EFFECTS))


@pytest.mark.parametrize('wrong', ['force of the robot on the wall', 'positions in mm',
                                   'force in kgf', 'wrench early'])
def test_concealed_physics_hides_no_wrong_use(wrong: str) -> None:
    name, change = WRONG[wrong]
    signals = recorded(**physics('coulomb_friction', 4.0))
    assert [one.name for one in failed(change(signals), nominal())] == [name]


@pytest.mark.parametrize('coarse', COARSE)
def test_coarse_data_fail_a_check_that_is_not_fatal(coarse: str) -> None:
    name, change = COARSE[coarse]
    (found,) = failed(change(recorded()), nominal())
    assert (found.name, found.fatal) == (name, False)
    assert found.could_cause < frozenset(EFFECTS)


def test_every_check_is_tested_here() -> None:
    tested = {name for name, _ in (*WRONG.values(), *COARSE.values())}
    assert tested | {'unilateral', 'wall_location', 'constant_speed', *OF_FILES} == set(CHECKS)


@pytest.mark.parametrize('name', OF_FILES)
def test_fault_of_a_file_fails_its_check_alone(name: str) -> None:
    recording = Recording('file', recorded(), **OF_FILES[name])
    (found,) = [one for one in check(recording, nominal())[0] if not one.ok]
    assert (found.name, found.fatal) == (name, name != 'complete_file')


@pytest.mark.parametrize('location', [-0.1, 0.06, 1.0])
def test_a_wall_that_is_elsewhere_fails_the_location(location: float) -> None:
    (found,) = failed(recorded(), nominal(environment__location=location))
    assert found.name == 'wall_location'
    assert abs(float(found.text.split('set the location to about ')[1].split()[0])) < 0.002


def test_checks_say_which_recording_is_wrong() -> None:
    recordings = [Recording('monday', recorded()), Recording('tuesday', forced(-1.0)(recorded()))]
    (found,) = (one for one in examine(recordings, nominal()).checks if not one.ok)
    assert found.text.startswith('tuesday: F_e is ')


def test_a_refused_recording_gets_a_report_without_names() -> None:
    found = diagnose(Recording('file', scaled(1e3, 1.0)(recorded())), nominal())
    assert (found.verdict, found.effects, found.refused) == ('unexplained', [], True)
    report = as_dict(found)
    (wrong,) = (one for one in report['checks'] if not one['ok'])
    assert wrong['name'] == 'length_unit' and 'record metres' in wrong['text']
    assert as_text(found).startswith('Check length_unit: ')
    assert 'Fix the recording first: length unit' in as_html(found, 'file')


def stroke(speed: float, back: bool = False, wait: float = 0.0) -> Signals:
    """Load a stiffening specimen by 5 mm at constant speed, once; wait for a share of that."""
    t = np.arange(0.0, 0.005 / speed, 0.01)
    x = speed * np.maximum(t - wait * t[-1], 0.0)
    if back:
        x = np.minimum(x, 0.005 - x)
    random = np.random.default_rng(1)
    force = -5000.0 * x - 2e7 * x**3 + random.normal(0.0, 0.01, len(t))
    x += random.normal(0.0, 1e-7, len(t))
    return Signals(t, force, t, x, np.empty(0), np.empty((4, 0)))


@pytest.mark.parametrize('breaks, failing', [(False, []), (True, ['position_sign'])])
def test_metal_may_yield_but_what_breaks_must_be_cut(breaks: bool, failing: list[str]) -> None:
    s = stroke(1e-4, back=not breaks)
    deepest = np.maximum.accumulate(s.position)
    elastic = s.position - np.maximum(deepest - (1e-3 if breaks else 1e-4), 0.0)
    force = -4e5 * np.maximum(elastic, 0.0) * ~(breaks & (deepest > 0.003))
    found = failed(s._replace(force=force), nominal(environment__stiffness=1e5))
    assert [one.name for one in found if one.fatal] == failing
    assert all('where the specimen breaks' in one.text for one in found if one.fatal)


SPECIMEN = nominal(environment__stiffness=5000.0, environment__damping=0.0,
                   environment__unilateral=False)


def test_a_force_that_no_unit_explains_is_another_signal() -> None:
    (found,) = failed(stroke(1e-3, back=True)._replace(
        force=5e-9 * stroke(1e-3, back=True).force), SPECIMEN)
    assert found.name == 'force_unit' and 'belong together' in found.text


@pytest.mark.parametrize('friction', [0.0, 2.0], ids=['alone', 'with friction'])
def test_a_force_between_two_units_has_the_nearer_one(friction: float) -> None:
    world = recorded(**physics('coulomb_friction', friction)) if friction else recorded()
    found = check(Recording('', forced(0.36)(world)), nominal())[0]
    assert [one.name for one in found if one.fatal] == ['force_unit']
