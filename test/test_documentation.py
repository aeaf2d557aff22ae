# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The documentation builds, its example prints what it says, and its links lead somewhere."""

from importlib import import_module, util
import os
from pathlib import Path
import re
import runpy
import shutil
import subprocess
import sys
from typing import Any

import contact_estimation as ce
from contact_estimation.physics import EFFECTS
import pytest

ROOT = Path(__file__).resolve().parent.parent
DOC = ROOT / 'doc'
README = ROOT / 'README.md'
PAGES = [README, *sorted(DOC.glob('*.md'))]
BUILDERS = ('sphinx', 'myst_parser', 'numpydoc', 'furo', 'matplotlib')


def example() -> str:
    """Return the code of doc/example.py without its licence header."""
    return (DOC / 'example.py').read_text().partition('\n\n')[2]


def test_readme_fits_on_two_screens() -> None:
    assert len(README.read_text().splitlines()) <= 165


def test_readme_lists_every_effect_with_its_family() -> None:
    families: dict[str, list[str]] = {}
    for name, cls in EFFECTS.items():
        families.setdefault(cls.family, []).append(f'`{name}`')
    rows = [f'| {family} | {", ".join(names)} |' for family, names in families.items()]
    assert '\n'.join(['| family | effects |', '|---|---|', *rows, '']) in README.read_text()


def test_readme_shows_the_example_and_its_output() -> None:
    text = README.read_text()
    assert f'```python\n{example()}```' in text
    assert f'```text\n{(DOC / "example.txt").read_text()}```' in text


def test_example_prints_the_output_of_the_documentation(
    capsys: pytest.CaptureFixture[str]
) -> None:
    runpy.run_path(str(DOC / 'example.py'))
    assert capsys.readouterr().out == (DOC / 'example.txt').read_text()


def test_relative_links_lead_to_files() -> None:
    for page in PAGES:
        found = re.findall(r'\]\(([^)#:]+)(?:#[^)]*)?\)|src="([^"]+)"', page.read_text())
        targets = [page.parent / (link or source) for link, source in found]
        missing = [str(t) for t in targets if 'generated' not in t.parts and not t.exists()]
        assert missing == [], page


def test_pages_name_tests_that_exist() -> None:
    for page in PAGES:
        named = re.findall(r'test/\w+\.py', page.read_text())
        assert [one for one in named if not (ROOT / one).exists()] == [], page


def test_python_interface_page_has_every_public_name() -> None:
    for name in ce.__all__:
        assert re.search(rf'^(\.\. .*:: )?\s*{name}$', (DOC / 'api.md').read_text(), re.M), name


def test_commands_page_has_every_executable(setup_arguments: dict[str, Any]) -> None:
    text = (DOC / 'commands.md').read_text()
    scripts = setup_arguments['entry_points']['console_scripts']
    names = [script.partition(' = ')[0] for script in scripts]
    assert [name for name in names if f'`{name}`' not in text] == []


def test_page_of_warnings_is_that_of_the_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(DOC))
    pages = import_module('generated_pages')
    assert (DOC / 'warnings.md').read_text() == pages.warnings_page() + '\n'


@pytest.mark.parametrize('model', sorted((DOC / 'models').iterdir()), ids=lambda p: p.stem)
def test_example_models_are_valid(model: Path) -> None:
    ce.read_model(model)


@pytest.mark.slow
def test_documentation_builds_without_warnings_and_has_every_effect(tmp_path: Path) -> None:
    for module in BUILDERS:
        if util.find_spec(module) is None:
            pytest.skip(f'{module} is not installed; pip install .[doc]')
    for name in ('doc', 'test'):  # the build writes generated pages beside the sources
        leave_out = shutil.ignore_patterns('_build', 'generated', '__pycache__')
        shutil.copytree(ROOT / name, tmp_path / name, ignore=leave_out)
    run = subprocess.run(
        [sys.executable, '-m', 'sphinx', '-W', '-q', '-b', 'html', 'doc', 'html'], cwd=tmp_path,
        env={**os.environ, 'PYTHONPATH': str(ROOT)}, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    pages = (tmp_path / 'html' / 'generated').glob('effects_*.html')
    text = ''.join(page.read_text() for page in pages)
    assert [name for name in ce.EFFECTS if f'{name}.png' not in text] == []
