# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The result of a diagnosis of a whole arm."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .arm_recording import Array
from .channels import Channels, Term
from .checks import ArmCheck
from .gram import Fitted
from ..fit.beam import Compared
from ..result import Diagnosis, Value

VERDICTS = ('consistent', 'recalibrate', 'physics_missing', 'unexplained')
"""From the best to the worst."""


@dataclass(frozen=True)
class ArmEffect:
    """
    Physics that the description of an arm lacks.

    Attributes
    ----------
    name, family, equation : str
        As in JOINT_EFFECTS.
    term : Term
        Law and place.
    joints : tuple of str
        Where it acts: one, two for what couples them; all that show it for a link or the arm.
    link : str
        That it belongs to; '' for none.
    recording : str
        The only one that shows it; '' for all.
    probability : float
        That there is a law of this kind at this place.
    parameters : dict of str to Value
        Fitted.
    share, share_interval : float, tuple of float
        Part of the misfit of the joint that shows it most, which it takes away on blocks that were
        not fitted; 95 % interval.
    torque_shares : dict of str to float
        Mean square of its own torque over the variance of the joint's torque, by joint.
    gain : float
        Score lost without it [nat].
    indistinguishable_from : list of str
        Names with their places.
    intervals_s : list of tuple of float
        Where its torque is largest [s].
    region : str
        Of the motion.
    note : str
        What else is to be said; '' if nothing.

    """

    name: str
    family: str
    equation: str
    term: Term
    joints: tuple[str, ...]
    link: str
    recording: str
    probability: float
    parameters: dict[str, Value]
    share: float
    share_interval: tuple[float, float]
    torque_shares: dict[str, float]
    gain: float
    indistinguishable_from: list[str]
    intervals_s: list[tuple[float, float]]
    region: str
    note: str = ''

    @property
    def place(self) -> str:
        """Return where it is, in words."""
        only = f' in {self.recording}' if self.recording else ''
        if self.link:
            return self.link + only
        if self.term.place is None:
            return 'the whole arm' + only
        return ' and '.join(self.joints) + only


@dataclass(frozen=True)
class JointResult:
    """
    One joint.

    Attributes
    ----------
    name, verdict : str
        As of `ArmDiagnosis`.
    torque_range : float
        99 % of its torque [N m].
    nominal, recalibrated, corrected : float
        Error of its torque on blocks left out, root mean square [N m].
    noise : float
        White noise of its torque within the band of the motion [N m].
    share, share_nominal : float
        Of the variance of its torque that the corrected and the nominal model predict.
    friction : tuple of float
        Coulomb friction [N m] and viscous friction [N m s/rad] that come nearest to all laws of
        friction that are named at it, along the recorded motion: what simulators take.

    """

    name: str
    verdict: str
    torque_range: float
    nominal: float
    recalibrated: float
    corrected: float
    noise: float
    share: float
    share_nominal: float
    friction: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class HeldOutArm:
    """
    A recording that was not fitted.

    Attributes
    ----------
    name : str
        Of the file.
    nominal, corrected : dict of str to float
        Share of each joint's torque that is predicted while it moves.
    with_rests : dict of str to float
        The same of all samples: at rest friction holds whatever it is loaded with, and no law of
        the motion tells how much that is.

    """

    name: str
    nominal: dict[str, float]
    corrected: dict[str, float]
    with_rests: dict[str, float]


@dataclass(frozen=True, eq=False)
class ArmDiagnosis:
    """
    The result of `diagnose_arm`.

    Attributes
    ----------
    verdict : str
        The worst of all joints, see `VERDICTS`.
    effects : list of ArmEffect
        What lacks; friction, which every joint has, last.
    joints : list of JointResult
        Those with torques.
    left_out : dict of str to str
        Joints without, and why.
    checks : list of ArmCheck
        For wrong use.
    holdouts : list of HeldOutArm
        Recordings that were not fitted.
    next_experiment : str
        Recommendation; '' if none.
    channels : Channels or None
        What was fitted; None if refused.
    model : frozenset of Term
        Of the corrected model, with zeros and with laws too small for a name.
    fitted : Fitted or None
        Its fit.
    compared : Compared or None
        All models.
    contact : Diagnosis or None
        Of what the tip touches, without a robot; None if no nominal contact was given.
    apparent_mass : tuple of float or None
        Of the tip along the direction in which it presses: mean, least and most [kg].

    """

    verdict: str
    effects: list[ArmEffect]
    joints: list[JointResult]
    left_out: dict[str, str]
    checks: list[ArmCheck]
    holdouts: list[HeldOutArm] = field(default_factory=list)
    next_experiment: str = ''
    channels: Channels | None = None
    model: frozenset[Term] = frozenset()
    fitted: Fitted | None = None
    compared: Compared | None = None
    contact: Diagnosis | None = None
    apparent_mass: tuple[float, float, float] | None = None

    @property
    def refused(self) -> bool:
        """Whether something must be put right before anything can be diagnosed."""
        return any(one.fatal and not one.ok for one in self.checks)

    def predicted(self, piece: Any, j: int, zeros: bool = True) -> Array:
        """Return what the corrected model adds to RNEA in joint j along a piece, shape (M,)."""
        assert self.channels is not None and self.fitted is not None
        return self.channels.predicted(piece, j, self.fitted, zeros)
