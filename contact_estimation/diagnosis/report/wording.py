# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The sentences that the text and the page share."""

from math import isfinite, sqrt
from typing import Sequence

from ..checks.check import LISTED
from ..dependence import Dependence
from ..fit.constants import CONSTANTS
from ..location import Location
from ..result import Diagnosis, NamedEffect
from ...physics import EFFECTS

PORTS = {'contact': 'in the contact', 'force_sensor': 'in the force sensor',
         'robot': 'in the robot'}
MODELS = 'nominal', 'recalibrated', 'corrected'
_PHASES = {
    'free': 'in free flight', 'entry': 'just after touch-down', 'hold': 'during the hold',
    'loading': 'while loading', 'unloading': 'while unloading',
    'all': 'in all phases of contact',
}
_BETWEEN = {'smooth': 'smooth', 'held': 'held constant'}
_LEAST_PERCENT = 0.1  # smaller shares are written as below it


def headline(diagnosis: Diagnosis) -> str:
    """Return the verdict as one plain sentence, without a full stop."""
    d = diagnosis
    if d.verdict == 'consistent':
        return 'The simulation explains the recording' + (
            '' if negligible(d) else ' to within the sensor noise')
    if d.verdict == 'recalibrate':
        return f'The simulation has the right physics with wrong values: {_recalibrated(d)}'
    if d.refused:
        wrong = ' and '.join(check.name.replace('_', ' ') for check in d.checks if check.fatal)
        return f'Fix the recording first: {wrong}'
    names = ' and '.join(f'{effect.name.replace("_", " ")} {PORTS[effect.port]}'
                         for effect in d.effects)
    if d.verdict == 'physics_missing':
        return f'The simulation lacks {names}'
    unknown = 'physics that no effect of the library explains'
    return f'The simulation lacks {names}; most of the mismatch is {unknown}' if names else (
        f'The simulation lacks {unknown}')


def _recalibrated(diagnosis: Diagnosis) -> str:
    """List the values of the wall that recalibration changes."""
    names = ('K_e', 'N/m'), ('B_e', 'N s/m'), ('M_e', 'kg')
    old, new = diagnosis.nominal, diagnosis.recalibrated
    values = [(f'{before:.5g}', f'{after:.5g}')
              for before, after in zip(old.values, new.values[:old.base_count])]
    changed = any(before != after for before, after in values)
    return ', '.join(f'{name} is {after} {unit} instead of {before} {unit}'
                     for (name, unit), (before, after) in zip(names, values)
                     if before != after or not changed)


def share_of(effect: NamedEffect) -> str:
    """Return 'explains 81 % (74 to 86 %) of the misfit in cross-validation' or the like."""
    share = _percent(effect.share, effect.share_interval)
    sentence = f'explains {share} of the misfit in cross-validation'
    if effect.beside_zeros is not None:
        rest = _percent(effect.beside_zeros.share, effect.beside_zeros.interval)
        sentence += f', {rest} of what the offsets leave'
    return sentence


def _percent(share: float, bounds: tuple[float, float]) -> str:
    """Return a share and its interval, such as '81 % (74 to 86 %)'; a single part has none."""
    share, low, high = (100.0 * value for value in (share, *bounds))
    digits = 0 if share >= 10.0 else 1
    text = f'{share:.{digits}f} %' if abs(share) >= _LEAST_PERCENT else f'below {_LEAST_PERCENT} %'
    interval = f'{low:.{digits}f} to {high:.{digits}f} %'
    known = isfinite(low) and isfinite(high) and abs(share) >= _LEAST_PERCENT
    return f'{text} ({interval})' if known and interval != f'{text[:-2]} to {text}' else text


def remainder(diagnosis: Diagnosis) -> str:
    """Return what the named effects leave, and where, in one sentence; '' without effects."""
    left = diagnosis.remainder
    if not diagnosis.effects:
        return ''
    left_by = 'The named effect leaves' if len(diagnosis.effects) == 1 else (
        'The named effects together leave')
    if left is None:
        return f'{left_by} less than 1 % of the misfit above the noise'
    return (f'{left_by} {100.0 * left.share:.0f} % of the misfit: {PORTS[left.location.port]}, '
            f'{place_of(left.location)}')


def negligible(diagnosis: Diagnosis) -> str:
    """Say how little a model leaves that lacks nothing, if noise is less than half; else ''."""
    d = diagnosis
    errors = {'consistent': d.force.nominal, 'recalibrate': d.force.recalibrated}
    error = errors.get(d.verdict)
    if error is None or error**2 < 2.0 * d.noise_floor**2:
        return ''
    left = sqrt(error**2 - d.noise_floor**2)
    share = left / max(one.observed.force_range for one in d.recordings)
    reason = ('below the reporting threshold' if share < CONSTANTS.instrument
              else 'this recording does not tell which law it obeys')
    return (f'Held-out residual {left:.2g} N rms beyond the noise, {100.0 * share:.2g} % of the '
            f'range of the force: {reason}')


def held_out_result(diagnosis: Diagnosis) -> str:
    """Return the effect of the correction on held-out data; '' if there are no errors."""
    d = diagnosis
    before, after = d.pair
    changed = bool(d.effects) or d.verdict == 'recalibrate'
    parts = []
    for errors, signal, factor, unit in (
        (d.force, 'force', 1.0, 'N'), (d.motion, 'free-run position', 1e6, 'µm'),
    ):
        first, last = getattr(errors, before), getattr(errors, after)
        if first is None or last is None:
            continue
        first_text, last_text = (f'{factor * value:.3g} {unit}' for value in (first, last))
        change = 'falls' if last < first else 'rises'
        parts.append(f'the {signal} error ' + (
            f'{change} from {first_text} to {last_text}' if changed else f'is {first_text}'))
    if not parts:
        return ''
    return (f'On held-out data {" and ".join(parts)} (rms); '
            f'the force noise is {d.noise_floor:.3g} N.')


def improvement(diagnosis: Diagnosis) -> str:
    """Return the interval of the relative improvement in words; '' without named effects."""
    if diagnosis.improvement is None or not diagnosis.effects:
        return ''
    low, high = (100.0 * value for value in diagnosis.improvement)
    little = ('; the force there tells little of the names: test them on a recording in which '
              'they act, with --holdout') if low <= 0.0 else ''
    return (f'the corrected force error is {low:.0f} to {high:.0f} % below the recalibrated one '
            f'(95 % interval){little}')


def place_of(location: Location) -> str:
    """Return 'while loading (1.0-2.3 s), strongest at large d, 0.5 to 6.9 Hz' or the like."""
    times = ', '.join(f'{a:.1f}-{b:.1f} s' for a, b in location.intervals_s[:LISTED])
    times += ', ...' if len(location.intervals_s) > LISTED else ''
    times = f' ({times})' if times else ''
    strongest = 'strongest at ' if location.region.startswith(('small', 'large')) else ''
    low, high = location.band_hz
    return (f'{_PHASES.get(location.phase, location.phase)}{times}, '
            f'{strongest}{location.region}, {low:.3g} to {high:.3g} Hz')


def mismatch(diagnosis: Diagnosis) -> str:
    """Return where the mismatch sits, without a full stop; '' where there is none."""
    d = diagnosis
    if d.location is None:
        return ''
    unexplained = d.verdict == 'unexplained' and not d.effects
    which = 'Unexplained mismatch' if unexplained else 'Mismatch of the recalibrated model'
    return f'{which}: {PORTS[d.location.port]}, {place_of(d.location)}'


def how_it_was_read(diagnosis: Diagnosis) -> list[str]:
    """Return what was assumed of the inputs, and what held-out data decided, in sentences."""
    d, said = diagnosis, []
    if d.held_out_chose:
        said.append('The held-out part refuted the likeliest model, and chose among all.')
    if d.rests_left_out:
        said.append('Where the drive stands still was left out: friction holds any force there.')
    if d.between_samples in _BETWEEN:
        said.append(f'Between its samples the force is {_BETWEEN[d.between_samples]}; straight '
                    'lines explain less.')
    elif d.holds_reference:
        said.append('The robot holds its reference between setpoints; straight lines explain '
                    'its motion less.')
    return said


def tested_dependences(diagnosis: Diagnosis) -> dict[str, list[Dependence]]:
    """Return the dependences of the channel that shows the mismatch by model; {} if untested."""
    tested = {name: [one for one in found if one.channel == diagnosis.located_channel]
              for name, found in diagnosis.dependences.items()}
    return tested if all(tested.values()) else {}


def significant(tested: Sequence[Dependence]) -> str:
    """List what residuals depend on significantly, such as 'depth 90 %, time 65 %'."""
    found = sorted((one for one in tested if one.is_real), key=lambda one: -one.share)
    return ', '.join(f'{quantity(one)} {100.0 * one.share:.0f} %'
                     for one in found[:LISTED]) or 'no significant dependence'


def quantity(one: Dependence) -> str:
    """Return the name of the quantity that a dependence is on."""
    return 'autocorrelation' if one.on == 'its own past' else one.on


def meaning(name: str) -> str:
    """Return what an effect is, in one line."""
    return EFFECTS[name].description
