# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What an arm touches, diagnosed from force and motion of its tip alone."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike
from typing import Any, Callable, Mapping, Sequence

from ..diagnose import diagnose
from ..observe.signals import read_recording, without_reference
from ..result import Diagnosis
from ...plant.plant_parameters import PlantParameters

COMPLIANCE = 'a compliance of joints, tool or mount in series with the wall'


def diagnose_contact(
    paths: Sequence[str | PathLike[str]], urdf_file: str | PathLike[str],
    nominal: PlantParameters, *, held_out: Sequence[str | PathLike[str]] = (),
    topics: Mapping[str, str] | None = None, parameters: Mapping[str, Any] | None = None,
    seed: int = 0, progress: Callable[[str], None] = lambda text: None,
) -> Diagnosis:
    """
    Compare contacts along the normal of an arm with a model of the environment.

    The robot is diagnosed joint by joint: eq. (1), with one mass and no joints, has no part in it,
    and whatever controller moves the tip is nothing that the contact could lack.

    A compliance C between the measured joints and the wall looks like a late force:
    F + B_e' C dF/dt = -(K_e' (x - x_e) + B_e' v), with K_e' and B_e' by 1 + K_e C too small, and
    x_e off by how far the arm sags. The compliance is listed beside both.

    paths, held_out: recordings to fit and to test on
    urdf_file: robot description
    nominal: of which environment and physics are used
    topics, parameters: as of `read_recording`; `kinematics.*` and `contact.normal` must be given
    or recorded
    seed, progress: as of `diagnose`
    """
    chosen = {**(parameters or {}), 'robot_description_file': str(urdf_file)}
    fitted, tested = (
        [without_reference(read_recording(path, topics=topics, parameters=chosen))
         for path in some] for some in (paths, held_out))
    found = diagnose(fitted, nominal, held_out=tested, seed=seed, progress=progress)
    return replace(found, effects=[
        replace(one, indistinguishable_from=[*one.indistinguishable_from, COMPLIANCE])
        if one.family == 'timing' or one.name == 'contact_offset' else one
        for one in found.effects])
