# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Make the pictures and outputs in README.md and the pages with the commands beside them.

Run `python doc/figures.py`, or `python doc/figures.py diagnosis` for one of `PARTS`, with the
package and its extras `ros` and `tools` installed. The picture of the loop depends slightly on the
timing of the machine, the others on the seed alone.

"""

from __future__ import annotations

import base64
from pathlib import Path
import re
import shutil
import subprocess
import sys
from tempfile import TemporaryDirectory

DOC = Path(__file__).resolve().parent
IMAGES = DOC / 'images'
MODELS = DOC / 'models'


def main() -> None:
    """Run the commands in a temporary folder and keep their pictures."""
    for part in sys.argv[1:] or PARTS:
        with TemporaryDirectory() as name:
            PARTS[part](Path(name))


def make_loop(folder: Path) -> None:
    """Run the loop and keep its summary."""
    text = run(folder, 'loop', '--duration', '12', '--experiment', 'sine', '--output',
               'my_first_run')
    (IMAGES / 'loop.txt').write_text(text)
    shutil.copyfile(folder / 'my_first_run' / 'summary.png', IMAGES / 'loop.png')


def make_diagnosis(folder: Path) -> None:
    """Diagnose the recording of a simulation and keep report, models and picture."""
    run(folder, 'simulate', '--model', str(MODELS / 'dry_friction.yaml'), '--experiment',
        'rich', '--seed', '1', '--output', 'run.mcap')
    text = run(folder, 'diagnose', 'run.mcap', '--nominal', str(MODELS / 'nominal.yaml'),
               '--html', 'report.html', '--write-comparison', 'comparison.json')
    (IMAGES / 'diagnosis.txt').write_text(text)
    (IMAGES / 'comparison.txt').write_text(
        output_of(folder, str(DOC / 'comparison.py'), 'comparison.json'))
    page = (folder / 'report.html').read_text(encoding='utf-8')
    (IMAGES / 'diagnosis.png').write_bytes(first_picture(page))


def make_arm(folder: Path) -> None:
    """Diagnose a simulated arm blind, and keep report and pictures."""
    run(folder, 'blind_trials', '--arms', '2', '--seed', '1', '--only-write', '--output', 'arms')
    world = Path('arms', 'handed_over', 'arm_1_001')
    text = run(folder, 'diagnose', f'{world}.mcap', '--nominal-robot', f'{world}.urdf',
               '--html', 'report.html')
    (IMAGES / 'arm.txt').write_text(text)
    page = (folder / 'report.html').read_text(encoding='utf-8')
    (IMAGES / 'arm.png').write_bytes(first_picture(page))


def run(folder: Path, command: str, *arguments: str) -> str:
    """Run a command of this package in a folder and return what it prints."""
    return output_of(folder, '-c', (
        f'from contact_estimation.executables import {command}; '
        f'raise SystemExit({command}())'), *arguments)


def output_of(folder: Path, *arguments: str) -> str:
    """Run Python in a folder and return what it prints."""
    done = subprocess.run([sys.executable, *arguments], cwd=folder, check=True,
                          stdout=subprocess.PIPE, text=True)
    return done.stdout


def first_picture(page: str) -> bytes:
    """Return the first PNG of an HTML report."""
    found = re.search(r'data:image/png;base64,([A-Za-z0-9+/=]+)', page)
    if found is None:
        raise ValueError('expected a PNG picture in the report, got none')
    return base64.b64decode(found[1])


PARTS = {'loop': make_loop, 'diagnosis': make_diagnosis, 'arm': make_arm}


if __name__ == '__main__':
    main()
