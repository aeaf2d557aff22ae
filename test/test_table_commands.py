# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Commands read and write tables without loss, and say what they read of them."""

import os
from pathlib import Path

import contact_estimation as ce
from contact_estimation.commands import convert as convert_module, replay as replay_module
from contact_estimation.plant.simulation import simulate_experiment, write_simulation
import numpy as np
import pytest
from run_commands import Command


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a simulated recording of two touches."""
    path = tmp_path_factory.mktemp('tables') / 'run.mcap'
    simulation = simulate_experiment(ce.PlantParameters(), ce.experiment_named('sine'))
    write_simulation(path, simulation, 'x', 'contact_x', 'tool')
    return path


@pytest.fixture
def replay(capfd: pytest.CaptureFixture[str]) -> Command:
    return Command('replay', replay_module.main, capfd)


@pytest.fixture
def convert(capfd: pytest.CaptureFixture[str]) -> Command:
    return Command('convert', convert_module.main, capfd)


def test_cells_without_a_number_are_reported(tmp_path: Path, convert: Command) -> None:
    (tmp_path / 'a.csv').write_text('t_ms,F,x\n0,1,1\n1,over,1\n2,1,NA\n')
    said = convert(tmp_path / 'a.csv', tmp_path / 'b.mcap').out
    assert "F (1 cells hold no number, the first 'over') joint.x=x\n" in said


def test_rows_that_are_written_twice_count_once(
    recording: Path, tmp_path: Path, replay: Command, convert: Command
) -> None:
    once, twice = tmp_path / 'a.csv', tmp_path / 'b.csv'
    assert convert(recording, once).code == 0
    names, *rows = once.read_text().splitlines()
    twice.write_text('\n'.join([names, *(row for row in rows for _ in '12')]))
    estimates = []
    for path in (once, twice):
        done = replay(path, '--csv', path.with_suffix('.estimates'))
        estimates.append(path.with_suffix('.estimates').read_bytes())
    assert estimates[0] == estimates[1]
    assert f't=t_ns ({len(rows)} rows are copies of others' in done.out


def test_full_disk_names_the_file(recording: Path, replay: Command) -> None:
    if not os.path.exists('/dev/full'):
        pytest.skip('no /dev/full here')
    for option in ('--csv', '--json'):
        refused = replay.refusal(recording, option, '/dev/full')
        assert 'No space left on device: /dev/full' in refused


def test_a_wrong_sign_is_told_and_changed_by_its_column(
    recording: Path, tmp_path: Path, replay: Command
) -> None:
    signals = ce.read_table(recording)
    rows = np.column_stack([signals['t'], -signals['wrench.force.x'], signals['joint.contact_x']])
    np.savetxt(tmp_path / 'a.csv', rows, delimiter=',', header='t,F,x', comments='')
    refused = replay(tmp_path / 'a.csv')
    assert refused.code and 'a minus changes a sign: --columns wrench.force.x=-' in refused.err
    assert refused.err.count('set force_sign') == 1
    (tmp_path / 'a.yaml').write_text(
        'estimator_node: {ros__parameters: {environment: {location: .nan}}}')
    said = replay(tmp_path / 'a.csv', '--params', tmp_path / 'a.yaml').err
    assert 'force_sign' in said and 'tare' not in said  # an unseen contact is no offset
    assert not replay(tmp_path / 'a.csv', '--columns', 'wrench.force.x=-F').code


def test_columns_and_units_need_a_table(recording: Path, tmp_path: Path, replay: Command) -> None:
    for option in (('--columns', 't=time'), ('--units', 'mm')):
        said = replay.refusal(recording, *option)
        assert f'{option[0]} is for tables' in said
    with pytest.raises(ce.ContactEstimationError, match='--units is for tables'):
        ce.read_table(recording, units=('mm',))


@pytest.mark.slow
def test_bag_to_csv_to_bag_gives_the_same_estimates(
    recording: Path, tmp_path: Path, replay: Command, convert: Command
) -> None:
    as_csv, copy = tmp_path / 'a.csv', tmp_path / 'b.mcap'
    for paths in ((recording, as_csv), (as_csv, copy)):
        assert convert(*paths).code == 0
    written = []
    for number, path in enumerate((recording, as_csv, copy)):
        estimates = tmp_path / f'{number}.estimates'
        assert replay(path, '--csv', estimates).code == 0
        written.append(estimates.read_bytes())
    assert written[0] == written[1] == written[2]
    said = replay(as_csv).out.splitlines()[0]
    assert said.startswith('columns: ') and said.endswith(' t=t_ns')
