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

"""Model reference adaptive estimation in the structure of Singh and Popa (1995)."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, expm1
from typing import Sequence

from .estimator import EnvironmentParameters, Held, OnlineEstimator, Reference, Snapshot, TimedRow
from .indirect_adaptive import IndirectAdaptive, IndirectAdaptiveParameters
from ..parameters import parameter, ParameterGroup


@dataclass(frozen=True)
class ModelReferenceParameters(ParameterGroup):
    """Target impedance, adaptation of the plant, and gains of the environment estimator."""

    target_mass: float = parameter(100.0, 'M_t of the reference model', 'kg', minimum=1e-6)
    target_damping: float = parameter(6500.0, 'B_t of the reference model', 'N s/m', minimum=0.0)
    target_stiffness: float = parameter(1e5, 'K_t of the reference model', 'N/m', minimum=0.0)
    plant_rate: float = parameter(
        5.0, 'Decay rate of the plant equation error', '1/s', minimum=0.0, maximum=1e3
    )
    plant_filter: float = parameter(
        60.0, 'Pole of the filter that spares differentiating the velocity', '1/s', minimum=0.1
    )
    stiffness_gain: float = parameter(
        5.0e4, 'Entry of Gamma^-1 for K in eq. (25)', 'N/m/(N m s)', minimum=0.0
    )
    damping_gain: float = parameter(
        2.5e3, 'Entry of Gamma^-1 for B in eq. (25)', 'N s/m/(N m)', minimum=0.0
    )
    normalised: bool = parameter(False, 'Normalise eq. (25), as in indirect_adaptive')


class ReferenceModel:
    """
    The target impedance of eq. (1), driven by the reference and the measured force.

    Parameters
    ----------
    mass, damping, stiffness : float
        M_t [kg], B_t [N s/m], K_t [N/m].

    """

    def __init__(self, mass: float, damping: float, stiffness: float) -> None:
        self.mass, self.damping, self.stiffness = mass, damping, stiffness
        self.position = self.velocity = 0.0
        self.started = False

    def start(self, position: float, velocity: float) -> None:
        """
        Put the model where the arm is.

        Parameters
        ----------
        position, velocity : float
            x [m] and its rate [m/s].

        """
        self.position, self.velocity, self.started = position, velocity, True

    def step(self, dt: float, force: float, reference: Reference) -> None:
        """
        Integrate eq. (1) over one sample, semi-implicitly.

        Parameters
        ----------
        dt : float
            Time step [s].
        force : float
            F_e [N].
        reference : Reference
            x_r with its derivatives.

        """
        x_r, v_r, a_r = reference
        # Backward Euler: stable for any damping and stiffness at any sample rate.
        drive = force + self.mass * a_r + self.damping * v_r + self.stiffness * (
            x_r - self.position
        )
        momentum = self.mass * self.velocity + dt * drive
        self.velocity = momentum / (self.mass + dt * self.damping + dt * dt * self.stiffness)
        self.position += dt * self.velocity


class PlantEstimator:
    """
    Adapt (K_p, B_p, 1) / M_p of the arm to v' - a_r = -a_K e - a_B w + a_F F_e.

    e = x - x_r and w its rate. Both sides pass 1 / (s + pole), so that the velocity is never
    differentiated: v - pole v_f - (a_r)_f = phi^T a with phi = (-e_f, -w_f, F_f). Normalised
    gradient adaptation.

    Parameters
    ----------
    pole : float
        Of the filter [1/s].
    rate : float
        Decay rate of the equation error [1/s].
    start : tuple of float, length 3
        First guess of (a_K, a_B, a_F).

    """

    def __init__(self, pole: float, rate: float, start: tuple[float, float, float]) -> None:
        self._pole, self.rate = pole, rate
        self._scale = tuple(max(a, 1e-6) ** 2 for a in start)
        self.a = list(start)
        self._filtered: list[float] | None = None
        self._last: tuple[float, ...] = ()

    def step(
        self, dt: float, position: float, velocity: float, force: float, reference: Reference
    ) -> None:
        """
        Learn from one sample.

        Parameters
        ----------
        dt : float
            Time step [s].
        position, velocity, force : float
            x [m], its rate [m/s] and F_e [N].
        reference : Reference
            What the arm follows.

        """
        x_r, v_r, a_r = reference
        now = (position - x_r, velocity - v_r, force, velocity, a_r)
        if self._filtered is None:
            self._filtered, self._last = [value / self._pole for value in now], now
            return
        keep = exp(-self._pole * dt)
        gain = 0.5 * (1.0 - keep) / self._pole  # of a ramp between the samples, nearly
        # The feed-forward alone is a staircase: over the last interval the old one acted.
        ahead = (*now[:4], self._last[4])
        filtered = [
            keep * f + gain * (u + last) for f, u, last in zip(self._filtered, ahead, self._last)
        ]
        self._filtered, self._last = filtered, now
        e_f, w_f, F_f, v_f, a_f = filtered
        phi = (-e_f, -w_f, F_f)
        error = velocity - self._pole * v_f - a_f - sum(p * a for p, a in zip(phi, self.a))
        power = sum(s * p * p for s, p in zip(self._scale, phi))
        step = -expm1(-self.rate * dt) * error / (power + 1e-9)
        self.a = [max(a + step * s * p, 0.0) for a, s, p in zip(self.a, self._scale, phi)]


class ModelReferenceAdaptive(OnlineEstimator):
    """
    Plant estimator, reference model and environment estimator side by side.

    The environment estimator is eq. (25) with the gains of indirect_adaptive, as in the paper;
    the plant estimator tells the impedance that the arm really has, `model_error` how far the arm
    is from the target impedance.

    """

    Parameters = ModelReferenceParameters
    follows_reference = True

    def __init__(
        self, tuning: ParameterGroup, environment: EnvironmentParameters, sample_period_s: float
    ) -> None:
        self._environment_estimator = IndirectAdaptive(
            IndirectAdaptiveParameters(), environment, sample_period_s
        )
        self._target: tuple[float, ...] = ()
        super().__init__(tuning, environment, sample_period_s)

    def configure(self, tuning: ParameterGroup) -> None:
        """Take new tuning; a new target restarts the model. See `OnlineEstimator.configure`."""
        assert isinstance(tuning, ModelReferenceParameters)
        p = tuning
        self._environment_estimator.configure(
            IndirectAdaptiveParameters(p.stiffness_gain, p.damping_gain, p.normalised)
        )
        target = p.target_mass, p.target_damping, p.target_stiffness, p.plant_filter
        if target != self._target:
            self._target = target
            M, B, K, pole = target
            self.model = ReferenceModel(M, B, K)
            self.plant = PlantEstimator(pole, p.plant_rate, (K / M, B / M, 1.0 / M))
        self.plant.rate = p.plant_rate

    def start_from(self, stiffness: float, damping: float) -> None:
        """Begin anew; see `OnlineEstimator.start_from`."""
        self._environment_estimator.start_from(stiffness, damping)
        self.stiffness, self.damping = stiffness, damping

    def learn(
        self, rows: Sequence[TimedRow], noise_variance: float, held: Held
    ) -> list[Snapshot]:
        """Apply eq. (25); see `OnlineEstimator.learn`."""
        inner = self._environment_estimator
        inner.environment = self.environment
        snapshots = inner.learn(rows, noise_variance, held)
        self.stiffness, self.damping = inner.stiffness, inner.damping
        return snapshots

    def snapshot(self) -> Snapshot:
        """Tell what is known now; see `OnlineEstimator.snapshot`."""
        return self._environment_estimator.snapshot()

    def observe(
        self, dt: float, position: float, velocity: float, force: float, reference: Reference
    ) -> None:
        """Run the model and adapt the plant; see `OnlineEstimator.observe`."""
        if not self.model.started:
            self.model.start(position, velocity)
        self.model.step(dt, force, reference)
        self.plant.step(dt, position, velocity, force, reference)
        self.model_error = position - self.model.position
