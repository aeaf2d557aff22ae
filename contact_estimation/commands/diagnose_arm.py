# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`diagnose --nominal-robot`: name the physics that the description of an arm lacks."""

from dataclasses import replace
import json
from pathlib import Path
from typing import Any, Callable, Sequence

from .command_line import (
    as_json, check_outputs, chosen_parameters, new_file, reading_of, topics_of, write_results)
from .progress import Progress
from ..diagnosis.arm.arm_recording import read_arm_recording
from ..diagnosis.arm.conclude import diagnose_arm
from ..diagnosis.arm.contact import diagnose_contact
from ..diagnosis.arm.corrected_robot import corrected_urdf, mjcf_snippet
from ..diagnosis.arm.result import ArmDiagnosis
from ..diagnosis.arm.text import as_dict, as_html, as_text, headline
from ..diagnosis.fit.beam import as_dict as comparison, Compared
from ..diagnosis.report.json_report import model_file
from ..exceptions import ParameterRangeError, RecordingError
from ..figures import require_matplotlib
from ..kinematics.arm_dynamics import ArmDynamics
from ..kinematics.description import read_description
from ..plant.plant_parameters import read_model
from ..reference.arm_excitation import exciting_trajectory

_OF_ONE_AXIS = ('axis', 'joint')


def run(options: Any) -> int:
    """Diagnose an arm, write the requested files and print the report."""
    _check(options)
    if options.html:
        require_matplotlib()
    urdf = read_description(options.nominal_robot)
    progress = Progress('diagnose')
    stage = progress.stage(20)
    fitted, tested, simulations = (
        [read_arm_recording(path, topics_of(options), chosen_parameters(options),
                            **reading_of(options)) for path in paths]
        for paths in (options.recordings, options.holdout, filter(None, [options.simulation])))
    if options.nominal and not any(one.wrench for one in fitted):
        raise RecordingError(
            '--nominal, the contact, needs a wrench beside the joint states, got none in '
            f'{", ".join(options.recordings)}; choose its topic with --topic wrench:=, or leave '
            '--nominal out')
    simulated = None
    for one in simulations:
        simulated = diagnose_arm(one, urdf, seed=options.seed, progress=stage)
    diagnosis = diagnose_arm(fitted, urdf, held_out=tested, seed=options.seed,
                             simulated=simulated, progress=stage)
    if options.nominal:
        diagnosis = replace(diagnosis, contact=diagnose_contact(
            options.recordings, options.nominal_robot, read_model(options.nominal),
            held_out=options.holdout, topics=topics_of(options),
            parameters=chosen_parameters(options), arm=diagnosis, seed=options.seed,
            progress=stage, **reading_of(options)))
    progress.done()
    _write(diagnosis, urdf, options)
    if simulated is not None:
        print(f'Simulation {options.simulation}: {headline(simulated)}.\n')
    print(as_text(diagnosis))
    return 0


def _check(options: Any) -> None:
    """Refuse options that do not fit together, and results that cannot be written."""
    for name in _OF_ONE_AXIS:
        if getattr(options, name):
            raise ParameterRangeError(
                f'--{name} belongs to the diagnosis of a single axis, and --nominal-robot to that '
                'of a whole arm, whose contact lies along contact.normal of --params')
    if options.write_model and not options.nominal:
        raise ParameterRangeError(
            '--write-model needs --nominal MODEL.yaml, the contact that is corrected; '
            '--write-urdf writes the corrected arm')
    check_outputs(
        [options.json, options.html, options.write_urdf, options.write_trajectory,
         _beside(options.write_urdf, '.mjcf'), _beside(options.write_trajectory, '.yaml'),
         options.write_comparison, options.write_model],
        {'the robot description': [options.nominal_robot],
         'a recording': [*options.recordings, *options.holdout, options.simulation],
         'the nominal model file': [options.nominal], 'a parameter file': options.params})


def _beside(path: str | None, suffix: str) -> str | None:
    """Return the file beside another: MJCF by a URDF, a message by a table."""
    return str(Path(path).with_suffix(suffix)) if path else None


def _write(diagnosis: ArmDiagnosis, urdf: str, options: Any) -> None:
    results: dict[str, Callable[[], str]] = {
        'json': lambda: as_json(as_dict(diagnosis), allow_nan=False),
        'html': lambda: as_html(diagnosis, names_of(options.recordings)),
        'write_comparison': lambda: comparison_text(diagnosis.compared)}
    if diagnosis.contact is not None:
        contact = diagnosis.contact
        results['write_model'] = lambda: model_file(contact)
    if not diagnosis.refused:
        results['write_urdf'] = lambda: corrected_urdf(diagnosis, urdf)
    write_results(options, results)
    if options.write_urdf and not diagnosis.refused:
        new_file(_beside(options.write_urdf, '.mjcf') or '').write_text(mjcf_snippet(diagnosis))
    if options.write_trajectory:
        arm = ArmDynamics(urdf, [one.name for one in diagnosis.joints] or None)
        motion = exciting_trajectory(arm, options.seed)
        new_file(options.write_trajectory).write_text(motion.as_csv(arm))
        new_file(_beside(options.write_trajectory, '.yaml') or '').write_text(
            motion.as_message(arm))


def comparison_text(compared: Compared | None) -> str:
    """Return the models that were compared, as JSON."""
    return json.dumps(None if compared is None else comparison(compared)) + '\n'


def names_of(recordings: Sequence[str]) -> str:
    """Return the title of a report."""
    return ', '.join(Path(path).name for path in recordings)
