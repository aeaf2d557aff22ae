# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The laws of one joint of an arm, scored with what joints share as it is."""

from typing import Iterable, Mapping, TYPE_CHECKING

import numpy as np

from .arm_recording import Array
from .channels import Term
from .gram import of_blocks, remainder, SENSOR
from ...physics.joint_effects import JOINT_EFFECTS

if TYPE_CHECKING:
    from .space import ArmModels


def all_possible(theta: Mapping[Term, Array]) -> bool:
    """Return whether the coefficients of all laws are physically possible."""
    return all(JOINT_EFFECTS[term.effect].possible(values) for term, values in theta.items())


class JointJudge:
    """The score of the laws of one joint, with the shared coefficients of a model."""

    def __init__(self, space: 'ArmModels', model: frozenset[Term], k: int) -> None:
        self._space, self._k, self._gram = space, k, space.gram
        local, shared = self._gram.split(model)
        self.local = local[k]
        _, both, _ = self._gram.solve(model)
        outer, places = self._gram.shared_index(k, shared)
        theta, gram = both[:, places], self._gram
        self._w = gram.weights[k]
        self._rhs = gram.c_fit[k] - np.einsum('bpo,bo->bp', gram.G_fit[k][:, :, outer], theta)
        G, c, own = gram.G[k], gram.c[k], of_blocks(theta)
        # What the shared coefficients leave, of the fits without each block, and of that on all.
        self._rest = c - np.einsum('bpo,fbo->fbp', G[:, :, outer], own)
        self._square = remainder(G[:, outer[:, None], outer], c[:, outer], gram.s[:, k], own)

    def scores(
        self, models: Iterable[frozenset[Term]], least: float = -np.inf
    ) -> dict[frozenset[Term], float]:
        """Return the scores above `least` of C possible sets of laws of the joint."""
        gram, k, models = self._gram, self._k, list(models)
        every = [sorted(one, key=gram.order.__getitem__) for one in models]
        rows = [gram.index(k, terms) for terms in every]
        index = np.full((len(rows), max(map(len, rows), default=1)), -1)  # a column of zeros
        for padded, row in zip(index, rows):
            padded[:len(row)] = row
        G = gram.G[k][:, index[:, :, None], index[:, None, :]]  # (B, C, K, K)
        whole = G.sum(axis=0)
        K = self._w * np.concatenate([whole - G, whole[None]]) + np.eye(index.shape[1])
        T = np.linalg.solve(K, self._w * self._rhs[:, index, None])[..., 0]  # (B + 1, C, K)
        left_out, fitted = np.maximum(remainder(
            G, self._rest[:, :, index], self._square[..., None], of_blocks(T)), 0.0
            ) / gram.kept[:, k, None]
        share = self._space.constants.left_out
        expected = share * left_out + (1.0 - share) * fitted
        beyond = np.maximum(expected - gram.felt_noise[k], 0.0)
        likelihood = -0.5 * gram.counts[:, k] @ np.log(beyond / gram.floor[k] + 1.0)
        score = likelihood - 0.5 * np.sum(T[-1, :, :gram.width(SENSOR)] ** 2, axis=-1)
        score -= [sum(map(self._space.cost, one)) for one in models]
        return {one: float(own) for one, own, terms, theta in zip(models, score, every, T[-1])
                if own > least and all_possible(gram.of((SENSOR, *terms), theta))}
