# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""One row at a time through the stages: the one place that knows how tests call them."""

from __future__ import annotations

from typing import Any, NamedTuple, Sequence

from contact_estimation.estimators.estimate import Frozen
from contact_estimation.signals.contact_sample import ContactSample

FREE = Frozen(False, False)


class Known(NamedTuple):
    """What an estimator knows."""

    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float
    location_shift: float
    inertia: float


def known(estimator: Any) -> Known:
    """Ask an estimator what it knows now."""
    return Known(*estimator.current())


def learn(
    estimator: Any, dt: float, row: Sequence[float], variance: float = 0.0, frozen: Frozen = FREE
) -> None:
    """Let an estimator learn from one row."""
    estimator.update([(dt, row)], variance, frozen)


def filtered(bank: Any, rows: Sequence[Sequence[float]]) -> list[Sequence[float]]:
    """Pass rows through a filter bank, one at a time."""
    return [bank.take(row) for row in rows]


def row_of(
    relation: Any, dt: float, delta: float, velocity: float, pressing: float, contact: bool
) -> Sequence[float] | None:
    """Build the row of one sample; None outside contact."""
    if contact:
        return relation.row(dt, delta, velocity, pressing)  # type: ignore[no-any-return]
    relation.leave()
    return None


def estimate_after(pipeline: Any, sample: ContactSample) -> Any:
    """Pass one sample through a pipeline."""
    return pipeline.process((sample,))[0]
