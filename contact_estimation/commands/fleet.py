# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`fleet`: replay and diagnose an archive of recordings; one table, one page."""

from pathlib import Path
from typing import Any

from .command_line import (
    add_params_option, add_source_options, add_tare_option, chosen_parameters, command,
    different_files, Parser, reading_of, require_at_least, topics_of)
from .progress import Progress
from ..exceptions import RecordingError
from ..figures import require_matplotlib
from ..fleet.discovery import find_recordings, skipped_files
from ..fleet.one_recording import Settings
from ..fleet.page import as_html
from ..fleet.run import Fleet, run_fleet
from ..fleet.table import as_parquet, require_pyarrow
from ..parameters import without
from ..plant.plant_parameters import read_model
from ..ros.estimator_node_parameters import EstimatorNodeParameters
from ..scheduling import require_distributed, workers
from ..texts import write_whole


def make_parser() -> Parser:
    """Build the command line of `fleet`."""
    parser = Parser(
        prog='fleet',
        description='Replay and diagnose every recording of an archive in parallel, and write '
        'table.parquet, a row for each recording and contact, and index.html: which physics are '
        'missing, where and since when, wear, and robots that differ from the rest. A recording '
        'that cannot be used becomes a row with its error. An interrupted run resumes: what was '
        'finished with the same recording, model, options and version is not repeated.')
    parser.add_argument('paths', metavar='PATH', nargs='+',
                        help='.mcap files, rosbag2 folders, folders of both, tables, or quoted '
                        'patterns')
    parser.add_argument('--nominal', metavar='MODEL.yaml', required=True,
                        help='model file of the simulation (section plant_node)')
    parser.add_argument('--output', metavar='DIR', required=True,
                        help='folder for table, page and finished results')
    parser.add_argument('--group-by', metavar='PATTERN',
                        help='regular expression, searched for in each path; its group in '
                        "parentheses names the robot, such as '(robot_[a-z]+)/' (default: all "
                        'recordings are one group)')
    parser.add_argument('--scheduler', metavar='ADDRESS',
                        help='Dask scheduler whose workers to use, such as tcp://host:8786 '
                        '(default: processes on this machine)')
    parser.add_argument('--jobs', type=int, metavar='N',
                        help='processes on this machine (default: one for each processor); with '
                        '--scheduler, recordings at a time')
    parser.add_argument('--pooled', type=int, default=4, metavar='N',
                        help='recordings of each group that are also diagnosed together, spread '
                        'over time, each predicted by the others; 0: none '
                        '(default: %(default)s)')
    parser.add_argument('--no-pages', action='store_true',
                        help='skip the page of each recording; writing them takes a fifth of the '
                        'time')
    parser.add_argument('--most-samples', type=int, default=1_000_000, metavar='N',
                        help='diagnose at most the first N wrenches of a recording, which bounds '
                        'the memory of a worker (default: %(default)s)')
    parser.add_argument('--seed', type=int, default=0,
                        help='seed of the bootstraps (default: %(default)s)')
    add_params_option(
        parser, ', which overrides recorded parameters: for archives of other recorders')
    add_source_options(parser)
    add_tare_option(parser)
    return parser


def run(options: Any) -> int:
    """Work through the archive, write table and page and print a summary."""
    require_at_least(options, jobs=1, seed=0, pooled=0, most_samples=1000)
    for require in (require_matplotlib, require_distributed, require_pyarrow):
        require()  # before the first recording, not after the last
    settings = Settings.of(
        read_model(options.nominal), topics=topics_of(options), axis=options.axis or 'x',
        joint=options.joint or '', seed=options.seed, most_samples=options.most_samples,
        reading=reading_of(options),
        parameters=without(EstimatorNodeParameters, chosen_parameters(options)))
    found = find_recordings(options.paths, options.group_by)
    used = {one.name for one in found}
    skipped = [name for name in skipped_files(options.paths) if name not in used]
    folder = _output(options.output)
    different_files((str(folder / name) for name in ('table.parquet', 'index.html')),
                    {'the nominal model file': [options.nominal]})
    progress = Progress('fleet')
    with workers(options.scheduler, options.jobs) as started:
        fleet = run_fleet(found, settings, started, folder, most_pooled=options.pooled,
                          with_pages=not options.no_pages, progress=progress.show)
    progress.done()
    write_whole(folder / 'table.parquet', as_parquet(fleet.entries, settings.model_sha256))
    write_whole(folder / 'index.html', as_html(fleet).encode('utf-8'))
    _print(fleet, folder)
    if skipped:
        print(f'skipped {len(skipped)} files: {", ".join(skipped[:5])}'
              f'{" and more" if len(skipped) > 5 else ""}; give tables as a quoted pattern, such '
              "as 'archive/*.csv', convert ROS 1 bags with rosbags-convert, and copy what a pipe "
              'delivers to a file')
    return 0


def _output(path: str) -> Path:
    """Create the folder of a run, or continue in it."""
    folder = Path(path)
    if folder.exists() and not folder.is_dir():
        raise RecordingError(f'--output {path} is a file; choose a folder')
    if (folder / 'metadata.yaml').exists():
        raise RecordingError(f'--output {path} is a recording; choose another folder')
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _print(fleet: Fleet, folder: Path) -> None:
    groups = len({entry.group for entry in fleet.entries})
    print(f'{len(fleet.entries)} recordings in {groups} '
          f'{"group" if groups == 1 else "groups"}, {fleet.done} finished before, '
          f'{len(fleet.failed)} with an error')
    if fleet.damaged:
        print(f'damaged results made again: {len(fleet.damaged)}, such as {fleet.damaged[0]}')
    if fleet.identical:
        print(f'{fleet.identical} recordings are identical to others' if fleet.identical > 1
              else '1 recording is identical to another')
    print(f'wrote table.parquet and index.html in {folder}')


main = command(make_parser, run)
