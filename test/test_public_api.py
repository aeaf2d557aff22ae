# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The public face: its names resolve, on first use, and importing it changes nothing else."""

from __future__ import annotations

import ast
import json
from pathlib import Path
import subprocess
import sys
from typing import Any

import contact_estimation as ce
import pytest

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


def test_type_checkers_see_the_names_that_resolve_at_run_time() -> None:
    tree = ast.parse(Path(ce.__file__).read_text())
    blocks = [node for node in tree.body if isinstance(node, ast.If)]
    imports = [node for node in blocks[0].body if isinstance(node, ast.ImportFrom)]
    typed = {alias.name: node.module for node in imports for alias in node.names}
    assert typed == ce._MODULES
    assert set(typed) == set(ce.__all__)


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
