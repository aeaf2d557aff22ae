# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Consecutive samples as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from .contact_sample import ContactSample
from ..exceptions import SignalShapeError


@dataclass(frozen=True)
class ContactRecording:
    """A stretch of contact samples, in the order of their stamps."""

    stamp_ns: NDArray[np.int64]  # (N,) header stamps [ns]
    position: NDArray[np.float64]  # (N,) x [m]
    velocity: NDArray[np.float64]  # (N,) rate of x [m/s]; NaN where unknown
    force: NDArray[np.float64]  # (N,) measured F_e [N], negative while pressing

    def __post_init__(self) -> None:
        """Check that all arrays have one length."""
        shapes = {np.shape(a) for a in (self.stamp_ns, self.position, self.velocity, self.force)}
        if len(shapes) != 1 or len(next(iter(shapes))) != 1:
            raise SignalShapeError(
                'stamp_ns, position, velocity and force must be one-dimensional and of one '
                f'length, got shapes {sorted(shapes)}'
            )

    @classmethod
    def of(cls, samples: Sequence[ContactSample]) -> 'ContactRecording':
        """Return samples stacked into arrays."""
        columns = list(zip(*samples)) or [(), (), (), ()]
        return cls(
            np.array(columns[0], np.int64), *(np.array(c, np.float64) for c in columns[1:])
        )

    @property
    def t(self) -> NDArray[np.float64]:
        """Time since the first sample [s], shape (N,)."""
        return np.asarray((self.stamp_ns - self.stamp_ns[:1]) * 1e-9, np.float64)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.stamp_ns)

    def __iter__(self) -> Iterator[ContactSample]:
        """Iterate over the samples, in plain Python numbers."""
        columns = (self.stamp_ns, self.position, self.velocity, self.force)
        return map(ContactSample, *(column.tolist() for column in columns))
