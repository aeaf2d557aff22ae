# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimator node with a managed life cycle, for systems that a lifecycle manager starts."""

from typing import Any, Sequence

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn

from .estimator_node import all_specifications, EstimatorNode
from .running import run_node
from .topics import WRENCH

PURPOSE = ('managed_estimator_node: estimator_node as a managed (lifecycle) node of ROS 2; it '
           'takes data and publishes only while it is active')


class ManagedEstimatorNode(EstimatorNode, LifecycleNodeMixin):
    """
    An `EstimatorNode` that is silent unless it is active.

    Parameters can be set in every state. What arrives while the node is not active is ignored, so
    that a deactivation is a gap in the stamps. Cleaning up resets the estimate.
    """

    def __init__(self) -> None:
        self._active = False
        EstimatorNode.__init__(self)
        LifecycleNodeMixin.__init__(self)
        # rclpy raises where a transition is not possible now, which would end the process.
        service = self._service_change_state
        change = service.callback

        def answer(request: Any, response: Any) -> Any:
            try:
                return change(request, response)
            except rclpy_implementation.RCLError:
                self.get_logger().error(
                    f'transition {request.transition.id} is not possible in the state '
                    f'{self._state_machine.current_state[1]}')
                response.success = False
                return response

        service.callback = answer

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take data from now on."""
        self._thread.catch_up()  # what arrived before is ignored, also if it is not served yet
        self._diagnostics.arrived()  # silence counts from here
        self._active = True
        self.get_logger().info('active')
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Ignore data from now on."""
        self._active = False
        self.get_logger().info('not active')
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Reset the estimate."""
        self._reset()
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """End the process."""
        self._active, self.finished = False, True
        return super().on_shutdown(state)

    def _on_wrench(self, raw: bytes) -> None:
        if self._active:
            super()._on_wrench(raw)

    def _on_motion(self, raw: bytes) -> None:
        if self._active:
            super()._on_motion(raw)

    def _on_desired(self, raw: bytes) -> None:
        if self._active:
            super()._on_desired(raw)

    def _report(self) -> None:
        if self._active:
            super()._report()


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until it is shut down or interrupted."""
    return run_node(ManagedEstimatorNode, PURPOSE, all_specifications(), args, WRENCH)
