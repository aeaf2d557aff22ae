# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Wrench and joint samples are paired by their stamps alone."""

from __future__ import annotations

from math import inf, nan

from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.synchronisation import SynchronisationParameters, Synchroniser
import numpy as np
import pytest

MS = 1_000_000
Message = tuple[str, int]  # kind, stamp_ns


def synchroniser() -> Synchroniser:
    """Make a synchroniser: time-out 100 ms, gap 50 ms, jump 500 ms."""
    return Synchroniser(SynchronisationParameters())


def send(of: Synchroniser, messages: list[Message]) -> list[ContactSample]:
    """Send messages whose content follows from their stamps."""
    samples: list[ContactSample] = []
    for kind, stamp in messages:
        if kind == 'wrench':
            samples.extend(one for (one,) in of.add_wrench(stamp, (-1e-6 * stamp,)))
        else:
            motion = 1e-9 * stamp, 1.0 + 1e-12 * stamp
            samples.extend(one for (one,) in of.add_motion(stamp, motion))
    return samples


def streams(milliseconds: range, shift_ns: int = 0) -> list[Message]:
    """Wrench and joint at the same times, the joint later by a shift."""
    return [m for t in milliseconds for m in
            (('wrench', t * MS), ('joint', t * MS + shift_ns))]


def stamps_ms(samples: list[ContactSample]) -> list[float]:
    """Stamps in milliseconds."""
    return [sample.stamp_ns / MS for sample in samples]


def test_motion_is_interpolated_to_the_wrench() -> None:
    of = synchroniser()
    of.add_motion(0, (1.0, 10.0))
    of.add_wrench(3 * MS, (-5.0,))
    ((sample,),) = of.add_motion(4 * MS, (2.0, 20.0))
    assert sample == ContactSample(3 * MS, 1.75, 17.5, -5.0)


def test_wrench_waits_for_a_joint_sample_at_or_after_it() -> None:
    of = synchroniser()
    of.add_motion(0, (1.0, 0.0))
    assert not list(of.add_wrench(MS, (0.0,)))
    ((sample,),) = of.add_motion(2 * MS, (1.0, 0.0))
    assert sample.stamp_ns == MS


@pytest.mark.parametrize('kind', ['wrench', 'joint'])
def test_duplicate_is_counted_and_the_rest_unharmed(kind: str) -> None:
    of, messages = synchroniser(), streams(range(0, 20, 2))
    doubled = [m for m in messages for _ in range(2 if m == (kind, 10 * MS) else 1)]
    assert send(of, doubled) == send(synchroniser(), messages)
    assert of.rejected == {f'{kind}_duplicate': 1}


@pytest.mark.parametrize('kind', ['wrench', 'joint'])
def test_late_sample_is_counted_and_the_rest_unharmed(kind: str) -> None:
    of, messages = synchroniser(), streams(range(0, 20, 2))
    at = messages.index((kind, 10 * MS)) + 1
    late = [*messages[:at], (kind, 7 * MS), *messages[at:]]
    assert send(of, late) == send(synchroniser(), messages)
    assert of.rejected == {f'{kind}_out_of_order': 1}


@pytest.mark.parametrize('force', [nan, inf, -inf])
def test_wrench_that_is_not_finite_is_counted_and_the_rest_unharmed(force: float) -> None:
    of = synchroniser()
    samples = send(of, streams(range(0, 10, 2)))
    of.add_wrench(10 * MS, (force,))
    samples += send(of, [('joint', 10 * MS), *streams(range(12, 20, 2))])
    assert stamps_ms(samples) == [0, 2, 4, 6, 8, 12, 14, 16, 18]
    assert of.rejected == {'wrench_not_finite': 1}


@pytest.mark.parametrize('position', [nan, inf, -inf])
def test_joint_that_is_not_finite_is_counted_and_bridged(position: float) -> None:
    of = synchroniser()
    samples = send(of, streams(range(0, 10, 2)))
    of.add_motion(10 * MS, (position, 0.0))
    samples += send(of, [('wrench', 10 * MS), *streams(range(12, 20, 2))])
    assert stamps_ms(samples) == list(range(0, 20, 2))
    assert samples[5].position == pytest.approx(1e-9 * 10 * MS)
    assert of.rejected == {'joint_not_finite': 1}


def test_wrench_is_given_up_after_the_time_out_in_stamps() -> None:
    of = synchroniser()
    send(of, [('joint', 0), ('wrench', 2 * MS), ('wrench', 102 * MS)])
    assert not of.rejected
    send(of, [('wrench', 103 * MS)])
    assert of.rejected == {'joint_missing': 1}


@pytest.mark.parametrize('first', ['wrench', 'joint'])
def test_time_that_jumps_back_starts_anew(first: str) -> None:
    of, again = synchroniser(), streams(range(2, 22, 2))
    again.sort(key=lambda m: (m[1], m[0] != first))
    send(of, streams(range(5000, 5020, 2)))
    assert send(of, again) == send(synchroniser(), again)
    assert of.time_jumps == 1 and of.jumped


def test_any_arrival_within_the_time_out_gives_bit_identical_samples() -> None:
    for seed in range(5):
        for shift_ns in [0, 700_000]:
            random = np.random.default_rng(seed)
            messages = streams(range(0, 1000, 2), shift_ns)
            delay = {'wrench': 0.0, 'joint': 0.0}
            arrivals: list[tuple[float, int, Message]] = []
            for kind, stamp in messages:  # each topic keeps its order
                delay[kind] = max(delay[kind], stamp + float(random.uniform(0.0, 45.0)) * MS)
                arrivals.append((delay[kind], len(arrivals), (kind, stamp)))
            shuffled = [message for _, _, message in sorted(arrivals)]
            of, expected = synchroniser(), synchroniser()
            assert send(of, shuffled) == send(expected, messages), (seed, shift_ns)
            assert of.rejected == expected.rejected, (seed, shift_ns)
