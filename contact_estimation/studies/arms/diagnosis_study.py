# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Whether `diagnose` names what is concealed in the simulation of an arm."""

from __future__ import annotations

from contextlib import redirect_stderr, redirect_stdout
import io
import json
from pathlib import Path
from typing import Any, NamedTuple, Sequence

from .arm_files import ArmFiles, tool_parameters, world_of
from .simulation import Run, World
from ...commands.diagnose import main as diagnose
from ...exceptions import EstimationError

FRICTION_N = 8.0
"""Of the joints, as a force along the normal."""

CONCEALED = ('nothing', 'joint friction', 'tool mass')
_RIGHT_PORTS: dict[str, set[str]] = {
    'nothing': set(), 'joint friction': {'robot'}, 'tool mass': {'force_sensor'},
}


class Case(NamedTuple):
    """One arm with something concealed."""

    name: str  # for files
    run: Run  # simulation
    recording: Path  # of it
    world: World  # truth
    parameters: dict[str, Any]  # of the estimator, which do not know what is concealed


def concealed_case(files: ArmFiles, concealed: str, seed: int, tool: Path) -> Case:
    """Conceal and record."""
    world = world_of(seed, FRICTION_N if concealed == 'joint friction' else 0.0)
    run, recording = files.touch(world, seed, concealed.replace(' ', '_'))
    known = tool_parameters(tool)
    if concealed == 'tool mass':
        known['tool.mass'] = 0.0
    name = f'{concealed.replace(" ", "_")}_{seed}'
    return Case(name, run, recording, world, {**files.parameters(run), **known})


def diagnosed(files: ArmFiles, concealed: str, seed: int, tool: Path) -> dict[str, Any]:
    """Conceal, record and diagnose."""
    case = concealed_case(files, concealed, seed, tool)
    given = ['--params', str(files.parameter_file(case.name, case.parameters)),
             '--seed', str(seed)]
    return {'arm': files.arm.name, 'concealed': concealed, 'seed': seed,
            **diagnosis_of(files, case, case.recording, concealed, given)}


def diagnosis_of(
    files: ArmFiles, case: Case, recording: Path, concealed: str, options: Sequence[str] = ()
) -> dict[str, Any]:
    """Diagnose a recording of a case."""
    name = recording.name.removesuffix('.mcap')
    nominal = files.nominal_model(case.name, case.run, case.world)
    report, printed = files.path(f'{name}.diagnosis.json'), io.StringIO()
    with redirect_stdout(printed), redirect_stderr(printed):
        code = diagnose([
            str(recording), '--nominal', str(nominal), '--json', str(report), *options])
    if code:
        raise EstimationError(f'diagnose failed on {recording}: {printed.getvalue()}')
    return _scored(json.loads(report.read_text()), _RIGHT_PORTS[concealed])


def _scored(report: dict[str, Any], right: set[str]) -> dict[str, Any]:
    ports = [effect['port'] for effect in report['effects']]
    return {
        'verdict': report['verdict'],
        'names': [effect['name'] for effect in report['effects']],
        'parameters': {
            f'{effect["name"]}.{name}': fitted['value'] for effect in report['effects']
            for name, fitted in effect['parameters'].items()
        },
        'right': set(ports[:1]) == right,
        'alone': set(ports) == right,
        'stiffness': (report['corrected']['stiffness'] or {}).get('value'),
    }
