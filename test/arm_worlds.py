# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings of a small arm: rigid-body dynamics of Pinocchio plus laws, without integration."""

from functools import lru_cache
from typing import Any, Sequence

from contact_estimation.diagnosis.arm.arm_recording import ArmRecording, ArmWrench
from contact_estimation.kinematics.arm_dynamics import ArmDynamics, Outside, PER_LINK
from contact_estimation.physics.joint_effects import JOINT_EFFECTS, JointMotion
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.arm_models import arm_description, TIP
from contact_estimation.plant.arm_simulation import ArmLaw
from contact_estimation.reference.arm_excitation import ArmTrajectory, exciting_trajectory
import numpy as np

URDF = arm_description('planar_3r')
JOINTS = ('joint_1', 'joint_2', 'joint_3')
FRICTION = [law for j, (F_c, B) in enumerate(((3.0, 2.0), (1.5, 1.0), (0.2, 0.1)))
            for law in (ArmLaw('coulomb_friction', [F_c], j, 0.02),
                        ArmLaw('viscous_friction', [B], j))]


@lru_cache(maxsize=4)
def motion(seed: int = 1, duration: float = 25.0) -> ArmTrajectory:
    """Return a motion of the arm."""
    return exciting_trajectory(ArmDynamics(URDF), seed, duration, tries=5)


def along(arm: ArmDynamics, wanted: ArmTrajectory) -> JointMotion:
    """Return the motion as laws see it."""
    load = arm.torque(wanted.q, wanted.v, wanted.a)
    speed = np.percentile(np.abs(wanted.v), 95, axis=0)
    return JointMotion(arm, wanted.q, wanted.v, wanted.a, load, speed, wanted.q.mean(axis=0), load,
                       float(wanted.t[1] - wanted.t[0]))


def arm_recording(
    laws: Sequence[ArmLaw] = (), seed: int = 1, links: float = 0.02, friction: bool = True,
    pressed: Any = None, **changes: Any,
) -> ArmRecording:
    """
    Return a recording; `changes` replace its q, v or tau by a function of it.

    `pressed`, shape (N, 6), is a wrench at the tip, measured with noise.
    """
    arm, wanted, rng = ArmDynamics(URDF), motion(seed), np.random.default_rng(seed)
    scale = np.repeat(1.0 + links * rng.uniform(-1.0, 1.0, 3), PER_LINK)
    here = along(arm, wanted)
    tau = arm.with_parameters(arm.neutral * scale).torque(wanted.q, wanted.v, wanted.a)
    for law in [*(FRICTION if friction else []), *laws]:
        for j, column in JOINT_EFFECTS[law.effect].columns(here, law.place, law.shape).items():
            tau[:, j] += column @ np.asarray(law.theta)
    wrench = None
    if pressed is not None:
        tau -= arm.torque_from(wanted.q, Outside(TIP, pressed))
        noise = rng.normal(size=pressed.shape) * [0.3, 0.3, 0.3, 0.02, 0.02, 0.02]
        wrench = ArmWrench(TIP, pressed + noise, EstimationParameters())
    tau += 0.002 * np.ptp(tau, axis=0) * rng.normal(size=tau.shape)
    signals: dict[str, Any] = {'q': wanted.q, 'v': wanted.v, 'tau': tau}
    signals.update({name: change(signals[name]) for name, change in changes.items()})
    return ArmRecording('run.mcap', JOINTS, wanted.t, **signals, wrench=wrench)


def pressing() -> Any:
    """Return the wrench of something that pushes now and then along the axes of the root."""
    arm, wanted = ArmDynamics(URDF), motion()
    wave = np.sin(2.0 * np.pi * np.outer(wanted.t, [0.23, 0.31, 0.11]))
    force = 60.0 * np.maximum(wave - 0.3, 0.0) * [1.0, 0.2, 1.0]
    return np.hstack([np.einsum('nij,ni->nj', arm.axes(wanted.q, TIP), force),
                      np.zeros((len(force), 3))])
