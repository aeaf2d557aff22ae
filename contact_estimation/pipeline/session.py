# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""On-line estimation without ROS: synchronised samples, estimates and reference."""

from collections import Counter
from math import nan
from typing import Any, Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .agenda import Agenda
from .arm_kinematics import described_in_file, kinematics_of, NO_DESCRIPTION, NO_TRANSFORMS
from .axes import AxesEstimation, Moment, Result
from .axis_pipeline import EstimationPipeline
from .parameters import EstimationParameters
from .reference_stream import ReferenceStream
from ..estimators.estimate import AxesEstimates, new_tuple
from ..kinematics.contact_kinematics import ArmSample, ArmState, ContactKinematics
from ..parameters import changed
from ..reference.setpoints import Desired, Reference
from ..signals.contact_sample import AxesSample, ContactSample
from ..signals.stamp_screen import BEFORE_ANY
from ..signals.synchronisation import Columns, Synchroniser

_FEW = 4  # samples that are not worth arrays
_OF_LOADS = 10  # wrenches of an arm, of which one is a part of the mean load


class ContactSession:
    """
    One synchroniser, the estimation of all axes, and the reference generator.

    All axes share their stamps: forces come in one wrench, positions in one joint state. Each is
    estimated by eq. (3) independently of the others. Live and recorded data pass the same code.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.
    generate_reference : bool
        False where the reference is given by `add_reference` instead (replay).

    Attributes
    ----------
    pipelines : dict of str to EstimationPipeline
        By axis, the contact axis first.
    pipeline : EstimationPipeline
        Of the contact axis.
    stream : ReferenceStream
        Of the references generated.
    matrix : MatrixEstimation
        Of three coupled axes.
    arm : ContactKinematics or None
        Of the arm, where one is configured and described; see `describe`.
    description, problem : str
        Text of the URDF of the arm, or why there is none.
    last_stamp_ns, last_position, last_force : int, float, float
        Stamp [ns], position [m] and force [N] along the contact axis of the last sample processed.
    estimates : tuple of Estimate
        After that sample, of each axis; empty before the first.

    """

    def __init__(
        self, parameters: EstimationParameters, generate_reference: bool = True
    ) -> None:
        self.parameters = parameters
        self._axes = AxesEstimation(parameters)
        self.pipelines, self.checks = self._axes.pipelines, self._axes.checks
        self.pipeline, *self._further = self.pipelines.values()
        self.matrix = self._axes.matrix
        self.rejection_texts: dict[str, str] = {}  # by reason, of the last rejection
        self.notices: dict[str, str] = {}  # by name, warnings that stay until taken out
        self.last_stamp_ns, self.last_position, self.last_force = BEFORE_ANY, nan, nan
        self.estimates: AxesEstimates = ()
        self.description = self.problem = ''
        self.arm: ContactKinematics | None = None
        self._synchroniser = Synchroniser(
            parameters.synchronisation,
            # The sample of an arm becomes a ContactSample when its turn comes.
            (lambda *measured: (ArmSample(*measured),)) if parameters.kinematics.tip else None)
        if parameters.pose_source == 'tf':
            self.problem = NO_TRANSFORMS
        elif parameters.kinematics.tip:
            self.problem = NO_DESCRIPTION
            self.describe(described_in_file(parameters))
        self._generates = generate_reference
        self.stream = ReferenceStream(parameters, self._synchroniser.rejected)
        self._agenda = Agenda()
        self._follows_reference = self.pipeline.follows_reference

    def describe(self, description: str) -> None:
        """
        Set the URDF of the arm, without which none of its samples can be used; '' for none yet.

        If it does not fit the parameters, an error is raised and the arm stays as it was.
        """
        if description:
            self.use_arm(kinematics_of(self.parameters, description))
            self.description = description

    def use_arm(self, arm: ContactKinematics) -> None:
        """Set the arm, which was not known or has other frames now."""
        self.arm, self.problem = arm, ''

    @property
    def rejected(self) -> Counter[str]:
        """Return the number of messages and samples rejected, by reason."""
        return self._synchroniser.rejected

    @property
    def waits(self) -> bool:
        """Whether a wrench waits for its joint state."""
        return self._synchroniser.waits

    @property
    def time_jumps(self) -> int:
        """Return the number of backward clock jumps."""
        return self._synchroniser.time_jumps

    @property
    def motion_lag_s(self) -> float:
        """How far the newest motion is behind the newest wrench [s]; NaN before both."""
        return self._synchroniser.motion_lag_s

    @property
    def moment(self) -> Moment:
        """Return the last sample processed."""
        return Moment(self._agenda.jumps, self.last_stamp_ns)

    def add_wrench(self, stamp_ns: int, *forces: float) -> list[Result]:
        """
        Add a wrench.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        *forces : float
            F_e along each axis of `pipelines` [N]; of an arm, force [N] and torque [N m].

        Returns
        -------
        results : list of Result
            One for each sample completed by this wrench.

        """
        samples = self._synchroniser.add_wrench(stamp_ns, forces)
        return self._process(samples) if samples else []

    def add_motion(self, stamp_ns: int, *motion: float) -> list[Result]:
        """
        Add a joint state.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        *motion : float
            x of each axis of `pipelines` [m], then its rate of each axis [m/s], NaN where not
            measured; of an arm, q of each joint, then its rate.

        Returns
        -------
        results : list of Result
            One for each sample completed by this joint state.

        """
        self.checks.joint_stamps.append((stamp_ns,))
        samples = self._synchroniser.add_motion(stamp_ns, motion)
        return self._process(samples) if samples else []

    def add_pairs(
        self, stamps_ns: NDArray[np.int64], forces: Columns, positions: Columns,
        velocities: Columns,
    ) -> list[AxesEstimates] | None:
        """
        Add wrenches and joint states that have the same stamps, many at once.

        Returns the estimates of each sample, or None where stamps or values are irregular, or a
        reference is generated: the messages must be added one by one then.
        """
        if self._generates or self._synchroniser.jumped:
            return None
        if not self._synchroniser.add_pairs(stamps_ns, forces, positions, velocities):
            return None
        self.checks.joint_stamps.extend(stamps_ns)
        estimates: list[AxesEstimates] = []
        columns = list(zip(positions, velocities, forces))
        begin, count, agenda = 0, len(stamps_ns), self._agenda
        while begin < count:
            if agenda.references or agenda.actions:
                agenda.apply(int(stamps_ns[begin]))
            end = min(count, begin + self.checks.room, agenda.next_due(stamps_ns))
            if end - begin < _FEW or self._follows_reference or self.matrix.runs:
                end = begin + 1
                one = stamps_ns[begin].item()
                estimates.append(self._estimate(tuple(
                    ContactSample(one, *(column[begin].item() for column in own))
                    for own in columns)))
            else:
                part = slice(begin, end)
                estimates += self._estimate_many(
                    stamps_ns[part], [[column[part] for column in own] for own in columns])
            begin = end
        return estimates

    def _estimate_many(
        self, stamps_ns: NDArray[np.int64], columns: Sequence[Columns]
    ) -> list[AxesEstimates]:
        """Estimate from samples during which nothing is due, of each axis for itself."""
        found = [pipeline.take_many(stamps_ns, *own)
                 for pipeline, own in zip(self.pipelines.values(), columns)]
        estimates: list[AxesEstimates] = list(zip(*found))
        self.last_stamp_ns = stamps_ns[-1].item()
        self.last_position, _, self.last_force = (column[-1].item() for column in columns[0])
        self.estimates = estimates[-1]
        self.checks.add_many(stamps_ns, columns, found)
        return estimates

    def count_rejected(self, reason: str, text: str = '') -> None:
        """Count a message that could not be used, for a reason, with a text that explains it."""
        self._synchroniser.rejected[reason] += 1
        self.rejection_texts[reason] = text

    def _process(self, samples: Sequence[AxesSample]) -> list[Result]:
        results: list[Result] = []
        agenda = self._agenda
        if self._synchroniser.jumped:
            self._restart_time()
        if self._generates:
            self.stream.arrive(self._synchroniser.newest_ns)
        for paired in samples:
            if agenda.references or agenda.actions:
                agenda.apply(paired[0][0])
            axes, state = paired, None
            if self.arm is not None:
                axes, state = self._along_normal(self.arm, paired)
            estimates = self._estimate(axes)
            sample, reference = axes[0], None
            follow_ns = sample[0] + self.stream.period_ns
            if self._generates:
                reference = self.stream.step(sample, estimates[0])
                if self._follows_reference:
                    agenda.references.append(((agenda.jumps, follow_ns), reference))
            results.append(new_tuple(Result, (sample, estimates, follow_ns, reference, state)))
        return results

    def _along_normal(
        self, arm: ContactKinematics, paired: Any
    ) -> tuple[AxesSample, ArmState | None]:
        """Return the sample of the contact axis; one of an arm only when its turn has come."""
        arm.held = self.pipeline.contact  # as of the sample before
        sample = arm.contact(paired[0])
        self.checks.wrenches.append(
            (sample[0], *arm.components('xyz'.index(self.parameters.axis))))
        if not len(self.checks.wrenches) % _OF_LOADS:
            self.checks.loads.append((sample[0], *arm.loads(paired[0].wrench)))
        return (sample,), arm.state

    def _estimate(self, axes: AxesSample) -> AxesEstimates:
        """Estimate from the next sample, for which all that is due has been applied."""
        sample = axes[0]
        self.last_stamp_ns, self.last_position, _, self.last_force = sample
        estimates: AxesEstimates = (self.pipeline.take(sample, self._agenda.followed),)
        if len(axes) > 1:  # further axes have no reference
            estimates += tuple(map(EstimationPipeline.take, self._further, axes[1:]))
        self.estimates = estimates
        self.checks.add(axes, estimates)
        if self.matrix.runs:
            self.matrix.process(axes, estimates)
        return estimates

    def _restart_time(self) -> None:
        self._synchroniser.jumped = False
        self._axes.restart_time()
        self._agenda.change_clock()
        self.stream.change_clock()
        self.last_stamp_ns = BEFORE_ANY

    def add_desired(self, stamp_ns: int, desired: Desired) -> None:
        """Add a setpoint of the planner, effective from its stamp; see `ReferenceStream.add`."""
        self.stream.add(stamp_ns, desired)

    def add_reference(self, stamp_ns: int, reference: Reference, jumps: int = 0) -> None:
        """
        Add a reference that takes effect at a stamp; in stamp order, possibly ahead of samples.

        Parameters
        ----------
        stamp_ns : int
            Instant from which the robot follows it [ns].
        reference : Reference
            x_r with derivatives.
        jumps : int
            Number of backward clock jumps before it.

        """
        self._agenda.references.append(((jumps, stamp_ns), reference))

    def schedule(self, after: Moment, action: Callable[[], object]) -> None:
        """Schedule a call after one sample and before the next, in the order of the samples."""
        self._agenda.actions.append((after, action))

    def change_parameters(self, changes: Mapping[str, Any]) -> None:
        """
        Change parameters by dotted name while running; K_hat, B_hat stay, x_r stays continuous.

        If a value is not valid, an error is raised and nothing has changed.
        """
        parameters = changed(self.parameters, changes)
        self._axes.configure(parameters)
        self.stream.configure(parameters)
        self._synchroniser.configure(parameters.synchronisation)
        if self.arm is not None:
            self.arm.configure(parameters.tool)
        self._follows_reference = self.pipeline.follows_reference
        self.parameters = parameters

    def reset(self) -> None:
        """Reset K_hat and B_hat to their initial values on every axis."""
        self._axes.reset()
        self.stream.reset()

    def set_bias(self, bias: Mapping[str, float]) -> None:
        """Set the force by axis that is subtracted from the measured F_e [N], see `tare`."""
        for axis, value in bias.items():
            self.pipelines[axis].set_bias(value)

    def tare(self) -> tuple[bool, str]:
        """Set the force bias of all axes, or of none; see `AxesEstimation.tare`."""
        return self._axes.tare()
