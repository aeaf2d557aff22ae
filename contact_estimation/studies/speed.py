# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Benchmarks of node, estimators, replay and view, each against a reference in the same run."""

from __future__ import annotations

import os
import platform
from typing import Any

from ..commands.command_line import as_json, check_outputs, command, Parser, write_results
from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import ParameterRangeError
from ..pipeline.parameters import EstimationParameters

BENCHMARKS = ('estimators', 'node', 'watch', 'replay')
_DEFAULT = EstimationParameters().estimator
_CONTACTS = ('mixed', 'always')


def make_parser() -> Parser:
    """Build the command line of the benchmarks."""
    parser = Parser(
        prog='studies speed',
        description='Measure run times and their ratios to a reference measured in the same run: '
        "estimators against filterpy's KalmanFilter, the node against an rclpy node that only "
        'echoes, the loop with a live view against that without, replay against rosbags '
        'deserialising the same file. Other load on the machine affects all times; the ratios are '
        'the most robust.',
    )
    parser.add_argument(
        'which', nargs='*', metavar='BENCHMARK', help='any of ' + ', '.join(BENCHMARKS) + ' (all)'
    )
    parser.add_argument('--json', metavar='FILE', help='write all results as JSON')
    parser.add_argument('--rounds', type=int, help='repetitions (node and watch 2, replay 3)')
    node = parser.add_argument_group('node and watch')
    node.add_argument('--seconds', type=float, default=15.0, help='duration of each run [s] (15)')
    node.add_argument('--estimator', choices=ONLINE_ESTIMATORS, default=_DEFAULT,
                      help=f'estimator of the node; not used by watch ({_DEFAULT})')
    replay = parser.add_argument_group('replay')
    replay.add_argument('--recording',
                        help='recording with wrench and joint_states (a simulated one)')
    replay.add_argument('--hours', type=float, default=0.1,
                        help='duration of the simulated recording [h] (0.1)')
    replay.add_argument(
        '--contact', choices=_CONTACTS, default='mixed',
        help='contact in the simulated recording: a third of the time, or always, which is the '
        'worst case for replay (mixed)',
    )
    return parser


def run(options: Any) -> int:
    """Run the chosen benchmarks."""
    _check(options)
    check_outputs([options.json], {})
    results: dict[str, Any] = {'machine': _machine()}
    for name in BENCHMARKS:
        if name in (options.which or BENCHMARKS):
            results[name] = _run_one(name, options)
    write_results(options, {'json': lambda: as_json(results)})
    return 0


def _check(options: Any) -> None:
    for name in options.which:
        if name not in BENCHMARKS:
            raise ParameterRangeError(
                f'BENCHMARK must be among {", ".join(BENCHMARKS)}, got {name!r}'
            )
    for name in ('rounds', 'seconds', 'hours'):
        value = getattr(options, name)
        if value is not None and not 0 < value < 1e6:
            raise ParameterRangeError(f'--{name} must be > 0, got {value:g}')


def _run_one(name: str, options: Any) -> dict[str, Any]:
    """Import only the requested one: node needs ROS, estimators filterpy, replay rosbags."""
    if name == 'node':
        from .speed_nodes import run_node_benchmark

        return run_node_benchmark(options.seconds, options.rounds or 2, options.estimator)
    if name == 'watch':
        from .speed_nodes import run_watch_benchmark

        return run_watch_benchmark(options.seconds, options.rounds or 2)
    if name == 'replay':
        from .speed_replay import run_replay_benchmark

        return run_replay_benchmark(
            options.recording, options.hours, options.contact, options.rounds or 3
        )
    from .speed_estimators import run_estimator_benchmark

    return run_estimator_benchmark(12.0)


def _machine() -> dict[str, Any]:
    return {
        'processors': os.cpu_count(),
        'python': platform.python_version(),
        'system': platform.platform(),
        'load_average': os.getloadavg(),
    }


main = command(make_parser, run)
