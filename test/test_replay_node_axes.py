# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Replay of several axes gives what the node has published, to the bit."""

from __future__ import annotations

from math import nan
from pathlib import Path
import signal

from axes_peer import node_of_axes
from axes_runs import Instant, instants, JOINTS, LOCATIONS, moved_instants, WALLS
from contact_estimation.exceptions import RecordingError
from contact_estimation.messages import Vector3StampedDecoder
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.stamp_screen import CONFIRMING
import pytest
from ros_peer import ESTIMATES, PERIOD_NS
from ros_processes import node_process, wait_until_recorded

pytestmark = pytest.mark.slow

SAMPLES = instants(0.5)


def recorded(folder: Path, name: str) -> dict[int, tuple[float, ...]]:
    """Read recorded vectors by their stamps; nothing where there is no recording yet."""
    decode = Vector3StampedDecoder().decode
    try:
        messages = RecordingReader(folder).messages([f'/estimator_node/{name}'])
        return {v[0]: v[1:] for v in (decode(m.data) for m in messages)}
    except RecordingError:
        return {}


def recording_has_inputs(folder: Path) -> bool:
    """Tell whether the recorder hears both sensors and the events."""
    wanted = {'/wrench', '/joint_states', '/estimator_node/events'}
    return set(RecordingReader(folder).topics()) >= wanted


def replayed(folder: Path, name: str) -> dict[int, tuple[float, ...]]:
    """Replay; the axes are z and x, and y is not estimated."""
    replay = RecordingReplay(RecordingReader(folder), RecordingSource(), {})
    return {
        z.stamp_ns: (getattr(x, name), nan, getattr(z, name))
        for batch in replay.estimates() for z, x in batch
    }


def biased(samples: list[Instant]) -> list[Instant]:
    """Put free flight before the samples, and a bias on all forces."""
    rest = [samples[0]._replace(stamp_ns=k * PERIOD_NS) for k in range(300)]
    together = rest + moved_instants(samples, 300 * PERIOD_NS)
    return [s._replace(forces=tuple(f - 2.0 for f in s.forces)) for s in together]


def test_replay_of_two_axes_equals_the_node_bit_for_bit(tmp_path: Path) -> None:
    folder = tmp_path / 'recording'
    parameters = {'axis': 'z', 'joint': JOINTS['z'], 'environment.location': LOCATIONS['z'],
                  'further_axes.x.joint': JOINTS['x']}
    with node_of_axes(tmp_path / 'node', parameters) as peer, node_process(
        tmp_path / 'recorder', 'recorder_node', output=folder
    ) as recorder:
        knock = iter(range(peer.begin_ns + 10**9, peer.begin_ns + 10**12, PERIOD_NS))

        def complete() -> bool:
            """Send some more samples, enough to be believed after a silence, and look."""
            peer.feed([ContactSample(next(knock), -0.01, 0.0, 0.0) for _ in range(CONFIRMING)])
            there = all(recorded(folder, name) for name in ESTIMATES)
            return there and recording_has_inputs(folder)

        peer.spin_until(complete, 'every topic in the recording')
        assert peer.trigger('reset').success
        samples = moved_instants(biased(SAMPLES), next(knock) + 10**9)
        peer.feed_instants(samples[:290])
        assert peer.trigger('tare').success
        peer.feed_instants(samples[290:600])
        peer.change(estimator='rls', further_axes__x__location=1e-4)
        peer.feed_instants(samples[600:])
        last = samples[-1].stamp_ns
        outputs = [f'/estimator_node/{name}' for name in ESTIMATES]
        wait_until_recorded(folder, ['/wrench', '/joint_states', *outputs], last)
        recorder.signal(signal.SIGINT)
        assert recorder.end().code == 0
    for name in ESTIMATES:
        node, again = recorded(folder, name), replayed(folder, name)
        wrong = [s.stamp_ns for s in samples
                 if repr(list(node[s.stamp_ns])) != repr(list(again[s.stamp_ns]))]
        assert wrong == []
    assert node[last][0] == pytest.approx(WALLS['x'][1], rel=0.2)
