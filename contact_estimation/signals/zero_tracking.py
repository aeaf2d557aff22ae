# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The zero of a force sensor that drifts, tracked in free flight and extrapolated in contact."""

from __future__ import annotations

from math import sqrt

DRIFT_STD = 1.0
"""Of the drift before any free flight [standard deviations of the noise per s]."""
DRIFT_WALK = 0.02
"""Random walk of the drift [noise / s per sqrt(s)]: at 500 Hz it is averaged over 1.5 s, which is
(period / walk^2)^(1/4)."""
_CLIP = 3.0  # standard deviations of an innovation, beyond which it is an outlier or a touch


class ZeroTracker:
    """
    Kalman filter of zero z and drift d of a force: z' = d, d' white noise.

    zero, drift: z [N] and d [N/s]
    """

    def __init__(self) -> None:
        self.zero = self.drift = 0.0
        self._P = 0.0, 0.0, DRIFT_STD * DRIFT_STD  # in variances of the noise

    @property
    def zero_std(self) -> float:
        """Return the standard deviation of the zero in those of the noise."""
        return sqrt(self._P[0])

    def step(self, size: float, variance: float) -> None:
        """Move the zero by what is known to have changed [N], with a variance [noise^2]."""
        zz, zd, dd = self._P
        self.zero += size
        self._P = zz + variance, zd, dd

    def predict(self, dt: float) -> None:
        """Extrapolate by a time step [s]."""
        zz, zd, dd = self._P
        self.zero += self.drift * dt
        self._P = zz + dt * (2.0 * zd + dt * dd), zd + dt * dd, dd + DRIFT_WALK * DRIFT_WALK * dt

    def correct(self, force: float, noise_std: float) -> None:
        """Use a force of free flight less the zero, and the deviation of its noise [N]."""
        zz, zd, dd = self._P
        most = _CLIP * noise_std * sqrt(1.0 + zz)
        force = min(max(force, -most), most)
        of_zero, of_drift = zz / (1.0 + zz), zd / (1.0 + zz)
        self.zero += of_zero * force
        self.drift += of_drift * force
        self._P = zz - of_zero * zz, zd - of_zero * zd, dd - of_drift * zd
