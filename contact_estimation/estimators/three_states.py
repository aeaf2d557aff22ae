# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Kalman corrections of three states in scalars.

Array operations on three by three matrices take ten times as long.
"""

State = tuple[float, float, float]
Covariance = tuple[float, float, float, float, float, float]
"""Upper triangle (aa, ab, ac, bb, bc, cc) of a symmetric matrix of the states (a, b, c)."""


def diagonal(a: float, b: float, c: float) -> Covariance:
    """Return the covariance of independent states."""
    return a * a, 0.0, 0.0, b * b, 0.0, c * c


def correct(
    x: State, P: Covariance, H: State, error: float, variance: float,
    free: tuple[bool, bool, bool],
) -> tuple[State, Covariance, float]:
    """
    Correct states and covariance with one scalar measurement.

    x <- x + g e, P <- P - g H P with g = P H^T / (H P H^T + R). A state that is not free is a
    consider state (Schmidt): its value and its covariance with other such states stay; its
    uncertainty reduces the gain of the free ones.
    """
    aa, ab, ac, bb, bc, cc = P
    h_a, h_b, h_c = H
    p_a = aa * h_a + ab * h_b + ac * h_c
    p_b = ab * h_a + bb * h_b + bc * h_c
    p_c = ac * h_a + bc * h_b + cc * h_c
    expected = h_a * p_a + h_b * p_b + h_c * p_c + variance
    g_a, g_b, g_c = p_a / expected, p_b / expected, p_c / expected
    a, b, c = x
    free_a, free_b, free_c = free
    if free_a:
        a += g_a * error
        aa -= g_a * p_a
    if free_b:
        b += g_b * error
        bb -= g_b * p_b
    if free_c:
        c += g_c * error
        cc -= g_c * p_c
    if free_a or free_b:
        ab -= g_a * p_b
    if free_a or free_c:
        ac -= g_a * p_c
    if free_b or free_c:
        bc -= g_b * p_c
    return (a, b, c), (aa, ab, ac, bb, bc, cc), expected


def grow(P: Covariance, growth: State) -> Covariance:
    """
    Increase the covariance of some states by forgetting, while others are not forgotten.

    Two states that grow scale with the factors given. One that grows alone forgets only what it
    has beyond the others, its variance given them: scaling its covariances with them too would
    keep a correlation of the past, along which both then drift.
    """
    aa, ab, ac, bb, bc, cc = P
    a, b, c = growth
    if (a > 1.0) == (b > 1.0):
        return aa * a * a, ab * a * b, ac * a * c, bb * b * b, bc * b * c, cc * c * c
    if a > 1.0:
        return aa + (a * a - 1.0) * _given((aa, ab, ac, bb, bc, cc)), ab, ac, bb, bc, cc
    return aa, ab, ac, bb + (b * b - 1.0) * _given((bb, ab, bc, aa, ac, cc)), bc, cc


def _given(P: Covariance) -> float:
    """Return the variance of a where b and c are known."""
    aa, ab, ac, bb, bc, cc = P
    determinant = bb * cc - bc * bc
    if determinant > 0.0:
        by_others = (ab * (ab * cc - 2.0 * ac * bc) + ac * ac * bb) / determinant
    else:
        by_others = ab * ab / bb if bb > 0.0 else 0.0
    return max(aa - by_others, 0.0)


def constrain(x: State, P: Covariance, normal: State, low: float, high: float) -> State:
    """
    Project states onto limits of a linear combination of them, along their covariance.

    The others move consistently: x <- x - P n excess / (n^T P n).
    """
    n_a, n_b, n_c = normal
    value = n_a * x[0] + n_b * x[1] + n_c * x[2]
    if low <= value <= high:
        return x
    aa, ab, ac, bb, bc, cc = P
    p_a = aa * n_a + ab * n_b + ac * n_c
    p_b = ab * n_a + bb * n_b + bc * n_c
    p_c = ac * n_a + bc * n_b + cc * n_c
    variance = n_a * p_a + n_b * p_b + n_c * p_c
    if variance <= 0.0:
        return x
    share = (value - min(max(value, low), high)) / variance
    return x[0] - p_a * share, x[1] - p_b * share, x[2] - p_c * share
