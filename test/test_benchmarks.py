# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The commands of the benchmarks: their help, and an end of every process they start."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
import subprocess
import sys
from typing import Any

from contact_estimation.benchmarks import watch_benchmark
import pytest

COMMANDS = ('__main__', 'arms.__main__', 'estimators_study', 'fleet', 'input_checks',
            'online_study', 'records')


@pytest.mark.parametrize('name', COMMANDS)
def test_every_benchmark_has_a_help(name: str) -> None:
    parser = import_module(f'contact_estimation.benchmarks.{name}').make_parser()
    assert len(parser.format_help()) > 200


def test_an_interrupted_watch_benchmark_ends_its_loop(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    started: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def start(command: list[str], **options: Any) -> subprocess.Popen[bytes]:
        started.append(popen([sys.executable, '-c', 'import time; time.sleep(60)'], **options))
        return started[-1]

    def interrupt(_: int) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(subprocess, 'Popen', start)
    monkeypatch.setattr(watch_benchmark, '_descendants', interrupt)
    with pytest.raises(KeyboardInterrupt):
        watch_benchmark._measured_loop([], tmp_path / 'errors.txt')
    assert started[0].poll() is not None
