# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""Configuration, summary and figure of the loop, on a synthetic run."""

from __future__ import annotations

from pathlib import Path

from contact_estimation.parameters.file import read_parameter_file
from contact_estimation.ros.loop_configuration import (
    configure,
    LoopConfiguration,
    write_parameters,
)
from contact_estimation.ros.loop_figure import plot_run
from contact_estimation.ros.loop_run import RecordedRun
from contact_estimation.ros.loop_summary import gap_explained, summarise
import numpy as np
import pytest

T = 0.01 * np.arange(1200)


def series(values: float) -> np.ndarray:
    """Return a constant series."""
    return np.column_stack((T, np.full(len(T), values)))


def run_of(configuration: LoopConfiguration) -> RecordedRun:
    """Return a run whose estimates are 1 % and 10 % high until contact ends at 3 s."""
    wall = configuration.plant.environment
    estimates = {'stiffness': series(1.01 * wall.stiffness), 'damping': series(1.1 * wall.damping),
                 'stiffness_std': series(10.0), 'damping_std': series(2.0)}
    estimates['stiffness'][T > 3.0, 1] = 0.0
    signals = {'force': series(-25.0), 'position': series(0.02), 'reference': series(0.03),
               'desired': series(0.025), 'desired_force': series(50.0),
               'model_fit': np.array([[1.0, np.nan], [2.0, 7.0], [3.0, 1.5]])}
    plant = {'begin_stamp_ns': 10**9, 'last_contact_stamp_ns': 4 * 10**9, 'samples_sent': 401,
             'samples_lost': 3, 'rate_hz': 100.0, 'latency_ms': {'p50': 1.0}}
    return RecordedRun({**signals, **estimates}, plant)


def test_summary_takes_the_estimates_at_the_last_contact() -> None:
    configuration = configure('sine')
    summary = summarise(run_of(configuration), configuration)
    assert summary['stiffness_error_percent'] == pytest.approx(1.0)
    assert summary['damping_error_percent'] == pytest.approx(10.0)
    assert summary['mean_force_n'] == 25.0
    assert (summary['samples_sent'], summary['samples_lost']) == (401, 3)


@pytest.mark.parametrize('mean, law, explained', [
    (25.0, 25.5, True), (25.0, 30.0, False), (49.8, 49.8, False), (25.0, None, False),
])
def test_eq20_explains_a_gap_that_it_predicts(
    mean: float, law: float | None, explained: bool
) -> None:
    summary = {'mean_force_n': mean, 'desired_force_n': 50.0, 'eq20_force_n': law}
    assert gap_explained(summary) == explained


def test_figure_shows_signals_estimates_and_true_values() -> None:
    pytest.importorskip('matplotlib')
    configuration = configure('sine')
    figure = plot_run(run_of(configuration), 'a title', configuration.plant.environment)
    labels = [axis.get_ylabel() for axis in figure.axes]
    assert labels == ['pressing force [N]', 'position [mm]', 'K_e [N/m]', 'B_e [N s/m]']
    assert figure.axes[3].get_xlabel() == 'time [s]'
    shown = [[line.get_label() for line in axis.lines] for axis in figure.axes]
    assert shown[0] == ['-F_e measured', 'F_r desired']
    assert shown[1] == ['x_d desired', 'x_r reference', 'x measured']
    true, estimate = figure.axes[2].lines
    assert true.get_ydata()[0] == configuration.plant.environment.stiffness
    assert len(estimate.get_ydata()) == len(T)


def test_configuration_gives_the_estimator_the_robot_of_the_plant(tmp_path: Path) -> None:
    file = tmp_path / 'in.yaml'
    file.write_text('plant_node: {ros__parameters: {robot: {stiffness: 7000.0}}}')
    configuration = configure('sine', str(file), estimator='kalman', seed=3)
    write_parameters(tmp_path / 'out.yaml', configuration, tmp_path / 'recording',
                     tmp_path / 'plant.json')
    estimator = read_parameter_file(tmp_path / 'out.yaml', 'estimator_node')
    assert estimator['reference.robot_stiffness'] == 7000.0
    assert estimator['estimator'] == 'kalman'
    plant = read_parameter_file(tmp_path / 'out.yaml', 'plant_node')
    assert plant['seed'] == 3 and plant['summary_file'] == str(tmp_path / 'plant.json')
