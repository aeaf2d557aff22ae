# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The pipelines of all axes, and what looks at several of them."""

from __future__ import annotations

from .axis_pipeline import EstimationPipeline
from .checks.input_checks import InputChecks
from .matrix_estimation import MatrixEstimation
from .parameters import EstimationParameters


class AxesEstimation:
    """
    A pipeline for each axis, the on-line checks of them, and the matrix of three.

    What concerns all of them at once; samples pass through the session.
    """

    def __init__(self, parameters: EstimationParameters) -> None:
        self.pipelines = {
            axis: EstimationPipeline(parameters.of_axis(axis)) for axis in parameters.joints
        }
        self.checks = InputChecks(parameters, self.pipelines)
        self.matrix = MatrixEstimation(parameters)

    def configure(self, parameters: EstimationParameters) -> None:
        """Set new parameters while running; K_hat and B_hat stay."""
        for axis, pipeline in self.pipelines.items():
            pipeline.configure(parameters.of_axis(axis))
        self.matrix.configure(parameters)
        self.checks.configure(parameters)

    def restart_time(self) -> None:
        """Accept stamps before the last one, as when a bag loops; K_hat and B_hat stay."""
        for pipeline in self.pipelines.values():
            pipeline.restart_time()
        self.checks.restart()

    def reset(self) -> None:
        """Reset K_hat and B_hat to their initial values."""
        self.matrix.reset()
        for pipeline in self.pipelines.values():
            pipeline.reset()
        self.checks.reset()

    def tare(self) -> tuple[bool, str]:
        """Set the force bias to the mean force of the last moments of free flight."""
        messages = {axis: p.tare_refusal() for axis, p in self.pipelines.items()}
        done = not any(messages.values())
        if done:
            messages = {axis: p.tare()[1] for axis, p in self.pipelines.items()}
        if len(messages) == 1:
            return done, next(iter(messages.values()))
        return done, '; '.join(f'{axis}: {text}' for axis, text in messages.items() if text)
