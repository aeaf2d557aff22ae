# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Position, velocity and force along the contact normal of an arm, from joints and wrench."""

from math import nan
from typing import NamedTuple, Sequence

import numpy as np

from .robot_model import Array, RobotModel
from .tool_load import cross_matrix, load_map, STANDARD_GRAVITY, ToolParameters
from .transform_model import TransformModel
from ..exceptions import ParameterRangeError
from ..signals.conditioning import ContactParameters
from ..signals.contact_sample import ContactSample


class ArmSample(NamedTuple):
    """Joints and wrench of an arm at one instant."""

    stamp_ns: int  # header stamp of the wrench [ns]
    motion: Sequence[float]  # q of the n joints [rad] or [m], then q_dot, NaN where not measured
    wrench: Sequence[float]  # force [N] and torque [N m] as measured, in the sensor's frame


class ArmState(NamedTuple):
    """What the joints and the wrench of one instant amount to."""

    # R, p: pose of the tip in the base frame [m]
    R: Array
    p: Array
    normal: Array  # (3,) unit vector into the wall, in the base frame
    # (6,) without the weight of the tool and the zero of the sensor, in the sensor's frame [N], [N
    # m]
    wrench: Array
    # velocity of the tip's origin [m/s] and angular velocity of the tip [rad/s], in the base
    # frame; NaN where joints have no measured velocity
    twist: tuple[Array, Array]
    R_sensor: Array  # (3, 3) axes of the sensor in the base frame
    sensor: Array  # (3,) origin of the sensor in the tip's frame [m]


_NOT_MEASURED = np.full(3, nan), np.full(3, nan)


class ContactKinematics:
    """
    Map joints and wrench to the contact axis: x = n . p, v = n . J q_dot, F_e = n . R_s f.

    p is the tip's origin, or `contact.point` of the tip, in the base frame; R_s turns the axes of
    the sensor into those of the base and f is the measured force without the load of the tool. A
    shift of the wrench's point leaves f as it is. The origin of x is that of the base frame.

    A normal given in the tip's frame follows the tip while `held` is False, and stays as it is in
    the base frame while `held` is True: in contact, so that x is one coordinate.

    force_sign: -1 where the driver publishes the wrench that the robot applies
    mount: roll, pitch and yaw of the sensor's axes in its link [rad]
    in_base: whether the driver expresses the wrench in axes of the base instead
    sensor: link in whose axes the wrench is measured, see `use_sensor`; '' before
    """

    def __init__(
        self, model: RobotModel | TransformModel, contact: ContactParameters, tool: ToolParameters,
        force_sign: float = 1.0, mount: Sequence[float] = (0.0, 0.0, 0.0), in_base: bool = False,
    ) -> None:
        from scipy.spatial.transform import Rotation  # slow to import, and only arms need it

        self.model, self.held, self.sensor = model, False, ''
        self.state: ArmState | None = None
        self._own_normal = unit_normal(contact)
        self._normal = self._own_normal
        self._wall: Array | None = None
        self._in_tip = contact.normal_frame == 'tip'
        self._point = np.array(contact.point) if any(contact.point) else None
        self.configure(tool)
        self._sign, self._in_base = force_sign, in_base
        self._axes = self._mount = Rotation.from_euler('xyz', mount).as_matrix()
        self._offset: Array | None = None
        self._gravity = model.root_axes.T @ np.array([0.0, 0.0, -STANDARD_GRAVITY])

    def configure(self, tool: ToolParameters) -> None:
        """Set another load of the tool."""
        self._load, self._bias = load_map(tool)
        self._weighs = bool(self._load.any())

    def use_sensor(
        self, frame: str, mounting: Array | None = None, offset: Array | None = None
    ) -> None:
        """Set the link of the wrench, and axes (3, 3) and origin (3,) [m] of the sensor in it."""
        fixed = self.model.in_tip(frame)
        self._axes = self._mount if mounting is None else mounting @ self._mount
        self._offset = offset
        self._fixed = None
        if fixed is not None:
            self._fixed = fixed[0] @ self._axes
            self._origin = fixed[1] if offset is None else fixed[1] + fixed[0] @ offset
        self.sensor = frame

    @property
    def normal(self) -> Array:
        """Return the unit vector into the wall, in the base frame, shape (3,)."""
        return self._normal

    def contact(self, sample: ArmSample) -> ContactSample:
        """Return motion and force along the normal."""
        stamp_ns, motion, measured = sample
        R, p, x, v = self.motion(motion)
        R_sensor = self._sensor_axes(motion, R, p)
        wrench = self._compensated(measured, R_sensor)
        self._force = R_sensor @ wrench[:3]
        self.state = ArmState(R, p, self._normal, wrench, self._twist, R_sensor, self._origin)
        return ContactSample(stamp_ns, x, v, float(self._normal @ self._force))

    def components(self, place: int) -> tuple[float, float, float]:
        """Return the last force along the normal and two axes of the wall [N], rotated."""
        if self._wall is None:
            self._wall = axes_of_wall(self._normal)
        x, y, z = (self._wall @ self._force).tolist()
        return ((x, y, z), (z, x, y), (y, z, x))[place]

    def loads(self, measured: Sequence[float]) -> list[float]:
        """
        Return the force and the weight per mass of the last sample in axes of the sensor, (9,).

        The force is that of a wrench in the configured axes, then in the other ones.

        measured (6,): its wrench
        """
        assert self.state is not None
        R = self.state.R_sensor
        force = self._sign * np.array(measured[:3], float)
        turned = force @ R
        pair = (turned, force) if self._in_base else (force, turned)
        return np.concatenate([*pair, self._gravity @ R]).tolist()  # type: ignore[no-any-return]

    def motion(self, motion: Sequence[float]) -> tuple[Array, Array, float, float]:
        """Return R and p of the tip in the base [m], and x [m] and v [m/s] along the normal."""
        count = len(motion) // 2
        q, q_dot = np.array(motion[:count], float), np.array(motion[count:], float)
        measured = not np.isnan(q_dot).any()
        R, p, p_dot, omega = self.model.velocity(q, q_dot if measured else np.zeros(count))
        self._twist = (p_dot, omega) if measured else _NOT_MEASURED
        if self._in_tip and not self.held:
            self._normal, self._wall = R @ self._own_normal, None
        normal, point, rate = self._normal, p, p_dot
        if self._point is not None:
            lever = R @ self._point
            point, rate = p + lever, p_dot + cross_matrix(omega) @ lever
        return R, p, float(normal @ point), float(normal @ rate) if measured else nan

    def _sensor_axes(self, motion: Sequence[float], R: Array, p: Array) -> Array:
        """Return R_s, shape (3, 3), from a motion and the tip's pose that belongs to it."""
        if self._fixed is not None:
            return R @ self._fixed
        axes, origin = self.model.pose(motion[:len(motion) // 2], self.sensor)
        if self._offset is not None:
            origin = origin + axes @ self._offset
        # A joint lies between tip and sensor: the twist of the tip is not that of the sensor.
        self._origin, self._twist = R.T @ (origin - p), _NOT_MEASURED
        return axes @ self._axes

    def _compensated(self, measured: Sequence[float], R_sensor: Array) -> Array:
        """Return a wrench without the tool's weight and the zero of the sensor."""
        wrench = self._sign * np.array(measured, float)
        if self._in_base:
            wrench = (wrench.reshape(2, 3) @ R_sensor).ravel()
        wrench -= self._bias
        if self._weighs:
            wrench -= self._load @ (self._gravity @ R_sensor)
        return wrench


def axes_of_wall(normal: Array) -> Array:
    """
    Return axes of which the first is the normal.

    normal (3,): unit vector
    Returns axes (3, 3): right-handed, one a row; the second is normal to the axis of the base that
    is most nearly along the wall
    """
    along = cross_matrix(normal) @ np.eye(3)[int(np.argmin(np.abs(normal)))]
    along /= np.linalg.norm(along)
    return np.array([normal, along, cross_matrix(normal) @ along])


def unit_normal(contact: ContactParameters) -> Array:
    """Return the direction of `contact.normal`, shape (3,)."""
    length = float(np.linalg.norm(contact.normal))
    if not length > 1e-6:
        raise ParameterRangeError(
            'contact.normal must be a direction of three numbers, into the wall, for an arm '
            f'(kinematics.tip is set), got {list(contact.normal)}; such as [0.0, 0.0, -1.0] for '
            'a table below, with contact.normal_frame base')
    return np.array(contact.normal) / length
