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

"""Diagnostics of the estimator node, for /diagnostics."""

from __future__ import annotations

from collections import deque
from math import isfinite
import time
from typing import Any, Sequence

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from .percentiles import percentiles
from ..estimation.model_fit import ModelFitMonitor
from ..estimation.pipeline import EstimationPipeline
from ..estimation.session import ContactSession
from ..estimators.estimator import Estimate

_LATENCIES_KEPT = 2000
_TARE_DUE = 2.0  # standard deviations of the force noise; the level is a mean over 0.5 s


class EstimatorDiagnostics:
    """
    Collect statistics at every sample and report them as a diagnostic status.

    Parameters
    ----------
    name : str
        Of the node.
    silence_s : float
        Time without a wrench after which the status is STALE [s].

    """

    def __init__(self, name: str, silence_s: float) -> None:
        self._name, self.silence_s = name, silence_s
        self.processed = 0
        self.errors = 0
        self.last_error = ''
        self._latencies_ns: deque[int] = deque(maxlen=_LATENCIES_KEPT)
        self._last_arrival = time.monotonic()
        self._before = (0, self._last_arrival)
        self._rejected_before = 0

    def arrived(self) -> None:
        """Note the arrival of a wrench."""
        self._last_arrival = time.monotonic()

    def published(self, stamp_ns: int) -> None:
        """
        Note that the outputs for a sample have been published.

        Parameters
        ----------
        stamp_ns : int
            Of the sample [ns].

        """
        self.processed += 1
        self._latencies_ns.append(time.time_ns() - stamp_ns)

    def failed(self, error: Exception) -> None:
        """
        Note an exception in a data callback.

        Parameters
        ----------
        error : Exception
            The exception, after which the node continues.

        """
        self.errors += 1
        self.last_error = f'{type(error).__name__}: {error}'

    def message(
        self, stamp: Any, session: ContactSession, estimates: Sequence[Estimate]
    ) -> DiagnosticArray:
        """
        Return the diagnostic message.

        Parameters
        ----------
        stamp : builtin_interfaces.msg.Time
            Now.
        session : ContactSession
            Whose counters are reported.
        estimates : sequence of Estimate
            The last one of each axis; empty before the first.

        Returns
        -------
        message : DiagnosticArray
            One status with all values.

        """
        estimate = estimates[0] if estimates else None
        level, text = self._judge(session, estimate)
        values = {**self._rates(), **self._estimation(session, estimate)}
        for (axis, pipeline), other in list(zip(session.pipelines.items(), estimates))[1:]:
            values.update((f'{axis}_{k}', v) for k, v in _values_of(other).items())
            values[f'{axis}_contact'] = pipeline.contact
            values.update((f'{axis}_{k}', v) for k, v in _fit_of(pipeline.model_fit).items())
        values.update(self._problems(session))
        status = DiagnosticStatus(
            level=level, name=f'{self._name}: contact estimation', message=text,
            hardware_id='', values=[KeyValue(key=k, value=str(v)) for k, v in values.items()],
        )
        message = DiagnosticArray(status=[status])
        message.header.stamp = stamp
        return message

    def _judge(self, session: ContactSession, estimate: Estimate | None) -> tuple[bytes, str]:
        silent = time.monotonic() - self._last_arrival
        rejected = sum(session.rejected.values())
        newly, self._rejected_before = rejected - self._rejected_before, rejected
        if silent > self.silence_s:
            return DiagnosticStatus.STALE, f'no wrench for {silent:.1f} s; is the sensor running?'
        if session.problem:
            return DiagnosticStatus.WARN, session.problem
        if estimate is None:
            return DiagnosticStatus.WARN, 'wrenches come, but no joint state matches their stamps'
        if newly:
            return DiagnosticStatus.WARN, f'{newly} samples rejected since the last report'
        warning = _warning(session)
        if warning:
            return DiagnosticStatus.WARN, warning
        reason = f': {estimate.reason}' if estimate.reason else ''
        return DiagnosticStatus.OK, f'{estimate.status.value}{reason}'

    def _rates(self) -> dict[str, Any]:
        now = time.monotonic()
        (count, then), self._before = self._before, (self.processed, now)
        rate = (self.processed - count) / max(now - then, 1e-6)
        values: dict[str, Any] = {'samples': self.processed, 'rate_hz': f'{rate:.1f}'}
        for name, latency in percentiles(list(self._latencies_ns)).items():
            if latency is not None:
                values[f'latency_ms_{name}'] = f'{latency * 1e-6:.3f}'
        return values

    @staticmethod
    def _estimation(session: ContactSession, estimate: Estimate | None) -> dict[str, Any]:
        pipeline, parameters = session.pipeline, session.parameters
        values: dict[str, Any] = {
            'estimator': parameters.estimator,
            'reference_law': parameters.reference_law,
            'reference_limited': session.stream.limited,
            'contact': pipeline.contact,
            'excitation_stiffness_std': f'{pipeline.excitation.stiffness_std:.6g}',
            'excitation_damping_std': f'{pipeline.excitation.damping_std:.6g}',
            'force_noise_std': f'{pipeline.noise_std:.6g}',
            'force_bias': f'{pipeline.bias:.6g}',
            'free_flight_level': f'{pipeline.free_flight_level:.6g}',
        }
        if estimate is None:
            return values
        details = {f'{parameters.estimator}_{name}': f'{value:.8g}'
                   for name, value in pipeline.estimator.details.items()}
        return {**values, **_values_of(estimate), **_fit_of(pipeline.model_fit), **details}

    def _problems(self, session: ContactSession) -> dict[str, Any]:
        values: dict[str, Any] = {
            'missing': session.pipeline.missing,
            'outliers': session.pipeline.outliers,
            'time_jumps': session.time_jumps,
            'errors': self.errors,
        }
        values.update((f'rejected_{k}', v) for k, v in sorted(session.rejected.items()))
        if self.last_error:
            values['last_error'] = self.last_error
        return values


def _values_of(estimate: Estimate) -> dict[str, str]:
    """Return the estimate of one axis as texts."""
    values = {}
    for name in ('stiffness', 'stiffness_std', 'damping', 'damping_std', 'location', 'inertia'):
        value = getattr(estimate, name)
        if isfinite(value):
            values[name] = f'{value:.8g}'
    values['status'] = estimate.status.value
    values['reason'] = estimate.reason
    return values


def _fit_of(monitor: ModelFitMonitor) -> dict[str, Any]:
    """Return how the model fits now, and the worst mismatch so far."""
    values: dict[str, Any] = {
        'model_fit': f'{monitor.now.ratio:.3g}', 'model_mismatches': monitor.count
    }
    if monitor.worst.text:
        values['model_fit_worst'] = f'{monitor.worst.ratio:.3g}'
        values['model_fit_worst_text'] = monitor.worst.text
    return values


def _warning(session: ContactSession) -> str:
    """Return a warning of what biases the estimates: sensor, model, gains or rate."""
    for axis, pipeline in session.pipelines.items():
        if _needs_tare(pipeline):
            where = f' along {axis}' if len(session.pipelines) > 1 else ''
            level = -pipeline.free_flight_level
            return f'the sensor reads {level:.3g} N in free flight{where}; call ~/tare there'
        if pipeline.model_fit.now.text:
            where = f'axis {axis}: ' if len(session.pipelines) > 1 else ''
            return where + pipeline.model_fit.now.text
        if pipeline.hindrance:
            where = f'axis {axis}: ' if len(session.pipelines) > 1 else ''
            return where + pipeline.hindrance
        location = _location_warning(pipeline)
        if location:
            return f'axis {axis}: {location}' if len(session.pipelines) > 1 else location
    rate, period = session.parameters.sample_rate, session.pipeline.sample_period_s
    if period > 0.0 and not 0.9 < period * rate < 1.1:
        return f'samples come at {1.0 / period:.4g} Hz, but sample_rate is {rate:g}; correct it'
    return ''


def _location_warning(pipeline: EstimationPipeline) -> str:
    """Return a warning of a surface that is elsewhere, or that the contact does not show."""
    shift, location = pipeline.location_shift, pipeline.parameters.environment.location
    if shift != 0.0:
        return (f'the surface is {1e3 * shift:+.3g} mm from environment.location; set it to '
                f'{location + shift:.6g} m')
    if pipeline.contact and pipeline.location_unchecked:
        return ('the motion does not show where the surface is, so that stiffness relies on '
                'environment.location; touch down again or excite')
    return ''


def _needs_tare(pipeline: EstimationPipeline) -> bool:
    """Return whether the free-flight force exceeds its noise."""
    return abs(pipeline.free_flight_level) > max(_TARE_DUE * pipeline.noise_std, 1e-3)
