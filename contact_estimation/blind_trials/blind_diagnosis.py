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

"""`diagnose` in a process of its own, which is given recording and nominal model, no more."""

from __future__ import annotations

import json
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time
from typing import Any

from .handing_over import Handed, write_json

_LONGEST_S = 1800.0


def command_line(recording: Path, nominal: Path, output: Path) -> list[str]:
    """
    Write the command line.

    Parameters
    ----------
    recording, nominal : Path
        What is handed over.
    output : Path
        Where the report shall be.

    Returns
    -------
    words : list of str
        Of this package's `diagnose`, whatever is on PATH.

    """
    return [sys.executable, '-m', 'contact_estimation.commands.diagnose', str(recording),
            '--nominal', str(nominal), '--json', str(output)]


def diagnose_blind(files: Handed) -> None:
    """
    Diagnose a trial and keep what was said.

    Parameters
    ----------
    files : Handed
        Of the trial; its report is written: `report` (null where there is none), `error` and
        `seconds`.

    """
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / 'report.json'
        begin = time.monotonic()
        error = _run(command_line(files.recording, files.nominal, output))
        seconds = time.monotonic() - begin
        report: Any = None
        if not error:
            report = json.loads(output.read_text())
    write_json(files.report, {'report': report, 'error': error, 'seconds': round(seconds, 1)})


def _run(words: list[str]) -> str:
    """Run the command and give its complaint, '' for none."""
    # One thread each: several run side by side.
    environment = {**os.environ, 'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1'}
    try:
        done = subprocess.run(words, env=environment, capture_output=True, text=True,
                              timeout=_LONGEST_S, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return f'not done within {_LONGEST_S:g} s'
    lines = done.stderr.strip().splitlines()
    return '' if done.returncode == 0 else (lines or [f'exit code {done.returncode}'])[-1]
