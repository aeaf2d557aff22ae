# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Ctrl-C ends a node quietly at any moment of its start."""

from __future__ import annotations

from pathlib import Path
import subprocess
import sys

import pytest
from ros_processes import environment

pytestmark = pytest.mark.slow

# Interrupts itself when a module is imported.
INTERRUPTED = """
import os, signal, sys
def hook(event, facts):
    if event == 'import' and facts[0] == sys.argv[1]:
        os.kill(os.getpid(), signal.SIGINT)
from contact_estimation.ros import executables
sys.addaudithook(hook)
raise SystemExit(executables.estimator_node([]))
"""


@pytest.mark.parametrize('module', ['rclpy.node', 'std_srvs.srv', 'numpy'])
def test_interrupt_while_a_node_imports_ends_it_without_a_word(
    tmp_path: Path, module: str
) -> None:
    run = subprocess.run(
        [sys.executable, '-c', INTERRUPTED, module], env=environment(tmp_path),
        capture_output=True, text=True, timeout=120.0)
    assert (run.returncode, run.stdout, run.stderr) == (0, '', '')


def test_interrupt_while_a_command_imports_is_one_line(tmp_path: Path) -> None:
    code = INTERRUPTED.replace('contact_estimation.ros import executables',
                               'contact_estimation.commands import entry_points')
    code = code.replace('executables.estimator_node([])', 'entry_points.replay()')
    run = subprocess.run(
        [sys.executable, '-c', code, 'numpy'], env=environment(tmp_path), capture_output=True,
        text=True, timeout=120.0)
    assert (run.returncode, run.stdout, run.stderr) == (1, '', 'replay: interrupted\n')
