# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Experiments by name."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any, Callable

from .excitation import Excitation, Multisine, PseudoRandomBinary, Sine
from .experiment import Experiment, Segment, START
from .experiment_file import read_experiment
from ..exceptions import UnknownNameError

DEPTH = 0.0204
"""Final x_d [m]: 50 N under eq. (1) with the nominal values."""
DESIRED_FORCE = 50.0

FORCE_EXCITATION: dict[str, Excitation | None] = {
    'sine': Sine(8.0, 20.0),  # eq. (40)
    'prbs': PseudoRandomBinary(8.0),
    'multisine': Multisine(8.0, [2.0 * pi * f for f in (0.8, 1.9, 3.2, 5.3, 8.1)]),
    'none': None,
}


def manoeuvre(
    name: str,
    force_excitation: Excitation | None = None,
    position_excitation: Excitation | None = None,
    hold_s: float = 2.0,
    force: float = DESIRED_FORCE,
) -> Experiment:
    """
    Return the manoeuvre of the paper: approach, press, withdraw.

    Parameters
    ----------
    name : str
        Name of the experiment.
    force_excitation : Excitation or None
        Added to F_d while a force is prescribed [N], eq. (40).
    position_excitation : Excitation or None
        Added to x_d from the approach to the end of the withdrawal [m], eq. (41).
    hold_s : float
        Duration of the hold [s].
    force : float
        F_d [N]; NaN: no force prescribed, eq. (1) alone.

    Returns
    -------
    experiment : Experiment
        Lasts 10 s plus `hold_s`.

    """
    pressing: dict[str, Any] = {'force': force, 'position_excitation': position_excitation}
    if force == force:
        pressing['force_excitation'] = force_excitation
    return Experiment(
        name,
        START,
        (
            Segment(4.4, START),
            Segment(2.2, DEPTH, **pressing),
            Segment(hold_s, DEPTH, **pressing),
            Segment(2.2, START, position_excitation=position_excitation),
            Segment(1.2, START),
        ),
    )


def rich() -> Experiment:
    """
    Return three episodes that differ in speed, depth and excitation.

    No force is prescribed, eq. (1) alone: suited to recordings for `diagnose`.

    Returns
    -------
    experiment : Experiment
        Lasts 15.8 s.

    """
    away = -0.02

    def touch(approach_s: float, depth: float, amplitude: float, *omegas: float) -> list[Segment]:
        excitation = Multisine(amplitude, list(omegas))
        return [
            Segment(approach_s, depth), Segment(0.3, depth),
            Segment(3.0, depth, position_excitation=excitation), Segment(0.8, away),
        ]

    return Experiment('rich', away, (
        Segment(0.5, away),
        *touch(0.8, 0.012, 0.002, 5.0, 11.0, 23.0),
        *touch(0.5, 0.020, 0.003, 4.0, 9.0, 17.0),
        *touch(1.5, 0.024, 0.002, 6.0, 13.0, 27.0),
        Segment(0.3, away),
    ))


EXPERIMENTS: dict[str, Callable[[], Experiment]] = {
    'sine': lambda: manoeuvre('sine', FORCE_EXCITATION['sine']),
    'prbs': lambda: manoeuvre('prbs', FORCE_EXCITATION['prbs']),
    'multisine': lambda: manoeuvre('multisine', FORCE_EXCITATION['multisine']),
    'none': lambda: manoeuvre('none'),
    'long': lambda: manoeuvre('long', FORCE_EXCITATION['sine'], hold_s=12.0),
    'rich': rich,
}


def experiment_named(name: str) -> Experiment:
    """
    Return an experiment by name, or read it from a YAML file.

    Parameters
    ----------
    name : str
        Key of EXPERIMENTS, or path of a file ending in .yaml or .yml.

    Returns
    -------
    experiment : Experiment
        The experiment.

    Raises
    ------
    UnknownNameError
        If the name is unknown.
    ModelFileError
        If the file is missing or does not follow the schema.

    """
    if name in EXPERIMENTS:
        return EXPERIMENTS[name]()
    if Path(name).suffix in ('.yaml', '.yml'):
        return read_experiment(Path(name))
    raise UnknownNameError.among('experiment', name, [*EXPERIMENTS, 'FILE.yaml'])
