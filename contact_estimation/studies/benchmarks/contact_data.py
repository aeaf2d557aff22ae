# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Samples in contact for the estimator benchmark, and the estimator input made of them."""

from __future__ import annotations

from typing import Any, NamedTuple, Sequence

from .simulated_samples import pressing, RATE
from ...estimators.estimate import EstimateStatus, Frozen
from ...estimators.estimator import TimedRow
from ...parameters.values import build
from ...pipeline.axes import Result
from ...pipeline.axis_pipeline import EstimationPipeline
from ...pipeline.parameters import EstimationParameters
from ...reference.setpoints import Reference
from ...signals.contact_sample import ContactSample


class ContactData(NamedTuple):
    """Samples, each with the reference that the robot followed."""

    approach: list[tuple[ContactSample, Reference]]  # in free flight, before the contact
    samples: list[tuple[ContactSample, Reference]]  # in contact


def contact_data(seconds: float) -> ContactData:
    """
    Simulate an approach and a contact at 500 Hz.

    seconds: duration of the contact [s]
    """
    approach, pressed = pressing(seconds)
    results = [*approach, *pressed]
    pairs = [(now.sample, _followed(before)) for before, now in zip(results, results[1:])]
    return ContactData(pairs[:len(approach)], pairs[len(approach):])


def _followed(result: Result) -> Reference:
    assert result.reference is not None
    return result.reference


def settled_pipeline(data: ContactData, name: str) -> EstimationPipeline:
    """Build a pipeline that has processed the approach."""
    parameters = build(EstimationParameters, {'estimator': name, 'sample_rate': RATE})
    pipeline = EstimationPipeline(parameters)
    for sample, reference in data.approach:
        pipeline.process((sample,), reference)
    return pipeline


def estimator_rows(data: ContactData, name: str) -> list[TimedRow]:
    """Collect the rows that a pipeline passes to an estimator that runs on rows."""
    pipeline = settled_pipeline(data, name)
    rows: list[TimedRow] = []
    assert pipeline.estimator is not None
    update = pipeline.estimator.update

    def record(part: Sequence[TimedRow], variance: float, frozen: Frozen) -> list[Any]:
        rows.extend(part)
        return update(part, variance, frozen)

    setattr(pipeline.estimator, 'update', record)
    for sample, reference in data.samples:
        pipeline.take(sample, reference)
    return rows


def learning_share(data: ContactData, name: str) -> float:
    """Return the fraction of samples that update the estimate."""
    take = settled_pipeline(data, name).take
    statuses = [take(sample, reference).status for sample, reference in data.samples]
    return sum(status is EstimateStatus.ESTIMATING for status in statuses) / len(statuses)
