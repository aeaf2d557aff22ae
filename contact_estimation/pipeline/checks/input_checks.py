# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The checks of a session on its last blocks of samples, judged once in 0.5 to 2 s."""

from collections import deque
from functools import partial
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .axes_checks import WrenchAxes
from .check import Array, AxisState, BLOCKS, Check, Warned, Window
from .force_checks import (
    ForceBias, ForceDirection, ForceNoise, ForceSign, ForceStill, ModelMismatch, OtherAxis,
    Surface, SurfaceShifted, SurfaceUnchecked)
from .lag_checks import StampSkew
from .stream_checks import (
    JointStill, JointUnits, JointVelocity, PositionUnit, SampleRate, StampBursts, TwoForces,
    TwoPositions, ZeroSteps)
from .windows import FREE, Windows
from ..parameters import EstimationParameters
from ...estimators.estimate import AxesEstimates, Estimate
from ...signals.contact_sample import AxesSample


CHECKS: tuple[Check, ...] = (
    TwoForces(), TwoPositions(), StampBursts(), ForceStill(), JointStill(), JointUnits(),
    PositionUnit(), JointVelocity(), WrenchAxes(), ForceSign(), OtherAxis(), ForceDirection(),
    StampSkew(), Surface(), ZeroSteps(), ForceBias(), ForceNoise(), SampleRate(), ModelMismatch(),
    SurfaceShifted(), SurfaceUnchecked(),
)
"""Every check of an axis, in the order of importance; the first active one is the headline."""

_QUIET = 8  # judgements in a row that find nothing, from which half as many are enough
_RELEVANT = ('environment', 'further_axes', 'synchronisation', 'contact')


class Found(NamedTuple):
    """A warning of the past or present."""

    warned: Warned  # with its last text
    # first_ns, last_ns: stamps of the first and the last judgement that found it [ns]
    first_ns: int
    last_ns: int


class InputChecks:
    """
    Let `CHECKS` judge the evidence, and withhold estimates that they invalidate.

    Judgements fall at fixed counts of samples.

    joint_stamps: stamps of joint states to come [ns]; the session appends to it
    wrenches: stamp [ns] and force along x, y and z [N] of wrenches to come; the inputs append to
    it
    loads: of an arm, stamp [ns] and `ContactKinematics.loads`
    due: number of samples of a block after which there is something to judge
    joints, limits: of an arm, the last positions of its joints and, by place, names and limits of
    those that turn [rad]; the inputs set both
    found: by check and axis, every warning since the start or `reset`
    """

    def __init__(
        self, parameters: EstimationParameters, pipelines: Mapping[str, Any]
    ) -> None:
        self._p, self._pipelines = parameters, pipelines
        self._windows = Windows(pipelines)
        self.joint_stamps, self.wrenches = self._windows.joint_stamps, self._windows.wrenches
        self.loads = self._windows.loads
        self.joints: Sequence[float] = ()
        self.limits: Mapping[int, tuple[str, float, float]] = {}
        self.reset()

    def reset(self) -> None:
        """Forget all evidence and all warnings."""
        self.found: dict[tuple[str, str], Found] = {}
        self._windows.reset()
        self._clear()

    def _clear(self) -> None:
        self._active: dict[tuple[str, str], tuple[str, int]] = {}  # text, judgements in a row
        for pipeline in self._pipelines.values():
            pipeline.publication.invalid = ''
        self.restart()

    def restart(self) -> None:
        """Start a new window, as after a clock jump; warnings stay."""
        self._windows.restart(self._p.sample_rate)
        # One after each sample: all at once would take longer than its period.
        self._waiting: deque[Callable[[], object]] = deque()
        self.due = self._windows.block
        self._stamp_ns = 0  # of the evidence
        self._quiet = self._blocks = 0  # judgements that found nothing, blocks since the last one

    def configure(self, parameters: EstimationParameters) -> None:
        """Set new parameters; warnings that depend on them are judged afresh."""
        old, self._p = self._p, parameters
        if any(getattr(parameters, name) != getattr(old, name) for name in _RELEVANT):
            self._clear()
        elif parameters.sample_rate != old.sample_rate:
            self.restart()

    def add(self, axes: AxesSample, estimates: AxesEstimates) -> None:
        """Add a sample; judge the next check that waits, or begin with a complete block."""
        samples = self._windows.samples
        for pending, sample, estimate in zip(samples, axes, estimates):
            pending.numbers.extend((*sample, estimate[7] is not FREE))
        if len(samples[0].numbers) >= 5 * self.due:
            self._judge_next(axes[0][0], 1)

    def add_many(
        self, stamps_ns: NDArray[np.int64], columns: Sequence[Sequence[Array]],
        estimates: Sequence[Sequence[Estimate]],
    ) -> None:
        """
        Add samples as `add` does one by one.

        stamps_ns (N,): stamps [ns]; N is at most `room`
        columns (N,): position [m], rate [m/s] and force [N], for each axis
        """
        self._windows.add_many(stamps_ns, columns, estimates)
        count = len(self._windows.samples[0]) + 1 - self.due
        if count > 0:
            self._judge_next(int(stamps_ns[-1]), count)

    @property
    def room(self) -> int:
        """Return the number of samples after which evidence is collected or a verdict is told."""
        return self.due - len(self._windows.samples[0]) + max(len(self._waiting) - 1, 0)

    def _judge_next(self, stamp_ns: int, count: int) -> None:
        """Do steps that wait, one a sample, or close the block that ends at a stamp."""
        if self._waiting:
            with np.errstate(all='ignore'):  # squares of huge values are not finite: no evidence
                for _ in range(count):
                    self._waiting.popleft()()
        else:
            self._stamp_ns = stamp_ns
            if self._windows.close_block(stamp_ns):
                self._quiet //= 2  # a touch shows the most
            if self._windows.joint_rate > 0.0:
                for pipeline in self._pipelines.values():
                    pipeline.posterior.blocks.expect_joint_states(1.0 / self._windows.joint_rate)
            self._blocks += 1
            # The window holds four blocks: each sample is judged at least once.
            if self._blocks >= min(2 ** (self._quiet // _QUIET), BLOCKS):
                self._blocks, self._quiet = 0, 0 if self._active else self._quiet + 1
                self._collect(*self._pipelines)
        after = len(self._windows.samples[0]) + 1
        self.due = after if self._waiting else max(after, self._windows.block)

    def _collect(self, axis: str, *later: str) -> None:
        """Collect the evidence of an axis, of which checks tell their verdict before the next."""
        seen = self._windows.of_axis(
            axis, self._p, AxisState.of(self._pipelines[axis]), self.joints, self.limits)
        for check in CHECKS:
            if not check.of_state:
                self._waiting.extend(partial(stage, seen) for stage in check.stages)
                self._waiting.append(partial(self._judge, seen, check))
        self._waiting.append(partial(self._tell, axis, *later))

    def warnings(self) -> list[Warned]:
        """Return the active warnings, the most important first."""
        active = []
        for check in CHECKS:
            for axis, pipeline in self._pipelines.items():
                text = self._text(check, axis)
                if check.of_state and (text or check.confirmations == 1):
                    seen = Window.of_state(axis, self._p, AxisState.of(pipeline))
                    text = check.judge(seen) or ''
                if text:
                    where = f'axis {axis}: ' if len(self._pipelines) > 1 else ''
                    active.append(Warned(check.name, axis, where + text, check.invalidates))
        return active

    def ordered_warnings(self) -> list[Found]:
        """Return every warning since the start or `reset`, the most important first."""
        order = [check.name for check in CHECKS]
        return sorted(self.found.values(), key=lambda one: order.index(one.warned.name))

    def explain_no_contact(self, axis: str) -> str:
        """Return what forces and positions there were instead of a contact."""
        deepest, pressing = self._windows.most(axis)
        pipeline = self._pipelines[axis]
        place = ('environment.location is taken at first touch'
                 if pipeline.surface.location != pipeline.surface.location
                 else f'where environment.location is {pipeline.surface.location:.4g} m; set it '
                 'to where the wall is, or to nan to take it at first touch')
        return (f'the largest pressing force is {pressing + 0.0:.3g} N, where contact begins '
                f'above {pipeline.posterior.contact.threshold:.3g} N; x reaches {deepest:.4g} m, '
                f'{place}')

    def _text(self, check: Check, axis: str) -> str:
        text, count = self._active.get((check.name, axis), ('', 0))
        return text if count >= check.confirmations else ''

    def _judge(self, seen: Window, check: Check) -> None:
        key = check.name, seen.axis
        in_foreign_axes = check.needs_axes and (WrenchAxes.name, seen.axis) in self._active
        text = '' if in_foreign_axes else check.judge(seen)
        if text is None:
            return
        if not text:
            self._active.pop(key, None)
            return
        self._active[key] = text, self._active.get(key, ('', 0))[1] + 1
        if self._text(check, seen.axis):
            first_ns = self.found[key].first_ns if key in self.found else self._stamp_ns
            self.found[key] = Found(
                Warned(check.name, seen.axis, text, check.invalidates), first_ns, self._stamp_ns)

    def _tell(self, axis: str, *later: str) -> None:
        """Judge the state now, withhold estimates or allow them, and go on with the next axis."""
        pipeline = self._pipelines[axis]
        seen = Window.of_state(axis, self._p, AxisState.of(pipeline))
        for check in CHECKS:
            if check.of_state:
                self._judge(seen, check)
        invalid = [self._text(check, axis) for check in CHECKS if check.invalidates]
        pipeline.publication.invalid = next(filter(None, invalid), '')
        if later:
            self._collect(*later)
