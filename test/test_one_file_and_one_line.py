# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A new effect or estimator is one new file and its line in the registry, nothing else."""

from __future__ import annotations

import json
import os
from pathlib import Path
import shutil
import subprocess
import sys
from typing import Any

import contact_estimation
import pytest

HERE = Path(__file__).resolve().parent


def add(package: Path, toy: str, *changes: tuple[str, str]) -> None:
    """Copy a file into a package, and add lines after others to its `__init__.py`."""
    shutil.copy(HERE / f'{toy}.py', package)
    registry = (package / '__init__.py').read_text()
    for line, added in changes:
        assert registry.count(line) == 1
        registry = registry.replace(line, line + added)
    (package / '__init__.py').write_text(registry)


@pytest.fixture(scope='module')
def facts(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Extend a copy of the package, and look at what it does."""
    folder = tmp_path_factory.mktemp('extended')
    package = folder / 'contact_estimation'
    shutil.copytree(contact_estimation.__path__[0], package,
                    ignore=shutil.ignore_patterns('__pycache__'))
    add(package / 'physics', 'toy_effect', (
        'EFFECTS: dict[str, type[Effect]] = {name: _class_of(name) for name in (\n',
        "    'toy_effect',\n"))
    add(package / 'estimators', 'toy_estimator',
        ('ESTIMATORS: dict[str, type[OnlineEstimator]] = {\n',
         "    'toy_estimator': ToyEstimator,\n"),
        ('from __future__ import annotations\n', 'from .toy_estimator import ToyEstimator\n'))
    shutil.copy(HERE / 'extended_package_facts.py', folder)
    done = subprocess.run(
        [sys.executable, 'extended_package_facts.py', str(folder)], cwd=folder,
        env={**os.environ, 'PYTHONPATH': str(folder)}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow
def test_plant_simulates_a_new_effect_from_a_model_file(facts: Any) -> None:
    without, with_effect = facts['force']
    assert with_effect > without + 2.0


def test_estimators_compensate_a_new_effect(facts: Any) -> None:
    assert abs(facts['compensated'] / 4800.0 - 1.0) < 0.03
    assert facts['uncompensated'] > 1.1 * 4800.0


def test_diagnosis_tries_a_new_effect(facts: Any) -> None:
    assert 'toy_effect' in facts['candidates']


def test_blind_trials_draw_a_new_effect(facts: Any) -> None:
    assert 'toy_effect' in facts['trials']


def test_config_files_hold_a_new_effect_with_comments(facts: Any) -> None:
    lines = (
        '      # The wall hardens suddenly.\n      toy_effect:\n'
        '        # Coefficient of the fifth power [N/m^5]\n        K_5: .nan\n')
    assert all(lines in text for name, text in facts['config'].items() if name.endswith('.yaml'))


def test_a_new_estimator_runs_under_its_name(facts: Any) -> None:
    assert abs(facts['toy_estimator'] / 4800.0 - 1.0) < 0.03


def test_config_file_holds_a_new_estimator_with_its_tuning(facts: Any) -> None:
    text = facts['config']['estimator_node.yaml']
    assert 'toy_estimator, indirect_adaptive' in text
    assert '        # Share of the error removed by one sample; at least 0\n' in text
