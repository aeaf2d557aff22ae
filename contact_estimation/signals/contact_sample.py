"""One instant of the contact axis."""

from __future__ import annotations

from typing import NamedTuple


class ContactSample(NamedTuple):
    """
    Motion and force at one instant, along the contact axis.

    A NamedTuple, since making a frozen dataclass of this size costs more than a whole update of
    an estimator.

    Attributes
    ----------
    stamp_ns : int
        Header stamp of the wrench [ns].
    position : float
        x of the end-effector [m], +x into the wall.
    velocity : float
        Its rate [m/s]; NaN where the robot does not tell.
    force : float
        Measured F_e [N], negative while pressing.

    """

    stamp_ns: int
    position: float
    velocity: float
    force: float
