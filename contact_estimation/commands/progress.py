# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Progress bar of the commands: on stderr, only on a terminal, cleared at the end."""

from typing import Any, Callable, Mapping

from tqdm import tqdm

from ..scheduling import Call, workers

_FORMAT = '{desc} {percentage:5.1f} %|{bar}| {remaining} left{postfix}'

tqdm.monitor_interval = 0  # no thread of its own: commands fork worker processes


class Progress:
    """Show the completed fraction of a command, at most twice a second."""

    def __init__(self, name: str) -> None:
        # disable=None: silent unless stderr is a terminal; smoothing=0: mean rate since start.
        self._stages = 0
        self._bar = tqdm(
            desc=name, total=1.0, disable=None, leave=False, dynamic_ncols=True,
            delay=0.5, mininterval=0.5, miniters=0, smoothing=0.0, bar_format=_FORMAT)

    def show(self, fraction: float, text: str = '') -> None:
        """Update the bar."""
        self._bar.set_postfix_str(text, refresh=False)
        self._bar.update(fraction - self._bar.n)

    def stage(self, expected: int) -> Callable[[str], None]:
        """Return what shows the next of so many stages by its text."""
        def show(text: str) -> None:
            self._stages += 1
            self.show(min(0.95, self._stages / expected), text)

        return show

    def done(self) -> None:
        """Clear the bar."""
        self._bar.close()


def computed(
    name: str, calls: Mapping[str, Call], jobs: int | None, scheduler: str | None = None
) -> dict[str, Any]:
    """Return the value of each call by its key, or raise the first error, with a progress bar."""
    progress, found = Progress(name), {}
    with workers(scheduler, jobs) as started:
        for key, answer in started.answers(calls):
            if answer.error is not None:
                raise answer.error
            found[key] = answer.value
            progress.show(len(found) / len(calls), key)
    progress.done()
    return found
