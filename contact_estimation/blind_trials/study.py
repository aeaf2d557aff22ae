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

"""A study: trials drawn, diagnosed blind, unsealed and scored; it goes on where it stopped."""

from __future__ import annotations

from concurrent.futures import as_completed, ProcessPoolExecutor
from dataclasses import asdict
import hashlib
import json
from pathlib import Path
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from .blind_diagnosis import diagnose_blind
from .drawing import draw_trial, plan_effects
from .handing_over import hand_over, Handed
from .scoring import Score, score
from .totals import confusion, groups, totals
from .unknown import UNKNOWN


class Planned(NamedTuple):
    """
    A trial before it is drawn.

    Attributes
    ----------
    name : str
        Tells nothing of what is in it.
    effect : str
        '' where nothing is to be missing.
    seed : tuple of int
        Of all its chance.

    """

    name: str
    effect: str
    seed: tuple[int, int, int]


def plan(count: int, clean: int, seed: int, unknown: int = 0) -> list[Planned]:
    """
    Plan a study.

    Parameters
    ----------
    count : int
        Of trials with an effect.
    clean : int
        Of trials without.
    seed : int
        Of the study.
    unknown : int
        Of trials with an effect that the library has no name for.

    Returns
    -------
    planned : list of Planned
        A larger study of the same seed holds the trials of a smaller one, so that it can grow.

    """
    kinds = (plan_effects(count, seed), [''] * clean, plan_effects(unknown, seed, UNKNOWN))
    return [Planned(_name((seed, kind, k)), effect, (seed, kind, k))
            for kind, effects in enumerate(kinds) for k, effect in enumerate(effects)]


def _name(seed: tuple[int, int, int]) -> str:
    return 'trial_' + hashlib.sha256(repr(seed).encode()).hexdigest()[:8]


def run_trial(folder: Path, planned: Planned) -> None:
    """
    Do of a trial what is not done yet.

    Parameters
    ----------
    folder : Path
        Of the study.
    planned : Planned
        The trial.

    """
    files = Handed.of(folder, planned.name)
    if not files.truth.exists():
        rng = np.random.default_rng(planned.seed)
        hand_over(draw_trial(planned.effect, rng), files, rng)
        files.report.unlink(missing_ok=True)
    if not files.report.exists():
        diagnose_blind(files)


def run_study(
    folder: Path, trials: Sequence[Planned], jobs: int, tell: Callable[[float, str], None]
) -> list[Score]:
    """
    Run a study, or what is left of it.

    Parameters
    ----------
    folder : Path
        Where its files are.
    trials : sequence of Planned
        All of it.
    jobs : int
        Processes.
    tell : callable
        Is told the share that is done, and the name of the trial.

    Returns
    -------
    scores : list of Score
        In the order of the plan.

    """
    with ProcessPoolExecutor(jobs) as pool:
        waiting = {pool.submit(run_trial, folder, trial): trial for trial in trials}
        try:
            for done, future in enumerate(as_completed(waiting), 1):
                future.result()
                tell(done / len(trials), waiting[future].name)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return [unseal(folder, trial) for trial in trials]


def unseal(folder: Path, planned: Planned) -> Score:
    """
    Hold what was said against the truth.

    Parameters
    ----------
    folder : Path
        Of the study.
    planned : Planned
        A trial that is done.

    Returns
    -------
    score : Score
        Of its report.

    """
    files = Handed.of(folder, planned.name)
    return score(planned.name, json.loads(files.truth.read_text()),
                 json.loads(files.report.read_text()))


def as_dict(scores: Sequence[Score], seed: int) -> dict[str, Any]:
    """
    Give a study as data.

    Parameters
    ----------
    scores : sequence of Score
        Of the study.
    seed : int
        Of the study.

    Returns
    -------
    study : dict
        What JSON can say.

    """
    return {
        'count': sum(bool(s.effect) and not s.outside for s in scores),
        'clean': sum(not s.effect for s in scores),
        'unknown': sum(s.outside for s in scores),
        'seed': seed,
        'totals': _totals(scores),
        'groups': {kind: {label: _totals(part) for label, part in parts.items()}
                   for kind, parts in groups(scores).items()},
        'confusion': confusion(scores),
        'trials': [asdict(s) for s in scores],
    }


def _totals(scores: Sequence[Score]) -> list[dict[str, Any]]:
    return [{**total._asdict(), 'met': total.met} for total in totals(scores)]
