# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The public face and what importing it loads."""

from __future__ import annotations

import json
from pathlib import Path
import subprocess
import sys
from typing import Any

import contact_estimation
import contact_estimation as ce
import pytest

PACKAGE = Path(contact_estimation.__file__).parent
CORE = sorted(
    '.'.join(('contact_estimation', *file.relative_to(PACKAGE).with_suffix('').parts))
    for file in PACKAGE.rglob('*.py')
    if not {'ros', '__main__.py', 'speed_nodes.py'}
    & set(file.relative_to(PACKAGE).parts)
)
BANNED = ('rclpy', 'geometry_msgs', 'sensor_msgs', 'trajectory_msgs', 'std_msgs')


@pytest.mark.slow
def test_core_imports_without_ros() -> None:
    code = (
        'import importlib, sys\n'
        f'for name in {CORE!r}: importlib.import_module(name)\n'
        f'print(len(sys.modules), [name for name in {BANNED!r} if name in sys.modules])'
    )
    run = subprocess.run(
        [sys.executable, '-c', code], cwd=PACKAGE.parent, capture_output=True, text=True
    )
    count, _, imported = run.stdout.strip().partition(' ')
    assert imported == '[]', run.stdout + run.stderr
    assert int(count) > len(CORE) > 100


def test_core_of_the_nodes_imports_without_scipy() -> None:
    """It takes longer to import than all else; what needs it imports it when first called."""
    names = ('pipeline.session', 'pipeline.replay', 'plant.closed_loop', 'recordings')
    code = '; '.join([*(f'import contact_estimation.{name}' for name in names),
                      'import sys', 'print([name for name in sys.modules if "scipy" in name])'])
    run = subprocess.run(
        [sys.executable, '-c', code], cwd=PACKAGE.parent, capture_output=True, text=True)
    assert run.stdout == '[]\n', run.stdout + run.stderr


ROOT = Path(ce.__file__).parent.parent


def after_import() -> Any:
    """Return the modules loaded and the environment changed by importing the package."""
    code = (
        'import json, os, sys; before = dict(os.environ); import contact_estimation as ce\n'
        'print(json.dumps([sorted(sys.modules), dict(os.environ) == before]))'
    )
    run = subprocess.run([sys.executable, '-c', code], cwd=ROOT, check=True,
                         capture_output=True, text=True)
    return json.loads(run.stdout)


def test_public_name_resolves_and_is_documented() -> None:
    for name in ce.__all__:
        value = getattr(ce, name)
        assert isinstance(value, dict) or value.__doc__, name


def test_importing_the_package_loads_no_numerical_library_and_no_ros() -> None:
    modules, _ = after_import()
    heavy = {'numpy', 'scipy', 'matplotlib', 'yaml', 'rclpy', 'geometry_msgs'}
    assert heavy.isdisjoint(modules)


def test_unknown_attribute_names_the_choices() -> None:
    with pytest.raises(AttributeError, match='no attribute .diagnos.; expected one of .*diagnose'):
        getattr(ce, 'diagnos')


def test_unknown_axis_names_the_choices(tmp_path: Path) -> None:
    with pytest.raises(ce.ContactEstimationError, match="unknown axis 'w'; .*known: x, y, z"):
        ce.read_recording(tmp_path / 'run.mcap', axis='w')


def test_diagnose_needs_a_recording() -> None:
    with pytest.raises(ce.ContactEstimationError, match='at least one recording, got none'):
        ce.diagnose([], ce.PlantParameters())
