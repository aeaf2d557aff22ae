# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What an arm touches, diagnosed from force and motion of its tip alone."""

from dataclasses import replace
from os import PathLike
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from .arm_recording import ArmRecording, Array, read_arm_recording
from .result import ArmDiagnosis
from ..diagnose import diagnose
from ..observe.signals import read_recording, Recording, without_reference
from ..result import Diagnosis
from ...kinematics.arm_dynamics import ArmDynamics
from ...plant.plant_parameters import PlantParameters

COMPLIANCE = 'a compliance of joints, tool or mount in series with the wall'


def diagnose_contact(
    paths: Sequence[str | PathLike[str]], urdf_file: str | PathLike[str], nominal: PlantParameters,
    *, held_out: Sequence[str | PathLike[str]] = (), topics: Mapping[str, str] | None = None,
    parameters: Mapping[str, Any] | None = None, arm: ArmDiagnosis | None = None, seed: int = 0,
    progress: Callable[[str], None] = lambda text: None, **reading: Any,
) -> Diagnosis:
    """
    Compare contacts along the normal of an arm with a model of the environment.

    The robot is diagnosed joint by joint: eq. (1), with one mass and no joints, has no part in it,
    and whatever controller moves the tip is nothing that the contact could lack.

    A compliance C between the measured joints and the wall looks like a wall that is softer by
    1 + K_e C, begins where the arm sags to, and pushes late or relaxes (with a spring in series it
    is the standard linear solid): F + B_e' C dF/dt = -(K_e' (x - x_e) + B_e' v). That of
    `joint_flexibility` in the diagnosis `arm` is taken out of x; one that is not known is listed
    beside these.

    paths, held_out: recordings to fit and to test on
    urdf_file: robot description
    nominal: of which environment and physics are used
    topics, parameters, reading: as of `read_recording`; `kinematics.*` and `contact.normal` must
    be given or recorded
    arm: diagnosis of the joints
    seed, progress: as of `diagnose`
    """
    chosen = {**(parameters or {}), 'robot_description_file': str(urdf_file)}
    soft = {one.joints[0]: one.parameters['compliance'].value for one in arm.effects
            if 'compliance' in one.parameters} if arm else {}

    def read(path: str | PathLike[str]) -> Recording:
        one = without_reference(read_recording(path, topics=topics, parameters=chosen, **reading))
        if not soft:
            return one
        assert arm is not None and arm.channels is not None
        states, s = read_arm_recording(path, topics, chosen, **reading), one.signals
        lag = tip_lag(states, arm.channels.arm, soft)
        lag = np.interp(s.joint_t - s.joint_t[0], states.t, lag)
        return replace(one, signals=s._replace(position=s.position - lag))

    fitted, tested = ([read(path) for path in some] for some in (paths, held_out))
    found = diagnose(fitted, nominal, held_out=tested, seed=seed, progress=progress)
    return replace(found, effects=[
        replace(one, indistinguishable_from=[*one.indistinguishable_from, COMPLIANCE])
        if one.family in ('timing', 'relaxation') or one.name == 'contact_offset' else one
        for one in found.effects])


def tip_lag(states: ArmRecording, arm: ArmDynamics, soft: Mapping[str, float]) -> Array:
    """Return the lag of the tip along the normal, n . J_v (c load), (N,) [m]; soft: c by joint."""
    assert states.wrench is not None
    chosen, q = states.wrench.parameters, states.of_joints(arm.joints).q
    tip, still = chosen.kinematics.tip, np.zeros_like(q)
    load = arm.torque(q, still, still) - arm.torque_from(q, states.wrench.outside(arm, q))
    frame = tip if chosen.contact.normal_frame == 'tip' else chosen.kinematics.base
    normal = arm.axes(q, frame) @ np.divide(
        chosen.contact.normal, np.linalg.norm(chosen.contact.normal))
    bent = load * [soft.get(name, 0.0) for name in arm.joints]
    return np.asarray(np.einsum('ni,nij,njk,nk->n', normal, arm.axes(q, tip),
                                arm.jacobian(q, tip)[:, :3], bent))
