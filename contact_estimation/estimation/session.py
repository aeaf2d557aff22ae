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

"""The whole of on-line estimation without ROS: readings in, results out."""

from __future__ import annotations

import bisect
from collections import Counter, deque
from math import inf, isfinite, nan
from operator import itemgetter
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .axes import Columns, FurtherAxes
from .parameters import EstimationParameters
from .pipeline import EstimationPipeline, NO_REFERENCE
from ..estimators.estimator import Estimate
from ..parameters.values import changed
from ..reference.reference_generator import ReferenceGenerator
from ..reference.setpoints import Desired, Reference
from ..signals.contact_sample import ContactSample
from ..signals.synchronisation import Synchroniser

_WISHES_KEPT = 64


class Moment(NamedTuple):
    """
    A sample, told apart from one of the same stamp before time was set back.

    Attributes
    ----------
    jumps : int
        How often time had been set back before.
    stamp_ns : int
        Stamp of the sample [ns].

    """

    jumps: int
    stamp_ns: int


class Result(NamedTuple):
    """
    What one wrench sample has led to.

    Attributes
    ----------
    sample : ContactSample
        The sample used.
    estimate : Estimate
        What is known of the environment.
    reference_stamp_ns : int
        Instant from which the robot follows the reference [ns].
    reference : Reference or None
        None where nothing was ever desired.
    further : tuple of Estimate
        Of the axes beside the contact axis, in the order of `further_axes`.

    """

    sample: ContactSample
    estimate: Estimate
    reference_stamp_ns: int
    reference: Reference | None
    further: tuple[Estimate, ...] = ()


class ContactSession:
    """
    Synchroniser, pipeline and reference generator, and the events that act on them.

    The node feeds it what arrives, replay what was recorded; both get the same results.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.
    generate_reference : bool
        False where the reference is given by `add_reference` instead (replay).

    Attributes
    ----------
    last_stamp_ns : int
        Stamp of the last sample processed [ns].

    """

    def __init__(
        self, parameters: EstimationParameters, generate_reference: bool = True
    ) -> None:
        self.parameters = parameters
        self.pipeline = EstimationPipeline(parameters)
        self.last_stamp_ns = -(2**63)
        self._further = FurtherAxes(parameters)
        self._synchroniser = Synchroniser(parameters.synchronisation)
        self._generates = generate_reference
        self._generator = ReferenceGenerator(parameters.reference_law, parameters.reference)
        self._desired: deque[tuple[int, Desired]] = deque(maxlen=_WISHES_KEPT)
        self._references: deque[tuple[Moment, Reference]] = deque()
        self._followed = NO_REFERENCE
        self._scheduled: deque[tuple[Moment, Callable[[], object]]] = deque()
        self._jumps = 0
        self._frame_id = parameters.frame_id
        self._start_ns: int | None = None
        self._resting_position = nan
        self._period_ns = round(1e9 / parameters.sample_rate)

    @property
    def rejected(self) -> Counter[str]:
        """Samples not used, by reason."""
        return self._synchroniser.rejected

    @property
    def missing(self) -> int:
        """Samples that the spacing of the stamps says are missing."""
        return self.pipeline.missing

    @property
    def waits(self) -> bool:
        """Whether a wrench waits for its joint sample."""
        return self._synchroniser.waits

    @property
    def time_jumps(self) -> int:
        """Times that the stamps were set back."""
        return self._synchroniser.time_jumps

    # -- readings ---------------------------------------------------------------------------

    def add_wrench(self, stamp_ns: int, force: float) -> list[Result]:
        """
        Take a wrench reading.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        force : float
            F_e along the contact axis [N].

        Returns
        -------
        results : list of Result
            One for each sample that is complete now.

        """
        samples = self._synchroniser.add_wrench(stamp_ns, force)
        return [self._process(sample) for sample in samples]

    def add_motion(self, stamp_ns: int, position: float, velocity: float) -> list[Result]:
        """
        Take a joint reading.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        position, velocity : float
            x [m] and its rate [m/s], NaN where not measured.

        Returns
        -------
        results : list of Result
            One for each sample that is complete now.

        """
        samples = self._synchroniser.add_motion(stamp_ns, position, velocity)
        return [self._process(sample) for sample in samples]

    def add_wrenches(self, stamp_ns: int, forces: Sequence[float]) -> list[Result]:
        """
        Take a wrench reading of several axes.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        forces : sequence of float
            F_e of each of `further_axes.estimated_axes` [N].

        Returns
        -------
        results : list of Result
            One for each sample that is complete now.

        """
        return self.add_wrench(stamp_ns, self._further.add_wrench(stamp_ns, forces))

    def add_motions(
        self, stamp_ns: int, positions: Sequence[float], velocities: Sequence[float]
    ) -> list[Result]:
        """
        Take a joint reading of several axes.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        positions, velocities : sequence of float
            x [m] and its rate [m/s] of each of `further_axes.estimated_axes`, NaN where not
            measured.

        Returns
        -------
        results : list of Result
            One for each sample that is complete now.

        """
        motion = self._further.add_motion(stamp_ns, positions, velocities)
        return self.add_motion(stamp_ns, *motion)

    def add_desired(self, stamp_ns: int, desired: Desired) -> None:
        """
        Take what the planner wants.

        Parameters
        ----------
        stamp_ns : int
            Instant for which it is wanted [ns].
        desired : Desired
            Position with derivatives and force; a position that is not finite is rejected, and
            a force that does not press counts as none.

        """
        if not isfinite(desired.position):
            self.count_rejected('desired_not_finite')
            return
        force = desired.force
        if force <= 0.0 or force - force != 0.0:  # NaN alone is a wish: none
            if force < 0.0 or force == inf:
                self.count_rejected('desired_force_not_positive')
            force = nan
        v, a = (r if isfinite(r) else 0.0 for r in (desired.velocity, desired.acceleration))
        if self._desired and stamp_ns < self._desired[-1][0]:
            self._desired.clear()  # time was set back, or the planner changed its mind
        self._desired.append((stamp_ns, Desired(desired.position, v, a, force)))

    def add_reference(self, stamp_ns: int, reference: Reference, jumps: int = 0) -> None:
        """
        Take the reference that is in force, where it is not generated here.

        May come early, but in the order of the stamps.

        Parameters
        ----------
        stamp_ns : int
            Instant from which the robot follows it [ns].
        reference : Reference
            x_r with derivatives.
        jumps : int
            How often time had been set back before.

        """
        self._references.append((Moment(jumps, stamp_ns), reference))

    def accepts_frame(self, frame_id: str) -> bool:
        """
        Check the frame of a wrench; the first one counts where none is configured.

        Parameters
        ----------
        frame_id : str
            Of the wrench.

        Returns
        -------
        accepted : bool
            False: the wrench must not be added; it is counted as rejected.

        """
        if not self._frame_id:
            self._frame_id = frame_id
        if frame_id == self._frame_id:
            return True
        self.count_rejected('wrench_frame_id')
        return False

    @property
    def frame_id(self) -> str:
        """Frame of the wrenches; '' before the first."""
        return self._frame_id

    def count_rejected(self, reason: str) -> None:
        """
        Count a message that could not be used.

        Parameters
        ----------
        reason : str
            Why.

        """
        self._synchroniser.count(reason)

    # -- events -----------------------------------------------------------------------------

    @property
    def moment(self) -> Moment:
        """The last sample processed."""
        return Moment(self._jumps, self.last_stamp_ns)

    def schedule(self, after: Moment, action: Callable[[], object]) -> None:
        """
        Do something after one sample and before the next, whenever they come.

        Parameters
        ----------
        after : Moment
            The sample that it follows; in the order of the events.
        action : callable
            Called without arguments.

        """
        self._scheduled.append((after, action))

    def change_parameters(self, changes: Mapping[str, Any]) -> None:
        """
        Change parameters while running; K_hat and B_hat stay and x_r stays continuous.

        Parameters
        ----------
        changes : mapping
            Dotted name to new value.

        Raises
        ------
        ContactEstimationError
            If a value is not valid; nothing has changed then.

        """
        parameters = changed(self.parameters, changes)
        self.pipeline.configure(parameters)
        self._further.configure(parameters)
        self._generator.configure(parameters.reference_law, parameters.reference)
        self._synchroniser.configure(parameters.synchronisation)
        self.parameters = parameters
        self._period_ns = round(1e9 / parameters.sample_rate)

    def reset(self) -> None:
        """Go back to the first guess of K_e and B_e."""
        self.pipeline.reset()
        self._further.reset()

    @property
    def pipelines(self) -> dict[str, EstimationPipeline]:
        """The pipelines of all axes by axis, that of the contact axis first."""
        return {self.parameters.axis: self.pipeline, **self._further.pipelines}

    def set_bias(self, bias: float, further: Mapping[str, float] | None = None) -> None:
        """
        Take a known force for zero, as an earlier tare has found it.

        Parameters
        ----------
        bias : float
            Subtracted from the measured F_e [N].
        further : mapping, optional
            The same by axis, for axes beside the contact axis.

        """
        self.pipeline.set_bias(bias)
        self._further.set_biases(further or {})

    def tare(self) -> tuple[bool, str]:
        """
        Take the free-flight force of the last moments for zero.

        Returns
        -------
        done : bool
            False in contact or too soon.
        message : str
            What was done, or why not.

        """
        if not self._further:
            return self.pipeline.tare()
        # Friction of a contact loads the other axes too, so none is free unless all are.
        refusals = {axis: p.tare_refusal() for axis, p in self.pipelines.items()}
        done = not any(refusals.values())
        said = {axis: p.tare()[1] for axis, p in self.pipelines.items()} if done else refusals
        return done, '; '.join(f'{axis}: {text}' for axis, text in said.items() if text)

    # -- many samples at once ---------------------------------------------------------------

    def add_pairs(
        self,
        stamps_ns: NDArray[np.int64],
        forces: NDArray[np.float64],
        positions: NDArray[np.float64],
        velocities: NDArray[np.float64],
    ) -> list[Estimate] | None:
        """
        Take wrenches and joint readings that have the same stamps; see `Synchroniser.add_pairs`.

        Parameters
        ----------
        stamps_ns : ndarray of int64, shape (N,)
            Stamps of both [ns].
        forces, positions, velocities : ndarray, shape (N,)
            F_e [N], x [m] and its rate [m/s], NaN where not measured.

        Returns
        -------
        estimates : list of Estimate or None
            One a sample; None where they must be added one by one.

        """
        if self._generates or self._synchroniser.jumped:
            return None
        samples = self._synchroniser.add_pairs(stamps_ns, forces, positions, velocities)
        return None if samples is None else self._process_run(samples, [])

    def add_pairs_of_axes(
        self, stamps_ns: NDArray[np.int64], forces: Columns, positions: Columns,
        velocities: Columns,
    ) -> tuple[list[Estimate], list[tuple[Estimate, ...]]] | None:
        """
        Take wrenches and joint readings of several axes that have the same stamps.

        Parameters
        ----------
        stamps_ns : ndarray of int64, shape (N,)
            Stamps of both [ns].
        forces, positions, velocities : sequence of ndarray, shape (N,)
            As in `add_pairs`, of each of `further_axes.estimated_axes`.

        Returns
        -------
        estimates, further : list of Estimate, list of tuple of Estimate, or None
            Of the contact axis and of the others; None where they must be added one by one.

        """
        if self._generates or self._synchroniser.jumped:
            return None
        if not self._further.add_pairs(stamps_ns, forces, positions, velocities):
            return None
        samples = self._synchroniser.add_pairs(stamps_ns, forces[0], positions[0], velocities[0])
        assert samples is not None, 'the axes take the same decisions'
        further: list[tuple[Estimate, ...]] = []
        return self._process_run(samples, further), further

    def _process_run(
        self, samples: list[ContactSample], further: list[tuple[Estimate, ...]]
    ) -> list[Estimate]:
        """Process samples, between events many at once; estimates of further axes are added."""
        estimates: list[Estimate] = []
        while samples:
            count = self._undisturbed(samples)
            if count == 0:
                result = self._process(samples[0])
                estimates.append(result.estimate)
                further.append(result.further)
                count = 1
            else:
                estimates += self.pipeline.process_run(samples[:count], self._followed)
                further += self._further.process(count)
                self.last_stamp_ns = samples[count - 1].stamp_ns
            del samples[:count]
        return estimates

    def _undisturbed(self, samples: list[ContactSample]) -> int:
        """Count the samples before the next event or change of reference."""
        if self.pipeline.estimator.follows_reference or self._references:
            return 0
        if not self._scheduled:
            return len(samples)
        jumps, stamp_ns = self._scheduled[0][0]
        if jumps > self._jumps:
            return len(samples)
        return bisect.bisect_right(samples, stamp_ns, key=itemgetter(0))

    # -- one sample -------------------------------------------------------------------------

    def _process(self, sample: ContactSample) -> Result:
        if self._synchroniser.jumped:
            self._restart_time()
        stamp_ns = sample.stamp_ns
        now = Moment(self._jumps, stamp_ns)
        while self._scheduled and self._scheduled[0][0] < now:
            self._scheduled.popleft()[1]()
        while self._references and self._references[0][0] <= now:
            self._followed = self._references.popleft()[1]
        pipeline = self.pipeline
        estimate = pipeline.process(sample, self._followed)
        further = self._further.process(1)[0] if self._further else ()
        period_ns = self._period_ns
        reference = self._make_reference(sample, estimate, period_ns) if self._generates else None
        self.last_stamp_ns = stamp_ns
        return Result(sample, estimate, stamp_ns + period_ns, reference, further)

    def _restart_time(self) -> None:
        self._synchroniser.jumped = False
        self._jumps += 1
        self.pipeline.restart_time()
        self._further.restart_time()
        self._generator.reset()
        self._followed = NO_REFERENCE
        self._resting_position = nan
        self._start_ns = None
        self.last_stamp_ns = -(2**63)

    def _make_reference(
        self, sample: ContactSample, estimate: Estimate, period_ns: int
    ) -> Reference:
        if self._start_ns is None:
            self._start_ns = sample.stamp_ns
        target_ns = sample.stamp_ns + period_ns
        period = period_ns * 1e-9
        # After a gap the robot still is where the last reference left it.
        since_last = (
            period if self.last_stamp_ns < 0
            else min((sample.stamp_ns - self.last_stamp_ns) * 1e-9, 2.0 * period)
        )
        reference = self._generator.step(
            (target_ns - self._start_ns) * 1e-9,
            since_last,
            self._desired_at(target_ns, sample.position),
            self.pipeline.contact,
            estimate.location,
            estimate.stiffness,
        )
        if self.pipeline.estimator.follows_reference:
            self.add_reference(target_ns, reference, self._jumps)
        return reference

    def _desired_at(self, stamp_ns: int, position: float) -> Desired:
        """
        Take the newest wish for that instant; without any, rest where the robot was.

        A wish that nobody renews is a place to rest at, not a motion to go on with.

        """
        for stamp, desired in reversed(self._desired):
            if stamp <= stamp_ns:
                old = (stamp_ns - stamp) * 1e-9 > self.parameters.synchronisation.timeout_s
                return desired._replace(velocity=0.0, acceleration=0.0) if old else desired
        if self._resting_position != self._resting_position:
            self._resting_position = position
        return Desired(self._resting_position, 0.0, 0.0, self.parameters.force_reference)
