# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from importlib import util
from pathlib import Path
import shutil
import subprocess
import sys

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parent.parent
# ament_pep257 holds properties to the imperative mood of functions.
# Two thirds of pydocstyle's time go into messages of debugging that nobody sees.
PYDOCSTYLE = ('import logging; logging.disable(logging.DEBUG); '
              'from pydocstyle.cli import main; main()')
LINTERS = {
    'flake8': ['-m', 'flake8'],
    'pydocstyle': ['-c', PYDOCSTYLE, '--property-decorators=none'],
    'mypy': ['-m', 'mypy'],
}
PLACES = [
    place for place in ('contact_estimation', 'launch', 'setup.py', 'test')
    if place.endswith('.py') or any((ROOT / place).rglob('*.py'))
]

# The same rules by another program, which says it better where ROS is installed.
BY_AMENT = {'flake8': 'ament_flake8', 'pydocstyle': 'ament_pep257'}


@pytest.mark.parametrize('linter', LINTERS)
def test_source_passes(linter: str) -> None:
    if linter in BY_AMENT and util.find_spec(BY_AMENT[linter]):
        pytest.skip(f'{BY_AMENT[linter]} says so')
    command = [sys.executable, *LINTERS[linter], *PLACES]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, f'{" ".join(command)}\n{run.stdout}{run.stderr}'


def test_source_passes_ament_flake8() -> None:
    main = pytest.importorskip('ament_flake8.main').main_with_errors
    code, errors = main(argv=[str(ROOT / place) for place in PLACES])
    assert code == 0, '\n'.join(errors)


@pytest.mark.parametrize('linter', ['ament_pep257', 'ament_copyright'])
def test_source_passes_ament(linter: str, capfd: pytest.CaptureFixture[str]) -> None:
    main = pytest.importorskip(f'{linter}.main').main
    assert main(argv=[str(ROOT / place) for place in PLACES]) == 0, capfd.readouterr().err


@pytest.mark.skipif(shutil.which('xmllint') is None, reason='xmllint is not installed')
def test_package_xml_passes_ament_xmllint(capfd: pytest.CaptureFixture[str]) -> None:
    main = pytest.importorskip('ament_xmllint.main').main
    assert main(argv=[str(ROOT / 'package.xml')]) == 0, capfd.readouterr().err
