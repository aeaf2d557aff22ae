# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Processor time of the kinematics of an arm, against a step of filterpy's Kalman filter."""

from __future__ import annotations

from statistics import median
import time
from typing import Any, Callable, Mapping

from .arm_files import ArmFiles
from .simulation import Run
from ..benchmarks.contact_data import contact_data
from ..benchmarks.estimator_steps import filterpy_step
from ...kinematics.contact_kinematics import ArmSample
from ...parameters.values import build
from ...pipeline.arm_kinematics import kinematics_of
from ...pipeline.parameters import EstimationParameters

_BLOCK = 250  # samples, so that both see the same load of the machine
_BLOCKS = 12


def kinematics_cost(files: ArmFiles, run: Run, tool: Mapping[str, Any]) -> dict[str, float]:
    """
    Time the way from joints and wrench to x, v and F_e, without the load of the tool.

    Returns cost: `kinematics_us`: processor time a sample [us], median over blocks; `to_filterpy`:
    its ratio to predict and update of filterpy's Kalman filter, in turn with it
    """
    parameters = build(EstimationParameters, {**files.parameters(run), **tool})
    arm = kinematics_of(parameters, files.description.read_text())
    q_dot = [0.0] * run.q.shape[1]
    samples = [ArmSample(0, [*q, *q_dot], wrench) for q, wrench in zip(
        run.q[:_BLOCK].tolist(), run.wrench[:_BLOCK].tolist())]
    reference = filterpy_step(contact_data(_BLOCK * _BLOCKS / 500.0 + 1.0))
    own, others = [], []
    for block in range(_BLOCKS):
        own.append(_timed(lambda: [arm.contact(sample) for sample in samples]))
        begin = block * _BLOCK
        others.append(_timed(lambda: reference(begin, begin + _BLOCK)))
    return {'kinematics_us': median(own[1:]), 'to_filterpy': median(own[1:]) / median(others[1:])}


def _timed(work: Callable[[], object]) -> float:
    begin = time.process_time_ns()
    work()
    return (time.process_time_ns() - begin) * 1e-3 / _BLOCK
