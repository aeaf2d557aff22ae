# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Three force axes at once, over DDS."""

from typing import Any, Iterator

from axes_runs import (
    feed_axes, Instant, instants, JOINTS, moved_instants, PARAMETERS, session_of_axes)
import pytest
from ros_messages import FRAME, JointState, to_stamp, WrenchStamped
from ros_peer import ESTIMATES, Peer
from ros_processes import node_process

pytestmark = pytest.mark.slow

SAMPLES = instants(0.5)


class AxesPeer(Peer):
    """A robot with a joint an axis, and one that is none of them."""

    def send(self, sample: Any) -> None:
        """Publish an instant, or free flight with which node and peer get to know each other."""
        if not isinstance(sample, Instant):
            sample = Instant(sample.stamp_ns, (-0.01, 0.24, -0.51), (0.0,) * 3, (0.0,) * 3)
        joints = JointState(name=['elbow', *JOINTS.values()], position=[9.0, *sample.positions],
                            velocity=[9.0, *sample.velocities])
        wrench = WrenchStamped()
        wrench.header.frame_id = FRAME
        joints.header.stamp = wrench.header.stamp = to_stamp(sample.stamp_ns)
        force = wrench.wrench.force
        force.x, force.y, force.z = sample.forces
        self.joints.publish(joints)
        self.wrenches.publish(wrench)

    def vectors(self, name: str) -> dict[int, tuple[float, float, float]]:
        """Return published vectors by their stamps."""
        heard = self.heard[name].items()
        return {stamp: (m.vector.x, m.vector.y, m.vector.z) for stamp, m in heard}


@pytest.fixture(scope='module')
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[AxesPeer]:
    with node_process(tmp_path_factory.mktemp('axes'), 'estimator_node', diagnostics_rate=10.0,
                      **PARAMETERS):
        peer = AxesPeer()
        try:
            peer.meet()
            yield peer
        finally:
            peer.close()


def test_published_vectors_are_those_of_the_session_bit_for_bit(peer: AxesPeer) -> None:
    samples: Any = moved_instants(SAMPLES, peer.begin_ns)
    peer.feed(samples)
    results = feed_axes(session_of_axes(), samples)
    for name in ESTIMATES:
        assert peer.vectors(name) == {
            r.sample.stamp_ns: tuple(getattr(e, name) for e in r.estimates) for r in results}


def test_status_and_diagnostics_tell_of_every_axis(peer: AxesPeer) -> None:
    samples: Any = moved_instants(SAMPLES, peer.begin_ns)
    peer.change(estimator='kalman')
    peer.feed(samples)
    peer.start_afresh()  # the status comes on change: that of the start was before the peer
    samples = moved_instants(SAMPLES, peer.begin_ns)
    peer.feed(samples)
    assert peer.statuses()[0].startswith('free: y free, z free')
    assert peer.statuses()[-1] == 'estimating: y estimating, z estimating'
    figures, (_, y, z) = peer.figures(), peer.vectors('stiffness')[samples[-1].stamp_ns]
    assert float(figures['y_stiffness']) == pytest.approx(y, rel=1e-6)
    assert float(figures['z_stiffness']) == pytest.approx(z, rel=1e-6)
    assert figures['z_contact'] == 'True'
