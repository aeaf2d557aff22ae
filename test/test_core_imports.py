# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Only ros/ and the benchmarks of the nodes import ROS."""

from __future__ import annotations

from pathlib import Path
import subprocess
import sys

import contact_estimation

PACKAGE = Path(contact_estimation.__file__).parent
CORE = sorted(
    '.'.join(('contact_estimation', *file.relative_to(PACKAGE).with_suffix('').parts))
    for file in PACKAGE.rglob('*.py')
    if file.relative_to(PACKAGE).parts[0] not in ('ros', 'benchmarks', '__main__.py')
)
BANNED = ('rclpy', 'geometry_msgs', 'sensor_msgs', 'trajectory_msgs', 'std_msgs')


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
    names = ('estimation.session', 'estimation.replay', 'plant.closed_loop', 'recordings')
    code = '; '.join([*(f'import contact_estimation.{name}' for name in names),
                      'import sys', 'print([name for name in sys.modules if "scipy" in name])'])
    run = subprocess.run(
        [sys.executable, '-c', code], cwd=PACKAGE.parent, capture_output=True, text=True)
    assert run.stdout == '[]\n', run.stdout + run.stderr
