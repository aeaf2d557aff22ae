# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of a real arm: its description, its frames, the axes of its force sensor."""

from dataclasses import dataclass

from ..parameters import parameter, ParameterGroup

AXES = ('sensor', 'base')
TOPIC, JOINT_EFFORTS = 'topic', 'joint_efforts'
TAKEN, TRACKED = 'taken', 'tracked'


@dataclass(frozen=True)
class KinematicsParameters(ParameterGroup):
    """Links between which the joints of an arm lie; an empty tip: one prismatic axis, no arm."""

    base: str = parameter('', 'Link in whose frame positions and poses are given', read_only=True)
    tip: str = parameter(
        '', 'Link that touches the wall; empty: no arm, the joint itself is the contact axis',
        read_only=True)


@dataclass(frozen=True)
class ForceSensorParameters(ParameterGroup):
    """Axes in which the wrench of an arm is measured, and the zero of the force."""

    frame: str = parameter(
        '', "Link of the force sensor; empty: the frame_id of the wrench's header", read_only=True)
    rpy: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), "Roll, pitch and yaw of the sensor's axes in that link, where the "
        'robot description lacks its mounting', 'rad', read_only=True)
    axes: str = parameter(
        'sensor', 'Axes in which the wrench is expressed: those of the sensor, or of '
        'kinematics.base, as of UR drivers that leave frame_id empty', choices=AXES,
        read_only=True)
    zero: str = parameter(
        TAKEN, 'Zero of the force, also without an arm: taken by a tare, or tracked in each free '
        'flight, as of a sensor that drifts', choices=(TAKEN, TRACKED), read_only=True)
