# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Reproduce the paper's table and figures, off-line."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from .paper_figures import plot_figures
from .paper_table import as_text, make_table
from ..commands.command_line import (
    as_json, check_outputs, command, Parser, require_at_least, write_results)
from ..commands.progress import Progress


def make_parser() -> Parser:
    """Build the command line of `reproduce`."""
    parser = Parser(
        prog='reproduce',
        description="Run the paper's cases, in simulation and on a virtual testbed, and print the "
        'errors at the last instant of contact with the Cramer-Rao bounds and the errors printed '
        'in the paper.',
    )
    parser.add_argument(
        '--seeds', type=int, default=20,
        help='runs of each case (20); at most 10 on the testbed, as in the paper',
    )
    parser.add_argument('--json', metavar='FILE', help='write the table as JSON')
    parser.add_argument('--output', metavar='DIR', help='plot the figures as PNG into this folder')
    parser.add_argument('--jobs', type=int, default=os.cpu_count() or 1,
                        help='number of parallel processes (all processors)')
    return parser


def run(options: Any) -> int:
    """Compute table and figures."""
    require_at_least(options, seeds=1, jobs=1)
    check_outputs([options.json], {})
    progress = Progress('reproduce')
    rows = make_table(options.seeds, options.jobs, progress.show)
    progress.done()
    print(as_text(rows))
    write_results(options, {'json': lambda: as_json({'cases': rows})})
    if options.output:
        for path in plot_figures(Path(options.output)):
            print(f'wrote {path}')
    return 0


main = command(make_parser, run)

if __name__ == '__main__':
    raise SystemExit(main())
