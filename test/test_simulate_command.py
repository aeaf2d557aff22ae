# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The commands `simulate` and `python -m contact_estimation`."""

from pathlib import Path
from typing import Any

from contact_estimation.commands.demonstrate import CONCEALED, main as demonstrate, WORLD
from contact_estimation.commands.simulate import main
from contact_estimation.parameters import build
from contact_estimation.physics import effects_that_are_on
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.encoding import JointStateEncoder, WrenchEncoder
from contact_estimation.recordings.recorded_signals import read_signals, RecordedSignals
from contact_estimation.recordings.source import RecordingSource
import numpy as np
from numpy.typing import NDArray
import pytest
from reference_messages import write
from run_commands import Command
from scipy.signal import lsim
import yaml

Array = NDArray[np.float64]
ATTACHED = {'stiffness': 1200.0, 'damping': 12.0, 'inertia': 0.6, 'unilateral': False}
SHORT = {'start': -0.01, 'segments': [
    {'duration': 0.4, 'position': 0.008}, {'duration': 0.3, 'position': -0.01},
]}


@pytest.fixture
def command(capfd: pytest.CaptureFixture[str]) -> Command:
    return Command('simulate', main, capfd)


def model_file(folder: Path, **groups: Any) -> str:
    """Write a model file and return its path."""
    path = folder / f'model_{len(list(folder.glob("model_*")))}.yaml'
    path.write_text(yaml.safe_dump({'plant_node': {'ros__parameters': groups}}))
    return str(path)


def experiment_file(folder: Path) -> str:
    """Write an experiment that touches the wall once and return its path."""
    path = folder / 'short.yaml'
    path.write_text(yaml.safe_dump(SHORT))
    return str(path)


def signals_of(path: Path) -> RecordedSignals:
    """Read a recording of the default topics."""
    return read_signals(RecordingReader(path), RecordingSource())


def simulated(folder: Path, name: str, *args: str) -> RecordedSignals:
    """Run the command and read what it has written."""
    output = folder / name
    assert main([*args, '--output', str(output)]) == 0
    return signals_of(output)


def driven_recording(path: Path, force: Array, rate: float = 600.0) -> Array:
    """Record a force, with a position that rests; give the times."""
    t = np.arange(len(force)) / rate
    wrenches, joints = WrenchEncoder('sensor'), JointStateEncoder('', 'j', False)
    stamps = [round(1e9 * now) + 5_000_000_000 for now in t.tolist()]
    write(path, [message for stamp, value in zip(stamps, force.tolist()) for message in (
        ('/wrench', stamp, wrenches.encode(stamp, value, 0.0, 0.0)),
        ('/joint_states', stamp, joints.encode(stamp, 0.0, 0.0)))])
    return t


def test_experiment_is_played_to_its_end_and_touches_the_wall(tmp_path: Path) -> None:
    got = simulated(tmp_path, 'a.mcap', '--model', model_file(tmp_path, seed=1),
                    '--experiment', experiment_file(tmp_path))
    assert len(got.wrench) == len(got.joint_states) == len(got.reference_trajectory) == 351
    assert np.min(got.wrench.values) < -10.0
    np.testing.assert_allclose(got.reference_trajectory.values[0, [0, 200]], [-0.01, 0.008])


def test_simulating_like_a_simulation_repeats_it(tmp_path: Path) -> None:
    model = model_file(tmp_path, physics={'coulomb_friction': {'F_c': 6.0}})
    first = simulated(tmp_path, 'a.mcap', '--model', model,
                      '--experiment', experiment_file(tmp_path))
    again = simulated(tmp_path, 'b.mcap', '--model', model, '--like', str(tmp_path / 'a.mcap'))
    np.testing.assert_array_equal(first.wrench.stamp_ns, again.wrench.stamp_ns)
    np.testing.assert_allclose(first.wrench.values, again.wrench.values, atol=1e-9)
    np.testing.assert_allclose(first.joint_states.values, again.joint_states.values, atol=1e-12)


def test_seed_decides_the_noise_and_nothing_else(tmp_path: Path) -> None:
    model = model_file(tmp_path, sensors={'force_noise': 1.0})
    args = ('--model', model, '--experiment', experiment_file(tmp_path))
    one, same, other = (
        simulated(tmp_path, f'{k}.mcap', *args, '--seed', seed) for k, seed in enumerate('335'))
    np.testing.assert_array_equal(one.wrench.values, same.wrench.values)
    assert np.std(one.wrench.values - other.wrench.values) == pytest.approx(2**0.5, rel=0.1)
    np.testing.assert_array_equal(one.joint_states.values, other.joint_states.values)


def test_attached_wall_is_that_of_a_linear_system_driven_straight_between_samples(
    tmp_path: Path,
) -> None:
    force = np.cumsum(np.random.default_rng(2).standard_normal(900))
    force -= force[0]
    t = driven_recording(tmp_path / 'in.mcap', force)
    got = simulated(tmp_path, 'out.mcap', '--model', model_file(tmp_path, environment=ATTACHED),
                    '--like', str(tmp_path / 'in.mcap'))
    expected = lsim(([-1.0], [0.6, 12.0, 1200.0]), force, t)[1]
    np.testing.assert_allclose(got.joint_states.values[0], expected, atol=1e-8)
    np.testing.assert_array_equal(got.wrench.values[0], force)
    assert len(got.reference_trajectory) == 0
    assert got.frame_id == 'sensor'


@pytest.mark.parametrize('groups, text', [
    ({'environment': {'stifness': 1.0}}, "did you mean 'environment.stiffness'"),
    ({'physics': {'colomb_friction': {'F_c': 1.0}}},
     "did you mean 'physics.coulomb_friction.F_c'"),
    ({'physics': {'stribeck_friction': {'F_c': 1.0}}}, 'needs all of F_c, F_s, v_s'),
    ({'environment': {'stiffness': -1.0}}, '(environment.unilateral: false) may have less')])
def test_invalid_model_is_refused_with_a_hint(
    tmp_path: Path, command: Command, groups: dict[str, Any], text: str
) -> None:
    assert text in command.refusal('--model', model_file(tmp_path, **groups), '--experiment',
                                   'sine', '--output', tmp_path / 'a.mcap')
    assert not (tmp_path / 'a.mcap').exists()


def test_recording_without_reference_is_refused_for_a_unilateral_wall(
    tmp_path: Path, command: Command
) -> None:
    driven_recording(tmp_path / 'in.mcap', np.zeros(10))
    assert 'has no reference_trajectory' in command.refusal(
        '--model', model_file(tmp_path, seed=1), '--like', tmp_path / 'in.mcap', '--output',
        tmp_path / 'a.mcap')


def test_nothing_is_overwritten(tmp_path: Path, command: Command) -> None:
    (tmp_path / 'a.mcap').write_text('precious')
    assert 'never overwritten' in command.refusal(
        '--model', model_file(tmp_path, seed=1), '--experiment', 'sine', '--output',
        tmp_path / 'a.mcap')
    assert (tmp_path / 'a.mcap').read_text() == 'precious'


@pytest.mark.parametrize('concealed', CONCEALED)
def test_each_concealed_world_has_one_effect(concealed: dict[str, float]) -> None:
    plant = build(PlantParameters, {**WORLD, **concealed})
    assert len(effects_that_are_on(plant.physics)) == 1


def test_folder_that_is_not_empty_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / 'kept').write_text('')
    assert demonstrate(['--output', str(tmp_path)]) == 1
    assert 'not empty' in capsys.readouterr().err
