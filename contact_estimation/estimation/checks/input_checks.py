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

"""The checks of a session: evidence collected sample by sample, judged twice a second."""

from __future__ import annotations

from collections import deque
from math import inf, nan
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from .check import Array, Check, Evidence, Forces, Warned
from .order import CHECKS
from ..parameters import EstimationParameters
from ..result import AxesEstimates
from ...estimators.estimator import EstimateStatus
from ...signals.contact_sample import AxesSample

_BLOCK_S = 0.5
_LEAST_BLOCK = 25  # samples
_BLOCKS = 4  # of a window
_KEPT = 50_000  # wrenches and joint stamps while no sample comes
_NOTHING = np.zeros(0)
_FREE = EstimateStatus.FREE
_RELEVANT = ('environment', 'further_axes', 'synchronisation', 'contact')


class Found(NamedTuple):
    """
    A warning of the past or present.

    Attributes
    ----------
    warned : Warned
        With its last text.
    first_ns, last_ns : int
        Stamps of the first and the last judgement that found it [ns].

    """

    warned: Warned
    first_ns: int
    last_ns: int


class InputChecks:
    """
    Collect evidence, let `CHECKS` judge it, and withhold estimates that they invalidate.

    Judgements fall at fixed counts of samples, so that they do not depend on how the samples are
    cut into runs.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.
    pipelines : mapping of str to EstimationPipeline
        By axis.

    Attributes
    ----------
    joint_stamps : deque of int
        Stamps of joint states to come [ns]; the session appends to it.
    wrenches : deque of (int, float, float, float)
        Stamp [ns] and force along x, y and z [N] of wrenches to come; the inputs append to it.
    found : dict
        By check and axis, every warning since the start or `reset`.

    """

    def __init__(
        self, parameters: EstimationParameters, pipelines: Mapping[str, Any]
    ) -> None:
        self._p, self._pipelines = parameters, pipelines
        self.joint_stamps: deque[int] = deque(maxlen=_KEPT)
        self.wrenches: deque[tuple[int, float, float, float]] = deque(maxlen=_KEPT)
        self.reset()

    def reset(self) -> None:
        """Forget all evidence and all warnings."""
        self.found: dict[tuple[str, str], Found] = {}
        self._travel = {axis: (inf, -inf) for axis in self._pipelines}
        self._pressing = {axis: -inf for axis in self._pipelines}
        self._clear()

    def _clear(self) -> None:
        self._active: dict[tuple[str, str], tuple[str, int]] = {}  # text, judgements in a row
        for pipeline in self._pipelines.values():
            pipeline.invalid = ''
        self.restart()

    def restart(self) -> None:
        """Start a new window, as after a clock jump; warnings stay."""
        self._block = max(_LEAST_BLOCK, round(_BLOCK_S * self._p.sample_rate))
        self._samples: list[AxesSample] = []
        self._estimates: list[AxesEstimates] = []
        self._windows: dict[str, deque[Array]] = {
            axis: deque(maxlen=_BLOCKS) for axis in self._pipelines}
        self._others: deque[Array] = deque(maxlen=_BLOCKS)
        self._joint_rate, self._block_end_ns = nan, 0

    def configure(self, parameters: EstimationParameters) -> None:
        """Set new parameters; warnings that depend on them are judged afresh."""
        old, self._p = self._p, parameters
        if any(getattr(parameters, name) != getattr(old, name) for name in _RELEVANT):
            self._clear()
        elif parameters.sample_rate != old.sample_rate:
            self.restart()

    def parts(self, run: Sequence[AxesSample]) -> Sequence[Sequence[AxesSample]]:
        """
        Cut a run where the checks judge.

        Parameters
        ----------
        run : sequence of AxesSample
            Consecutive samples.

        """
        room = self._block - len(self._samples)
        if len(run) <= room:
            return (run,)
        edges = [0, *range(room, len(run), self._block), len(run)]
        return [run[begin:end] for begin, end in zip(edges, edges[1:])]

    def add(self, part: Sequence[AxesSample], estimates: Sequence[AxesEstimates]) -> None:
        """
        Add processed samples.

        Parameters
        ----------
        part : sequence of AxesSample
            As of `parts`.
        estimates : sequence of AxesEstimates
            Of the same samples.

        """
        self._samples += part
        self._estimates += estimates
        if len(self._samples) >= self._block:
            self._judge()

    def warnings(self) -> list[Warned]:
        """Return the active warnings, the most important first."""
        active = []
        for check in CHECKS:
            for axis, pipeline in self._pipelines.items():
                text = self._text(check, axis)
                if check.of_state:
                    text = check.judge(self._evidence(axis, pipeline, empty=True)) or ''
                if text:
                    where = f'axis {axis}: ' if len(self._pipelines) > 1 else ''
                    active.append(Warned(check.name, axis, where + text, check.invalidates))
        return active

    def found_in_order(self) -> list[Found]:
        """Return every warning since the start or `reset`, the most important first."""
        order = [check.name for check in CHECKS]
        return sorted(self.found.values(), key=lambda one: order.index(one.warned.name))

    def why_no_contact(self, axis: str) -> str:
        """
        Return what forces and positions there were instead of a contact.

        Parameters
        ----------
        axis : str
            One of the pipelines.

        """
        place = list(self._pipelines).index(axis)
        pending = [axes[place] for axes in self._samples]
        deepest = max([self._travel[axis][1], *(sample[1] for sample in pending)])
        pressing = max([self._pressing[axis], *(-sample[3] for sample in pending)])
        pipeline = self._pipelines[axis]
        return (f'the largest pressing force is {pressing:.3g} N, where contact begins above '
                f'{pipeline.contact_threshold:.3g} N; x reaches {deepest:.4g} m, where '
                f'environment.location is {pipeline.location:.4g} m')

    def _text(self, check: Check, axis: str) -> str:
        text, count = self._active.get((check.name, axis), ('', 0))
        return text if count >= check.confirmations else ''

    # -- judgement ----------------------------------------------------------------------------

    def _judge(self) -> None:
        stamp_ns = self._samples[-1][0].stamp_ns
        self._close_block(stamp_ns)
        for axis, pipeline in self._pipelines.items():
            seen = self._evidence(axis, pipeline)
            for check in CHECKS:
                self._note(check, axis, check.judge(seen), stamp_ns)
            invalid = [self._text(check, axis) for check in CHECKS
                       if check.invalidates and not check.of_state]
            pipeline.invalid = next(filter(None, invalid), '')

    def _note(self, check: Check, axis: str, text: str | None, stamp_ns: int) -> None:
        if text is None:
            return
        key = check.name, axis
        if not text:
            self._active.pop(key, None)
            return
        self._active[key] = text, self._active.get(key, ('', 0))[1] + 1
        if self._text(check, axis):
            first_ns = self.found[key].first_ns if key in self.found else stamp_ns
            self.found[key] = Found(
                Warned(check.name, axis, text, check.invalidates), first_ns, stamp_ns)

    def _close_block(self, end_ns: int) -> None:
        """Turn the samples of a block into arrays."""
        for place, axis in enumerate(self._pipelines):
            table = np.array([axes[place] for axes in self._samples])  # (N, 4)
            low, high = self._travel[axis]
            x = table[:, 1]
            self._travel[axis] = min(low, float(x.min())), max(high, float(x.max()))
            self._pressing[axis] = max(self._pressing[axis], -float(table[:, 3].min()))
            touching = [axes[place][7] is not _FREE for axes in self._estimates]
            self._windows[axis].append(np.column_stack([table, touching]))
        wrenches = []
        while self.wrenches and self.wrenches[0][0] <= end_ns:
            wrenches.append(self.wrenches.popleft())
        self._others.append(np.array(wrenches).reshape(-1, 4))
        count = 0
        while self.joint_stamps and self.joint_stamps[0] <= end_ns:
            self.joint_stamps.popleft()
            count += 1
        begin_ns, self._block_end_ns = self._block_end_ns, end_ns
        self._joint_rate = count / ((end_ns - begin_ns) * 1e-9) if begin_ns else nan
        self._samples, self._estimates = [], []

    def _evidence(self, axis: str, pipeline: Any, empty: bool = False) -> Evidence:
        if empty:
            return Evidence(axis, self._p, pipeline, _NOTHING, _NOTHING, _NOTHING, _NOTHING,
                            np.zeros(0, dtype=np.bool_))
        stamps, x, v, force, touching = np.concatenate(self._windows[axis]).T
        begin = stamps[0]
        low, high = self._travel[axis]
        return Evidence(
            axis, self._p, pipeline, (stamps - begin) * 1e-9, x, v, force - pipeline.bias,
            touching > 0.5, self._other_forces(stamps, x), self._joint_rate, high - low)

    def _other_forces(self, stamps: Array, x: Array) -> tuple[Forces, ...]:
        """Return the components of the wrench that no axis estimates."""
        table = np.concatenate(self._others)
        if not len(table):
            return ()
        position = np.interp(table[:, 0], stamps, x)
        return tuple(Forces(other, table[:, 1 + place], position)
                     for place, other in enumerate('xyz') if other not in self._pipelines)
