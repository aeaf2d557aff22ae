# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The order of packages, what importing loads, and what one new file and one line do."""

import ast
from functools import lru_cache
import json
import os
from pathlib import Path
import shutil
import subprocess
import sys
from typing import Any

import contact_estimation
import contact_estimation as ce
import pytest

ROOT = Path(contact_estimation.__file__).parent
LAYERS = [
    'ament_licence', 'texts', 'exceptions', 'figures', 'scheduling', 'parameters',
    'parameter_files', 'recordings', 'signals', 'kinematics', 'physics', 'reference', 'estimators',
    'pipeline', 'plant', 'diagnosis.observe', 'diagnosis.checks', 'diagnosis.fit', 'diagnosis',
    'diagnosis.report', 'diagnosis.arm', 'fleet', 'watch', 'ros', 'commands',
    'studies.blind_trials', 'studies', 'executables']


def package_of(module: str) -> str:
    """Return the layer that a module, named below contact_estimation, belongs to."""
    return max((p for p in LAYERS if f'{module}.'.startswith(f'{p}.')), key=len)


@lru_cache(maxsize=None)
def imported(file: Path) -> list[str]:
    """Return the modules of this project that a file imports, below contact_estimation."""
    parts = file.relative_to(ROOT).parts[:-1]
    return ['.'.join([*parts[:len(parts) - node.level + 1], node.module or one.name])
            for node in ast.walk(ast.parse(file.read_text()))
            if isinstance(node, ast.ImportFrom) and node.level for one in node.names]


def test_a_package_imports_only_packages_listed_before_it() -> None:
    for package in LAYERS:
        files = [f for f in ROOT.rglob('*.py')
                 if f.stat().st_size and (f.parent != ROOT or f.stem in LAYERS)]
        names = {f: '.'.join(f.relative_to(ROOT).with_suffix('').parts) for f in files}
        of_package = [f for f, name in names.items() if package_of(name) == package]
        used = {package_of(module) for f in of_package for module in imported(f) if module}
        assert of_package, package
        below = LAYERS[:LAYERS.index(package) + 1]
        assert not used - set(below), package


def test_every_module_belongs_to_a_listed_package() -> None:
    names = {f.relative_to(ROOT).parts[0].removesuffix('.py') for f in ROOT.rglob('*.py')}
    listed = {layer.partition('.')[0] for layer in LAYERS}
    assert {name for name in names if not name.startswith('__')} == listed


def test_laws_of_blind_trials_share_no_code_with_the_diagnosis() -> None:
    files = list((ROOT / 'studies/blind_trials').glob('foreign_*.py'))
    used = {module for file in files for module in imported(file)}
    assert len(files) > 5
    assert all(module.startswith('studies.blind_trials.foreign_') for module in used)


CORE = sorted(
    '.'.join(('contact_estimation', *file.relative_to(ROOT).with_suffix('').parts))
    for file in ROOT.rglob('*.py')
    if not {'ros', '__main__.py', 'speed_nodes.py'}
    & set(file.relative_to(ROOT).parts)
)
BANNED = ('rclpy', 'geometry_msgs', 'sensor_msgs', 'trajectory_msgs', 'std_msgs')


def printed(code: str) -> str:
    """Run code in a Python of its own."""
    return subprocess.run([sys.executable, '-c', code], cwd=ROOT.parent, check=True,
                          capture_output=True, text=True).stdout


@pytest.mark.slow
def test_core_imports_without_ros() -> None:
    code = (
        'import importlib, sys\n'
        f'for name in {CORE!r}: importlib.import_module(name)\n'
        f'print(len(sys.modules), [name for name in {BANNED!r} if name in sys.modules])')
    count, _, imported = printed(code).strip().partition(' ')
    assert imported == '[]'
    assert int(count) > len(CORE) > 100


def test_core_of_the_nodes_imports_without_scipy() -> None:
    """It takes longer to import than all else; what needs it imports it when first called."""
    names = ('pipeline.session', 'pipeline.replay', 'plant.closed_loop', 'recordings')
    code = '; '.join([*(f'import contact_estimation.{name}' for name in names),
                      'import sys', 'print([name for name in sys.modules if "scipy" in name])'])
    assert printed(code) == '[]\n'


def test_public_name_resolves_and_is_documented() -> None:
    for name in ce.__all__:
        value = getattr(ce, name)
        assert isinstance(value, dict) or value.__doc__, name


def test_importing_the_package_loads_no_numerical_library_and_no_ros() -> None:
    modules = printed('import sys, contact_estimation; print(*sys.modules)').split()
    heavy = {'numpy', 'scipy', 'matplotlib', 'yaml', 'rclpy', 'geometry_msgs'}
    assert 'contact_estimation' in modules and heavy.isdisjoint(modules)


def test_unknown_attribute_names_the_choices() -> None:
    with pytest.raises(AttributeError, match='no attribute .diagnos.; expected one of .*diagnose'):
        getattr(ce, 'diagnos')


def test_unknown_axis_names_the_choices(tmp_path: Path) -> None:
    with pytest.raises(ce.ContactEstimationError, match="unknown axis 'w'; .*known: x, y, z"):
        ce.read_recording(tmp_path / 'run.mcap', axis='w')


def test_diagnose_needs_a_recording() -> None:
    with pytest.raises(ce.ContactEstimationError, match='at least one recording, got none'):
        ce.diagnose([], ce.PlantParameters())


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
        ('from dataclasses import make_dataclass\n', 'from .toy_estimator import ToyEstimator\n'))
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
