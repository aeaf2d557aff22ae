# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rigs of blind_trials: integration, nuisances, degree by which a law stands out, files."""

from __future__ import annotations

from pathlib import Path

from contact_estimation.studies.blind_trials.command import main
import pytest


# -- integration ------------------------------------------------------------------------------


# -- nuisances --------------------------------------------------------------------------------


# -- degree -----------------------------------------------------------------------------------


# -- plan and files ---------------------------------------------------------------------------


@pytest.mark.slow
def test_only_write_leaves_recordings_and_truths(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ['--count', '0', '--foreign', '1', '--unknown', '1', '--seed', '5', '--only-write',
             '--output', str(tmp_path)]
    assert main(words) == 0
    assert 'wrote 2 trials' in capsys.readouterr().out
    recordings = sorted(path.stem for path in (tmp_path / 'handed_over').glob('*.mcap'))
    truths = sorted(path.name for path in (tmp_path / 'sealed').glob('*.truth.json'))
    assert truths == [f'{name}.truth.json' for name in recordings]
    assert not (tmp_path / 'reports').exists()
    first = (tmp_path / 'sealed' / truths[0]).read_text()
    assert main([*words[:-1], str(tmp_path / 'again')]) == 0
    assert (tmp_path / 'again' / 'sealed' / truths[0]).read_text() == first
