# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The paper's table from one command, off-line."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from .command_line import command, new_file, Parser
from .progress import Progress
from ..exceptions import ParameterRangeError
from ..reproduction.figures import draw_figures
from ..reproduction.table import as_text, make_table


def make_parser() -> Parser:
    """Build the command line of `reproduce`."""
    parser = Parser(
        prog='reproduce',
        description="Run the paper's cases, simulated and on a virtual testbed, from seeds and "
        'print the errors at the last instant of contact beside the Cramer-Rao bound and the '
        "paper's figures.",
    )
    parser.add_argument(
        '--seeds', type=int, default=20,
        help='runs of each case (20); on the testbed 10 at most, as many as the paper made',
    )
    parser.add_argument('--json', metavar='FILE', help='the table as JSON')
    parser.add_argument('--output', metavar='DIR', help='folder for the figures as PNG')
    parser.add_argument('--jobs', type=int, default=os.cpu_count() or 1, help='processes')
    return parser


def run(options: Any) -> int:
    """
    Make table and figures.

    Parameters
    ----------
    options : argparse.Namespace
        Of `make_parser`.

    Returns
    -------
    code : int
        0.

    """
    for name in ('seeds', 'jobs'):
        if getattr(options, name) < 1:
            raise ParameterRangeError(f'--{name} must be >= 1, got {getattr(options, name)}')
    target = new_file(options.json) if options.json else None
    progress = Progress('reproduce')
    rows = make_table(options.seeds, options.jobs, progress.show)
    progress.done()
    print(as_text(rows))
    if target is not None:
        target.write_text(json.dumps({'cases': rows}, indent=1) + '\n')
    if options.output:
        for path in draw_figures(Path(options.output)):
            print(f'wrote {path}')
    return 0


main = command(make_parser, run)


if __name__ == '__main__':
    raise SystemExit(main())
