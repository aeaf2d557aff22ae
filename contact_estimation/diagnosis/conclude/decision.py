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

"""The decision: which effects are named, and whether something remains unexplained."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .apparent_mass import is_resonance
from .held_out_power import confirmed, held_out_powers, largest, MOST_POWER
from .shares import Shares, shares_of
from .trifles import is_trifle, without_unconfirmed_trifles
from ..fit.applicable import least_worth_a_name
from ..fit.criteria import (
    enough,
    EXPLAINED,
    leaves_noise,
    noise_scale,
    SURELY_MOST,
    THRESHOLD,
)
from ..fit.discrepancy import has_discrepancy, material, without_discrepancy
from ..fit.first_step import fit_without
from ..fit.fitting import Fit, fit
from ..fit.flexible import autocorrelation, predictable_share
from ..fit.model_uncertainty import discounted
from ..fit.order import ZEROS
from ..fit.pairs import is_pair
from ..fit.pull_offs import is_pulled_off
from ..fit.same_effects import fitted_again
from ..fit.search import may_show, Progress
from ..fit.selection import select, Selection, weigh
from ..fit.uncertainty import standard_deviations
from ..observe.model import Model, names_of
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]

_TRIFLE, _UNSURE = 0.01, 0.1  # shares not worth a name: of an effect beyond doubt, of another
_PREDICTABLE = 0.1  # share of the residual that a smoother predicts: structure, not noise
_SIGNIFICANT = 3.0  # standard deviations
_BY_PAIR = 0.85  # share that a pair must predict: two laws follow much of what neither is
_DOWN_TO_NOISE = 0.95  # share of the misfit of a part
_AUTOCORRELATION = 0.25  # of neighbouring residuals: structure that no smoother predicts


class Decision(NamedTuple):
    """
    The named effects, and whether something remains unexplained.

    Attributes
    ----------
    selection : Selection
        From which it was made: without effects that were doubtful, what they hid is a discrepancy.
    best : Fit
        The model with the effects that are named; the recalibrated one if none is.
    unexplained : bool
        Whether something is missing beside them.
    predictable : float
        Share of the residuals that a flexible smoother predicts in blocks it was not fitted on.
    shares : Shares or None
        What the names predict on parts left out; None without names.

    """

    selection: Selection
    best: Fit
    unexplained: bool
    predictable: float
    shares: Shares | None


def decide(
    selection: Selection, whole: Recordings, progress: Progress, again: bool = True,
) -> Decision:
    """
    Decide which effects are named and whether something remains unexplained.

    Parameters
    ----------
    selection : Selection
        Of the effects.
    whole : sequence of PreparedRecording
        Its recordings with their held-out parts.
    progress : callable
        Called with a description of each stage.
    again : bool
        Whether to select once more without a law whose size differs between the parts, or is
        none that is possible, if no other is left: a curve that fits best may stand before a law
        that fits nearly as well.

    Returns
    -------
    decision : Decision
        Names and whether they suffice.

    """
    recordings, base, best = selection.recordings, selection.base, selection.best
    if best.model.effects:
        if not has_discrepancy(recordings):
            best = _significant(recordings, confirmed(base, best, recordings, whole))
        rest = without_unconfirmed_trifles(recordings, base, best)
        if rest is not None:
            return decide(_carrying(selection, rest), whole, progress, False)
    if best.model.effects:
        progress('shares')
        in_form = selection.in_form if selection.in_form in best.model.effects else ''
        together = [name for name in best.model.effects if name in selection.pair]
        shares = shares_of(recordings, base.model, best.model, in_form,
                           together if len(together) > 1 else ())
        exact = not has_discrepancy(recordings)
        # What cannot be goes first: others may be doubtful beside it alone.
        doubtful = [name for name in best.model.effects if name != in_form and not (
            best.model.is_plausible(name) and may_show(recordings, best.model, name))]
        if in_form and shares.in_form[in_form].share < EXPLAINED:
            doubtful.append(in_form)
        # A level force down to the noise tells a sensor that clips in a single part, too.
        clipped = [name for name in best.model.effects if exact and EFFECTS[name].clips_force]
        pulled = [name for name in best.model.effects
                  if is_pulled_off(recordings, base.model, name)]
        told = (in_form, selection.marked, *clipped, *pulled)
        doubtful = doubtful or [name for name in best.model.effects if name not in told and (
            not shares.agrees(name)
            or _is_resonance(recordings, best.model, name)
            or shares.most(name) < (_TRIFLE if shares.sure(name) > 0.0 else _UNSURE)
            or not _is_sure(shares, name, exact)
            or exact and is_trifle(recordings, shares, name))]  # last: it fits again
        fewer = _without_doubtful(selection, best, shares, doubtful, whole, progress, again)
        if fewer is not None:
            return fewer
        if len(together) > 1 and shares.explained < _BY_PAIR:
            return decide_on_rest(selection, best.model, together, whole, progress)
        return Decision(selection, best, shares.explained < EXPLAINED, 0.0, shares)
    progress('structure of the residuals')
    recordings = _plain(recordings, base.model)
    carried, _ = weigh(recordings, fit(recordings, best.model))
    if not material(carried, base.model, least_worth_a_name(recordings)):
        usual = max(1.0, best.cost / best.residual_count)
        powers = held_out_powers(whole, best.model, trifles=False)
        late = largest(powers) > MOST_POWER * usual
        return Decision(selection, best, late, 0.0, None)
    unexplained, predictable = _structured(recordings, best)
    late = largest(held_out_powers(whole, best.model)) > MOST_POWER
    return Decision(selection, best, unexplained or late, predictable, None)


def _without_doubtful(
    selection: Selection, best: Fit, shares: Shares, doubtful: Sequence[str], whole: Recordings,
    progress: Progress, again: bool,
) -> Decision | None:
    """
    Decide without what is doubtful; None if nothing is, or laws are not sure without it.

    An elastic law and a loss of which neither is sure without the other are judged together.
    """
    if not doubtful:
        return None
    zeros = [name for name in doubtful if name in ZEROS]
    dropped = _dropped(shares, (zeros or doubtful)[-1])
    fewer = decide_on_rest(selection, best.model, dropped, whole, progress)
    laws, left = _laws(best.model), _laws(fewer.best.model)
    if len(zeros) == len(doubtful) and not laws <= left:
        return None
    if not left and not selection.pair and is_pair(best.model.effects):
        pair = tuple(name for name in best.model.effects if name in laws)
        both = decide(selection._replace(best=best, pair=pair), whole, progress, False)
        if laws <= _laws(both.best.model) and not both.unexplained:
            return both
    differing = {name for name in laws
                 if not best.model.is_plausible(name) or not shares.agrees(name)}
    if left or not differing or not again:
        return fewer
    other = decide_without(selection, differing, whole, progress)
    return other if _laws(other.best.model) else fewer


def _dropped(shares: Shares, name: str) -> tuple[str, ...]:
    """Return a doubtful effect, or the zeros if they are what makes a law doubtful."""
    zeros = tuple(other for other in shares.best.model.effects if other in ZEROS)
    if name in zeros or not zeros or shares.error_without(zeros) > shares.error_without((name,)):
        return (name,)
    return zeros


def _laws(model: Model) -> set[str]:
    return set(model.effects) - set(ZEROS)


def decide_without(
    selection: Selection, names: set[str], whole: Recordings, progress: Progress
) -> Decision:
    """
    Select and decide again, without some effects.

    Parameters
    ----------
    selection : Selection
        With them.
    names : set of str
        The effects.
    whole : sequence of PreparedRecording
        Its recordings with their held-out parts.
    progress : callable
        Called with a description of each stage.

    Returns
    -------
    decision : Decision
        Of the other effects.

    """
    base = selection.base.model
    recordings = _plain(selection.recordings, base)
    model = replace(base, excluded=base.excluded | names)
    others = select(recordings, fit(recordings, model), progress, by_likelihood=False)
    return decide(others, whole, progress, False)


def decide_on_rest(
    selection: Selection, model: Model, names: Sequence[str], whole: Recordings,
    progress: Progress,
) -> Decision:
    """
    Decide on the other effects of a model; what some carried becomes a discrepancy.

    Parameters
    ----------
    selection : Selection
        From which the model was decided.
    model : Model
        With effects.
    names : sequence of str
        Those that are left out.
    whole : sequence of PreparedRecording
        Its recordings with their held-out parts.
    progress : callable
        Called with a description of each stage.

    Returns
    -------
    decision : Decision
        Without them.

    """
    rest = fit_without(selection.recordings, model, names)
    return decide(_carrying(selection, rest), whole, progress, False)


def _plain(recordings: Recordings, base: Model) -> Recordings:
    """Return recordings without the discrepancy, if they have one."""
    if not has_discrepancy(recordings):
        return recordings
    return [discounted(without_discrepancy(one), base) for one in recordings]


def _carrying(selection: Selection, rest: Fit) -> Selection:
    """Take a model with fewer effects; what it leaves beyond noise becomes a discrepancy."""
    fewer = selection._replace(best=rest)
    if not rest.model.effects or has_discrepancy(selection.recordings):
        return fewer
    return fitted_again(selection.recordings, fewer)


def _is_resonance(recordings: Recordings, model: Model, name: str) -> bool:
    """Return whether an effect is a mass that vanishes at low frequencies."""
    if not EFFECTS[name].is_mass or not has_discrepancy(recordings):
        return False
    return is_resonance(recordings, model, name)


def _is_sure(shares: Shares, name: str, exact: bool) -> bool:
    """Return whether an effect surely predicts enough of the parts that were left out."""
    sure = shares.sure(name)
    if not exact:
        return sure > 0.0
    # What happens once, such as a sensor that settles, no other part tells.
    return not shares.is_flexible(name) or sure > SURELY_MOST or (
        sure > 0.0 and float(np.median(shares.of_channel[name].parts)) > _DOWN_TO_NOISE)


def _structured(recordings: Recordings, found: Fit) -> tuple[bool, float]:
    """Return whether residuals are structured beyond noise, and their predictable share."""
    found = fit(recordings, found.model)
    if leaves_noise(found):
        return False, 0.0
    predictable = max(predictable_share(one, found.model) for one in recordings)
    correlation = max(autocorrelation(one, found.model) for one in recordings)
    return predictable > _PREDICTABLE or correlation > _AUTOCORRELATION, predictable


def verdict_of(decision: Decision, base: Fit, nominal_cost: float) -> str:
    """
    Return the verdict.

    Parameters
    ----------
    decision : Decision
        On the names.
    base : Fit
        Recalibrated model.
    nominal_cost : float
        Of the nominal model.

    Returns
    -------
    verdict : str
        'consistent', 'recalibrate', 'physics_missing' or 'unexplained'.

    """
    if decision.unexplained:
        return 'unexplained'
    if decision.best.model.effects:
        return 'physics_missing'
    least = THRESHOLD * base.residual_count * noise_scale(base)
    return 'consistent' if nominal_cost - base.cost < least else 'recalibrate'


def _significant(recordings: Recordings, best: Fit) -> Fit:
    """
    Drop effects of which no parameter differs significantly from that of no effect.

    Unless the fit without them is much worse: then parameters are known only together.
    """
    stds = standard_deviations(recordings, best)
    for name in best.model.effects:
        place, neutral = best.model.place(name), EFFECTS[name].neutral
        away = [abs(value - neutral.get(parameter, 0.0)) > _SIGNIFICANT * std
                for parameter, value, std in zip(
                    names_of(name), best.model.values[place], stds[place])]
        if not any(away):
            rest = fit_without(recordings, best.model, (name,))
            if not enough(rest, best):
                return _significant(recordings, rest)
    return best
