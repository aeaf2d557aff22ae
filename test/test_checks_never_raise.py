# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""No check raises, whatever it is shown."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from contact_estimation.parameters.values import build
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.pipeline.checks import CHECKS, InputChecks
from contact_estimation.pipeline.checks.check import Evidence, Forces
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.signals.contact_sample import ContactSample
from hypothesis import given, settings, strategies as st
import numpy as np
from numpy.typing import NDArray
import pytest

ARM = {'kinematics.base': 'base_link', 'kinematics.tip': 'tool',
       'contact.normal': [0.0, 0.0, -1.0]}
SHAPES = ('constant', 'line', 'noise', 'alternating', 'steps', 'sine')
STEPS = (0.0, 1e-9, 2e-6, 2e-3, 1e-1, 10.0)


def signal(draw: Any, count: int) -> NDArray[np.float64]:
    """Draw a signal of some shape and size."""
    size = draw(st.sampled_from([0.0, 1e-300, 1e-12, 1e-3, 1.0, 50.0, 1e6, 1e160, 1e300]))
    shape, k = draw(st.sampled_from(SHAPES)), np.arange(count)
    noise = np.random.default_rng(draw(st.integers(0, 9))).standard_normal(count)
    values = {'constant': np.ones(count), 'line': k / max(count, 1), 'noise': noise,
              'alternating': (-1.0)**k, 'steps': np.floor(k / 100.0), 'sine': np.sin(0.05 * k)}
    return np.asarray(size * values[shape] + draw(st.sampled_from([0.0, -1.0, 1e-6])) * noise)


@st.composite
def evidence(draw: Any) -> Evidence:
    """Draw evidence: tiny windows, stamps that repeat, constant and huge signals."""
    count = draw(st.sampled_from([0, 1, 2, 3, 4, 17, 100, 250, 1000]))
    random = np.random.default_rng(draw(st.integers(0, 9)))
    steps = random.choice(draw(st.lists(st.sampled_from(STEPS), min_size=1)), size=count)
    t = np.cumsum(steps) - (steps[0] if count else 0.0)
    x, force = signal(draw, count), signal(draw, count)
    v = np.full(count, np.nan) if draw(st.booleans()) else signal(draw, count)
    contact = random.uniform(size=count) < draw(st.sampled_from([0.0, 0.5, 1.0]))
    parameters = build(EstimationParameters, ARM if draw(st.booleans()) else {})
    few = min(count, draw(st.sampled_from([0, 1, 1000])))
    return Evidence(
        'x', parameters, EstimationPipeline(), t, x, v, force, contact,
        (Forces('y', signal(draw, few), x[:few]),),
        draw(st.sampled_from([float('nan'), 0.0, 1e-9, 50.0, 500.0, 1e9])),
        float(np.ptp(x)) if count else 0.0, t[:few], draw(st.sampled_from([0.0, 1.7e9])),
        draw(st.sampled_from([(), (90.0,), (0.1,)])), {0: ('elbow', -3.0, 3.0)})


@given(evidence())
@settings(derandomize=True, deadline=None, max_examples=100)
def test_every_check_returns_a_text_or_none(seen: Evidence) -> None:
    with np.errstate(all='ignore'):
        for check in CHECKS:
            assert isinstance(check.judge(seen), (str, type(None)))


@pytest.mark.parametrize('change', [
    lambda k, s: s._replace(force=-27.0),
    lambda k, s: s._replace(position=0.003, velocity=0.0, force=-27.0),
    lambda k, s: s._replace(stamp_ns=s.stamp_ns - s.stamp_ns % 10_000_000 + 2000 * (k % 5)),
])
def test_a_session_judges_frozen_signals_and_bursts(change: Any) -> None:
    pipeline = EstimationPipeline()
    checks = InputChecks(EstimationParameters(), {'x': pipeline})
    noise = np.random.default_rng(0).normal(0.0, 0.6, 1500).tolist()
    for k, force in enumerate(noise):
        sample = ContactSample(10**9 + 2_000_000 * k, 1e-3 * np.sin(0.04 * k), 0.0, force - 20.0)
        sample = change(k, sample)
        estimate = SimpleNamespace(status=None)
        checks.add((sample,), ((0,) * 7 + (estimate,),))  # type: ignore[arg-type]
    assert all(isinstance(one.text, str) for one in checks.warnings())
