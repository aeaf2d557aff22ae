# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Tasks in this process, as processes, or on workers of Dask: of this machine or a scheduler."""

from contextlib import contextmanager
from importlib import metadata
import logging
import os
import subprocess
import time
from typing import Any, Callable, Iterator, Mapping, NamedTuple, Protocol, Sequence

from .exceptions import FleetError, MissingPackageError

_TIMEOUT_S = 30.0  # until a scheduler and its first worker answer
_IN_FLIGHT = 2  # tasks submitted for each thread: one runs, one waits


class Call(NamedTuple):
    """A function of a module, and its arguments: what a worker can import and run."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]


class Answer(NamedTuple):
    """The value of a call, or the error that ended it."""

    value: Any
    error: BaseException | None


class Workers(Protocol):
    """What runs calls, here or elsewhere."""

    def answers(self, calls: Mapping[str, Call]) -> Iterator[tuple[str, Answer]]:
        """Run calls and yield the answer of each by its key, in any order."""


class ThisProcess:
    """One call after the other, here: needs no other package."""

    def answers(self, calls: Mapping[str, Call]) -> Iterator[tuple[str, Answer]]:
        """Run calls in their order and yield the answer of each by its key."""
        for key, (function, arguments) in calls.items():
            try:
                answer = Answer(function(*arguments), None)
            except Exception as error:  # noqa: B902 - as a worker answers with any error
                answer = Answer(None, error)
            yield key, answer


class DaskWorkers:
    """The workers of a Dask client."""

    def __init__(self, client: Any, in_flight: int) -> None:
        self._client, self._in_flight = client, in_flight

    def answers(self, calls: Mapping[str, Call]) -> Iterator[tuple[str, Answer]]:
        """Run calls."""
        from distributed import as_completed

        waiting = iter(calls.items())
        keys: dict[str, str] = {}

        def submit() -> Any:
            for key, call in waiting:
                future = self._client.submit(call.function, *call.arguments, pure=False)
                keys[future.key] = key
                return future
            return None

        first = [submit() for _ in range(min(self._in_flight, len(calls)))]
        running = as_completed(first)
        first.clear()
        for future in running:
            error = future.exception()
            answer = Answer(None if error else future.result(), error)
            key = keys.pop(future.key)
            future.release()
            following = submit()
            if following is not None:
                running.add(following)
            yield key, answer


class Finished(NamedTuple):
    """What a process printed, and what it took."""

    # wall_s, cpu_s: elapsed time, and user plus system time [s]
    wall_s: float
    cpu_s: float
    error: str  # last line on stderr of a command that failed; '' on success


def finished(command: Sequence[str], timeout_s: float | None = None) -> Finished:
    """Run a process to its end; no other child of this process may end meanwhile."""
    from resource import getrusage, RUSAGE_CHILDREN  # of POSIX; only studies come here

    begin, before = time.monotonic(), getrusage(RUSAGE_CHILDREN)
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s,
                              stdin=subprocess.DEVNULL)
        lines = done.stderr.strip().splitlines() or [f'exit code {done.returncode}']
        error = lines[-1] if done.returncode else ''
    except subprocess.TimeoutExpired:
        error = f'not finished within {timeout_s:g} s'
    after = getrusage(RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Finished(time.monotonic() - begin, used, error)


@contextmanager
def workers(scheduler: str | None, jobs: int | None) -> Iterator[Workers]:
    """Start workers on this machine, or connect to those of a scheduler; 1 job: this process."""
    if scheduler is None and jobs == 1:
        yield ThisProcess()
    elif scheduler is None:
        with _local_client(jobs or os.cpu_count() or 1) as client:
            yield DaskWorkers(client, _IN_FLIGHT * (jobs or os.cpu_count() or 1))
    else:
        with _remote_client(scheduler) as client:
            threads = sum(client.nthreads().values())
            yield DaskWorkers(client, jobs or _IN_FLIGHT * threads)


def require_distributed() -> Any:
    """Import Dask."""
    try:
        import distributed
    except ImportError as error:
        raise MissingPackageError.of('distributed', 'working in parallel') from error
    return distributed


def installed_version() -> str:
    """Return the version of this package."""
    try:
        return metadata.version('contact_estimation')
    except metadata.PackageNotFoundError:
        return 'unknown'


@contextmanager
def _local_client(jobs: int) -> Iterator[Any]:
    distributed = require_distributed()
    # Processes of one thread: Python runs one thread at a time.
    with distributed.LocalCluster(
        n_workers=jobs, threads_per_worker=1, processes=True, host='127.0.0.1',
        dashboard_address='127.0.0.1:0', silence_logs=logging.CRITICAL,
    ) as cluster, distributed.Client(cluster) as client:
        yield client


@contextmanager
def _remote_client(address: str) -> Iterator[Any]:
    distributed = require_distributed()
    try:
        client = distributed.Client(address, timeout=_TIMEOUT_S)
    except (OSError, ValueError) as error:  # its time-out is an OSError
        raise FleetError(
            f'no Dask scheduler answers at {address}: {error}; start one with `dask scheduler`, '
            'and give the address that it prints') from error
    with client:
        try:
            client.wait_for_workers(1, timeout=_TIMEOUT_S)
        except TimeoutError as error:
            raise FleetError(
                f'the Dask scheduler at {address} has no worker; start some with '
                f'`dask worker {address}`') from error
        _require_same_version(client)
        yield client


def _require_same_version(client: Any) -> None:
    own = installed_version()
    for worker, version in client.run(installed_version, on_error='return').items():
        if version != own:
            raise FleetError(
                f'the Dask worker {worker} must have contact_estimation {own} installed, as '
                f'here, got {version}; install the same version for all workers')
