# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Adaptive model-following control of an arm of unknown mass and damping."""

from dataclasses import dataclass
from typing import NamedTuple

from .estimate import new_tuple
from ..parameters import parameter, ParameterGroup
from ..reference.setpoints import Reference


@dataclass(frozen=True)
class ModelFollowingParameters(ParameterGroup):
    """Target impedance, initial values of the arm, gains of control and adaptation."""

    target_mass: float = parameter(100.0, 'M_t of the reference model', 'kg', minimum=1e-6)
    target_damping: float = parameter(6500.0, 'B_t of the reference model', 'N s/m', minimum=0.0)
    target_stiffness: float = parameter(1e5, 'K_t of the reference model', 'N/m', minimum=0.0)
    arm_mass: float = parameter(50.0, 'Initial value of the mass of the arm', 'kg', minimum=1e-3)
    arm_damping: float = parameter(
        200.0, 'Initial value of the damping of the arm', 'N s/m', minimum=1e-3)
    arm_range: float = parameter(
        4.0, 'Mass and damping of the arm are limited to this factor of their initial values', '',
        minimum=1.0)
    error_rate: float = parameter(
        20.0, 'Rate at which x - x_m decays once the arm is known', '1/s', minimum=0.0, maximum=1e3
    )
    feedback_gain: float = parameter(
        2000.0, 'Gain of the filtered error; needs a sample period well below mass / gain',
        'N s/m', minimum=1e-3)
    arm_mass_gain: float = parameter(
        6e4, 'Adaptation gain of the mass of the arm; 0: keep the initial value', 'kg s^2/m^2',
        minimum=0.0)
    arm_damping_gain: float = parameter(
        2e6, 'Adaptation gain of the damping of the arm; 0: keep the initial value', 'kg/m^2',
        minimum=0.0)
    adaptation_limit: float = parameter(
        50.0, 'Upper limit of the adaptation rate in fast motion', '1/s', minimum=1e-3)


class Motion(NamedTuple):
    """Position [m], velocity [m/s] and acceleration [m/s^2] at an instant."""

    position: float
    velocity: float
    acceleration: float


class ReferenceModel:
    """
    The target impedance of eq. (1), driven by the reference and the measured force.

    mass, damping, stiffness: M_t [kg], B_t [N s/m], K_t [N/m]
    """

    def __init__(self, mass: float, damping: float, stiffness: float) -> None:
        self._M, self._B, self._K = mass, damping, stiffness
        self._last: tuple[Motion, float, Reference] | None = None

    @property
    def motion(self) -> Motion | None:
        """Of the model at the last sample; None before the first."""
        return self._last[0] if self._last else None

    def advance(
        self, dt: float, position: float, velocity: float, force: float, reference: Reference
    ) -> Motion:
        """
        Integrate eq. (1) over one sample, along the parabola of the last reference.

        By the trapezoid rule: of second order, and stable for any target at any sample rate.

        dt: time since the last sample [s]
        position, velocity: x [m] and its rate [m/s]; the model starts there
        force: F_e now [N]
        reference: x_r with its derivatives, from now on
        """
        M, B, K, last = self._M, self._B, self._K, self._last
        if last is None:
            x_m, v_m = position, velocity
        else:
            (x_m, v_m, _), last_force, (x_r, v_r, a_r, _) = last
            z, w = x_m - x_r, v_m - v_r  # M_t w' + B_t w + K_t z = F_e
            half = 0.5 * dt
            drag = half * (B + half * K)
            push = half * (last_force + force) - dt * K * z
            w_next = ((M - drag) * w + push) / (M + drag)
            z_next = z + half * (w + w_next)
            x_m, v_m = x_r + dt * (v_r + half * a_r) + z_next, v_r + dt * a_r + w_next
        x_r, v_r, a_r, _ = reference
        a_m = a_r + (force - B * (v_m - v_r) - K * (x_m - x_r)) / M
        motion = new_tuple(Motion, (x_m, v_m, a_m))
        self._last = motion, force, reference
        return motion


class ModelFollowing:
    """
    Drive the arm m x'' + b x' = u + F_e along the reference model, with m and b unknown.

    With e = x - x_m and the filtered error s = e' + r e, r the `error_rate`, the force

        u = m_hat a + b_hat v - F_e - k s,    a = a_m - r e',    v = v_m - r e

    leaves m s' = -(b + k) s + (m_hat - m) a + (b_hat - b) v, and the adaptation

        m_hat' = -g_m a s,    b_hat' = -g_b v s

    gives V = (m s^2 + (m_hat - m)^2 / g_m + (b_hat - b)^2 / g_b) / 2 the rate
    V' = -(b + k) s^2: s and e vanish whatever the wall does (Slotine and Li's law). Two measures
    keep a sampled and noisy loop stable: the limits of `arm_range`, which only lower V while the
    truth is within them, and the division of g_m and g_b by 1 + (g_m a^2 + g_b v^2) / (limit k),
    which matters in fast motion alone.

    mass, damping: m_hat [kg] and b_hat [N s/m]
    error: x - x_m at the last sample [m]
    """

    def __init__(self, tuning: ModelFollowingParameters) -> None:
        self._set(tuning)
        self.mass, self.damping, self.error = tuning.arm_mass, tuning.arm_damping, 0.0
        self.restart()

    def _set(self, tuning: ModelFollowingParameters) -> None:
        self._p, factor = tuning, tuning.arm_range
        self._masses = tuning.arm_mass / factor, tuning.arm_mass * factor
        self._dampings = tuning.arm_damping / factor, tuning.arm_damping * factor
        k = tuning.feedback_gain
        self._gains = (tuning.error_rate, tuning.arm_mass_gain, tuning.arm_damping_gain, k,
                       tuning.adaptation_limit * k)

    def configure(self, tuning: ModelFollowingParameters) -> None:
        """Set new tuning while running."""
        # New initial values replace the estimates of the arm, a new target restarts the model.
        old = self._p
        self._set(tuning)
        if (tuning.arm_mass, tuning.arm_damping) != (old.arm_mass, old.arm_damping):
            self.mass, self.damping = tuning.arm_mass, tuning.arm_damping
        if self._target_of(tuning) != self._target_of(old):
            self.restart()

    @staticmethod
    def _target_of(tuning: ModelFollowingParameters) -> tuple[float, float, float]:
        return tuning.target_mass, tuning.target_damping, tuning.target_stiffness

    def restart(self) -> None:
        """Restart the model at the position of the arm at the next sample."""
        self.model = ReferenceModel(*self._target_of(self._p))

    def force(
        self, dt: float, position: float, velocity: float, force: float, reference: Reference
    ) -> float:
        """
        Adapt to the last sample and return the control force for the next period.

        dt: time since the last sample [s]
        position, velocity, force: x [m], its rate [m/s] and F_e [N] as measured
        reference: what the model follows from now on
        Returns u: force for the arm until the next sample [N]
        """
        rate, g_m, g_b, k, most_power = self._gains
        x_m, v_m, a_m = self.model.advance(dt, position, velocity, force, reference)
        self.error = e = position - x_m
        e_dot = velocity - v_m
        s, a, v = e_dot + rate * e, a_m - rate * e_dot, v_m - rate * e
        power = g_m * a * a + g_b * v * v
        step = dt * s / (1.0 + power / most_power)
        m, b = self.mass - step * g_m * a, self.damping - step * g_b * v
        least, most = self._masses
        if not least <= m <= most:
            m = min(max(m, least), most)
        least, most = self._dampings
        if not least <= b <= most:
            b = min(max(b, least), most)
        self.mass, self.damping = m, b
        return m * a + b * v - force - k * s
