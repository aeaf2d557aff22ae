# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Tables are read as recordings: columns by name or chosen, in SI units."""

from datetime import time
from decimal import Decimal
from pathlib import Path
from typing import Any
from unittest import mock

import contact_estimation as ce
from contact_estimation.recordings.columns import signals_of_columns
from contact_estimation.recordings.table_file import read_columns
import numpy as np
import pytest
from scipy.io import savemat

ROWS = '0.0,1.5,0.1\n0.1,2.5,0.2\n'


def read(folder: Path, text: str, **options: Any) -> dict[str, Any]:
    """Write a text as CSV and read it."""
    (folder / 'a.csv').write_text(text)
    return ce.read_table(folder / 'a.csv', **options)


@pytest.mark.parametrize('header, keys', [
    ('t,Fz,z', 'wrench.force.z joint.z'),
    ('timestamp,actual_TCP_force_2,actual_q_5', 'wrench.force.z joint.q5'),
    ('time,O_F_ext_hat_K[2],O_T_EE[14]', 'wrench.force.z joint.z'),
    ('time,K_F_ext_hat_K[1],q[0]', 'wrench.force.y joint.q0'),
    ('__time,/ft/wrench/force/x,/joint_states/slide/position', 'wrench.force.x joint.slide'),
    ('Time (s),Load (N),Extension (m)', 'wrench.force.x joint.x'),
    ('Time measurement (s),Primary load measurement (N),Extension (m)', 'wrench.force.x joint.x'),
    ('t,F,x', 'wrench.force.x joint.x'),
    ('t,force_y,current_pos_z', 'wrench.force.y joint.z'),
    ('t,force_y,joint_1', 'wrench.force.y joint.q1'),
    ('Running Time,250 kN MTS Force,250 kN MTS Displacement', 'wrench.force.x joint.x'),
    ('t,wrench.force.y,joint.left', 'wrench.force.y joint.left'),
    ('time,tau_J[0],q[0]', 'joint.q0.effort joint.q0'),
    ('t,wrench_sensor_2,current_joint_0', 'wrench.force.z joint.q0'),
    ('log.t,log.Fz,log.z', 'wrench.force.z joint.z'),
    ('rosbagTimestamp,forceZ,posZ', 'wrench.force.z joint.z'),
])
def test_columns_are_found_by_the_names_of_common_logs(
    tmp_path: Path, header: str, keys: str
) -> None:
    (tmp_path / 'a.csv').write_text(f'{header}\n{ROWS}')
    columns = read_columns(tmp_path / 'a.csv')
    stamp_ns, signals = signals_of_columns(columns, {}, (), 'a.csv')
    force, joint = keys.split()
    assert stamp_ns.tolist() == [0, 100_000_000]
    assert set(signals) == {force, joint}
    assert signals[joint].tolist() == [0.1, 0.2]


@pytest.mark.parametrize('text', [
    't;F;x\n0,0;1,5;0,1\n0,1;2,5;0,2\n',
    '% t F x\n0.0 1.5 0.1\n0.1 2.5 0.2\n',
    'Test,7\nTime,Force,Position\ns,N,m\n' + ROWS,
    '"t"\t"F"\t"x"\n' + ROWS.replace(',', '\t'),
    '\ufefft_ms,F [kN],x (mm)\r\n0,0.0015,100\r\n100,0.0025,200\r\n',
    't,note,F,x\n0.0,begin,1.5,0.1\n0.1,,2.5,0.2\n',
    't|F|x\n# begin\n0.0|1.5|0.1\n0.1|2.5|0.2\n',
    't,F,x\n"0,000","1,500","0,100"\n"0,100","2,500","0,200"\n',
    't / s,F in N,"x, mm"\n0.0,1.5,100\n0.1,2.5,200\n',
    'Test;7;mm\n\nt;F;x;strain\n(s);(N);(m);(mm/mm)\n0,0;1,5;0,1;0\n0,1;2,5;0,2;0\n',
    't,F,x\n0.0,1.5D0,0.1e0\n0.1,2.5D+0,0.2\n',
    'time,F,x\n2026-01-31T12:00:00.0Z,1.5,0.1\n2026-01-31T12:00:00.1Z,2.5,0.2\n',
    'date,time,F,x\n1/31/2026,23:59:58.0,1.5,0.1\n1/31/2026,23:59:58.1,2.5,0.2\n',
    'time,F,x\n01/31/2026 23:59:58.0,1.5,0.1\n01/31/2026 23:59:58.1,2.5,0.2\n',
    'time;F;x\n31.1.2026 23:59:59,9;1,5;0,1\n1.2.2026 00:00:00,0;2,5;0,2\n',
    'time,F,x\n23:59:58:000,1.5,0.1\n23:59:58:100,2.5,0.2\n',
    'time,F,x\n1/31/2026 11:59:59.9 AM,1.5,0.1\n1/31/2026 12:00:00.0 PM,2.5,0.2\n',
    'time,F,x\n59:59.9,1.5,0.1\n00:00.0,2.5,0.2\n',
    'header.stamp.sec,header.stamp.nanosec,F,x\n9,950000000,1.5,0.1\n10,50000000,2.5,0.2\n',
    'timestamp,F,x\n1700000000000,1.5,0.1\n1700000000100,2.5,0.2\n',
    'timestamp,F,x\n1700000000000000,1.5,0.1\n1700000000100000,2.5,0.2\n',
    't,F,x\n0.0,1.5,0.1\n0.1,2.5,0.2\n1e300,1,1\ninf,1,1\n,1,1\n',
    't,F,x\n0.0,1.5,0.1,\n0.1,2.5,0.2,\n',
    't,wrench,pose\n,force_x,x\n0.0,1.5,0.1\n0.1,2.5,0.2\n',
    ',Force,,Position,\ntime,x,y,x,y\n0.0,1.5,0,0.1,0\n0.1,2.5,0,0.2,0\n',
    't,F,x,x\n0.0,1.5,0.1,0.1\n0.1,2.5,0.2,0.2\n',
    '%time,field.wrench.force.x,field.pose.position.x\n'
    '1700000000000000000,1.5,0.1\n1700000000100000000,2.5,0.2\n',
    't,skin,force,tcp\n0.0,"[[1 2]\n [3 4]]","[1.5, 0.0, 0.0]","(0.1, 0.0)"\n'
    '0.1,"[[1 2]\n [3 4]]","[2.5, 0.0, 0.0]","(0.2, 0.0)"\n'])
@pytest.mark.parametrize('encoding', ['utf-8', 'utf-16', 'utf-16-le', 'utf-16-be'])
def test_text_of_any_habit_is_read(tmp_path: Path, text: str, encoding: str) -> None:
    (tmp_path / 'a.csv').write_text(text, encoding=encoding)
    found = ce.read_table(tmp_path / 'a.csv')
    np.testing.assert_allclose(found['t'], [0.0, 0.1], atol=3e-7)  # of dates
    np.testing.assert_allclose(found['wrench.force.x'], [1.5, 2.5])
    np.testing.assert_allclose(found['joint.x'], [0.1, 0.2])


@pytest.mark.parametrize('text', [
    't,F,x\n"0.0","1,500.5","0.1"\n"0.1","1,000","0.2"\n',
    't;F;x\n0,0;1.500,5;0,1\n0,1;1000;0,2\n', 't F x\n0.0 1,500.5 0.1\n0.1 1000 0.2\n'])
def test_thousands_may_be_separated(tmp_path: Path, text: str) -> None:
    assert read(tmp_path, text)['wrench.force.x'].tolist() == [1500.5, 1000.0]


@pytest.mark.parametrize('number, value', [
    ('\u22121,5', -1.5), ('1 500,25', 1500.25), ('1.500,25', 1500.25), ("1'500", 1500.0)])
def test_numbers_of_typesetters_are_read(tmp_path: Path, number: str, value: float) -> None:
    found = read(tmp_path, f't;F;x\n0,0;{number};0,1\n0,1;0,5;0,2\n')
    assert found['wrench.force.x'].tolist() == [value, 0.5]


@pytest.mark.parametrize('header, units', [
    ('t [s],Fz [nN],z [nm],Tz [Nm]', ()), ('t,Fz,z,Tz [nm]', ('nN', 'nm'))])
def test_case_tells_a_nanometre_from_a_newton_metre(
    tmp_path: Path, header: str, units: tuple[str, ...]
) -> None:
    found = read(tmp_path, f'{header}\n0,1,5,3\n0.1,2,6,4\n', units=units)
    np.testing.assert_allclose(found['wrench.force.z'], [1e-9, 2e-9])
    np.testing.assert_allclose(found['joint.z'], [5e-9, 6e-9])
    np.testing.assert_allclose(found['wrench.torque.z'], [3.0, 4.0])


def test_decimal_comma_may_come_late(tmp_path: Path) -> None:
    rows = ''.join(f'{k};0;0\n' for k in range(300))
    assert read(tmp_path, f't_ms;F;x\n{rows}300;-0,125;0,5\n')['wrench.force.x'][-1] == -0.125


@pytest.mark.parametrize('names, units', [
    ('Ch 1 Displacement \tCh 1 Force \tCh 2 Torque \tRunning Time ', 'mm\tkN\tkN·mm\tsec'),
    ('Crosshead\tLoad\t_Cycle\tTime', 'mm\tkN\t_Cycle\tsec'),
    ('Disp \tLoad \t \tElapsed Time ', 'mm    \tkN\t-5.86\tSec  '),  # a value beside them
])
def test_units_of_testing_machines_count(tmp_path: Path, names: str, units: str) -> None:
    (tmp_path / 'a.txt').write_text(
        f'File Path: a\n\n{names}\n{units}\n2.0\t0.003\t1\t0.1\n2.5\t0.004\t1\t0.2\n')
    signals = ce.read_table(tmp_path / 'a.txt')
    assert signals['joint.x'].tolist() == [0.002, 0.0025]
    assert signals['wrench.force.x'].tolist() == [3.0, 4.0]


FORCE, X = 'wrench.force.x', 'joint.x'


@pytest.mark.parametrize('text, options, expected', [
    ('Time,Extension,Load,,10 mm/min\n(s),(mm),(N),,20 N preload\n0.0,1.0,2.0,,\n0.1,2.0,3.0,,\n',
     {}, {X: [1e-3, 2e-3], FORCE: [2.0, 3.0]}),
    ('Millis,Travel (mm),Force raw,Scale (grams)\n100,1.0,7,500\n133,2.0,8,1000\n',
     {'columns': {FORCE: '-4'}},
     {'t_ns': [100_000_000, 133_000_000], X: [1e-3, 2e-3], FORCE: [-4.903325, -9.80665]}),
    ('Clock,Way,Push\n(s),(mm),(N)\n0.0,1.0,2.0\n0.1,2.0,3.0\n',
     {'columns': {'t': 'Clock', X: '-Way', FORCE: 'Push [N]'}},
     {X: [-1e-3, -2e-3], FORCE: [2.0, 3.0]}),
    ('u,v,w\n1,-2,3\n1,-4,5\n',
     {'units': ('mm', 'kN'), 'columns': {'t': '500Hz', FORCE: 'v', X: '-w'}},
     {'t_ns': [0, 2_000_000], FORCE: [-2000.0, -4000.0], X: [-0.003, -0.005]}),
    ('t,F,x (\xb5m)\n0,1,5\n0.1,2,6\n', {}, {X: [5e-6, 6e-6]}),
    ('time,F,x\n23:59:59.9,1,0\n00:00:00.0,1,0\n00:00:00.1,1,0\n', {}, {'t': [0.0, 0.1, 0.2]}),
    ('t,F,x\n0.0,1\n0.1,1,2,late\n0.2,1,3\n0.3,1,4\n', {}, {X: [np.nan, 2.0, 3.0, 4.0]}),
], ids=['units beside a remark', 'scale and counter', 'chosen without unit', 'chosen with rate',
        'old code page', 'past midnight', 'rows of another length'])
def test_units_and_choices_count(
    tmp_path: Path, text: str, options: dict[str, Any], expected: dict[str, Any]
) -> None:
    (tmp_path / 'a.csv').write_text(text, encoding='latin-1')
    found = ce.read_table(tmp_path / 'a.csv', **options)
    found['t'] = found['t'] - found['t'][0]
    for name, values in expected.items():
        np.testing.assert_allclose(found[name], values, atol=1e-9, err_msg=name)


def test_settings_of_a_machine_are_no_names_and_a_chosen_column_no_other_signal(
    tmp_path: Path
) -> None:
    (tmp_path / 'a.csv').write_text(
        f'UNIT = gf,mm,s\nRATE = 0.0005,,\n1ST FORCE = ---,---,---\n{ROWS}')
    (tmp_path / 'b.csv').write_text(f't,load,x\n{ROWS}')
    assert list(read_columns(tmp_path / 'a.csv')) == ['1', '2', '3']
    _, found = signals_of_columns(
        read_columns(tmp_path / 'b.csv'), {'wrench.force.z': '-load'}, (), 'b.csv')
    assert set(found) == {'wrench.force.z', 'joint.x'}


def test_a_column_in_another_unit_is_another_signal(tmp_path: Path) -> None:
    text = 't,Force (V),Force (kN),x\n0.0,7,1,0\n0.1,7,2,1\n'
    (tmp_path / 'a.csv').write_text(text)
    assert ce.read_table(tmp_path / 'a.csv')['wrench.force.x'].tolist() == [1e3, 2e3]
    chosen = {'wrench.force.x': 'Force (V)'}
    with pytest.raises(ce.ContactEstimationError, match=r"in a unit of wrench.force.x.* got 'V'"):
        ce.read_table(tmp_path / 'a.csv', columns=chosen)
    known = ce.read_table(tmp_path / 'a.csv', columns=chosen, units=('N',))
    assert known['wrench.force.x'].tolist() == [7.0, 7.0]


def test_text_of_any_ending_is_a_table(tmp_path: Path) -> None:
    (tmp_path / 'run.tab').write_text(
        'gel\tgel\tgel\t\nForce\tDistance\tTime\t\ng\tmm\tsec\t\n\t\n1\t2\t0\t\n3\t4\t.1\t\n')
    signals = ce.read_table(tmp_path / 'run.tab')
    np.testing.assert_allclose(signals['wrench.force.x'], [9.80665e-3, 3 * 9.80665e-3])
    np.testing.assert_allclose(signals['joint.x'], [2e-3, 4e-3])
    (tmp_path / 'run.png').write_bytes(b'\x89PNG\r\n\x1a\n\0\0')
    with pytest.raises(ce.ContactEstimationError, match='is no MCAP file'):
        ce.read_table(tmp_path / 'run.png')


def test_parquet_and_mat_hold_the_same_table(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip('pyarrow')
    from pyarrow import parquet

    columns = {'t': [0.0, 0.1, 0.2], 'Fz': [1.0, 2.0, 3.0], 'z': [0.1, 0.2, 0.3]}
    parquet.write_table(pyarrow.table(columns), tmp_path / 'a.parquet')
    savemat(tmp_path / 'a.mat', {'log': columns, 'gain': 3.0})
    first = ce.read_table(tmp_path / 'a.parquet')
    second = ce.read_table(tmp_path / 'a.mat')
    np.testing.assert_equal(first, second)


def test_structs_of_matlab_are_numbered(tmp_path: Path) -> None:
    trials = np.array([(np.arange(3.0), 1.0 * np.arange(3)), (np.arange(3.0), 2.0 * np.arange(3))],
                      [('t', object), ('Fz', object)])
    savemat(tmp_path / 'a.mat', {'trial': trials, 'note': 'two'})
    found = read_columns(tmp_path / 'a.mat')
    assert list(found) == ['trial(1).t', 'trial(1).Fz', 'trial(2).t', 'trial(2).Fz']
    assert found['trial(2).Fz'].tolist() == [0.0, 2.0, 4.0]
    assert found.left_out == ['note']


def test_decimals_durations_and_times_of_parquet_are_numbers(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip('pyarrow')
    from pyarrow import parquet

    half = [Decimal('0.50'), Decimal('-1.25')]
    parquet.write_table(pyarrow.table({
        't': pyarrow.array([0, 2000], pyarrow.duration('us')), 'Fz': half, 'z': [0.1, 0.2],
        'clock': [time(0, 0, 1), time(0, 0, 2)]}), tmp_path / 'a.parquet')
    found = read_columns(tmp_path / 'a.parquet')
    assert found['clock_ns'].tolist() == [10**9, 2 * 10**9]
    signals = ce.read_table(tmp_path / 'a.parquet', columns={'t': 't_ns'})
    assert signals['t'].tolist() == [0.0, 0.002]
    assert signals['wrench.force.z'].tolist() == [0.5, -1.25]


def test_objects_of_matlab_are_named(tmp_path: Path) -> None:
    savemat(tmp_path / 'a.mat', {'log': [1.0]})  # scipy writes no objects
    with mock.patch('scipy.io.whosmat', side_effect=TypeError), pytest.raises(
            ce.ContactEstimationError, match='an object of a class, which only MATLAB'):
        read_columns(tmp_path / 'a.mat')


def test_parquet_without_rows_is_named_and_texts_are_not_expanded(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip('pyarrow')
    from pyarrow import parquet

    columns = {'t': [0.0, 0.1], 'pose': [{'z': 1.0}, {'z': 2.0}], 'note': ['x', 'y'],
               'skin': [[1.0], [2.0, 3.0]], 'Fz': np.array([1.0, 2.0], 'f2')}
    parquet.write_table(pyarrow.table(columns), tmp_path / 'a.parquet')
    parquet.write_table(pyarrow.table({'t': pyarrow.array([], 'f8')}), tmp_path / 'b.parquet')
    with pytest.raises(ce.ContactEstimationError, match='must have rows of numbers, got none'):
        read_columns(tmp_path / 'b.parquet')
    file = parquet.ParquetFile
    with mock.patch.object(file, 'read', autospec=True, side_effect=file.read) as read:
        found = read_columns(tmp_path / 'a.parquet')
    assert str(found).startswith("'t', 'pose.z', 'Fz' (not 'note', 'skin.list.element': texts")
    assert read.call_args.kwargs == {'columns': ['t', 'pose.z', 'Fz']}


@pytest.mark.parametrize('header, options, text', [
    ('t,a,b', {}, "no column for wrench.force.x .* columns: 't', 'a', 'b'; .*force.x=-COLUMN"),
    ('t,push,z', {}, '--columns wrench.force.z=COLUMN'),
    ('a,Fz,z', {}, 't=500Hz'),
    ('t,O_F_ext_hat_K_2,K_F_ext_hat_K_2', {}, 'several columns of .* may be wrench.force.z'),
    ('t,F,x', {'units': ('parsec',)}, "--units must list units .* got 'parsec'"),
    ('t,F,x', {'columns': {'joint.x': 'y'}}, "joint.x=y: .*'t', 'F', 'x'"),
    ('t,F,x', {'columns': {'force': 'F'}}, "no signal 'force'; expected one of t, wrench"),
    ('t,F,x\n0,one,1\n1,two,1\n2,three,1', {}, "column 'F' .* must hold numbers, got 3 other"),
    ('t,F,x\n,1,1\nNA,1,2\ninf,1,2\n', {}, "column 't' holds no time: .* t=500Hz"),
    ('t,F,x\n0.0,nan,1\n0.1,nan,2\n', {}, "must hold finite numbers, .* 'F';")])
def test_table_that_is_not_understood_says_how_to_choose(
    tmp_path: Path, header: str, options: Any, text: str
) -> None:
    with pytest.raises(ce.ContactEstimationError, match=text):
        read(tmp_path, header if header.endswith('\n') else f'{header}\n{ROWS}', **options)


def test_time_without_a_unit_is_refused_where_seconds_cannot_be_meant(tmp_path: Path) -> None:
    (tmp_path / 'a.csv').write_text('t,F,x\n0,1,1\n5,2,1\n10,3,1\n')
    with pytest.raises(ce.ContactEstimationError, match="'t' .* rises by 5 a row: .*--units ms"):
        ce.read_table(tmp_path / 'a.csv')
    assert ce.read_table(tmp_path / 'a.csv', units=('ms',))['t'].tolist() == [0.0, 0.005, 0.01]
    assert ce.read_table(tmp_path / 'a.csv', units=('s',))['t'].tolist() == [0.0, 5.0, 10.0]


def test_columns_of_one_name_are_chosen_by_place(tmp_path: Path) -> None:
    (tmp_path / 'a.csv').write_text('t,F,x,x\n0.0,1,1,2\n0.1,1,3,4\n')
    with pytest.raises(ce.ContactEstimationError, match="may be joint.x: 'column 3: x', 'column"):
        ce.read_table(tmp_path / 'a.csv')
    found = ce.read_table(tmp_path / 'a.csv', columns={'joint.x': '-4'})
    assert found['joint.x'].tolist() == [-2.0, -4.0]
