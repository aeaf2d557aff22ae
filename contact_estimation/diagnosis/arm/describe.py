# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is told of each name: values with bands, shares, and where in the motion."""

from typing import Any

import numpy as np

from .arm_recording import Array
from .bodies import possible_inertial
from .channels import Term
from .covariance import covariance
from .gram import GAIN_STD
from .result import ArmEffect
from .space import ArmModels, label
from ..fit.beam import Compared
from ..fit.evidence import share_of, taken
from ..fit.names import Named
from ..result import Value
from ...kinematics.arm_dynamics import PER_LINK
from ...physics.joint_effects import JOINT_EFFECTS

_SHOWS = 0.1  # of the largest share of a law of the whole arm: joints that show it
_REGION = 1.5  # times the mean, for a law to be located in a region
_SAME = 1e-3  # of the square of a torque: what is the same in another place
_INTERVALS = 3  # that are listed


class ArmNames:
    """The named model, its coefficients with standard deviations, and what its laws do."""

    def __init__(self, space: ArmModels, compared: Compared, named: Named) -> None:
        self.space, self.compared, self.named = space, compared, named
        self.model, self.fitted = named.model.found
        self.theta = self.fitted.theta
        self._covariance = covariance(space.gram, self.model)
        self.stds = {term: np.sqrt(np.diag(one)) for term, one in self._covariance.items()}
        self._without = dict[Term, Any]()

    def sizes(self, term: Term) -> Array:
        """Return the mean square of a law's own torque over that of each joint's, shape (C,)."""
        gram = self.space.gram
        out = np.zeros(len(gram.joints))
        for k, j in enumerate(gram.joints):
            if term in gram.at[k]:
                theta = self.theta[term] / gram.scales[term]
                index = gram.at[k][term]
                G = gram.G_fit[k][-1][np.ix_(index, index)]
                out[k] = theta @ G @ theta / gram.kept[:, k].sum() / gram.variance[k]
        return out

    def of_range(self, term: Term) -> float:
        """
        Return the torque of a law, rms, over the range of its joint's torque.

        A joint that carries less than a twentieth of what the strongest does counts as if it
        carried that: nearly all of its torque is friction.
        """
        gram = self.space.gram
        return float((np.sqrt(self.sizes(term) * gram.variance) / gram.size).max())

    def without(self, term: Term) -> Any:
        """Return the model without a law."""
        if term not in self._without:
            # What is impossible without a law is compared with the best model that lacks it.
            self._without[term] = self.space.without(self.named.model, [label(term)]) or next(
                one for one in self.compared.models if label(term) not in one.effects)
        return self._without[term]

    def removed(self, term: Term) -> Array:
        """Return what each joint's error grows by without a law, over its torque's variance."""
        rest, gram = self.without(term), self.space.gram
        weights = gram.kept / gram.kept.sum(axis=0)
        more = (weights * (rest.left_out - self.named.model.left_out)).sum(axis=0)
        return np.asarray(more * gram.floor / gram.variance)

    def gain(self, term: Term) -> float:
        """Return the score that is lost without a law [nat]."""
        evidence = self.compared.evidence
        return evidence.score(self.named.model) - evidence.score(self.without(term))

    def values(self, term: Term) -> tuple[Array, Array, str, list[str]]:
        """Return coefficients, standard deviations, a note, and what would change them most."""
        theta, stds, gram = self.theta[term], self.stds[term], self.space.gram
        if JOINT_EFFECTS[term.effect].family != 'load':
            return theta, stds, '', []
        per_gain = GAIN_STD * self.space.gram.per_gain(self.model, term)
        return (possible_inertial(theta, self._covariance[term]),
                np.sqrt(stds**2 + (per_gain**2).sum(axis=0)),
                f'its band includes gains of the torques that are known to {100 * GAIN_STD:.0f} %',
                [f'force_gain at {gram.channels.arm.joints[gram.joints[k]]}'
                 for k in [int(np.abs(per_gain[:, 0]).argmax())] if abs(per_gain[k, 0]) > stds[0]])


def described(names: ArmNames, term: Term, name: Any) -> ArmEffect:
    """Describe a law."""
    effect, gram = JOINT_EFFECTS[term.effect], names.space.gram
    arm, joints = gram.channels.arm, gram.joints
    theta, stds, note, rivals = names.values(term)
    as_links = _in_links(names, term)
    if as_links:
        note = (f'it includes what the description lacks as {as_links[0]}: about this axis no '
                'motion separates the two')
    parameters = {symbol: Value(float(value), float(std), unit)
                  for (symbol, unit), value, std in zip(effect.coefficients, theta, stds)}
    if effect.shape is not None:
        symbol, unit = effect.shape
        parameters[symbol] = Value(term.shape, float('nan'), unit)
    sizes = names.sizes(term)
    shows = [k for k in range(len(joints)) if sizes[k] >= _SHOWS * sizes.max()]
    main = int(np.argmax(sizes))
    where = {'joint': (term.place,), 'pair': term.place[:2] if effect.place == 'pair' else ()}.get(
        effect.place, tuple(joints[k] for k in shows))
    evidence = names.compared.evidence
    share = share_of(evidence, taken(evidence, names.without(term), names.named.model, main), main)
    return ArmEffect(
        effect.name, effect.family, effect.equation, term,
        tuple(arm.joints[j] for j in where),
        arm.links[term.place] if effect.place == 'link' or term.effect == 'payload' else '',
        gram.channels.names[term.file] if term.file >= 0 and len(gram.channels.names) > 1 else '',
        1.0 if name is None else float(name.probability), parameters,
        share.share, share.interval,
        {arm.joints[joints[k]]: float(size) for k, size in enumerate(sizes) if size > 0.0},
        names.gain(term) if name is not None else 0.0,
        [] if name is None else list(dict.fromkeys(
            [*(in_words(one, arm) for one in name.alike), *rivals, *as_links])),
        *_located(names, term, joints[main]), note)


def _in_links(names: ArmNames, term: Term) -> list[str]:
    """Return the link whose inertia is the same torque in all joints as a law of its joint."""
    channels = names.space.gram.channels
    if JOINT_EFFECTS[term.effect].family != 'inertia':
        return []
    last = PER_LINK * term.place + PER_LINK
    X, y = (np.concatenate(rows) for rows in zip(*(
        (channels.regressor(one, j)[:, last - PER_LINK:last],
         one.columns[term][j] @ names.theta[term] if j == term.place else np.zeros(len(one.t)))
        for one in channels.pieces for j in channels.measured)))
    rest = y - X @ np.linalg.lstsq(X, y, rcond=None)[0]
    return [f'link_inertia at {channels.arm.links[term.place]}'
            ] if rest @ rest < _SAME * (y @ y) else []


def in_words(one: str, arm: Any) -> str:
    """Return a name with its place in words, from its label."""
    law, _, place = one.partition('@')
    place, _, file = place.partition(' ')
    for sign in '+-':
        if sign in place:
            return f'{law} of {" and ".join(arm.joints[int(j)] for j in place.split(sign))}'
    if place == 'arm':
        return law
    links = JOINT_EFFECTS[law].place == 'link' or law == 'payload'
    return f'{law} at {(arm.links if links else arm.joints)[int(place)]}'


def _located(names: ArmNames, term: Term, j: int) -> tuple[list[tuple[float, float]], str]:
    """Return when, and in which region of the motion, a law's torque is largest."""
    pieces = names.space.gram.channels.pieces
    rows = [(one, one.columns[term][j] @ names.theta[term]) for one in pieces]
    torque = np.concatenate([x for _, x in rows]) ** 2
    mean = float(torque.mean()) + 1e-300
    found = []
    for file, first, last in names.space.gram.times:
        part = [x[(one.t >= first) & (one.t <= last)] for one, x in rows if one.file == file]
        power = float(np.mean(np.concatenate(part) ** 2)) / mean
        found.append((power, float(first), float(last)))
    largest = sorted(one for one in found if one[0] >= max(1.0, 0.7 * max(found)[0]))[-_INTERVALS:]
    v = np.abs(np.concatenate([one.v[:, j] for one in pieces]))
    a = np.abs(np.concatenate([np.gradient(one.v[:, j], one.t) for one in pieces]))
    load = np.abs(np.concatenate([one.tau[:, j] - one.residual[:, j] for one in pieces]))
    regions = {name: signal >= np.percentile(signal, 70) for name, signal in (
        ('fast motion', v), ('acceleration', a), ('large load', load))}
    regions['slow motion and reversals'] = v <= np.percentile(v, 30)
    best = max(regions, key=lambda name: float(torque[regions[name]].mean()))
    located = float(torque[regions[best]].mean()) >= _REGION * mean
    return sorted((first, last) for _, first, last in largest), best if located else 'all motion'
