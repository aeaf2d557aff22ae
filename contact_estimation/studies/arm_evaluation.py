# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the library finds on an arm, against the truth: tool, wall, concealed effect; cost."""

from __future__ import annotations

from contextlib import redirect_stderr, redirect_stdout
import io
import json
from math import nan
from pathlib import Path
from statistics import median
import time
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np

from .arm_files import ArmFiles, FORCE_BIAS, tool_parameters, world_of
from .arm_models import TOOL_CENTRE, TOOL_MASS
from .arm_simulation import Run, World
from .speed_estimators import contact_data, filterpy_step
from ..commands.calibrate_tool import main as calibrate_tool
from ..commands.diagnose import main as diagnose
from ..estimators.estimate import Estimate, EstimateStatus
from ..exceptions import EstimationError
from ..kinematics.contact_kinematics import ArmSample
from ..parameters import build
from ..pipeline.arm_kinematics import kinematics_of
from ..pipeline.axes import Moment
from ..pipeline.parameters import EstimationParameters
from ..pipeline.replay import RecordingReplay
from ..recordings import RecordingReader
from ..recordings.source import RecordingSource

_TARE_S = 2.5  # in free flight, before the first touch
_CASES = (
    ('kalman', 'load and inertia'), ('kalman', 'load only'), ('kalman', 'tare only'),
    ('kalman', 'none'), ('rls_adaptive', 'load and inertia'), ('rls_adaptive', 'none'),
    ('rls', 'load and inertia'),
)
_LOAD = ('tool.mass', 'tool.centre', 'tool.force_bias', 'tool.torque_bias')


class Estimated(NamedTuple):
    """Estimates at the last instant at which they were updated."""

    estimator: str  # which one
    compensation: str  # what of the tool was taken out of the force
    # stiffness, stiffness_std, damping, damping_std, location: in [N/m], [N s/m] and [m]
    stiffness: float
    stiffness_std: float
    damping: float
    damping_std: float
    location: float
    # why they were not updated at the end of the last contact; '' where they were
    withheld: str = ''
    warnings: tuple[str, ...] = ()  # names of the on-line checks that warned


def calibrated(files: ArmFiles, seed: int) -> dict[str, Any]:
    """Calibrate the tool from 12 poses."""
    output, report = files.path(f'tool_{seed}.yaml'), files.path(f'tool_{seed}.json')
    with redirect_stdout(io.StringIO()):
        code = calibrate_tool([
            str(files.calibration(seed)), '--robot-description', str(files.description),
            '--output', str(output), '--json', str(report)])
    if code:
        raise EstimationError(f'calibrate_tool failed on {files.arm.name}, seed {seed}')
    found = json.loads(report.read_text())
    centre = np.subtract(found['centre_m']['value'], TOOL_CENTRE)
    bias = np.subtract(found['force_bias_n']['value'], FORCE_BIAS)
    return {
        'file': output.name, 'mass_error_g': 1e3 * (found['mass_kg']['value'] - TOOL_MASS),
        'mass_std_g': 1e3 * found['mass_kg']['std'],
        'centre_error_mm': 1e3 * float(np.abs(centre).max()),
        'centre_std_mm': 1e3 * max(found['centre_m']['std']),
        'bias_error_n': float(np.abs(bias).max()),
    }


def estimated(files: ArmFiles, run: Run, recording: Path, tool: Path) -> list[Estimated]:
    """Estimate with the tool compensated, and with less."""
    whole = tool_parameters(tool)
    load = {name: whole[name] for name in _LOAD}
    taken_out: dict[str, Mapping[str, Any]] = {
        'load and inertia': whole, 'load only': load, 'tare only': {}, 'none': {},
    }
    return [
        estimated_with(files, run, recording, estimator, name, taken_out[name])
        for estimator, name in _CASES
    ]


def estimated_with(
    files: ArmFiles, run: Run, recording: Path, estimator: str, name: str, tool: Mapping[str, Any]
) -> Estimated:
    """Estimate with one estimator and one compensation of the tool."""
    reader = RecordingReader(recording)
    chosen = {**files.parameters(run), **tool, 'estimator': estimator}
    replay = RecordingReplay(reader, RecordingSource(), chosen)
    if name.startswith('tare'):
        begin = reader.start_ns or 0
        replay.session.schedule(Moment(0, begin + round(_TARE_S * 1e9)), replay.session.tare)
    last: Estimate | None = None
    withheld = ''
    for axes in (each for batch in replay.estimates() for each in batch):
        if axes[0].status is EstimateStatus.ESTIMATING:
            last, withheld = axes[0], ''
        elif axes[0].status is EstimateStatus.FROZEN:
            withheld = axes[0].reason
    warnings = tuple(one.warned.name for one in replay.session.checks.ordered_warnings())
    if last is None:
        return Estimated(estimator, name, nan, nan, nan, nan, nan, withheld, warnings)
    return Estimated(estimator, name, last.stiffness, last.stiffness_std, last.damping,
                     last.damping_std, last.location, withheld, warnings)


def errors(row: Estimated, run: Run, world: World) -> dict[str, Any]:
    """
    Compare estimates with the truth.

    Returns errors: signed errors and standard deviations, in percent of the true value or in mm
    """
    return {
        'estimator': row.estimator, 'compensation': row.compensation,
        'stiffness_error_percent': 100.0 * (row.stiffness / world.K_e - 1.0),
        'stiffness_std_percent': 100.0 * row.stiffness_std / world.K_e,
        'damping_error_percent': 100.0 * (row.damping / world.B_e - 1.0),
        'damping_std_percent': 100.0 * row.damping_std / world.B_e,
        'location_error_mm': 1e3 * (row.location - run.location),
        'withheld': row.withheld, 'warnings': list(row.warnings),
    }


_BLOCK = 250  # samples, so that both see the same load of the machine
_BLOCKS = 12


def kinematics_cost(files: ArmFiles, run: Run, tool: Mapping[str, Any]) -> dict[str, float]:
    """
    Time the way from joints and wrench to x, v and F_e, without the load of the tool.

    Returns cost: `kinematics_us`: processor time a sample [us], median over blocks; `to_filterpy`:
    its ratio to predict and update of filterpy's Kalman filter, in turn with it
    """
    parameters = build(EstimationParameters, {**files.parameters(run), **tool})
    arm = kinematics_of(parameters, files.description.read_text())
    q_dot = [0.0] * run.q.shape[1]
    samples = [ArmSample(0, [*q, *q_dot], wrench) for q, wrench in zip(
        run.q[:_BLOCK].tolist(), run.wrench[:_BLOCK].tolist())]
    reference = filterpy_step(contact_data(_BLOCK * _BLOCKS / 500.0 + 1.0))
    own, others = [], []
    for block in range(_BLOCKS):
        own.append(_timed(lambda: [arm.contact(sample) for sample in samples]))
        begin = block * _BLOCK
        others.append(_timed(lambda: reference(begin, begin + _BLOCK)))
    return {'kinematics_us': median(own[1:]), 'to_filterpy': median(own[1:]) / median(others[1:])}


def _timed(work: Callable[[], object]) -> float:
    begin = time.process_time_ns()
    work()
    return (time.process_time_ns() - begin) * 1e-3 / _BLOCK


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
