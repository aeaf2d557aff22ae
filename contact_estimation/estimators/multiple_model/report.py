# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is published of a wall: the mixture of all hypotheses."""

from math import nan, sqrt
from typing import Sequence

import numpy as np

from .constants import ANYWHERE_M, DAMPING_FLOOR, STIFFNESS_FLOOR, UNLIKELY
from .evidence import joined, Judged, mixture, Scene, walls
from .knowledge import Knowledge, SURE
from .laws import Array, BENT, IMPARTIAL, Ints, MASS, NAMES, POWERS
from .residuals import Residuals
from .wall_statistics import WallStatistics


class Report:
    """
    The mixture of all hypotheses, as it is published.

    known: what is known of the wall
    """

    def __init__(self, known: Knowledge) -> None:
        self.known = known
        self._depth = nan  # of the last K_e [m]
        self._powers = POWERS.copy()  # that of a curved wall is what was found
        self._curved: tuple[float, ...] = 0.0, 0.0  # relative variances if it may be curved

    def publish(
        self, weights: Array, judged: Judged, laws: Ints, scene: Scene, sums: WallStatistics,
        residuals: Residuals, others: Sequence[tuple[Array, Judged, int]],
    ) -> None:
        """
        Publish the mixture of all hypotheses.

        others: hypotheses of one law beside them, with their probabilities
        """
        every_law = weights.reshape(len(NAMES), -1)
        of_law = every_law.sum(1)
        found = every = walls(judged, laws, scene, ANYWHERE_M)
        # Walls are seldom curved, but where one may be, its band holds what it would be then.
        impartial = weights * IMPARTIAL[laws]
        for share, more, law in others:
            weights, found = joined(
                weights, found, share, walls(more, np.full(len(share), law), scene, ANYWHERE_M))
        (K, B, delta), spreads = mixture(weights, found)
        (K_else, B_else, _), curved = mixture(impartial, every)
        self._curved = tuple(
            max(other + (there - here) ** 2 - own, 0.0) / max(here * here, 1e-18)
            for here, there, own, other in ((K, K_else, spreads[0], curved[0]),
                                            (B, B_else, spreads[1], curved[1])))
        places = every_law.shape[1]
        mass = judged.theta[MASS * places, 2]
        bent = BENT * places + int(np.argmax(every_law[BENT]))
        stiffness, *_, square, cube = judged.theta[bent].tolist()
        if stiffness > 0.0:
            self._powers[0, BENT] = min(max((square + 2.0 * cube) / stiffness, -1.0), 2.0)
        K_std = sqrt(spreads[0] + (STIFFNESS_FLOOR * K) ** 2)
        surface, surface_std = self.known.surface, ANYWHERE_M
        if K_std < SURE * K:  # else nothing is found of it
            surface, surface_std = scene.x0 + delta, sqrt(spreads[2]) + 2e-6
        self._depth = scene.depth
        self.known = Knowledge(
            K, B, K_std, sqrt(spreads[1] + (DAMPING_FLOOR * B) ** 2), surface, surface_std,
            float(mass) if of_law[MASS] > 0.5 else nan, tuple(of_law.tolist()),
            residuals.fit, self._varies(sums, of_law), residuals.doubt)

    def _varies(self, sums: WallStatistics, of_law: Array) -> tuple[float, float]:
        """Return by how much more K_e and B_e deviate; see `Knowledge.varies`."""
        scatter = self._powers**2 @ of_law * (sums.scatter / sums.depth**2)
        K, B = np.sqrt(scatter + self._curved).tolist()
        return K, B

    def follow_depth(self, sums: WallStatistics) -> None:
        """Publish K_e and B_e of curved laws at the depth of now."""
        known, of_law = self.known, np.array(self.known.laws)
        if not known.valid or of_law[self._powers.any(axis=0)].sum() < UNLIKELY:
            return
        K, B = ((sums.depth / self._depth) ** self._powers @ of_law).tolist()
        self._depth = sums.depth
        self.known = known._replace(
            stiffness=K * known.stiffness, damping=B * known.damping,
            stiffness_std=K * known.stiffness_std, damping_std=B * known.damping_std,
            varies=self._varies(sums, of_law))
