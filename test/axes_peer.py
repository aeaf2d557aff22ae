# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The peer of an estimator node of several axes."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator

from axes_runs import Instant, JOINTS
from contact_estimation.signals.contact_sample import ContactSample
from ros_messages import FRAME, JointState, to_stamp, WrenchStamped
from ros_peer import Peer, WINDOW
from ros_processes import node_process


class AxesPeer(Peer):
    """A robot with a joint an axis, and one that is none of them."""

    def send(self, sample: ContactSample) -> None:
        """Publish free flight, with which node and peer get to know each other."""
        free = (-0.01, 0.24, -0.51)
        self.send_instant(Instant(sample.stamp_ns, free, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))

    def send_instant(self, sample: Instant) -> None:
        """Publish one sample of all axes on both topics."""
        stamp = to_stamp(sample.stamp_ns)
        joints = JointState(
            name=['elbow', *JOINTS.values()], position=[9.0, *sample.positions],
            velocity=[9.0, *sample.velocities],
        )
        joints.header.stamp = stamp
        self.joints.publish(joints)
        message = WrenchStamped()
        message.header.stamp, message.header.frame_id = stamp, FRAME
        force = message.wrench.force
        force.x, force.y, force.z = sample.forces
        self.wrenches.publish(message)

    def feed_instants(self, samples: list[Instant]) -> None:
        """Publish samples and take what comes for each, a window at a time."""
        for first in range(0, len(samples), WINDOW):
            window = samples[first:first + WINDOW]
            for sample in window:
                self.send_instant(sample)
            self.answered(window[-1].stamp_ns)

    def vectors(self, name: str) -> dict[int, tuple[float, float, float]]:
        """Return published vectors by their stamps."""
        heard = self.heard[name].items()
        return {stamp: (m.vector.x, m.vector.y, m.vector.z) for stamp, m in heard}


@contextmanager
def node_of_axes(folder: Path, parameters: dict[str, Any]) -> Iterator[AxesPeer]:
    """Run an estimator node of several axes; yields the peer that has met it."""
    named = {name.replace('.', '__'): value for name, value in parameters.items()}
    with node_process(folder, 'estimator_node', diagnostics_rate=10.0, **named):
        peer = AxesPeer()
        try:
            peer.meet()
            yield peer
        finally:
            peer.close()
