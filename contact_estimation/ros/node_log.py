# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the estimator node writes to its log."""

from __future__ import annotations

import time
from typing import Any, Mapping

from .topics import JOINT_STATES, REFERENCE, TF, WRENCH
from ..pipeline.parameters import EstimationParameters

_AGAIN_S = 10.0  # a warning that stays is repeated after this time
_QUIET_S = 1.0  # between two changes of state


class NodeLog:
    """Start, changes and warnings of an estimator node, throttled."""

    def __init__(self, node: Any) -> None:
        self._node, self._logger = node, node.get_logger()
        self._warned: dict[str, float] = {}
        self._state = ''
        self._state_time = -_QUIET_S

    def started(self, parameters: EstimationParameters) -> None:
        """Write topics, joints, axes and estimator."""
        resolve = self._node.resolve_topic_name
        axes = ', '.join(f'{axis} from joint {joint!r}' if joint else f'{axis} from the only joint'
                         for axis, joint in parameters.joints.items())
        axes += ' in metres'
        if parameters.kinematics.tip:
            axes = f'{parameters.axis} along contact.normal of an arm'
        motion = TF if parameters.pose_source == 'tf' else JOINT_STATES
        x_e = parameters.environment.location
        place = f'x_e = {x_e:g} m' if x_e == x_e else 'x_e taken at the first touch'
        self._logger.info(
            f'estimator {parameters.estimator}, {parameters.reference_law}; force from '
            f'{resolve(WRENCH)}, motion from {resolve(motion)}, axis {axes}; {place}; '
            f'estimates on {resolve("~/stiffness")}, reference on {resolve(REFERENCE)}')

    def changed(self, changes: Mapping[str, Any]) -> None:
        """Write changed parameters."""
        self._logger.info(
            'changed ' + ', '.join(f'{name} = {value!r}' for name, value in changes.items()))

    def event(self, text: str) -> None:
        """Write what a service has done."""
        self._logger.info(text)

    def state(self, text: str, stiffness: float) -> None:
        """Write the state of the estimation where it has changed."""
        now = time.monotonic()
        if text != self._state and now - self._state_time >= _QUIET_S:
            self._state, self._state_time = text, now
            self._logger.info(f'{text} (K_hat = {stiffness:.6g} N/m)')

    def warning(self, name: str, text: str) -> None:
        """Write a warning: at once where it is new, then every ten seconds."""
        now = time.monotonic()
        if now - self._warned.get(name, -_AGAIN_S) >= _AGAIN_S:
            self._warned[name] = now
            self._logger.warning(text)
