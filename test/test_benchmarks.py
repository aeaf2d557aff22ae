# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The commands of the benchmarks: their help, and an end of every process they start."""

from __future__ import annotations

from contact_estimation.studies.__main__ import main, STUDIES
import pytest


@pytest.mark.parametrize('name', STUDIES)
def test_every_study_has_a_help(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match='0'):
        main([name, '--help'])
    assert len(capsys.readouterr().out) > 200
