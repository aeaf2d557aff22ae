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

"""Contact detection from the measured force, with hysteresis."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from ..parameters.specification import parameter, ParameterGroup

_SETTLING_S = 0.5
_OUTLIER = 4.0  # standard deviations beyond which a free-flight sample counts only this much


@dataclass(frozen=True)
class ContactParameters(ParameterGroup):
    """Thresholds of contact, for estimator and force laws; where an arm touches the wall."""

    force_noise: float = parameter(
        0.6,
        'Initial standard deviation of the force noise, which is then estimated in free flight',
        'N',
        minimum=1e-9,
        maximum=1e6,
    )
    position_noise: float = parameter(
        1e-6, 'Standard deviation of the position noise', 'm', minimum=0.0
    )
    on_ratio: float = parameter(
        4.0,
        'Contact begins above this many standard deviations of the force noise; higher: later, '
        'fewer false contacts', minimum=1.0,
    )
    off_ratio: float = parameter(
        2.0, 'Contact ends below this many standard deviations of the force noise; at most '
        'on_ratio', minimum=0.0,
    )
    minimum_force: float = parameter(
        0.0, 'Contact begins above this force whatever the noise', 'N', minimum=0.0
    )
    samples: int = parameter(
        2, 'Consecutive samples above the threshold before contact begins', minimum=1, maximum=50
    )
    normal: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), 'Direction into the wall, of any length; for an arm (kinematics.tip)',
        read_only=True,
    )
    normal_frame: str = parameter(
        'base', 'Frame of the normal: kinematics.base, or kinematics.tip as it is oriented at '
        'touch-down', choices=('base', 'tip'), read_only=True,
    )
    point: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), 'Point of the tip that touches the wall, in the frame of kinematics.tip',
        'm', read_only=True,
    )


class ContactDetector:
    """
    Detect contact, and estimate level and noise of the force in free flight.

    Gating on delta > 0 alone would include the withdrawal, where the wall has lost contact
    although delta > 0; so contact requires a measured force above the noise. A predicted force
    above the noise is required where the estimator is updated.

    Parameters
    ----------
    parameters : ContactParameters
        Thresholds.

    Attributes
    ----------
    contact : bool
        Whether the last sample was in contact.
    level : float
        Mean pressing force in free flight [N].
    off : float
        Force above the level down to which a contact goes on [N].
    noise_variance, noise_std : float
        Of the force noise [N^2], [N]; the latter > 0.

    """

    def __init__(self, parameters: ContactParameters) -> None:
        self._p = parameters
        self.reset()

    def reset(self) -> None:
        """Reset contact, free-flight level and noise."""
        self.contact = False
        self.level = 0.0
        self.noise_variance = self._p.force_noise**2
        self._above = 0
        self._set_thresholds()

    def configure(self, parameters: ContactParameters) -> None:
        """
        Change the thresholds; the estimated noise stays unless its initial value changes.

        Parameters
        ----------
        parameters : ContactParameters
            The new thresholds.

        """
        if parameters.force_noise != self._p.force_noise:
            self.noise_variance = parameters.force_noise**2
        self._p = parameters
        self._set_thresholds()

    def touches(self, dt: float, pressing: float, inside: bool) -> bool:
        """
        Detect contact in one sample.

        Parameters
        ----------
        dt : float
            Time since the last sample [s].
        pressing : float
            -F_e, measured [N].
        inside : bool
            Whether the tool can be inside the wall: delta > 0 within the uncertainty of x_e.

        """
        measured = pressing - self.level
        if self.contact:
            self.contact = inside and measured > self.off
        elif inside and measured > self._on:
            self._above += 1  # a touch not yet confirmed is excluded from the statistics
            self.contact = self._above >= self._p.samples
        else:
            self._above = 0
            self._learn(dt, measured)
        return self.contact

    def _learn(self, dt: float, measured: float) -> None:
        limit = _OUTLIER * self.noise_std  # comparisons, not min and max: at every free sample
        deviation = measured
        if not -limit < measured < limit:
            deviation = limit if measured > 0.0 else -limit
        gain = dt / _SETTLING_S if dt < 0.1 * _SETTLING_S else 0.1
        self.level += gain * deviation
        self.noise_variance += gain * (deviation * deviation - self.noise_variance)
        self._set_thresholds()

    def _set_thresholds(self) -> None:
        p, variance = self._p, self.noise_variance
        self.noise_std = std = sqrt(variance if variance > 1e-18 else 1e-18)
        on, off = p.on_ratio * std, p.off_ratio * std
        self._on = on if on > p.minimum_force else p.minimum_force
        self.off = off if off < self._on else self._on
