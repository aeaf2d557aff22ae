# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The pipelines of all axes, the full matrices, and the results for one sample."""

from collections import deque
from typing import Any, NamedTuple

from .axis_pipeline import EstimationPipeline
from .checks.input_checks import InputChecks
from .parameters import EstimationParameters
from ..estimators import MATRIX_ESTIMATORS
from ..estimators.estimate import AxesEstimates, Estimate, EstimateStatus
from ..estimators.stiffness_matrix import (
    LABELS, matrices, MatrixEstimate, PRINCIPAL_LABELS, principal_table)
from ..kinematics.contact_kinematics import ArmState
from ..recordings.encoding import encode_multi_array, encode_string, Vector3StampedEncoder
from ..reference.setpoints import Reference
from ..signals.contact_sample import AxesSample, ContactSample


class Moment(NamedTuple):
    """The stamp of a sample, unique even where the clock has jumped back."""

    jumps: int  # number of backward clock jumps before the sample
    stamp_ns: int  # stamp of the sample [ns]


class Result(NamedTuple):
    """The estimates and the reference that belong to one sample."""

    sample: ContactSample  # of the contact axis
    estimates: AxesEstimates  # one for each estimated axis, the contact axis first
    reference_stamp_ns: int  # instant from which the robot follows the reference [ns]
    reference: Reference | None  # None where the session does not generate it (replay)
    arm: ArmState | None = None  # pose and compensated wrench of an arm

    @property
    def estimate(self) -> Estimate:
        """Estimate of the contact axis."""
        return self.estimates[0]


MULTI_ARRAY = 'std_msgs/msg/Float64MultiArray'
MATRIX_TOPICS = {
    'stiffness_matrix': MULTI_ARRAY,
    'principal_stiffness': MULTI_ARRAY,
    'contact_normal': 'geometry_msgs/msg/Vector3Stamped',
    'matrix_status': 'std_msgs/msg/String',
}
"""Name and type of the topics, below the name of the node."""


def encode_matrices(estimate: MatrixEstimate, vectors: Vector3StampedEncoder) -> dict[str, bytes]:
    """Encode an estimate for the topics of MATRIX_TOPICS."""
    quantities, columns = '/'.join(LABELS), '/'.join(PRINCIPAL_LABELS)
    return {
        'stiffness_matrix': encode_multi_array(
            [(quantities, 4), ('force x/y/z', 3), ('motion x/y/z', 3)],
            matrices(estimate).ravel().tolist()),
        'principal_stiffness': encode_multi_array(
            [('direction', 3), (columns, len(PRINCIPAL_LABELS))],
            principal_table(estimate).ravel().tolist()),
        'contact_normal': vectors.encode(estimate.stamp_ns, *estimate.normal.tolist()),
        'matrix_status': encode_string(status_text(estimate)),
    }


def status_text(estimate: MatrixEstimate) -> str:
    """Return the status of an estimate with its reason."""
    return ': '.join(filter(None, (estimate.status.value, estimate.reason)))


_MOST_WAITING = 1000  # that nobody has taken


class MatrixEstimation:
    """
    Estimate the matrices from the samples of a session, where its parameters say so.

    runs: whether the parameters name a matrix estimator
    """

    def __init__(self, parameters: EstimationParameters) -> None:
        self.last: MatrixEstimate | None = None
        self._contact = False
        self.runs = parameters.matrix_estimator in MATRIX_ESTIMATORS
        self._new: deque[MatrixEstimate] = deque(maxlen=_MOST_WAITING)
        self._estimator: Any = None
        if self.runs:
            self._estimator = MATRIX_ESTIMATORS[parameters.matrix_estimator](
                parameters.stiffness_matrix, parameters.synchronisation.timing_std)
            self._order = [list(parameters.joints).index(axis) for axis in 'xyz']

    def configure(self, parameters: EstimationParameters) -> None:
        """Set new parameters while running."""
        if self._estimator:
            self._estimator.configure(
                parameters.stiffness_matrix, parameters.synchronisation.timing_std)

    def reset(self) -> None:
        """Forget everything."""
        self.last, self._contact = None, False
        self._new.clear()
        if self._estimator:
            self._estimator.reset()

    def process(self, axes: AxesSample, estimates: AxesEstimates) -> None:
        """Process the next sample; the contact axis decides on contact."""
        ordered = tuple(axes[k] for k in self._order)
        self._contact = estimates[0].status is not EstimateStatus.FREE
        found = self._estimator.process([ordered], [self._contact])
        self._new += found
        self.last = found[-1] if found else self.last

    @property
    def status(self) -> str:
        """Return `free`, or the status and reason of the last estimate."""
        if not self._contact:
            return EstimateStatus.FREE.value
        return status_text(self.last) if self.last else 'frozen: the contact is still too short'

    def take(self) -> list[MatrixEstimate]:
        """Return the estimates made since the last call."""
        found = list(self._new)
        self._new.clear()
        return found


class AxesEstimation:
    """
    A pipeline for each axis, the on-line checks of them, and the matrix of three.

    What concerns all of them at once; samples pass through the session.
    """

    def __init__(self, parameters: EstimationParameters) -> None:
        self.pipelines = {
            axis: EstimationPipeline(parameters.of_axis(axis)) for axis in parameters.joints
        }
        self.checks = InputChecks(parameters, self.pipelines)
        self.matrix = MatrixEstimation(parameters)

    def configure(self, parameters: EstimationParameters) -> None:
        """Set new parameters while running; K_hat and B_hat stay."""
        for axis, pipeline in self.pipelines.items():
            pipeline.configure(parameters.of_axis(axis))
        self.matrix.configure(parameters)
        self.checks.configure(parameters)

    def restart_time(self) -> None:
        """Accept stamps before the last one, as when a bag loops; K_hat and B_hat stay."""
        for pipeline in self.pipelines.values():
            pipeline.restart_time()
        self.checks.restart()

    def reset(self) -> None:
        """Reset K_hat and B_hat to their initial values."""
        self.matrix.reset()
        for pipeline in self.pipelines.values():
            pipeline.reset()
        self.checks.reset()

    def tare(self) -> tuple[bool, str]:
        """Set the force bias to the mean force of the last moments of free flight."""
        messages = {axis: p.tare_refusal() for axis, p in self.pipelines.items()}
        done = not any(messages.values())
        if done:
            messages = {axis: p.tare()[1] for axis, p in self.pipelines.items()}
        if len(messages) == 1:
            return done, next(iter(messages.values()))
        return done, '; '.join(f'{axis}: {text}' for axis, text in messages.items() if text)
