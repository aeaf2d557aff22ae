# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The commands of the benchmarks: their help, and an end of every process they start."""

from __future__ import annotations

from contact_estimation.studies.__main__ import main, STUDIES
from contact_estimation.studies.online_study import as_markdown, scored, summary
import pytest


@pytest.mark.parametrize('name', STUDIES)
def test_every_study_has_a_help(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match='0'):
        main([name, '--help'])
    assert len(capsys.readouterr().out) > 200


@pytest.mark.parametrize('candidate', ['', 'kalman', 'filterpy Kalman, bare'])
def test_estimators_and_peers_find_the_stiffness_of_a_world(candidate: str) -> None:
    score = scored(candidate, 'end_of_contact_as_told', 0, 0)
    assert abs(score.K_error) < 0.01
    assert f'| {candidate} | 1 | 1 of 1 |' in as_markdown({'row': [summary(candidate, [score])]})
