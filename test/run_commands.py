# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Commands in this process: an exception that escapes one fails the test."""

from typing import Callable, NamedTuple

import pytest


class Ended(NamedTuple):
    """How a command has ended and what it has said."""

    code: int
    out: str
    err: str


class Command:
    """A command by its name and its `main`."""

    def __init__(
        self, name: str, main: Callable[[list[str]], int], capfd: pytest.CaptureFixture[str]
    ) -> None:
        self._name, self._main, self._capfd = name, main, capfd

    def __call__(self, *arguments: object) -> Ended:
        self._capfd.readouterr()
        try:
            code = self._main([str(argument) for argument in arguments])
        except SystemExit as end:
            code = int(str(end.code))
        return Ended(code, *self._capfd.readouterr())

    def refusal(self, *arguments: object) -> str:
        """Run where the command must refuse; return its one line."""
        ended = self(*arguments)
        lines = ended.err.strip().splitlines()
        assert (ended.code, ended.out, len(lines)) == (1, '', 1), ended
        assert lines[0].startswith(f'{self._name}: ')
        return lines[0]
