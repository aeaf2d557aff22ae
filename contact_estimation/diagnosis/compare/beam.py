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

"""The search for models: a beam from the nominal model outwards."""

from __future__ import annotations

from dataclasses import replace
from typing import Callable, NamedTuple, Protocol, Sequence

import numpy as np

from .evidence import Evidence, Scored

_WIDE, _DEEP = 3, 4  # models that are extended at a time, and how often
LAWS = 3  # of a model of one contact
# Extensions that are fitted to the end; nats below the best, from where that may bring one back.
_REFINED, _NEAR = 2, 10.0


class Space(Protocol):
    """The models that are compared."""

    def evidence(self) -> Evidence:
        """Return what models are compared against, with the recalibrated nominal model."""

    def extensions(self, one: Scored) -> list[Scored]:
        """Return the most promising models with one more effect."""

    def siblings(self, one: Scored) -> list[Scored]:
        """Return models with another law of its family in the place of each law of a model."""

    def to_the_end(self, one: Scored) -> Scored | None:
        """Fit a model to the end; None if its values are not possible."""


class Compared(NamedTuple):
    """
    The models of a search.

    Attributes
    ----------
    evidence : Evidence
        What they are compared against.
    models : list of Scored
        The best first.

    """

    evidence: Evidence
    models: list[Scored]

    @property
    def score(self) -> float:
        """Return the score of the best model."""
        return self.evidence.score(self.models[0])


def search(
    space: Space, progress: Callable[[str], None], known: Sequence[Scored] = (),
    extend: bool = True, laws: int = LAWS,
) -> Compared:
    """
    Extend the best models as long as the gain that is left could pay for a further law.

    Parameters
    ----------
    space : Space
        The models.
    progress : callable
        Called with a description of each stage.
    known : sequence of Scored
        Models of another space that are fitted again in this one, instead of all extensions of
        the nominal model.
    extend : bool
        Whether models are extended.
    laws : int
        Number from which on a model is not.

    Returns
    -------
    compared : Compared
        All models that were fitted.

    """
    evidence = space.evidence()
    root = evidence.base
    pool = {root.key: root}
    done = {root.key} if known else set[frozenset[str]]()  # its extensions are known
    for other in known:
        again = space.to_the_end(other) if other.key != root.key else None
        if again is not None:
            _keep(evidence, pool, again)
    evidence = evidence.informed_by(pool.values())
    for _ in range(_DEEP if extend else 0):
        frontier = [one for one in evidence.ranked(pool.values())[:_WIDE]
                    if one.key not in done and one.laws < laws
                    and _may_gain(evidence, one)]
        if not frontier:
            break
        for one in frontier:
            progress(', '.join(one.effects) or 'nominal model')
            done.add(one.key)
            extended = evidence.ranked(space.extensions(one))
            for rough in extended:
                _keep(evidence, pool, rough)
            best = evidence.score(evidence.ranked(pool.values())[0])
            for rough in extended[:_REFINED]:
                if evidence.score(rough) > best - _NEAR:
                    fitted = space.to_the_end(rough)
                    if fitted is not None:
                        _keep(evidence, pool, fitted)
        evidence = evidence.informed_by(pool.values())
    for sibling in space.siblings(evidence.ranked(pool.values())[0]) if extend else ():
        _keep(evidence, pool, sibling)
    return Compared(evidence, evidence.ranked(pool.values()))


def _keep(evidence: Evidence, pool: dict[frozenset[str], Scored], one: Scored) -> None:
    """Keep a model unless a better fit of the same effects is known."""
    key = one.key
    if key not in pool or evidence.score(one) > evidence.score(pool[key]):
        pool[key] = one


def _may_gain(evidence: Evidence, one: Scored) -> bool:
    """Return whether a law that explained all that is left would be worth its prior."""
    perfect = replace(one, left_out=np.minimum(one.left_out, 1.0),
                      fitted=np.minimum(one.fitted, 1.0), penalty=0.0)
    c = evidence.constants
    return evidence.score(perfect) - evidence.score(one) > c.parameter + c.law
