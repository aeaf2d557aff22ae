# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`diagnose --nominal-robot`: name the physics that the description of an arm lacks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from .command_line import different_files, new_file, topics_of
from .progress import Progress
from ..diagnosis.arm.arm_recording import read_arm_recording
from ..diagnosis.arm.conclude import diagnose_arm
from ..diagnosis.arm.corrected_robot import corrected_urdf, mjcf_snippet
from ..diagnosis.arm.page import as_html
from ..diagnosis.arm.result import ArmDiagnosis
from ..diagnosis.arm.text import as_dict, as_text
from ..exceptions import ModelFileError, ParameterRangeError
from ..figures import require_matplotlib
from ..kinematics.arm_dynamics import ArmDynamics
from ..reference.arm_excitation import exciting_trajectory

_OF_CONTACTS = ('nominal', 'write_model', 'write_comparison', 'params', 'axis', 'joint')


def run(options: Any) -> int:
    """Diagnose an arm, write the requested files and print the report."""
    for name in _OF_CONTACTS:
        if getattr(options, name):
            raise ParameterRangeError(
                f'--{name.replace("_", "-")} belongs to the diagnosis of a contact, and '
                '--nominal-robot to that of a whole arm; give one of them')
    outputs = [options.json, options.html, options.write_urdf, _mjcf(options),
               options.write_trajectory]
    for path in filter(None, outputs):
        new_file(path)
    if options.html:
        require_matplotlib()
    recordings = [*options.recordings, *options.holdout]
    different_files(outputs, {
        'the robot description': [options.nominal_robot], 'a recording': recordings})
    urdf = read_description(options.nominal_robot)
    progress, stages = Progress('diagnose'), list[str]()

    def report_stage(text: str) -> None:
        stages.append(text)
        progress.show(min(0.95, len(stages) / 20.0), text)

    topic = topics_of(options).get('joint_states', 'joint_states')
    fitted, tested = ([read_arm_recording(path, topic) for path in paths]
                      for paths in (options.recordings, options.holdout))
    diagnosis = diagnose_arm(
        fitted, urdf, held_out=tested, seed=options.seed, progress=report_stage)
    progress.done()
    _write(diagnosis, urdf, options)
    print(as_text(diagnosis))
    return 0


def _mjcf(options: Any) -> str | None:
    """Return the file for MuJoCo, beside the corrected description."""
    return str(Path(options.write_urdf).with_suffix('.mjcf')) if options.write_urdf else None


def _write(diagnosis: ArmDiagnosis, urdf: str, options: Any) -> None:
    if options.json:
        text = json.dumps(as_dict(diagnosis), indent=1, allow_nan=False)
        new_file(options.json).write_text(text + '\n')
    if options.html:
        title = ', '.join(Path(path).name for path in options.recordings)
        new_file(options.html).write_text(as_html(diagnosis, title), encoding='utf-8')
    if options.write_urdf and not diagnosis.refused:
        new_file(options.write_urdf).write_text(corrected_urdf(diagnosis, urdf))
        new_file(_mjcf(options) or '').write_text(mjcf_snippet(diagnosis))
    if options.write_trajectory:
        arm = ArmDynamics(urdf, [one.name for one in diagnosis.joints] or None)
        motion = exciting_trajectory(arm, options.seed)
        new_file(options.write_trajectory).write_text(motion.as_csv(arm))


def read_description(path: str) -> str:
    """Return the text of a robot description."""
    try:
        return Path(path).read_text()
    except UnicodeDecodeError as error:
        raise ModelFileError(f'{path} must be the text of a URDF file, got other data') from error
