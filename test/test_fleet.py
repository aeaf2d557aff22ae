# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An archive: discovered, run, resumed, and its findings."""

from dataclasses import dataclass, field, replace
from itertools import combinations
from math import nan
import os
from pathlib import Path
from typing import Any, Callable, Iterator, Mapping

from contact_estimation.commands import fleet as command_module
from contact_estimation.estimators.estimate import Estimate, EstimateStatus
from contact_estimation.exceptions import ParameterRangeError, RecordingError
from contact_estimation.fleet.discovery import find_recordings, skipped_files
from contact_estimation.fleet.findings import changes, differences, trends
from contact_estimation.fleet.one_recording import Episodes, process, Result, Settings
from contact_estimation.fleet.page import as_html
from contact_estimation.fleet.run import Fleet, Pool, PooledResult, pools, run_fleet
from contact_estimation.fleet.table import as_parquet, COLUMNS, in_time, rows_of
from contact_estimation.plant.plant_parameters import PlantParameters, read_model
from contact_estimation.scheduling import Answer, Call
from diagnosed_worlds import BEGIN_NS, nominal, recorded, write_model, write_recording
from fleet_entries import archive, group_of, outcome, report
import numpy as np
import pytest
from run_commands import Command


@pytest.fixture
def robots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Fill the working directory with recordings of two robots."""
    for name in ('robot_a/run_9.mcap', 'robot_a/run_10.mcap', 'robot_b/bag/bag_0.mcap',
                 'robot_b/bag/metadata.yaml', 'robot_b/notes.txt', '.hidden/run.mcap'):
        file = tmp_path / 'archive' / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(*paths: str, group_by: str | None = None) -> list[str]:
    return [one.name for one in find_recordings(paths, group_by)]


def test_a_folder_stands_for_its_files_and_bags_in_natural_order(robots: Path) -> None:
    assert names('archive') == [
        'archive/robot_a/run_9.mcap', 'archive/robot_a/run_10.mcap', 'archive/robot_b/bag']


def test_patterns_and_files_are_found_once(robots: Path) -> None:
    assert names('archive/**/run_*', 'archive/robot_a/run_9.mcap') == [
        'archive/robot_a/run_9.mcap', 'archive/robot_a/run_10.mcap']


def test_groups_are_named_by_the_pattern(robots: Path) -> None:
    found = find_recordings(['archive'], '(robot_[a-z])/')
    assert [one.group for one in found] == ['robot_a', 'robot_a', 'robot_b']


@pytest.mark.parametrize('pattern, text', [
    ('(', 'must be a regular expression'), ('robot', 'must have a group in parentheses'),
    ('(robot_a)', 'must match every path, but not archive/robot_b/bag')])
def test_an_unusable_pattern_is_refused(robots: Path, pattern: str, text: str) -> None:
    with pytest.raises(ParameterRangeError, match=text):
        find_recordings(['archive'], pattern)


@pytest.mark.parametrize('path, text', [
    ('nowhere', 'nowhere does not exist'), ('archive/*.db3', 'no recording at'),
    ('empty', 'no recording at empty')])
def test_a_path_without_recordings_is_refused(robots: Path, path: str, text: str) -> None:
    (robots / 'empty').mkdir()
    with pytest.raises(RecordingError, match=text):
        find_recordings([path])


def test_key_depends_on_recording_model_options_and_version() -> None:
    given = Settings.of(PlantParameters())
    others = [Settings.of(PlantParameters(seed=1)), Settings.of(PlantParameters(), seed=1),
              Settings.of(PlantParameters(), version='0.0.0')]
    keys = {settings.key('recording', 'a') for settings in (given, *others)}
    assert len(keys | {given.key('recording', 'b')}) == 5
    assert Settings.of(PlantParameters()).key('recording', 'a') in keys


def test_tables_ros_1_bags_and_pipes_of_a_folder_are_told_and_tables_read_where_named(
    tmp_path: Path
) -> None:
    for name in ('a.mcap', 'b.csv', 'c.bag', 'notes.md'):
        (tmp_path / name).write_bytes(b'')
    os.mkfifo(tmp_path / 'live.mcap')
    assert [Path(one.name).name for one in find_recordings([str(tmp_path)])] == ['a.mcap']
    assert [Path(one).name for one in skipped_files([str(tmp_path)])] == [
        'b.csv', 'c.bag', 'live.mcap']
    named = find_recordings([str(tmp_path / '*')])
    assert [Path(one.name).name for one in named] == ['a.mcap', 'b.csv']


RNG = np.random.default_rng(1)
STEADY = [report(value) for value in RNG.normal(4800.0, 5.0, 20)]
WORN = [report(4800.0 * 0.998**k + noise) for k, noise in enumerate(RNG.normal(0.0, 5.0, 20))]
FRICTION = [report(4800.0, ['coulomb_friction'] if k >= 12 else []) for k in range(20)]


def test_trend_is_the_median_of_all_slopes_in_pairs() -> None:
    trend = next(one for one in trends(archive(b=WORN)) if one.quantity == 'stiffness')
    points = list(zip(trend.numbers.tolist(), trend.values.tolist()))
    slopes = [(y2 - y1) / (x2 - x1) for (x1, y1), (x2, y2) in combinations(points, 2)]
    assert trend.slope == pytest.approx(np.median(slopes))
    assert trend.per_day == pytest.approx(trend.slope)  # a recording a day


def test_only_wear_is_a_significant_trend() -> None:
    found = trends(archive(a=STEADY, b=WORN))
    assert [(one.group, one.quantity) for one in found if one.significant] == [('b', 'stiffness')]
    wear = next(one for one in found if one.significant)
    assert wear.percent(wear.low) < -0.2 < wear.percent(wear.high) < 0.0


def test_change_is_found_at_the_first_recording_with_the_name() -> None:
    change, = changes(archive(a=STEADY, c=FRICTION))
    assert (change.group, change.family, change.number) == ('c', 'friction', 13)
    assert change.entry.name == 'c/run_12.mcap'
    assert (change.before, change.after) == ((0, 12), (8, 8))
    assert change.earliest == change.latest == 13


def test_only_the_group_that_is_different_differs() -> None:
    softer = [report(value) for value in RNG.normal(4700.0, 5.0, 20)]
    entries = archive(a=STEADY, b=STEADY[::-1], c=softer, d=FRICTION)
    found = [(one.group, one.what) for one in differences(entries)]
    assert found == [('c', 'stiffness'), ('d', 'friction')]


def test_copies_count_once_in_pools_changes_trends_and_differences() -> None:
    worn = group_of('a', [report(4800.0 - 60.0 * k, ['coulomb_friction'] * (k > 2))
                          for k in range(5)])
    copies = [replace(entry, name=f'{entry.name}_{n}') for entry in worn for n in range(4)]
    entries = in_time([*copies, *group_of('b', [report()] * 3)])
    assert [len(pool.members) for pool in pools(entries, [], 10)] == [5, 3]
    assert not changes(entries) and not differences(entries)
    assert all(np.isnan(trend.slope) and len(trend.values) < 6 for trend in trends(entries))


SETTINGS = Settings.of(nominal())


@dataclass
class InThisProcess:
    """Workers that run calls here, last call first, and may stop early as if killed."""

    stop_after: int = 10**6
    done: list[str] = field(default_factory=list)

    def answers(self, calls: Mapping[str, Call]) -> Iterator[tuple[str, Answer]]:
        for key, call in reversed(list(calls.items())):
            if len(call.arguments) > 1:  # not a hash
                if len(self.done) == self.stop_after:
                    raise KeyboardInterrupt
                self.done.append(key)
            try:
                yield key, Answer(call.function(*call.arguments), None)
            except ValueError as error:
                yield key, Answer(None, error)


@pytest.fixture(scope='module')
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write two good recordings, a copy, and a broken one."""
    folder = tmp_path_factory.mktemp('archive')
    write_recording(folder / 'run_1.mcap', recorded())
    write_recording(folder / 'run_2.mcap', recorded(physics__coulomb_friction__F_c=2.0))
    (folder / 'run_3.mcap').write_bytes((folder / 'run_1.mcap').read_bytes())
    (folder / 'run_4.mcap').write_bytes(b'')
    return folder


def run(recordings: Path, folder: Path, workers: InThisProcess) -> Fleet:
    found = find_recordings([str(recordings)])
    return run_fleet(found, SETTINGS, workers, folder, most_pooled=0, with_pages=False,
                     progress=lambda fraction, text: None)


@pytest.fixture(scope='module')
def whole(recordings: Path, tmp_path_factory: pytest.TempPathFactory) -> Fleet:
    return run(recordings, tmp_path_factory.mktemp('whole'), InThisProcess())


@pytest.mark.slow
def test_rows_hold_verdict_names_estimates_and_origin(whole: Fleet) -> None:
    rows = [row for entry in whole.entries for row in rows_of(entry, SETTINGS.model_sha256)]
    rubbing = [row for row in rows if row['recording'].endswith('run_2.mcap')]
    assert [row['episode'] for row in rubbing] == [1, 2]
    for row in rubbing:
        assert (row['verdict'], row['families']) == ('physics_missing', ['friction'])
        assert row['corrected_stiffness'] == pytest.approx(5000.0, rel=0.01)
        assert row['start'] == BEGIN_NS and row['error'] == ''
        assert set(row) <= {column.name for column in COLUMNS}


@pytest.mark.slow
def test_a_broken_recording_is_a_row_with_its_error(whole: Fleet) -> None:
    broken = whole.entries[-1]
    row, = rows_of(broken, SETTINGS.model_sha256)
    assert (row['episode'], row['start']) == (0, None)
    assert row['error'].startswith('recording run_4.mcap is empty')
    assert whole.failed == [broken]


@pytest.fixture
def quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the work on a recording by a result made up from its size."""
    def pretend(path: str, *arguments: object) -> Result:
        return Result(outcome(report(4800.0 + Path(path).stat().st_size)), '')

    monkeypatch.setattr('contact_estimation.fleet.run.process', pretend)


def test_equal_recordings_are_diagnosed_once(
    recordings: Path, tmp_path: Path, quickly: None
) -> None:
    workers = InThisProcess()
    assert len(run(recordings, tmp_path, workers).entries) == 4
    assert len(workers.done) == 3


def test_an_interrupted_run_resumes_to_the_same_table(
    recordings: Path, tmp_path: Path, quickly: None
) -> None:
    pytest.importorskip('pyarrow')
    first, second = InThisProcess(stop_after=2), InThisProcess()
    with pytest.raises(KeyboardInterrupt):
        run(recordings, tmp_path / 'a', first)
    fleets = [run(recordings, tmp_path / 'a', second),
              run(recordings, tmp_path / 'b', InThisProcess())]
    assert (len(first.done), len(second.done)) == (2, 1)
    assert not set(first.done) & set(second.done)
    assert len({as_parquet(fleet.entries, 'model') for fleet in fleets}) == 1


@pytest.mark.parametrize('change', [
    lambda text: text[:40], lambda text: '', lambda text: '[1, 2]', lambda text: '{"a": 1}',
    lambda text: text.replace('48', '49'), lambda text: text.replace('null', '[]')])
def test_a_damaged_result_is_named_and_made_again(
    change: Callable[[str], str], recordings: Path, tmp_path: Path, quickly: None
) -> None:
    before = run(recordings, tmp_path, InThisProcess())
    file = max((tmp_path / 'finished').iterdir(), key=lambda file: file.stat().st_size)
    file.write_text(change(file.read_text()))
    workers = InThisProcess()
    after = run(recordings, tmp_path, workers)
    assert (after.entries, workers.done) == (before.entries, [file.stem])
    assert (before.damaged, after.damaged) == ([], [file.name])


def test_table_has_explicit_types_and_units() -> None:
    parquet = pytest.importorskip('pyarrow.parquet')
    pyarrow = pytest.importorskip('pyarrow')
    entries = archive(a=[report(4800.0, ['coulomb_friction']), None])
    schema = parquet.read_schema(pyarrow.BufferReader(as_parquet(entries, 'model')))
    assert schema.names == [column.name for column in COLUMNS]
    assert schema.field('stiffness').metadata[b'unit'] == b'N/m'
    assert str(schema.field('start').type) == 'timestamp[ns, tz=UTC]'
    assert str(schema.field('names').type).startswith('list<')


def made_up() -> Fleet:
    """Return a fleet with something in every section, and a name to be escaped."""
    groups: dict[str, list[dict[str, Any] | None]] = {
        '<robot>': [report(4800.0, ['coulomb_friction'] * (k > 7)) for k in range(14)],
        'worn': [*(report(4800.0 - 12.0 * k) for k in range(12)), None],
    }
    entries = archive(**groups)
    pool = Pool('worn', entries[:3], None)
    pooled = PooledResult(pool, outcome(report()), '', [outcome(report())] * 2 + [
        outcome(None, error='no contact')])
    return Fleet(entries, [pooled], changes(entries), 0, 27, SETTINGS)


def test_page_says_what_changes_wears_and_differs() -> None:
    pytest.importorskip('matplotlib')
    page = as_html(made_up())
    assert page.count('<section>') == 7  # and the summary, which is the header
    assert '&lt;robot&gt;: friction appears from recording 9 of the group on' in page
    assert 'worn: K_e changes by -0.250 % per recording' in page
    assert '<robot>' not in page and '<script' not in page
    assert 'no contact' in page and 'broken' in page


@pytest.fixture
def refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Return what runs the command on a path with further options, where it must refuse."""
    for package in ('distributed', 'pyarrow', 'matplotlib'):
        pytest.importorskip(package)
    model = write_model(tmp_path / 'model.yaml')
    return lambda path, *options: Command('fleet', command_module.main, capfd).refusal(
        path, '--nominal', model, '--output', tmp_path / 'out', *options)


@pytest.mark.parametrize('options, text', [
    (['--jobs', '0'], '--jobs must be >= 1, got 0'),
    (['--group-by', 'run'], 'must have a group in parentheses')])
def test_wrong_options_are_refused_in_one_line(
    options: list[str], text: str, recordings: Path, refused: Callable[..., str]
) -> None:
    assert text in refused(recordings, *options)


def test_an_estimate_that_lost_its_band_is_no_value_of_a_contact() -> None:
    one = Estimate(0, 4800.0, 200.0, 5.0, 2.0, 0.0, nan, EstimateStatus.ESTIMATING, '', 1.0)
    values = {}
    for name, status, std in (
        ('kept', EstimateStatus.ESTIMATING, [5.0, 4.0]),
        ('lost', EstimateStatus.ESTIMATING, [5.0, nan]),
        ('never', EstimateStatus.ESTIMATING, [nan, nan]),
        ('withheld', EstimateStatus.FROZEN, [nan, nan]),
    ):
        episodes = Episodes()
        episodes.add(one._replace(stamp_ns=k * 10**9, stiffness_std=value, status=status,
                                  reason='why') for k, value in enumerate(std))
        values[name] = episodes.found()[0]['stiffness']
        assert episodes.found()[0]['reason'] == 'why'
    assert values == {'kept': 4800.0, 'lost': None, 'never': 4800.0, 'withheld': None}


def test_a_nominal_model_with_physics_is_taken_as_by_diagnose(
    recordings: Path, tmp_path: Path, refused: Callable[..., str]
) -> None:
    model = write_model(tmp_path / 'model.yaml', physics={'coulomb_friction': {'F_c': 2.0}})
    (tmp_path / 'empty').mkdir()
    assert 'no recording at' in refused(tmp_path / 'empty')
    settings = Settings.of(read_model(model))
    outcome = process(str(recordings / 'run_2.mcap'), settings, False).outcome
    assert (outcome['error'], outcome['report']['verdict']) == ('', 'consistent')


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_named(
    recordings: Path, refused: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr('contact_estimation.scheduling._TIMEOUT_S', 0.5)
    assert 'no Dask scheduler answers at tcp://127.0.0.1:9' in refused(
        recordings, '--scheduler', 'tcp://127.0.0.1:9')
