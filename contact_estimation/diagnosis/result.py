# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The result of a diagnosis: plain data for report, figures and model files."""

from dataclasses import dataclass, field
from math import nan
from typing import Sequence

from .checks.check import Check
from .dependence import Dependence
from .fit.beam import Compared
from .fit.evidence import NOISE_IS_KNOWN, Share
from .location import Location
from .observe.model import Model
from .observe.prepared_recording import Recordings
from ..physics.numeric import Array


@dataclass(frozen=True)
class Value:
    """A parameter with its uncertainty."""

    # value, std: estimate, and its standard deviation for residuals correlated in time
    value: float
    std: float
    unit: str  # SI


@dataclass(frozen=True)
class EffectOnPart:
    """An effect on one part of the recordings."""

    name: str  # of the part, such as 'episode 2'
    share: float  # of the part's misfit above the noise, predicted from the other parts
    parameters: dict[str, float]  # fitted on that part alone


@dataclass(frozen=True)
class NamedEffect:
    """
    An effect that the recordings support.

    Attributes
    ----------
    name, family, port, equation : str
        As in the registry.
    probability : float
        That the family is the right one, calibrated on worlds of foreign laws.
    share : float
        Part of the recalibrated model's squared misfit above the noise that the effect takes away
        on folds that neither model was fitted on.
    share_interval : tuple of float
        95 % interval, over the folds.
    parts : list of EffectOnPart
        Fold by fold.
    parameters : dict of str to Value
        Fitted.
    indistinguishable_from : list of str
        Effects that predict held-out data as well.
    location : Location
        Of the misfit without it.
    beside_zeros : Share or None
        Of a law beside named zeros of sensor and surface: its share of what these leave.

    """

    name: str
    family: str
    port: str
    equation: str
    probability: float
    share: float
    share_interval: tuple[float, float]
    parts: list[EffectOnPart]
    parameters: dict[str, Value]
    indistinguishable_from: list[str]
    location: Location
    beside_zeros: Share | None = None


@dataclass(frozen=True)
class Remainder:
    """What all named effects together leave."""

    share: float  # of the recalibrated model's squared misfit above the noise, on folds
    location: Location  # of the misfit of the corrected model
    text: str  # in words


@dataclass(frozen=True)
class Errors:
    """Root-mean-square errors of the three models."""

    # nominal, recalibrated, corrected: none without held-out data
    nominal: float | None
    recalibrated: float | None
    corrected: float | None

    def explained(self, noise: float, least: float) -> float | None:
        """
        Return the share of a misfit that the names explain, given the error of a correct one.

        None where the recalibrated model's error is below `least`, so that no misfit is shown,
        unless the names more than double what there is of it.
        """
        if self.recalibrated is None or self.corrected is None:
            return None
        some = (NOISE_IS_KNOWN * noise) ** 2
        share = 1.0 - (self.corrected**2 - noise**2) / max(
            max(self.recalibrated**2, some) - noise**2, 1e-300)
        shown = self.recalibrated**2 > max(least**2, some)
        return share if shown or share < -1.0 else None


@dataclass(frozen=True)
class HeldOutErrors:
    """Errors on one held-out part."""

    name: str  # such as 'episode 2'
    # force, motion: [N], [m]
    force: Errors
    motion: Errors


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """
    The result of `diagnose`.

    Attributes
    ----------
    verdict : str
        'consistent', 'recalibrate', 'physics_missing' or 'unexplained'.
    effects : list of NamedEffect
        Strongest first.
    location : Location or None
        Of the misfit of the recalibrated model; None if that is noise.
    remainder : Remainder or None
        What the names leave; None where that is noise.
    nominal, recalibrated, corrected : Model
        The three models; the last with the effects.
    stiffness, damping : Value
        Of the corrected model.
    noise_floor : float
        Of the force [N].
    force, motion : Errors
        Pooled over the held-out parts [N], [m].
    improvement : tuple of float or None
        95 % interval of 1 - corrected / recalibrated.
    holdouts : list of HeldOutErrors
        Fold by fold.
    next_experiment : str
        Recommendation; '' if no question is open.
    rivals : dict of str to Model
        Models that the next experiment would distinguish from the corrected one, by effect.
    evidence : dict of str to float
        Share of the misfit that each candidate alone explains, by name.
    residual_power : float
        Mean square of the residuals of the corrected model, in that of the noise.
    dependences : dict of str to list of Dependence
        Of the residuals of the shown recording, for each model of `pair`.
    recordings : list of PreparedRecording
        As fitted; the first has the largest misfit, is located and shown.
    free_runs : dict of str to ndarray
        Positions of the free runs of the shown recording, by model.
    checks : list of Check
        For wrong use; if a fatal one failed, nothing was fitted and there are no recordings.
    holds_reference : bool
        Whether the robot holds its reference between setpoints instead of interpolating it.
    rests_left_out : bool
        Whether the stretches were left out in which a drive is held at rest.
    held_out_chose : bool
        Whether held-out data refuted the likeliest model and chose among all.
    untried : list of tuple of str
        Families of which no law was tried, with the reason.
    nearly : str
        Which law comes near where none explains, or may be missing beside those that are named;
        '' if none does.
    compared : Compared, optional
        All models that were compared, with their errors on folds left out.

    """

    verdict: str
    effects: list[NamedEffect]
    location: Location | None
    remainder: Remainder | None
    nominal: Model
    recalibrated: Model
    corrected: Model
    stiffness: Value
    damping: Value
    noise_floor: float
    force: Errors
    motion: Errors
    improvement: tuple[float, float] | None
    holdouts: list[HeldOutErrors]
    next_experiment: str
    rivals: dict[str, Model]
    evidence: dict[str, float]
    residual_power: float
    dependences: dict[str, list[Dependence]] = field(repr=False)
    recordings: Recordings = field(repr=False)
    free_runs: dict[str, Array] = field(repr=False)
    checks: list[Check] = field(default_factory=list)
    holds_reference: bool = False
    rests_left_out: bool = False
    held_out_chose: bool = False
    untried: list[tuple[str, str]] = field(default_factory=list)
    nearly: str = ''
    compared: Compared | None = field(default=None, repr=False)

    @property
    def refused(self) -> bool:
        """Whether a check refuses the recordings: nothing is diagnosed."""
        return any(check.fatal for check in self.checks)

    @property
    def shown(self) -> str:
        """Name of the recording that is plotted and located in; '' if all were refused."""
        return self.recordings[0].name if self.recordings else ''

    @property
    def pair(self) -> tuple[str, str]:
        """Return the models to compare: before and after the correction."""
        return pair_of(bool(self.effects))

    @property
    def located_channel(self) -> str:
        """Return the channel that shows the mismatch: 'motion' or 'force'."""
        in_robot = self.location is not None and self.location.port == 'robot'
        driven = any(one.driven_by_force(self.nominal) for one in self.recordings[:1])
        return 'motion' if in_robot or driven else 'force'

    @property
    def between_samples(self) -> str | None:
        """Course of the force that drives a wall between samples; None with a robot."""
        for shown in self.recordings[:1]:
            if shown.driven_by_force(self.nominal):
                return shown.observed.between
        return None


def pair_of(with_effects: bool) -> tuple[str, str]:
    """Return which models a diagnosis compares."""
    return ('recalibrated', 'corrected') if with_effects else ('nominal', 'recalibrated')


def refuse(checks: Sequence[Check], nominal: Model) -> Diagnosis:
    """Return a diagnosis without names, fits and recordings."""
    failed = [check.text for check in checks if not check.ok and check.fatal]
    return Diagnosis(
        verdict='unexplained', effects=[], location=None, remainder=None, nominal=nominal,
        recalibrated=nominal, corrected=nominal, stiffness=Value(nominal.stiffness, nan, 'N/m'),
        damping=Value(nominal.damping, nan, 'N s/m'), noise_floor=nan,
        force=Errors(None, None, None), motion=Errors(None, None, None), improvement=None,
        holdouts=[], next_experiment=f'Put this right and repeat: {"; ".join(failed)}.', rivals={},
        evidence={}, residual_power=nan, dependences={}, recordings=[], free_runs={},
        checks=list(checks))
