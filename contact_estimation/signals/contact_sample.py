# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Motion and force at one instant, as recorded, and with known physics compensated."""

from dataclasses import dataclass
from typing import Iterator, NamedTuple, Protocol, Sequence

import numpy as np
from numpy.typing import NDArray

from ..exceptions import SignalShapeError


class ContactSample(NamedTuple):
    """
    Motion and force at one instant, along one axis.

    A NamedTuple: creating a frozen dataclass of this size takes longer than an estimator update.
    """

    stamp_ns: int  # header stamp of the wrench [ns]
    position: float  # x of the end-effector [m], +x into the wall
    velocity: float  # its rate [m/s]; NaN where not measured
    force: float  # measured F_e [N], negative while pressing


AxesSample = tuple[ContactSample, ...]
"""One sample of each estimated axis, all with the same stamp, the contact axis first."""


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
        return cls(np.array(columns[0], np.int64), *(np.array(c, np.float64) for c in columns[1:]))

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


class CompensatedSample(NamedTuple):
    """The terms of the relation that is left of a sample after known physics are compensated."""

    # penetration of the surface at its known position [m], NaN where that is not known
    depth: float
    pressing: float  # -F_e without what the sensor adds, and a weight [N]: decides contact
    rest: float  # the same less the known force of the environment [N]: what K_e and B_e explain
    travel: float  # displacement whose rate multiplies B_e [m]
    velocity: float  # that rate [m/s], NaN where not measured
    # stiffness_column, constant_column: phi_K [m], and its slope over the depth
    stiffness_column: float
    constant_column: float
    inertial_force: float  # force of M_e and the tool that `rest` is less of [N]
    hindrance: str  # why the relation does not hold; '' where it does


class SampleCompensation(Protocol):
    """Anything that compensates known physics sample by sample."""

    def take(self, sample: ContactSample, location: float, pressing: float) -> CompensatedSample:
        """
        Compensate one sample.

        location: x_e nominal [m]; NaN: not known yet
        pressing: -F_e less the bias [N]
        """
