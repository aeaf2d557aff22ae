# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The command `loop`, and its summary."""

import json
from pathlib import Path
import re
import signal
from typing import Any, NamedTuple

from contact_estimation.commands import loop
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.encoding import jazzy_typestore
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.reference.experiment import register_sequence
from contact_estimation.reference.experiments import FORCE_EXCITATION
from contact_estimation.ros.loop_processes import configure, LoopConfiguration, write_parameters
from contact_estimation.ros.loop_run import missing_estimates, plot_run, RecordedRun, summarise
from layout_fields import CONFIG, of_foxglove, of_plotjuggler, RecordedFields
import numpy as np
import pytest
from ros_processes import Executable, Finished, run_executable, wait_until
from run_commands import Command

KEYS = [
    'estimator', 'law', 'stiffness', 'damping', 'stiffness_error_percent', 'damping_error_percent',
    'mean_force_n', 'desired_force_n', 'eq20_force_n', 'model_fit', 'model_fit_worst', 'rate_hz',
    'samples_sent', 'samples_lost', 'latency_ms', 'disturbed']
EXPERIMENT = """
start: -0.005
segments:
- {duration: 0.2, position: -0.005}
- {duration: 0.3, position: 0.02, force: 50.0, force_excitation: &sine
    {kind: sine, amplitude: 8.0, angular_frequency: 20.0}}
- {duration: 1.0, position: 0.02, force: 50.0, force_excitation: *sine}
- {duration: 0.5, position: -0.005}
"""


class Run(NamedTuple):
    """A finished loop."""

    folder: Path
    finished: Finished

    @property
    def summary(self) -> dict[str, Any]:
        """Read summary.json."""
        content: dict[str, Any] = json.loads((self.folder / 'summary.json').read_text())
        return content


def arguments(folder: Path, *more: str) -> list[str]:
    """Write the experiment; return the command line."""
    file = folder / 'touch.yaml'
    file.write_text(EXPERIMENT)
    return ['--output', str(folder / 'out'), '--experiment', str(file), *more]


@pytest.fixture(scope='module')
def whole(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp('loop')
    given = arguments(folder, '--duration', '2', '--seed', '4', '--lockstep')
    return Run(folder / 'out', run_executable(folder / 'log', 'loop', *given))


@pytest.mark.slow
def test_loop_succeeds_and_prints_its_estimates(whole: Run) -> None:
    assert (whole.finished.code, whole.finished.stderr) == (0, '')
    lines = whole.finished.stdout.splitlines()
    assert lines[0].startswith('multiple_model, law eq20: K_e 4')
    assert lines[2].startswith('1000 samples at ') and 'dropped, latency [ms]: p50 ' in lines[2]


@pytest.mark.slow
def test_summary_has_its_keys_and_estimates_near_the_truth_at_the_last_contact(whole: Run) -> None:
    summary = whole.summary
    assert list(summary) == KEYS and list(summary['latency_ms']) == ['p50', 'p99', 'max']
    assert summary['stiffness'] == pytest.approx(4800.0, rel=0.05)
    assert summary['stiffness_error_percent'] == pytest.approx(
        100.0 * (summary['stiffness'] / 4800.0 - 1.0))
    assert abs(summary['damping_error_percent']) < 15.0


@pytest.mark.slow
def test_loop_writes_recording_and_figure(whole: Run) -> None:
    assert {path.name for path in whole.folder.iterdir()} >= {
        'recording', 'summary.json', 'summary.png'
    }
    reader = RecordingReader(whole.folder / 'recording')
    assert not reader.truncated
    assert {
        '/wrench', '/joint_states', '/desired_trajectory', '/reference_trajectory',
        '/estimator_node/stiffness', '/estimator_node/damping', '/diagnostics',
    } <= set(reader.topics())
    assert 'estimator_node' in reader.metadata()


@pytest.mark.slow
def test_replay_of_the_loop_ends_at_the_estimates_of_the_summary(whole: Run) -> None:
    reader = RecordingReader(whole.folder / 'recording')
    assert len(list(reader.messages(['wrench']))) == whole.summary['samples_sent']
    assert whole.summary['samples_lost'] == 0  # in lockstep
    replay = RecordingReplay(reader, RecordingSource(), {})
    estimates = [estimate for batch in replay.estimates() for estimate, in batch]
    plant = json.loads((whole.folder / 'plant_summary.json').read_text())
    last = {e.stamp_ns: e for e in estimates}[plant['last_contact_stamp_ns']]
    assert (last.stiffness, last.damping) == (whole.summary['stiffness'], whole.summary['damping'])


@pytest.mark.slow
def test_layouts_read_topics_and_fields_that_the_loop_records(whole: Run) -> None:
    fields = RecordedFields(whole.folder / 'recording', jazzy_typestore())
    for name, read in (
        ('foxglove.json', of_foxglove((CONFIG / 'foxglove.json').read_text())),
        ('plotjuggler.xml',
         of_plotjuggler((CONFIG / 'plotjuggler.xml').read_text(), fields.topics)),
    ):
        assert len(read) > 9
        assert [pair for pair in sorted(read) if not fields.has(*pair)] == [], name
    assert not fields.has('/wrench', 'wrench.force.w') and not fields.has('/wrenches', '')


def grown(folder: Path) -> bool:
    """Tell whether the recording holds contact samples already."""
    return any(file.stat().st_size > 60_000 for file in folder.glob('out/recording/*.mcap'))


def assert_kept(folder: Path, finished: Finished, text: str) -> None:
    """Check that a disturbed loop has said so and kept its recording."""
    assert finished.code == 1
    assert 'Traceback' not in finished.stderr
    lines = finished.stderr.strip().splitlines()
    assert len(lines) == 1 and text in lines[0], finished.stderr
    reader = RecordingReader(folder / 'out' / 'recording')
    assert sum(1 for _ in reader.messages(['wrench'])) > 100


@pytest.mark.slow
def test_interrupt_leaves_a_readable_recording(tmp_path: Path) -> None:
    given = arguments(tmp_path, '--duration', '600')
    with Executable(tmp_path / 'log', 'loop', *given) as process:
        wait_until(lambda: grown(tmp_path), 'a recording')
        process.signal(signal.SIGINT)
        assert_kept(tmp_path, process.end(), 'interrupted')


WRONG = [
    (['--experiment', 'sinus'], "did you mean 'sine'"),
    (['--experiment', 'nowhere.yaml'], 'cannot be read'),
    (['--estimator', 'fft'], 'indirect_adaptive'),
    (['--duration', '-1'], '--duration must be > 0'),
    (['--duration', 'long'], '--duration'),
    (['--seed', '-1'], 'seed'),
    (['--params', 'nowhere.yaml'], 'nowhere.yaml'),
    (['--nonsense'], '--nonsense'),
]


@pytest.mark.parametrize('wrong, text', WRONG, ids=[' '.join(w[0]) for w in WRONG])
def test_wrong_option_is_refused_before_anything_is_made(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], wrong: list[str], text: str
) -> None:
    loop_command = Command('loop', loop.main, capfd)
    assert text in loop_command.refusal('--output', tmp_path / 'out', *wrong)
    assert not (tmp_path / 'out').exists()


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


@pytest.mark.parametrize('lost, heard, text', [
    (3, True, ''), (401, False, 'the estimator used no sample'),
    (3, False, 'each of 401 samples, of which the estimator answered 398; .*loop again')])
def test_run_without_estimates_is_no_success(lost: int, heard: bool, text: str) -> None:
    run = run_of(configure('sine'))
    run.plant['samples_lost'] = lost
    if not heard:
        run.series['stiffness'] = np.empty((0, 2))
    found = missing_estimates(run)
    assert re.search(text, found) if text else found == ''


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


def test_multisine_peak_is_its_amplitude() -> None:
    multisine = FORCE_EXCITATION['multisine']
    assert multisine is not None
    values = [abs(multisine.value(t)) for t in np.arange(0.0, 10.0, 1e-3).tolist()]
    assert max(values) == pytest.approx(8.0, rel=0.01)
