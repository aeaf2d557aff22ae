# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimates of a recording at the end of each contact, from a replay in bounded memory."""

from __future__ import annotations

from math import isfinite
from typing import Any, Iterable, Mapping

from ..estimators.estimate import Estimate, EstimateStatus
from ..exceptions import RecordingError
from ..pipeline.replay import RecordingReplay
from ..recordings import RecordingReader
from ..recordings.estimation_metadata import from_metadata
from ..recordings.source import RecordingSource

_LEAST_CONTACT_S = 0.2  # as in the diagnosis
_VALUES = ('stiffness', 'stiffness_std', 'damping', 'damping_std', 'model_fit')


class Episodes:
    """
    Collect the contacts of a stream of estimates.

    first_ns, last_ns: stamps of the first and last sample [ns]
    """

    def __init__(self) -> None:
        self.first_ns: int | None = None
        self.last_ns: int | None = None
        self._begin_ns = 0
        self._last: Estimate | None = None
        self._found: list[dict[str, Any]] = []

    def add(self, estimates: Iterable[Estimate]) -> None:
        """Take consecutive estimates."""
        for estimate in estimates:
            if self.first_ns is None:
                self.first_ns = estimate.stamp_ns
            self.last_ns = estimate.stamp_ns
            if estimate.status is EstimateStatus.FREE:
                self._finish()
            else:
                if self._last is None:
                    self._begin_ns = estimate.stamp_ns
                self._last = estimate

    def found(self) -> list[dict[str, Any]]:
        """
        Return the contacts.

        Returns episodes: number from 1, begin and end [s] since the first sample, status and
        estimates at the end; None for what is not estimated. Contacts under 0.2 s are left out.
        """
        self._finish()
        return self._found

    def _finish(self) -> None:
        last, self._last = self._last, None
        if last is None or self.first_ns is None:
            return
        begin, end = ((stamp - self.first_ns) * 1e-9 for stamp in (self._begin_ns, last.stamp_ns))
        if end - begin >= _LEAST_CONTACT_S:
            values = {name: float(getattr(last, name)) for name in _VALUES}
            self._found.append({
                'episode': len(self._found) + 1, 'begin_s': begin, 'end_s': end,
                'status': last.status.value,
                **{name: value if isfinite(value) else None for name, value in values.items()},
            })


def replay_episodes(
    path: str, source: RecordingSource, chosen: Mapping[str, Any],
    over: Mapping[str, Any] | None = None,
) -> Episodes:
    """Replay a recording."""
    reader = RecordingReader(path, source)
    recorded = from_metadata(reader.metadata())
    chosen = {name: value for name, value in chosen.items() if name not in recorded}
    replay = RecordingReplay(reader, source, {**chosen, **(over or {})})
    episodes = Episodes()
    for estimates in replay.estimates():
        episodes.add(of_axes[0] for of_axes in estimates)
    if episodes.first_ns is None:
        raise RecordingError(
            f'no usable sample in {path}: expected wrenches with joint states at or around '
            'their stamps, got none; check topics, joint and stamps')
    return episodes
