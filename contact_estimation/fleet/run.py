# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""One run over an archive: compute what is missing, resuming an interrupted run; pool groups."""

from dataclasses import dataclass
import json
from pathlib import Path
from typing import Callable, Iterator, Mapping, NamedTuple, Sequence

import numpy as np

from .discovery import FoundRecording
from .findings import by_group, Change, changes
from .one_recording import (
    hash_of, nothing, Outcome, process, process_pooled, recording_sha256, Result, Settings)
from .table import distinct, Entry, in_time
from ..scheduling import Answer, Call, Workers
from ..texts import json_content, printable, write_whole

_RESULTS, _PAGES = 'finished', 'recordings'


class Finished:
    """The finished results in the folder of a run."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.damaged: list[str] = []  # names of files that are not as they were written
        for name in (_RESULTS, _PAGES):
            (folder / name).mkdir(parents=True, exist_ok=True)

    def get(self, key: str, with_page: bool) -> Outcome | None:
        """Return a finished result."""
        try:
            kept = json_content(self._file(key).read_text(encoding='utf-8'))
            outcome: Outcome = kept['outcome']
            if hash_of(outcome) != kept['sha256']:
                raise ValueError(key)
        except FileNotFoundError:
            return None
        except (KeyError, TypeError, ValueError):
            self.damaged.append(self._file(key).name)
            return None
        lacks_page = with_page and outcome['report'] is not None and not self.page(key)
        return None if lacks_page else outcome

    def keep(self, key: str, result: Result) -> None:
        """Write a result atomically."""
        if result.page:
            write_whole(self._folder / _PAGES / _page_name(key), result.page.encode('utf-8'))
        kept = {'sha256': hash_of(result.outcome), 'outcome': result.outcome}
        text = json.dumps(kept, allow_nan=False)
        write_whole(self._file(key), text.encode('utf-8'))

    def page(self, key: str) -> str:
        """Return the path of a diagnosis's page."""
        path = f'{_PAGES}/{_page_name(key)}'
        return path if (self._folder / path).exists() else ''

    def _file(self, key: str) -> Path:
        return self._folder / _RESULTS / f'{key}.json'


def _page_name(key: str) -> str:
    return f'{key[:16]}.html'


_LEAST = 3  # recordings: two to fit and one to leave out


class Pool(NamedTuple):
    """Recordings of a group that are diagnosed together."""

    group: str  # their group
    members: list[Entry]  # spread evenly over time, since the last change of what is named
    since: Change | None  # that change


class PooledResult(NamedTuple):
    """The pooled diagnosis of a group."""

    pool: Pool  # what was diagnosed
    whole: Outcome  # outcome with all members
    page: str  # its page, relative to the folder of the run; '' without
    left_out: list[Outcome]  # outcome of the others, tested on each member

    @property
    def same(self) -> int:
        """Return the number of members without which the families named are those of the whole."""
        return sum(_families(one) == _families(self.whole) for one in self.left_out
                   if one['report'])


def _families(outcome: Outcome) -> set[str]:
    return {effect['family'] for effect in outcome['report']['effects']}


def pools(entries: Sequence[Entry], found: Sequence[Change], most: int) -> list[Pool]:
    """Choose the recordings of each group that are diagnosed together."""
    chosen = []
    for group, members in by_group(entries).items():
        latest = max((change for change in found if change.group == group),
                     key=lambda change: change.number, default=None)
        since = members[latest.number - 1:] if latest else members
        known = [one for one in distinct(since) if one.report is not None]
        if min(len(known), most) >= _LEAST:
            places = np.linspace(0, len(known) - 1, min(most, len(known))).round().astype(int)
            chosen.append(Pool(group, [known[place] for place in places], latest))
    return chosen


def pooled_calls(pool: Pool, settings: Settings, with_page: bool) -> dict[str, Call]:
    """Return the diagnoses of a pool: the whole, then without each member in turn."""
    members = pool.members
    whole = settings.key('pooled', *(one.sha256 for one in members))
    calls = {whole: Call(process_pooled, ([one.path for one in members], [], settings, with_page))}
    for left_out in members:
        others = [one for one in members if one is not left_out]
        key = settings.key('left out', left_out.sha256, *(one.sha256 for one in others))
        calls[key] = Call(process_pooled, (
            [one.path for one in others], [left_out.path], settings, False))
    return calls


Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Fleet:
    """The results of a run."""

    entries: list[Entry]  # by group, and in time within each: the order of the table
    pooled: list[PooledResult]  # one for each group of enough recordings
    changes: list[Change]  # what is named from some recording on
    # done, redone: recordings whose results were there already, and those whose results were not;
    # copies count, too
    done: int
    redone: int
    settings: Settings  # of all of them
    damaged: Sequence[str] = ()  # files of results that were made again

    @property
    def failed(self) -> list[Entry]:
        """Return the recordings with an error."""
        return [entry for entry in self.entries if entry.outcome['error']]

    @property
    def refused(self) -> list[Entry]:
        """Return the recordings that a check refused."""
        return [entry for entry in self.entries if entry.outcome['report'] and not entry.report]

    @property
    def identical(self) -> int:
        """Return the number of recordings with the content of another one before them."""
        hashes = [entry.sha256 for entry in self.entries if entry.sha256]
        return len(hashes) - len(set(hashes))


def run_fleet(
    found: Sequence[FoundRecording], settings: Settings, workers: Workers, folder: Path, *,
    most_pooled: int, with_pages: bool, progress: Progress,
) -> Fleet:
    """Replay and diagnose the recordings of an archive."""
    finished = Finished(folder)
    hashes, unreadable = _hashes(found, workers)
    keys = {one.path: settings.key('recording', hashes[one.path])
            for one in found if one.path in hashes}
    calls = {keys[path]: Call(process, (path, settings, with_pages)) for path in keys}
    outcomes, there = _finish(calls, finished, workers, with_pages, progress)
    outcomes.update({one.path: nothing(settings, unreadable[one.path])
                     for one in found if one.path in unreadable})
    entries = in_time(
        Entry.of(one, hashes.get(one.path, ''), outcomes[keys.get(one.path, one.path)],
                 finished.page(keys[one.path]) if one.path in keys and with_pages else '')
        for one in found)
    found_changes = changes(entries, settings.seed)
    pooled = list(_pooled(entries, found_changes, most_pooled, settings, workers, finished,
                          with_pages, progress))
    ordered = [entry for members in by_group(entries).values() for entry in members]
    done = sum(key in there for key in keys.values())  # copies have one key
    return Fleet(ordered, pooled, found_changes, done, len(keys) - done, settings,
                 finished.damaged)


def _hashes(
    found: Sequence[FoundRecording], workers: Workers
) -> tuple[dict[str, str], dict[str, str]]:
    """Return the hash of each recording, and the error where it cannot be read."""
    calls = {one.path: Call(recording_sha256, (one.path,)) for one in found}
    hashes, errors = {}, {}
    for path, answer in workers.answers(calls):
        if answer.error is None:
            hashes[path] = answer.value
        else:
            errors[path] = _in_words(answer.error)
    return hashes, errors


def _finish(
    calls: Mapping[str, Call], finished: Finished, workers: Workers, with_pages: bool,
    progress: Progress,
) -> tuple[dict[str, Outcome], set[str]]:
    """Return each call's outcome, from a file or else a worker, and the keys of the files."""
    outcomes = {key: outcome for key in calls
                if (outcome := finished.get(key, with_pages)) is not None}
    missing = {key: call for key, call in calls.items() if key not in outcomes}
    there = set(outcomes)
    for key, answer in workers.answers(missing):
        outcomes[key] = _kept(key, answer, missing[key], finished)
        progress(len(outcomes) / len(calls), f'{len(outcomes)} of {len(calls)}')
    return outcomes, there


def _kept(key: str, answer: Answer, call: Call, finished: Finished) -> Outcome:
    """Keep a result, also one that says why a recording is unusable; not a worker's failure."""
    if answer.error is not None:
        settings = next(one for one in call.arguments if isinstance(one, Settings))
        return nothing(settings, _in_words(answer.error))
    result: Result = answer.value
    finished.keep(key, result)
    return result.outcome


def _pooled(
    entries: Sequence[Entry], found: Sequence[Change], most: int, settings: Settings,
    workers: Workers, finished: Finished, with_pages: bool, progress: Progress,
) -> Iterator[PooledResult]:
    chosen = pools(entries, found, most)
    calls = [pooled_calls(pool, settings, with_pages) for pool in chosen]
    everything = {key: call for of_pool in calls for key, call in of_pool.items()}
    # Only the whole has a page; a part without one is finished.
    outcomes, _ = _finish(everything, finished, workers, False, progress)
    for pool, of_pool in zip(chosen, calls):
        whole, *others = of_pool
        page = finished.page(whole) if with_pages else ''
        yield PooledResult(pool, outcomes[whole], page, [outcomes[key] for key in others])


def _in_words(error: BaseException) -> str:
    """Return an unexpected error of a worker as one line."""
    if isinstance(error, OSError) and error.strerror:
        return printable(f'{error.strerror}: {error.filename}')
    return printable(' '.join(f'{type(error).__name__}: {error}'.split()))
