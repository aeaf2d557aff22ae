# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Score of a diagnosis on a rig: by family, since no name of the library is exact there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import AbstractSet, Any, Mapping, Sequence

from ...physics import EFFECTS

NEUTRAL = ('force_bias', 'contact_offset')
"""Offsets beside other names, neither right nor wrong: every rig has small ones."""

RIGHT, WRONG, SILENT, FAILED = 'right', 'wrong', 'silent', 'failed'
"""Outcomes: an acceptable family first, another one first, no name, no report."""


@dataclass(frozen=True)
class NamedEffect:
    """One name of a report."""

    name: str  # key of EFFECTS
    probability: float  # as reported
    right: bool  # the name or one of its `indistinguishable_from` is of an acceptable family


@dataclass(frozen=True)
class FamilyScore:
    """Score of one report."""

    trial: str  # name of the trial
    law: str  # True law; '' in a clean world
    # acceptable families; empty for a clean world and for a law that no effect describes
    families: list[str]
    stage: str  # kind of experiment
    concealed: float  # degree by which the law stands out
    verdict: str  # verdict of the report; '' without a report
    names: list[NamedEffect]  # reported effects, in order, without neutral ones
    outcome: str  # RIGHT, WRONG, SILENT or FAILED; any name is wrong where no family is acceptable
    surplus: bool  # a name besides the first is not acceptable
    port_right: bool | None  # the port of the location is the true one; None in a clean world
    # intersection over union of true and reported intervals; None where a family is acceptable
    overlap: float | None
    error: str  # error message of the command; '' on success
    seconds: float  # run time of the diagnosis [s]

    @property
    def kind(self) -> str:
        """'foreign' (a family is acceptable), 'unknown' (none is) or 'clean'."""
        return 'foreign' if self.families else 'unknown' if self.law else 'clean'

    @property
    def is_miss(self) -> bool:
        """Whether the report is wrong in any respect."""
        wanted = RIGHT if self.families else SILENT
        return self.outcome != wanted or self.surplus


def family_score(trial: str, truth: Mapping[str, Any], answer: Mapping[str, Any]) -> FamilyScore:
    """Score a trial on a rig."""
    report: Mapping[str, Any] = answer['report'] or {}
    families, unknown = list(truth['families']), truth['unknown'] or {}
    acceptable = of_families(families)
    names = scored_names(report.get('effects', []), acceptable, set(NEUTRAL) - acceptable)
    location = report.get('location') or {}
    return FamilyScore(
        trial=trial, law=truth['law'], families=families, stage=truth['stage'],
        concealed=float(truth['concealed']), verdict=str(report.get('verdict', '')), names=names,
        outcome=outcome_of(bool(report), names),
        surplus=any(not named.right for named in names[1:]),
        port_right=location.get('port') == truth['port'] if truth['law'] else None,
        overlap=overlap_of(
            location.get('intervals_s', []), unknown['intervals_s']) if unknown else None,
        error=str(answer['error']), seconds=float(answer['seconds']),
    )


def of_families(families: Sequence[str]) -> set[str]:
    """Return the effects of families."""
    return {name for name, cls in EFFECTS.items() if cls.family in families}


def scored_names(
    effects: Sequence[Mapping[str, Any]], acceptable: AbstractSet[str], neutral: AbstractSet[str]
) -> list[NamedEffect]:
    """Score the names of a report."""
    return [
        NamedEffect(effect['name'], float(effect['probability']),
                    bool(acceptable & {effect['name'], *effect['indistinguishable_from']}))
        for effect in effects if effect['name'] not in neutral
    ]


def outcome_of(is_report: bool, names: Sequence[NamedEffect]) -> str:
    """Return the outcome of a trial."""
    if not is_report:
        return FAILED
    if not names:
        return SILENT
    return RIGHT if names[0].right else WRONG


def overlap_of(reported: Sequence[Sequence[float]], true: Sequence[Sequence[float]]) -> float:
    """
    Compute intersection over union of two lists of disjoint intervals.

    reported, true: intervals [s]
    """
    both = sum(max(0.0, min(b, d) - max(a, c)) for a, b in reported for c, d in true)
    each = sum(b - a for intervals in (reported, true) for a, b in intervals)
    return both / max(each - both, 1e-12)
