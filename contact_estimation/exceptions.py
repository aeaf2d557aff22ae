# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Exceptions of this package: wrong use, wrong configuration, unusable data."""

import difflib
from typing import Iterable, Sequence

from .texts import printable


class ContactEstimationError(Exception):
    """
    Base class of all exceptions of this package.

    Commands print the text as one line on stderr and exit with 1. The text states what is wrong,
    what was expected, what was received and what to change. What it quotes of files is escaped.

    """

    def __str__(self) -> str:
        """Return the text as one printable line."""
        return printable(super().__str__())


class ParameterRangeError(ContactEstimationError, ValueError):
    """A parameter is out of its range or has the wrong type."""


class ParameterReadOnlyError(ContactEstimationError, ValueError):
    """A parameter that is fixed at start was to be changed."""


class UnknownNameError(ContactEstimationError, ValueError):
    """A name (of an estimator, effect, law, experiment or key) is unknown."""

    @classmethod
    def among(cls, kind: str, name: object, known: Iterable[str]) -> 'UnknownNameError':
        """
        Return the error with the nearest known name and the list of valid names.

        For a dotted name only the names of its innermost known group are listed.

        kind: kind of the name, such as 'estimator'
        name: name received
        known: valid names
        Returns error: error to be raised
        """
        names, group, where = sorted(known), '', ''
        choices, wrong = names, str(name)
        if '.' in wrong:
            group = _known_group(wrong, names)
            wrong = wrong[len(group):].split('.')[0]
            choices = sorted({each[len(group):].split('.')[0] for each in names
                              if each.startswith(group)})
            where = f' in {group[:-1]}' if group else ''
        near = difflib.get_close_matches(wrong, choices, n=1, cutoff=0.5)
        if near:  # complete it to a full name
            full = [each for each in names if (each + '.').startswith(f'{group}{near[0]}.')]
            near = difflib.get_close_matches(str(name), full, n=1, cutoff=0.0)
        hint = f'did you mean {near[0]!r}? ' if near else ''
        return cls(f'unknown {kind} {name!r}; {hint}known{where}: {", ".join(choices)}')


def _known_group(name: str, known: Sequence[str]) -> str:
    """Return the longest prefix, including its dot, that known names share with a name."""
    parts = name.split('.')
    groups = ('.'.join(parts[:count]) + '.' for count in range(len(parts) - 1, 0, -1))
    return next((group for group in groups if any(each.startswith(group) for each in known)), '')


class SignalShapeError(ContactEstimationError, ValueError):
    """Arrays that must match differ in shape."""


class EstimationError(ContactEstimationError):
    """The data do not contain what an off-line estimator needs."""


class RecordingError(ContactEstimationError):
    """A recording cannot be read or lacks required data."""


class ModelFileError(ContactEstimationError):
    """A model, parameter or experiment file is invalid."""


class FleetError(ContactEstimationError):
    """The workers of a fleet do not answer, or differ from each other."""


class MissingPackageError(ContactEstimationError, ImportError):
    """An optional Python package that this command needs is not installed."""

    @classmethod
    def of(cls, package: str, needed_for: str) -> 'MissingPackageError':
        """
        Return the error with the command that installs the package.

        package: name on PyPI
        needed_for: feature that needs the package
        Returns error: error to be raised
        """
        return cls(
            f'{needed_for} needs the Python package {package!r}, which is not installed; '
            f'install it with: pip install {package}')


class MessageError(ContactEstimationError, ValueError):
    """
    A received message cannot be used.

    reason: short key for counting: 'malformed', 'joint_empty', 'joint_unknown', 'joint_ambiguous'
    or 'trajectory_empty'
    """

    def __init__(self, reason: str, text: str) -> None:
        super().__init__(text)
        self.reason = reason
