# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Errors that this package raises on purpose: wrong use or configuration, unusable data."""

from __future__ import annotations

import difflib
from typing import Iterable


class ContactEstimationError(Exception):
    """
    Base of all errors raised on purpose.

    Commands print its text as one line on stderr and exit with 1. The text names what is wrong,
    what was expected, what was received and what to change.

    """


class ParameterRangeError(ContactEstimationError, ValueError):
    """A parameter is out of its range or has the wrong type."""


class ParameterReadOnlyError(ContactEstimationError, ValueError):
    """A parameter that is fixed at start was asked to change."""


class UnknownNameError(ContactEstimationError, ValueError):
    """A name (estimator, effect, law, experiment, key) is not among the known ones."""

    @classmethod
    def among(cls, kind: str, name: object, known: Iterable[str]) -> 'UnknownNameError':
        """
        Build the error with the nearest known name and the list of all.

        Parameters
        ----------
        kind : str
            What the name stands for, such as 'estimator'.
        name : object
            The name received.
        known : iterable of str
            The valid names.

        Returns
        -------
        error : UnknownNameError
            Ready to be raised.

        """
        names = sorted(known)
        near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.5)
        hint = f'did you mean {near[0]!r}? ' if near else ''
        return cls(f'unknown {kind} {name!r}; {hint}known: {", ".join(names)}')


class SignalShapeError(ContactEstimationError, ValueError):
    """Arrays that belong together differ in shape."""


class EstimationError(ContactEstimationError):
    """The data do not show what an off-line estimator needs."""


class RecordingError(ContactEstimationError):
    """A recording cannot be read, or lacks what is needed."""


class ModelFileError(ContactEstimationError):
    """A model, parameter or experiment file cannot be understood."""


class MissingPackageError(ContactEstimationError, ImportError):
    """An optional Python package that this command needs is not installed."""

    @classmethod
    def of(cls, package: str, needed_for: str) -> 'MissingPackageError':
        """
        Build the error with both ways to install the package.

        Parameters
        ----------
        package : str
            Name on PyPI.
        needed_for : str
            What cannot be done without it.

        Returns
        -------
        error : MissingPackageError
            Ready to be raised.

        """
        return cls(
            f'{needed_for} needs the Python package {package!r}, which is not installed; '
            f'install it with: pip install {package}'
        )


class MessageError(ContactEstimationError, ValueError):
    """
    A received message cannot be used.

    Attributes
    ----------
    reason : str
        Short key for counting: 'malformed', 'joint_empty', 'joint_unknown', 'joint_ambiguous'
        or 'trajectory_empty'.

    """

    def __init__(self, reason: str, text: str) -> None:
        super().__init__(text)
        self.reason = reason
