# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Three force axes at once, over DDS."""

from __future__ import annotations

from typing import Iterator

from axes_peer import AxesPeer, node_of_axes
from axes_runs import feed_axes, instants, moved_instants, PARAMETERS, session_of_axes
import pytest
from ros_peer import ESTIMATES

pytestmark = pytest.mark.slow

SAMPLES = instants(0.5)


@pytest.fixture(scope='module')
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AxesPeer]:
    with node_of_axes(tmp_path_factory.mktemp('axes'), PARAMETERS) as peer:
        yield peer


@pytest.fixture
def peer(shared: AxesPeer) -> AxesPeer:
    shared.start_afresh()
    return shared


def test_published_vectors_are_those_of_the_session_bit_for_bit(peer: AxesPeer) -> None:
    samples = moved_instants(SAMPLES, peer.begin_ns)
    peer.feed_instants(samples)
    results = feed_axes(session_of_axes(), samples)
    for name in ESTIMATES:
        expected = {
            r.sample.stamp_ns: tuple(getattr(e, name) for e in r.estimates)
            for r in results
        }
        assert peer.vectors(name) == expected


def test_status_and_diagnostics_tell_of_every_axis(peer: AxesPeer) -> None:
    peer.change(estimator='kalman')
    peer.feed_instants(moved_instants(SAMPLES, peer.begin_ns))
    peer.start_afresh()  # the status comes on change: that of the start was before the peer
    samples = moved_instants(SAMPLES, peer.begin_ns)
    peer.feed_instants(samples)
    assert peer.statuses()[0].startswith('free: y free, z free')
    assert peer.statuses()[-1] == 'estimating: y estimating, z estimating'
    figures, (_, y, z) = peer.figures(), peer.vectors('stiffness')[samples[-1].stamp_ns]
    assert float(figures['y_stiffness']) == pytest.approx(y, rel=1e-6)
    assert float(figures['z_stiffness']) == pytest.approx(z, rel=1e-6)
    assert figures['z_contact'] == 'True'
