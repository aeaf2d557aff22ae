# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The commands of the benchmarks: their help, and an end of every process they start."""

from __future__ import annotations

from pathlib import Path
import subprocess
import sys
from typing import Any

from contact_estimation.messages.plain_decoding import DIAGNOSTICS_TYPE
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.studies.__main__ import main, STUDIES
from contact_estimation.studies.arms.live_run import warned
from contact_estimation.studies.benchmarks import watch_benchmark
from contact_estimation.studies.benchmarks.input_checks import lag_evidence
import numpy as np
import pytest
from reference_messages import header, new, serialized


@pytest.mark.parametrize('name', STUDIES)
def test_every_study_has_a_help(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match='0'):
        main([name, '--help'])
    assert len(capsys.readouterr().out) > 200


def test_an_unknown_study_is_refused_with_the_names_of_all(
    capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match='1'):
        main(['no_such'])
    error = capsys.readouterr().err
    assert error.count('\n') == 1 and all(name in error for name in STUDIES)


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


def test_one_frequency_shows_no_lag_and_two_show_it_in_proportion_to_their_power() -> None:
    t, wall = np.arange(1000) / 500.0, (5000.0, 100.0)
    inner = (t > 0.1) & (t < 1.9)

    def motion(*sines: tuple[float, float]) -> tuple[Any, Any]:
        return (sum(size * np.sin(omega * t) for size, omega in sines),
                sum(size * omega * np.cos(omega * t) for size, omega in sines))

    one = lag_evidence(t, *motion((1e-3, 20.0)), inner, wall, 0.01, 0.6)
    assert one.over_wall < 0.1
    two = lag_evidence(t, *motion((1e-3, 20.0), (5e-4, 60.0)), inner, wall, 0.01, 0.6)
    assert two.over_wall > 10.0 * two.over_mass > 100.0
    twice = lag_evidence(t, *motion((2e-3, 20.0), (1e-3, 60.0)), inner, wall, 0.01, 0.6)
    assert twice.over_wall == pytest.approx(4.0 * two.over_wall)


def test_each_kind_of_warning_that_a_node_published_is_listed_once(tmp_path: Path) -> None:
    with RecordingWriter.file(tmp_path / 'a.mcap') as writer:
        for k, text in enumerate(('at 540 Hz; correct it', 'at 612.5 Hz; correct it', 'skew')):
            values = [new('KeyValue', 'samples', '5'), new('KeyValue', 'warning_1', text)]
            status = new('DiagnosticStatus', 1, '/node', text, '', values)
            raw = serialized(new('DiagnosticArray', header(), [status]), DIAGNOSTICS_TYPE)
            writer.write('/diagnostics', DIAGNOSTICS_TYPE, raw, k)
    assert warned(RecordingReader(tmp_path / 'a.mcap')) == ['at 540 Hz', 'skew']
