# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The studies: whatever only measures. `python -m contact_estimation.studies NAME ...`."""

from importlib import import_module
import sys
from typing import Sequence

from ..commands.command_line import Parser

STUDIES = {
    'arms': ('arm_study', 'the library on two arms simulated in MuJoCo'),
    'online': ('online_study', 'on-line estimation: defaults, all estimators, full matrices'),
    'records': ('records', 'names of `diagnose` on recordings of real things'),
    'speed': ('speed', 'run times of estimators, node, replay and view'),
}


def make_parser() -> Parser:
    """Build the command line that selects a study."""
    studies = ', '.join(f'{name} ({purpose})' for name, (_, purpose) in STUDIES.items())
    parser = Parser(
        prog='studies',
        description='Run one of the studies that measure accuracy, coverage and speed; '
        '`studies NAME --help` shows its options.')
    parser.add_argument('name', metavar='NAME', choices=list(STUDIES), help=studies)
    return parser


def main(args: Sequence[str] | None = None) -> int:
    """Hand the remaining arguments to the chosen study, imported when it is chosen."""
    words = list(sys.argv[1:] if args is None else args)
    name = make_parser().parse_args(words[:1]).name
    return int(import_module(f'.{STUDIES[name][0]}', __package__).main(words[1:]))


if __name__ == '__main__':
    raise SystemExit(main())
