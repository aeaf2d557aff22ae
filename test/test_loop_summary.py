# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Summary of the loop, and its excitation and experiments."""

from __future__ import annotations

from math import sin
from pathlib import Path

from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.reference.experiment import Multisine, register_sequence
from contact_estimation.reference.experiments import FORCE_EXCITATION
from contact_estimation.ros.loop_processes import configure, LoopConfiguration, write_parameters
from contact_estimation.ros.loop_run import plot_run, RecordedRun, summarise
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


def shift_register() -> list[int]:
    """Run ten bits of an integer, bit k - 1 is register k; feedback from 7 and 10."""
    state, bits = 0b1111111111, []
    for _ in range(2046):
        bits.append(state >> 9 & 1)
        state = (state << 1 | (state >> 6 ^ state >> 9) & 1) & 0b1111111111
    return bits


def test_register_is_that_of_integer_bit_operations() -> None:
    assert list(register_sequence()) == shift_register()[:1023]


def test_sine_is_that_of_the_paper() -> None:
    sine = FORCE_EXCITATION['sine']
    assert sine is not None
    assert all(sine.value(t) == pytest.approx(8.0 * sin(20.0 * t)) for t in (0.0, 0.1, 5.9))


def test_multisine_peak_is_its_amplitude() -> None:
    multisine = FORCE_EXCITATION['multisine']
    assert multisine is not None
    values = [abs(multisine.value(t)) for t in np.arange(0.0, 10.0, 1e-3).tolist()]
    assert max(values) == pytest.approx(8.0, rel=0.01)


def test_multisine_without_frequencies_is_refused() -> None:
    with pytest.raises(ParameterRangeError, match='at least one frequency'):
        Multisine(1.0, [])
