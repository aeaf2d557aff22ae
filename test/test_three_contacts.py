# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The example of eq. (6): three points that come, slide and go."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from contact_estimation.estimators.contact_points_estimator import ContactPointsEstimate
from contact_estimation.studies import three_contacts as command
from contact_estimation.studies.three_contacts import (
    ALL_TOUCH_S, errors_of, estimate, Instant, RATE, simulate, VARIANTS)
import pytest

ALL_TOUCH = round(ALL_TOUCH_S * RATE)


@lru_cache(maxsize=None)
def simulated() -> list[Instant]:
    """Simulate once for all tests."""
    return simulate(0)


@lru_cache(maxsize=None)
def estimates(variant: str) -> list[ContactPointsEstimate]:
    """Estimate once for all tests."""
    return estimate(simulated(), variant)


@pytest.mark.slow
@pytest.mark.parametrize('variant', ['friction estimated', 'friction known'])
@pytest.mark.parametrize('place', [ALL_TOUCH, -1])
def test_with_friction_stiffness_and_damping_are_true(variant: str, place: int) -> None:
    e = estimates(variant)[place]
    off = errors_of(e)
    assert abs(off.stiffness_percent) < 0.3
    assert abs(off.damping_percent) < 1.0
    assert abs(off.friction) < 0.003
    assert e.stiffness_std < 3.0 and e.damping_std < 1.0  # so the bounds are no idle ones


@pytest.mark.slow
def test_command_prints_the_estimates_and_draws_them(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip('matplotlib')
    monkeypatch.setattr(command, 'simulate', lambda seed: simulated())
    monkeypatch.setattr(command, 'estimate', lambda instants, variant: estimates(variant))
    assert command.main(['--output', str(tmp_path / 'new')]) == 0
    out = capfd.readouterr().out
    assert all(out.count(f'  {variant} ') == 2 for variant in VARIANTS)
    assert (tmp_path / 'new' / 'three_contacts.png').stat().st_size > 10_000
    assert (tmp_path / 'new' / 'three_contacts.json').exists()
