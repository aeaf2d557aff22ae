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

"""
What a model leaves unexplained at each port of a recording.

Force port: measured force less the sensor chain applied to the wall's force for the measured
motion. Motion port: innovations of the robot (or of a permanently attached wall) driven by its
reference and the wall's force. A contact effect shows on both, a sensor effect on the first
alone, a robot effect on the second alone; the noise of the two is independent.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .driven_wall import DrivenWall
from .model import Laws, Model
from .observed import Observed
from .observer import discretise, innovations, run, SecondOrder

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

OBSERVER_CUTOFF = 50.0
"""omega_o [rad/s]: errors of a sample's time at an impact are forgotten within 40 ms."""

ROBUST = 5.0
"""Residuals count linearly beyond so many standard deviations (Huber 1964)."""

_DROP = 5.0  # standard deviations: the price of a sample at which the force vanished


@dataclass
class Ports:
    """
    Residuals of models on one recording, whitened and averaged over blocks.

    Attributes
    ----------
    observed : Observed
        The recording.
    force_noise, motion_noise : float
        Standard deviations of the residuals of a right model, a sample [N], [m].
    use : ndarray of bool, shape (N,)
        Samples that count.
    block : int
        Samples averaged to one residual.
    dropped : ndarray of bool, shape (N,), or None
        Where the force vanished in the midst of a contact, see `force_drops`. What presses
        nothing there is known; a model that cannot let go pays for each such sample.
    rounds : int
        Of Picard's iteration for a wall without a robot; 1: forces at the measured motion.

    """

    observed: Observed
    force_noise: float
    motion_noise: float
    use: Flags
    block: int
    dropped: Flags | None = None
    rounds: int = 1
    _observer: SecondOrder | None = field(init=False, default=None)
    _weights: dict[str, Array] = field(init=False, default_factory=dict)
    _masks: dict[str, Flags] = field(init=False, default_factory=dict)
    _spread: dict[str, Array] = field(init=False, default_factory=dict)
    _doubt: tuple[Array, Array] | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        """Count the samples of each block."""
        measured, moved = self.use & self.observed.measured, self.use
        if self.dropped is not None:  # no one can predict when, within a sample, it let go
            edges = np.flatnonzero(np.diff(self.dropped.astype(int)))
            measured, moved = measured.copy(), moved.copy()
            for edge in edges.tolist():
                measured[max(0, edge - 1):edge + 3] = False
                moved[edge:edge + round(4.0 / (OBSERVER_CUTOFF * self.observed.h))] = False
        self._masks = {'force': measured, 'motion': moved}
        self._spread = self._spread_of_stamps()
        self._weights = {port: self._sum(mask.astype(float)) for port, mask in self._masks.items()}

    def _spread_of_stamps(self) -> dict[str, Array]:
        """Tell by how much stamps that stray widen the noise: a moving thing was elsewhere."""
        o = self.observed
        rate = np.gradient(o.force, o.h) if o.jitter * o.h > 0.0 else np.zeros(len(o.t))
        span = max(1, round(0.02 / o.h))
        slope = np.convolve(rate, np.ones(span) / span, mode='same')
        return {'force': np.hypot(1.0, slope * o.jitter / self.force_noise),
                'motion': np.hypot(1.0, o.v * o.jitter / self.motion_noise)}

    @property
    def count(self) -> int:
        """Number of residuals that are not empty."""
        o = self.observed
        ports = ['force', 'motion'] if o.reference is not None else ['force']
        return sum(int(np.count_nonzero(self._weights[port])) for port in ports)

    def _sum(self, signal: Array) -> Array:
        count = len(signal) // self.block
        return signal[:count * self.block].reshape(count, self.block).sum(axis=1)

    def average(self, port: str, residual: Array, noise: float) -> Array:
        """
        Average over blocks.

        Parameters
        ----------
        port : str
            'force' or 'motion': which samples count.
        residual : ndarray, shape (N,)
            Any error.
        noise : float
            Its standard deviation a sample.

        Returns
        -------
        averaged : ndarray, shape (blocks,)
            In standard deviations of a block's mean; 0 for empty blocks.

        """
        weights = self._weights[port]
        total = self._sum(residual / self._spread[port] * self._masks[port])
        return total / (noise * np.sqrt(np.maximum(weights, 1.0)))

    def force_residual(self, model: Model) -> Array:
        """
        Subtract the predicted from the measured force.

        Parameters
        ----------
        model : Model
            With its values.

        Returns
        -------
        residual : ndarray, shape (N,)
            [N].

        """
        laws = model.laws()
        return self._sensed_residual(laws.chain, self._force(laws)[0])

    def _force(self, laws: Laws) -> tuple[Array, Array]:
        o = self.observed
        force, d = laws.contact.force_and_depth(o.t, o.x, o.v, o.a)
        if self.dropped is not None:
            force = np.where(self.dropped, 0.0, force)
        return force, d

    def _sensed_residual(self, chain: list, force: Array) -> Array:  # type: ignore[type-arg]
        o = self.observed
        for effect in chain:
            force = effect.sense_along(o.t, force, o.a)
        return o.force - force

    def motion_residual(self, model: Model) -> Array | None:
        """
        Compute the innovations of the motion port; parameters as `force_residual`.

        Returns
        -------
        innovations : ndarray, shape (N,), or None
            [m]; None without robot and with a wall that can let go.

        """
        laws, o = model.laws(), self.observed
        if o.reference is not None:
            return self._robot_innovations(laws, *self._force(laws))
        if self.driven_by_force(model):
            return DrivenWall(model, o).innovations(self.rounds, self.force_noise)
        return None

    def _robot_run(self, laws: Laws, force: Array, d: Array) -> tuple[Array, SecondOrder]:
        """Let the robot run free under its reference and the wall's force on the measured x."""
        o, robot = self.observed, laws.robot
        assert o.reference is not None
        reference = o.reference_at(robot.reference_delay)
        if robot.is_linear:
            push = robot.impedance_force(0.0, 0.0, reference)
        else:
            push = (robot.force(o.x, o.v, reference, np) + robot.damping * o.v
                    + robot.stiffness * o.x)
        push = push + (at_touch_down(force, d) if laws.contact.unilateral else force)
        system = discretise(robot.mass, robot.damping, robot.stiffness, o.h)
        return run(system, push, float(o.x[0]), robot.stiffness), system

    def _robot_innovations(self, laws: Laws, force: Array, d: Array) -> Array:
        o = self.observed
        predicted, system = self._robot_run(laws, force, d)
        misfit = o.raw_position - predicted
        return innovations(misfit, self._whitener(system), OBSERVER_CUTOFF, o.h)

    def distrust_motion(self, model: Model) -> None:
        """
        Take what a model leaves in the motion for its noise.

        Parameters
        ----------
        model : Model
            Fitted.

        """
        motion = self.motion_residual(model)
        if motion is not None:
            left = self.average('motion', motion, self.motion_noise)
            filled = self.filled('motion')
            self.motion_noise *= max(1.0, float(np.sqrt(np.mean(left[filled] ** 2))))

    def answer_to(self, push: Array, model: Model) -> Array | None:
        """
        Compute the innovations that a force on the robot would leave.

        Parameters
        ----------
        push : ndarray, shape (N,)
            Force that the model does not know [N].
        model : Model
            Fitted.

        Returns
        -------
        innovations : ndarray, shape (N,), or None
            [m]; None without a robot.

        """
        o, robot = self.observed, model.laws().robot
        if o.reference is None:
            return None
        system = discretise(robot.mass, robot.damping, robot.stiffness, o.h)
        moved = run(system, push, 0.0, 0.0)
        return innovations(moved, self._whitener(system), OBSERVER_CUTOFF, o.h)

    def driven_by_force(self, model: Model) -> bool:
        """Tell whether there is no robot, and a wall whose mass the measured force moves."""
        return self.observed.driven_by_force(model.nominal)

    def _wall_time(self, model: Model) -> float:
        """Tell in what time the nominal wall springs back [s]."""
        wall = model.nominal.environment
        return 0.5 / max(OBSERVER_CUTOFF, np.sqrt(wall.stiffness / wall.inertia))

    def _whitener(self, system: SecondOrder) -> SecondOrder:
        """Weigh all models with the first one's dynamics, or they could not be compared."""
        if self._observer is None:
            self._observer = system
        return self._observer

    def residuals(self, model: Model, robust: bool = True, briefly: bool = False) -> Array:
        """
        Stack the residuals of both ports.

        Parameters
        ----------
        model : Model
            With its values.
        robust : bool
            Whether to bend them, see `huber`; without impacts there is no need to.
        briefly : bool
            Whether a wall without a robot shall forget within its own time, see
            `DrivenWall.innovations`: less sharp, but a step from afar goes the right way.

        Returns
        -------
        residuals : ndarray, shape (R,)
            In standard deviations; white, of variance 1 where the model is right.

        """
        laws, o = model.laws(), self.observed
        parts = []
        if not self.driven_by_force(model):
            force, d = self._force(laws)
            residual = self._sensed_residual(laws.chain, force)
            parts.append(self.average('force', residual, self.force_noise))
            if o.reference is not None:
                motion = self._robot_innovations(laws, force, d)
                parts.append(self.average('motion', motion, self.motion_noise))
        else:
            memory = self._wall_time(model) if briefly else np.inf
            motion = DrivenWall(model, o).innovations(self.rounds, self.force_noise, memory)
            parts.append(self.average('motion', motion, self.motion_noise))
        residuals = np.concatenate(parts)
        if self.dropped is not None and not any(e.lets_go for e in laws.contact.effects):
            price = _DROP * np.sqrt(self._sum(self.dropped.astype(float)))
            residuals[:len(price)] = np.hypot(residuals[:len(price)], price)
        if self._doubt is not None:
            directions, share = self._doubt
            residuals = residuals - directions @ (share * (directions.T @ residuals))
        return huber(residuals) if robust and laws.contact.unilateral else residuals

    def filled(self, port: str) -> Flags:
        """
        Tell which blocks have samples that count.

        Parameters
        ----------
        port : str
            'force' or 'motion'.

        Returns
        -------
        filled : ndarray of bool, shape (blocks,)
            False where the residual is 0 for want of any.

        """
        return self._weights[port] > 0.0

    def split(self, residuals: Array) -> Array:
        """
        Take stacked residuals apart again.

        Parameters
        ----------
        residuals : ndarray, shape (R,)
            Of `residuals`.

        Returns
        -------
        parts : ndarray, shape (ports, blocks)
            Of the force, where it does not drive the wall; of the motion, where there is one.

        """
        return residuals.reshape(-1, len(self.observed.t) // self.block)

    def blocks(self, signal: Array) -> Array:
        """
        Average a signal over each block.

        Parameters
        ----------
        signal : ndarray, shape (N,)
            Any.

        Returns
        -------
        mean : ndarray, shape (blocks,)
            In its unit.

        """
        return self._sum(signal) / self.block

    def touching(self, model: Model) -> Flags:
        """
        Tell in which blocks the surface is reached.

        Parameters
        ----------
        model : Model
            Tells where it is.

        Returns
        -------
        touching : ndarray of bool, shape (blocks,)
            For most of their samples; everywhere for a permanently attached wall.

        """
        o, law = self.observed, model.laws().contact
        if not law.unilateral:
            return np.ones(len(o.t) // self.block, bool)
        return self.blocks(law.contact(o.t, o.x, o.v).astype(float)) > 0.5

    def discount(self, columns: Array | None) -> None:
        """
        Discount from now on what nobody can know better, see `nuisances.doubt`.

        Parameters
        ----------
        columns : ndarray, shape (R, C), or None
            What each such thing leaves in the residuals, in its standard deviation; the residuals
            are whitened with the covariance of all. None: forget what was discounted.

        """
        self._doubt = None
        if columns is not None:
            directions, sizes, _ = np.linalg.svd(columns, full_matrices=False)
            self._doubt = directions, 1.0 - 1.0 / np.sqrt(1.0 + sizes**2)


def huber(residuals: Array) -> Array:
    """
    Bend residuals so that their squares are Huber's loss.

    Parameters
    ----------
    residuals : ndarray
        In standard deviations.

    Returns
    -------
    bent : ndarray
        The same up to `ROBUST`.

    """
    size = np.abs(residuals)
    far = size > ROBUST
    if not far.any():
        return residuals
    bent = residuals.copy()
    bent[far] = np.sign(residuals[far]) * np.sqrt(ROBUST * (2.0 * size[far] - ROBUST))
    return bent


def at_touch_down(force: Array, d: Array) -> Array:
    """
    Keep the impulse of a force that begins between two samples.

    The force straight between samples would begin at the sample before touch-down. Its value
    there is set so that the area under both lines it ends is that of the true force.

    Parameters
    ----------
    force, d : ndarray, shape (N,)
        F_e [N] and penetration [m].

    Returns
    -------
    force : ndarray, shape (N,)
        Changed at the samples before touch-down alone.

    """
    begins = np.flatnonzero((force[:-1] == 0.0) & (d[:-1] <= 0.0) & (d[1:] > 0.0))
    d_0, d_1 = d[begins], d[begins + 1]
    share = d_1 / (d_1 - d_0)  # of the step that is spent in contact
    changed = force.copy()
    # The damper's part is there at once, the spring's grows from 0; the measured force at the
    # first sample is nearly all damper.
    changed[begins] = force[begins + 1] * (share - 0.5)
    return changed
