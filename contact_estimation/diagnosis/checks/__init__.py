# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks for wrong use, made before any physics is named."""

from dataclasses import replace
from typing import Mapping, NamedTuple, Sequence

from . import experiment, sensors, signs_and_axes, stamps
from .check import Check, of_families, Test
from .quantities import Quantities
from ..observe.signals import check_signals, Recording
from ...physics import EFFECTS
from ...plant.plant_parameters import PlantParameters

_RIGHT = ('clock_offset', 'sampling_rate', 'position_sign', 'length_unit', 'force_unit',
          'excitation')
"""Checks without which force, motion and command cannot be compared."""

CHECKS: Mapping[str, Test] = {
    'complete_file': Test(stamps.complete_file),
    'stamp_order': Test(stamps.stamp_order),
    'stamp_bursts': Test(stamps.stamp_bursts),
    'two_sources': Test(sensors.two_sources),
    'spikes': Test(sensors.spikes, put_right=sensors.without_spikes),
    'sampling_rate': Test(
        stamps.sampling_rate, after=('stamp_bursts',), could_cause=of_families(
            'timing', 'inertia', 'damping_law', 'robot', 'limits', 'clearance', 'adhesion')),
    'wrench_axes': Test(signs_and_axes.wrench_axes),
    'clock_offset': Test(stamps.clock_offset, after=('sampling_rate', 'wrench_axes')),
    'common_time': Test(stamps.common_time, after=('clock_offset',)),
    'gaps': Test(stamps.gaps, after=('clock_offset',),
                 could_cause=of_families('relaxation', 'hysteresis')),
    'excitation': Test(experiment.excitation, after=('clock_offset',)),
    'unilateral': Test(experiment.unilateral,
                       after=('excitation', 'clock_offset', 'sampling_rate')),
    'force_sign': Test(signs_and_axes.force_sign, after=('clock_offset',),
                       put_right=signs_and_axes.inverted),
    'position_sign': Test(signs_and_axes.position_sign, after=('clock_offset',)),
    'length_unit': Test(
        signs_and_axes.length_unit, after=('clock_offset', 'force_sign', 'position_sign')),
    'force_unit': Test(
        signs_and_axes.force_unit,
        after=('clock_offset', 'force_sign', 'position_sign', 'length_unit')),
    'command_topic': Test(experiment.command_topic, after=_RIGHT),
    'reference_clock': Test(stamps.reference_clock, after=(*_RIGHT, 'command_topic')),
    'reference_rates': Test(experiment.reference_rates, after=('clock_offset', 'command_topic')),
    'zero_steps': Test(sensors.zero_steps, after=('clock_offset', 'two_sources', 'stamp_bursts')),
    'axis': Test(signs_and_axes.axis, after=(*_RIGHT, 'command_topic')),
    'wall_location': Test(
        experiment.wall_location,
        after=('clock_offset', 'force_sign', 'position_sign', 'length_unit', 'excitation',
               'axis')),
    'force_clipping': Test(
        sensors.force_clipping, after=('clock_offset',), could_cause=of_families(
            'elastic_law', 'hysteresis', 'limits', 'relaxation') - {'force_saturation'}),
    'quantisation': Test(
        sensors.quantisation, after=('clock_offset', 'length_unit'), could_cause=frozenset(
            {'backlash', 'dead_zone', 'free_play', 'moving_environment', 'plastic_set',
             'presliding_friction'})),
    'constant_speed': Test(
        experiment.constant_speed, after=('clock_offset', 'excitation'), alone=True,
        could_cause=of_families('relaxation', 'wall_motion', 'timing', 'damping_law', 'inertia')
        | {'force_drift', 'settling_bias'}),
}
"""In the order of testing: each after those without which it has no meaning."""


class Examined(NamedTuple):
    """Recordings after all checks: one result for each of `CHECKS`, and what is to be fitted."""

    checks: list[Check]
    recordings: list[Recording]

    @property
    def refused(self) -> bool:
        """Whether a check refuses the recordings: nothing is diagnosed."""
        return any(one.fatal for one in self.checks)

    @property
    def excluded(self) -> frozenset[str]:
        """Effects that must not be named: wrong use would look like them."""
        return frozenset().union(*(one.could_cause for one in self.checks))


def examine(
    recordings: Sequence[Recording], model: PlantParameters, fitted: int | None = None
) -> Examined:
    """Check recordings for wrong use; correct what is beyond doubt."""
    several = len(recordings) > 1
    alone = (len(recordings) if fitted is None else fitted) == 1
    found = [check(recording, model, alone) for recording in recordings]
    named = [[replace(one, text=f'{recording.name}: {one.text}') if several and not one.ok else one
              for one in checks] for checks, recording in found]
    checks = [_worst(alike) for alike in zip(*named)]
    return Examined(checks, [recording for _, recording in found])


def check(
    recording: Recording, model: PlantParameters, alone: bool = True
) -> tuple[list[Check], Recording]:
    """Check one recording, fitted `alone` or not; return what is to be fitted, corrected."""
    check_signals(recording.signals)
    quantities = Quantities(recording.signals, model, recording)
    checks: list[Check] = []
    for name, test in CHECKS.items():
        missing = [one for one in checks
                   if one.name in test.after and (one.fatal or not one.tested)]
        if missing:
            checks.append(Check(name, True, f'not tested until {missing[0].name} is fixed',
                                tested=False))
            continue
        if test.alone and not alone:
            checks.append(Check(name, True, 'not tested on several recordings', tested=False))
            continue
        found = test.find(quantities)
        fatal = found.fatal and not found.ok
        causes = frozenset(EFFECTS) if fatal else test.could_cause
        checks.append(Check(name, found.ok, found.text, fatal,
                            frozenset() if found.ok else causes))
        if not found.ok and not fatal and test.put_right is not None:
            recording = replace(recording, signals=test.put_right(recording.signals))
            quantities = Quantities(recording.signals, model, recording)
    return checks, recording


def _worst(alike: Sequence[Check]) -> Check:
    failed = [one for one in alike if not one.ok]
    if len(failed) < 2:
        return (failed or alike)[0]
    return Check(failed[0].name, False, '; '.join(one.text for one in failed),
                 any(one.fatal for one in failed),
                 frozenset().union(*(one.could_cause for one in failed)))
