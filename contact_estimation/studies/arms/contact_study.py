# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Tool, stiffness and damping that the library finds on an arm, against the simulation's truth."""

from __future__ import annotations

from contextlib import redirect_stdout
import io
import json
from math import nan
from pathlib import Path
from typing import Any, Mapping, NamedTuple

import numpy as np

from .arm_files import ArmFiles, tool_parameters
from .arm_models import TOOL_CENTRE, TOOL_MASS
from .arm_recording import FORCE_BIAS
from .simulation import Run, World
from ...commands.calibrate_tool import main as calibrate_tool
from ...estimators.estimate import Estimate, EstimateStatus
from ...exceptions import EstimationError
from ...pipeline.axes import Moment
from ...pipeline.replay import RecordingReplay
from ...recordings import RecordingReader
from ...recordings.source import RecordingSource

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
    warnings = tuple(one.warned.name for one in replay.session.checks.found_in_order())
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
