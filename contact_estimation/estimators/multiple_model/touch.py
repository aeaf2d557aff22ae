# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Where a short contact begins: its rows straddle the touch, where the surface is a corner."""

from math import sqrt

import numpy as np

from .blocks import PRESSES
from .constants import CLIP, DAMPING_S, DAMPING_STD_S
from .laws import ACCELERATION, Array, DEPTH, FORCE, ONE, RATE
from .smoothing import Smoothing

_LINEAR = [DEPTH, RATE, ACCELERATION, FORCE]
_PLACES = 25  # tried along the way of the samples before and after the touch
_MASS_S2 = 1e-4  # prior deviation of the coefficient of S2 y, relative to K: a lag of 10 ms [s^2]
_FLATTEST = 1e-6  # prior precision of K relative to its scale


def before_release(
    smooth: Smoothing, force: Array, x: Array, variance: float
) -> tuple[Array, Array] | None:
    """
    Return the samples of a short contact that rows can be made of.

    The release, where the wall lets go, is not used. None where the force is too weak to be sure
    that it was a contact, where it presses from the beginning, or there are too few samples.
    """
    deviation = sqrt(variance)
    pressing = np.flatnonzero(force > PRESSES * deviation)
    if not len(pressing) or force.max() < CLIP * deviation:
        return None
    end = int(pressing[-1])
    windows = (end - 2 * smooth.half - 1) // smooth.hop + 1
    if windows < 1:
        return None
    length = smooth.length(windows)
    if force[end - length] > PRESSES * deviation:  # its touch is not among the samples
        return None
    return force[end - length:end], x[end - length:end]


def surface_of_touch(
    smooth: Smoothing, force: Array, x: Array, weight: float, gram: Array, x0: float,
    scale: float, prior: tuple[Array, Array, Array],
) -> tuple[float, float] | None:
    """
    Return where a contact began, by the evidence of a spring and a damper from each place on.

    force, x (N,): pressing force [N] and position [m], from before the touch to before the release
    weight: of a row [1/N^2]
    gram (22, 22): of earlier contacts, about x0 [m]
    x0, scale: reference of `gram` [m]; scale of the stiffness [N/m]
    prior (M,): centre [m], standard deviation [m] and weight of a mixture
    Returns surface, std: mean and standard deviation [m]; None where no place explains a pressing
    force
    """
    centres, stds, shares = prior
    places = np.concatenate([np.linspace(x.min(), x.max(), _PLACES, endpoint=False),
                             centres[(centres > x.min()) & (centres < x.max())]])
    table = smooth.bands((len(x) - 2 * smooth.half - 1) // smooth.hop + 1)[0]
    length = table.shape[0]
    y = np.maximum(x[:length] - places[:, None], 0.0)
    rows = (y @ table).reshape(len(places), 3, -1)
    pressed = (force[:length] @ table).reshape(3, -1)[0]
    rows = np.concatenate([rows, np.broadcast_to(pressed, (len(places), 1, len(pressed)))], axis=1)
    G = weight * rows @ rows.transpose(0, 2, 1) + _at_places(gram, places - x0)
    K = np.full(len(places), scale)
    for _ in range(3):  # the priors of the others scale with K
        precision = np.stack([_FLATTEST / K**2, (DAMPING_STD_S * K) ** -2.0,
                              (_MASS_S2 * K) ** -2.0], axis=1)
        mean = np.stack([0.0 * K, DAMPING_S * K, 0.0 * K], axis=1)
        A = G[:, :3, :3] + precision[:, :, None] * np.eye(3)
        eta = G[:, :3, 3] + precision * mean
        theta = np.linalg.solve(A, eta[:, :, None])[:, :, 0]
        K = np.maximum(theta[:, 0], 1e-2 * scale)
    left = (precision * mean * mean).sum(1) - (eta * theta).sum(1)
    evidence = 0.5 * (np.log(precision).sum(1) - np.linalg.slogdet(A)[1] - left)
    density = shares / stds * np.exp(-0.5 * np.square((places[:, None] - centres) / stds))
    odds = evidence + np.log(density.sum(1) + 1e-300)
    odds[theta[:, 0] <= 0.0] = -np.inf
    if not np.isfinite(odds).any():
        return None
    p = np.exp(odds - odds.max())
    p /= p.sum()
    surface = float(p @ places)
    step = (x.max() - x.min()) / _PLACES
    return surface, sqrt(float(p @ np.square(places - surface)) + step * step / 12.0)


def _at_places(gram: Array, delta: Array) -> Array:
    """Return the part of a Gram matrix that a known surface leaves, for each place of it."""
    known = np.repeat(gram[np.ix_(_LINEAR, _LINEAR)][None], len(delta), axis=0)
    cross = delta[:, None] * gram[ONE, _LINEAR]
    known[:, 0] -= cross
    known[:, :, 0] -= cross
    known[:, 0, 0] += delta * delta * gram[ONE, ONE]
    return known
