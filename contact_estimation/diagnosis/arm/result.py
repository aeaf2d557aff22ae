# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The result of a diagnosis of a whole arm."""

from dataclasses import dataclass, field
from typing import Any

from .arm_recording import Array
from .channels import Channels, Term
from .gram import Fitted
from ..checks.check import Check
from ..fit.beam import Compared
from ..result import Diagnosis, Value

VERDICTS = ('consistent', 'recalibrate', 'physics_missing', 'unexplained')
"""From the best to the worst."""


@dataclass(frozen=True)
class ArmEffect:
    """Physics that the description of an arm lacks."""

    # name, family, equation: as in JOINT_EFFECTS
    name: str
    family: str
    equation: str
    term: Term  # law and place
    # where it acts: one, two for what couples them; all that show it for a link or the arm
    joints: tuple[str, ...]
    link: str  # that it belongs to; '' for none
    recording: str  # the only one that shows it; '' for all
    probability: float  # that there is a law of this kind at this place
    parameters: dict[str, Value]  # fitted
    # share, share_interval: part of the misfit of the joint that shows it most, which it takes
    # away on blocks that were not fitted; 95 % interval
    share: float
    share_interval: tuple[float, float]
    # mean square of its own torque over the variance of the joint's torque, by joint
    torque_shares: dict[str, float]
    gain: float  # score lost without it [nat]
    indistinguishable_from: list[str]  # names with their places
    intervals_s: list[tuple[float, float]]  # where its torque is largest [s]
    region: str  # of the motion
    note: str = ''  # what else is to be said; '' if nothing

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
    """One joint."""

    # name, verdict: as of `ArmDiagnosis`
    name: str
    verdict: str
    torque_range: float  # 99 % of its torque [N m]
    # nominal, recalibrated, corrected: error of its torque on blocks left out, root mean square
    # [N m]
    nominal: float
    recalibrated: float
    corrected: float
    noise: float  # white noise of its torque within the band of the motion [N m]
    # share, share_nominal: of the variance of its torque that the corrected and the nominal
    # model predict
    share: float
    share_nominal: float
    # coulomb friction [N m] and viscous friction [N m s/rad] that come nearest to all laws of
    # friction that are named at it, along the recorded motion: what simulators take
    friction: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class HeldOutArm:
    """A recording that was not fitted."""

    name: str  # of the file
    # nominal, corrected: share of each joint's torque that is predicted while it moves
    nominal: dict[str, float]
    corrected: dict[str, float]
    # the same of all samples: at rest friction holds whatever it is loaded with, and no law of
    # the motion tells how much that is
    with_rests: dict[str, float]


@dataclass(frozen=True, eq=False)
class ArmDiagnosis:
    """The result of `diagnose_arm`."""

    verdict: str  # the worst of all joints, see `VERDICTS`
    effects: list[ArmEffect]  # what lacks; friction, which every joint has, last
    joints: list[JointResult]  # those with torques
    left_out: dict[str, str]  # joints without, and why
    checks: list[Check]  # for wrong use
    holdouts: list[HeldOutArm] = field(default_factory=list)  # recordings that were not fitted
    next_experiment: str = ''  # recommendation; '' if none
    channels: Channels | None = None  # what was fitted; None if refused
    # of the corrected model, with laws too small for a name
    model: frozenset[Term] = frozenset()
    fitted: Fitted | None = None  # its fit
    compared: Compared | None = None  # all models
    # of what the tip touches, without a robot; None if no nominal contact was given
    contact: Diagnosis | None = None
    # of the tip along the direction in which it presses: mean, least and most [kg]
    apparent_mass: tuple[float, float, float] | None = None

    @property
    def refused(self) -> bool:
        """Whether something must be put right before anything can be diagnosed."""
        return any(one.fatal for one in self.checks)

    def predicted(self, piece: Any, j: int) -> Array:
        """Return what the corrected model adds to RNEA in joint j along a piece, shape (M,)."""
        assert self.channels is not None and self.fitted is not None
        return self.channels.predicted(piece, j, self.fitted)
