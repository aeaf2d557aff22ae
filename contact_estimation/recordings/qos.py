# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The quality of service under which a topic was published, as rosbag2 records it."""

from __future__ import annotations

import dataclasses
from typing import Any

import yaml

# What rmw calls an infinite duration.
_INFINITE = {'sec': 9223372036, 'nsec': 854775807}


@dataclasses.dataclass(frozen=True)
class OfferedQos:
    """Quality of service of a publisher."""

    reliability: str = 'reliable'  # 'reliable' or 'best_effort'
    depth: int = 10  # length of the queue
    durability: str = 'volatile'  # 'volatile' or 'transient_local'
    history: str = 'keep_last'  # 'keep_last' or 'keep_all'

    @classmethod
    def of_profile(cls, profile: Any) -> 'OfferedQos':
        """Convert a rclpy.qos.QoSProfile."""
        return cls(
            reliability=profile.reliability.name.lower(),
            depth=profile.depth,
            durability=profile.durability.name.lower(),
            history=profile.history.name.lower(),
        )

    def as_profiles(self) -> list[dict[str, Any]]:
        """Return the list of profiles that rosbag2 writes to metadata.yaml (version 9)."""
        return [
            {
                'history': self.history,
                'depth': self.depth,
                'reliability': self.reliability,
                'durability': self.durability,
                'deadline': dict(_INFINITE),
                'lifespan': dict(_INFINITE),
                'liveliness': 'automatic',
                'liveliness_lease_duration': dict(_INFINITE),
                'avoid_ros_namespace_conventions': False,
            }
        ]

    def as_text(self) -> str:
        """Return the profiles as the YAML text that rosbag2 writes to an MCAP channel."""
        return yaml.safe_dump(self.as_profiles(), sort_keys=False).strip()
