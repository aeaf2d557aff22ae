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

"""Checks that read the state of a pipeline: model, estimator, rate."""

from __future__ import annotations

from .check import Check, Evidence

_RATE_OFF = 0.1


class ModelMismatch(Check):
    """The model of the estimator fits the last 2 s of contact."""

    name = 'model_fit'
    message = 'residual 3.2 x noise, changes sign with velocity: friction? run diagnose'
    cause = ('The contact has physics that the model lacks; the text says what the residual '
             'depends on.')
    remedy = 'Run `diagnose` on a recording; compensate what it names by `physics.*`.'
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return the judgement of the monitor."""
        return str(seen.pipeline.model_fit.now.text)


class EstimatorHindrance(Check):
    """Nothing hinders the estimator that was chosen."""

    name = 'estimator'
    message = 'the gains of mrac are too small for this wall, or similar words of the estimator'
    cause = 'The estimator has a limit that this contact exceeds; the text says which.'
    remedy = 'Change the tuning as the text says, or choose another estimator.'
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return what the estimator says."""
        return str(seen.pipeline.hindrance)


class SampleRate(Check):
    """Samples come at `sample_rate`."""

    name = 'sample_rate'
    message = 'samples come at 1000 Hz, but sample_rate is 500; correct it'
    cause = '`sample_rate` is not the rate of the wrench, or samples are lost.'
    remedy = ('Set `sample_rate`: filters and relations are built for it. Where the sensor does '
              'send at this rate, find what drops samples: a machine or network that is too slow.')
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Compare the spacing of the stamps with the nominal one."""
        rate, period = seen.parameters.sample_rate, seen.pipeline.sample_period_s
        if period <= 0.0 or abs(period * rate - 1.0) < _RATE_OFF:
            return ''
        dropped = ', or find why samples are dropped' if period * rate > 1.0 else ''
        return (f'samples come at {1.0 / period:.4g} Hz, but sample_rate is {rate:g}; correct '
                f'it{dropped}')
