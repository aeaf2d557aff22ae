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

"""Samples in contact for the estimator benchmark, and what a pipeline makes of them."""

from __future__ import annotations

from typing import Any, NamedTuple, Sequence

from .simulated_samples import pressing, RATE
from ..estimation.parameters import EstimationParameters
from ..estimation.pipeline import EstimationPipeline
from ..estimation.result import Result
from ..estimators.estimator import EstimateStatus, Frozen, TimedRow
from ..parameters.values import build
from ..reference.setpoints import Reference
from ..signals.contact_sample import ContactSample


class ContactData(NamedTuple):
    """Samples in contact with the references in force, and those that led there."""

    approach: list[tuple[ContactSample, Reference]]
    samples: list[tuple[ContactSample, Reference]]


def contact_data(seconds: float) -> ContactData:
    """
    Simulate.

    Parameters
    ----------
    seconds : float
        Length of the contact [s].

    Returns
    -------
    data : ContactData
        At 500 Hz.

    """
    approach, pressed = pressing(seconds)
    results = [*approach, *pressed]
    pairs = [(now.sample, _followed(before)) for before, now in zip(results, results[1:])]
    return ContactData(pairs[:len(approach)], pairs[len(approach):])


def _followed(result: Result) -> Reference:
    assert result.reference is not None
    return result.reference


def settled_pipeline(data: ContactData, name: str) -> EstimationPipeline:
    """
    Bring a pipeline into contact.

    Parameters
    ----------
    data : ContactData
        The approach.
    name : str
        Of the estimator.

    Returns
    -------
    pipeline : EstimationPipeline
        Ready for `data.samples`.

    """
    parameters = build(EstimationParameters, {'estimator': name, 'sample_rate': RATE})
    pipeline = EstimationPipeline(parameters)
    for sample, reference in data.approach:
        pipeline.process((sample,), reference)
    return pipeline


def learned(data: ContactData, name: str) -> tuple[list[TimedRow], float]:
    """
    Listen to what a pipeline gives its estimator.

    Parameters
    ----------
    data, name
        As of `settled_pipeline`.

    Returns
    -------
    rows : list of tuple
        Gated and filtered.
    share : float
        Of the samples at which the estimator learns; below 1, the times of the pipeline are too
        good.

    """
    pipeline = settled_pipeline(data, name)
    rows: list[TimedRow] = []
    update = pipeline.estimator.update

    def listen(part: Sequence[TimedRow], variance: float, frozen: Frozen) -> list[Any]:
        rows.extend(part)
        return update(part, variance, frozen)

    setattr(pipeline.estimator, 'update', listen)
    estimates = [pipeline.process((s,), reference)[0] for s, reference in data.samples]
    learning = [e.status is EstimateStatus.ESTIMATING for e in estimates]
    return rows, sum(learning) / len(learning)
