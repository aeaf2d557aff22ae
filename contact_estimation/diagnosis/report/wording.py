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


"""The sentences that the text and the page share."""

from __future__ import annotations

from math import isfinite, sqrt
from typing import Sequence


from ..conclude.dependence import Dependence
from ..conclude.location import Location
from ..conclude.result import Diagnosis, NamedEffect
from ..fit.applicable import is_single_stroke, least_worth_a_name
from ..fit.discrepancy import least_material
from ...physics import EFFECTS

PORTS = {'contact': 'in the contact', 'force_sensor': 'in the force sensor',
         'robot': 'in the robot'}
_PHASES = {
    'free': 'in free flight', 'entry': 'just after touch-down', 'hold': 'during the hold',
    'loading': 'while loading', 'unloading': 'while unloading',
    'all': 'in all phases of contact',
}
_TWICE = 2.0  # the variance of the noise
_MOST_INTERVALS = 4
_LEAST_PERCENT = 0.1
_MOST_QUANTITIES = 4


def headline(diagnosis: Diagnosis) -> str:
    """
    Return the verdict as one plain sentence.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    headline : str
        Without a full stop.

    """
    d = diagnosis
    if d.verdict == 'consistent':
        return 'The simulation explains the recording' + (
            '' if trifle(d) else ' to within the sensor noise')
    if d.verdict == 'recalibrate':
        return f'The simulation has the right physics with wrong values: {_recalibrated(d)}'
    if d.refused:
        wrong = ' and '.join(check.name.replace('_', ' ') for check in d.checks if check.fatal)
        return f'The recording must be put right first: {wrong}'
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
    """
    Return how much of the misfit an effect predicts on parts that were not fitted.

    Parameters
    ----------
    effect : NamedEffect
        Of the diagnosis.

    Returns
    -------
    sentence : str
        Without a full stop, such as 'predicts 81 % (74 to 86 %) of the misfit on parts left out';
        a single part has no interval.

    """
    share = _percent(effect.share, effect.share_interval)
    sentence = f'predicts {share} of the misfit on parts left out'
    if effect.beside_zeros is not None:
        rest = _percent(effect.beside_zeros.share, effect.beside_zeros.interval)
        sentence += f', {rest} of what the zeros leave'
    if effect.mark is not None:
        if not effect.share_interval[0] > 0.0:
            sentence = 'predicts nothing certain of the misfit on parts left out'
        return f'{sentence}, but {effect.mark.words}: something else is larger'
    if effect.share_in_form is None:
        return sentence
    return (f'{sentence}, but explains {100.0 * effect.share_in_form:.0f} % with a size of its '
            'own in each part: the size depends on something else, such as speed, depth or time')


def _percent(share: float, interval: tuple[float, float]) -> str:
    """Return a share and its interval, such as '81 % (74 to 86 %)'."""
    share, low, high = (100.0 * value for value in (share, *interval))
    digits = 0 if share >= 10.0 else 1
    text = f'{share:.{digits}f} %' if abs(share) >= _LEAST_PERCENT else f'below {_LEAST_PERCENT} %'
    if abs(share) < _LEAST_PERCENT or not (isfinite(low) and isfinite(high)):
        return text
    return f'{text} ({low:.{digits}f} to {high:.{digits}f} %)'


def remainder(diagnosis: Diagnosis) -> str:
    """
    Return what the named effects leave, and where, in one sentence.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    sentence : str
        Without a full stop; '' without named effects.

    """
    left = diagnosis.remainder
    if not diagnosis.effects:
        return ''
    left_by = 'The named effect leaves' if len(diagnosis.effects) == 1 else (
        'The named effects together leave')
    if left is None:
        return f'{left_by} less than 1 % of the misfit above the noise'
    return (f'{left_by} {100.0 * left.share:.0f} % of the misfit: {PORTS[left.location.port]}, '
            f'{place_of(left.location)}')


def trifle(diagnosis: Diagnosis) -> str:
    """
    Say how little a model leaves that lacks nothing, if that is more than noise.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    sentence : str
        Without a full stop; '' where a name is missing, or nothing.

    """
    d = diagnosis
    errors = {'consistent': d.force.nominal, 'recalibrate': d.force.recalibrated}
    error = errors.get(d.verdict)
    if error is None or error**2 < _TWICE * d.noise_floor**2:
        return ''
    left = sqrt(error**2 - d.noise_floor**2)
    shown = max(d.recordings, key=lambda one: one.observed.force_range)
    percent = 100.0 * left / shown.observed.force_range
    least = least_material(shown) * least_worth_a_name(d.recordings)
    stroke = ' in a single stroke' if is_single_stroke(d.recordings) else ''
    reason = (f'too little for a name{stroke}' if left < least
              else 'the position does not resolve it')
    return (f'Beside the noise it leaves {left:.2g} N (rms, held out), {percent:.2g} % of the '
            f'range of the force: {reason}')


def held_out_result(diagnosis: Diagnosis) -> str:
    """
    Return the effect of the correction on held-out data in one sentence.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    sentence : str
        Errors before and after the correction; '' if there are none to compare.

    """
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


def place_of(location: Location) -> str:
    """
    Describe where a mismatch sits, without its port.

    Parameters
    ----------
    location : Location
        Phase, times, region and frequencies.

    Returns
    -------
    text : str
        Such as 'while loading (1.0-2.3 s), strongest at large d, 0.5 to 6.9 Hz'.

    """
    times = ', '.join(f'{a:.1f}-{b:.1f} s' for a, b in location.intervals_s[:_MOST_INTERVALS])
    times += ', ...' if len(location.intervals_s) > _MOST_INTERVALS else ''
    times = f' ({times})' if times else ''
    strongest = 'strongest at ' if location.region.startswith(('small', 'large')) else ''
    low, high = location.band_hz
    return (f'{_PHASES.get(location.phase, location.phase)}{times}, '
            f'{strongest}{location.region}, {low:.3g} to {high:.3g} Hz')


def tested_dependences(diagnosis: Diagnosis) -> dict[str, list[Dependence]]:
    """
    Return the dependences of the channel that shows the mismatch.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    tested : dict of str to list of Dependence
        By model, before and after; empty if the recording is too short to test.

    """
    tested = {name: [one for one in found if one.channel == diagnosis.located_channel]
              for name, found in diagnosis.dependences.items()}
    return tested if all(tested.values()) else {}


def significant(tested: Sequence[Dependence]) -> str:
    """
    List the quantities on which residuals depend significantly.

    Parameters
    ----------
    tested : sequence of Dependence
        Of one model and channel.

    Returns
    -------
    text : str
        Such as 'depth 90 %, time 65 %': shares of the residuals' mean square.

    """
    found = sorted((one for one in tested if one.is_real), key=lambda one: -one.share)
    listed = [f'{quantity(one)} {100.0 * one.share:.0f} %' for one in found[:_MOST_QUANTITIES]]
    return ', '.join(listed) or 'no significant dependence'


def quantity(one: Dependence) -> str:
    """
    Return the name of the quantity that a dependence is on.

    Parameters
    ----------
    one : Dependence
        Any.

    Returns
    -------
    name : str
        'autocorrelation' for the residuals' own past.

    """
    return 'autocorrelation' if one.on == 'its own past' else one.on


def improvement(diagnosis: Diagnosis) -> str:
    """
    Return the interval of the relative improvement as a sentence.

    Parameters
    ----------
    diagnosis : Diagnosis
        The result.

    Returns
    -------
    sentence : str
        Without a full stop; '' without named effects.

    """
    if diagnosis.improvement is None or not diagnosis.effects:
        return ''
    low, high = (100.0 * value for value in diagnosis.improvement)
    return (f'the corrected force error is {low:.0f} to {high:.0f} % below the recalibrated one '
            '(95 % interval)')


def meaning(name: str) -> str:
    """
    Return what an effect is, in one line.

    Parameters
    ----------
    name : str
        Key of EFFECTS.

    Returns
    -------
    meaning : str
        Its description.

    """
    return EFFECTS[name].description
