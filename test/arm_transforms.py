# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The small arm as `robot_state_publisher` would publish it on tf."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, Sequence

from arm_contact import instants, messages, PARAMETERS
from reference_messages import transforms_bytes
from scipy.spatial.transform import Rotation
from small_arm import FIXED, MOVING, step

OF_TF: dict[str, Any] = {**PARAMETERS, 'pose_source': 'tf'}


def transform(q: Any, link: str, stamp_ns: int = 0) -> tuple[int, str, str, Any]:
    """Return stamp, parent, child and pose of a link."""
    parent, T = step(q, link)
    turned = Rotation.from_matrix(T[:3, :3]).as_quat()
    return stamp_ns, parent, link, (*T[:3, 3].tolist(), *turned.tolist())


def static_bytes(links: Sequence[str] = FIXED) -> bytes:
    return transforms_bytes([transform((0.0, 0.0, 0.0), link) for link in links])


@lru_cache(maxsize=None)
def tf_messages(every: int = 1, split: bool = False) -> list[tuple[str, int, bytes]]:
    """
    Return topic, stamp and content of all messages, transforms in place of joint states.

    Transforms are given with every so many wrenches, in one message or from two publishers of
    which the second comes late.
    """
    listed = [('/tf_static', 0, static_bytes())]
    truth = {one.contact.stamp_ns: one.q for one in instants()}
    wrenches = [m for m in messages() if m[0] == '/wrench']
    for number, (topic, stamp_ns, raw) in enumerate(wrenches):
        if number % every == 0:
            parts = [MOVING[:2], MOVING[2:]] if split else [MOVING]
            for part in parts:
                listed.append(('/tf', stamp_ns, transforms_bytes(
                    [transform(truth[stamp_ns], link, stamp_ns) for link in part])))
        listed.append((topic, stamp_ns, raw))
    return listed
