# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Symmetric 3 x 3 matrices in plain scalars."""

from __future__ import annotations

from .testbed_constants import Triple

Symmetric = tuple[float, float, float, float, float, float]
"""Entries 11, 12, 13, 22, 23, 33."""


def solve(matrix: Symmetric, right: Triple) -> Triple:
    """Solve a symmetric positive definite 3 x 3 system by Cramer's rule."""
    m11, m12, m13, m22, m23, m33 = matrix
    r1, r2, r3 = right
    k11, k12, k13 = m22 * m33 - m23 * m23, m13 * m23 - m12 * m33, m12 * m23 - m13 * m22
    k22, k23, k33 = m11 * m33 - m13 * m13, m12 * m13 - m11 * m23, m11 * m22 - m12 * m12
    scale = 1.0 / (m11 * k11 + m12 * k12 + m13 * k13)
    return (
        scale * (k11 * r1 + k12 * r2 + k13 * r3),
        scale * (k12 * r1 + k22 * r2 + k23 * r3),
        scale * (k13 * r1 + k23 * r2 + k33 * r3),
    )


def times(matrix: Symmetric, vector: Triple) -> Triple:
    """Multiply a symmetric matrix by a vector."""
    m11, m12, m13, m22, m23, m33 = matrix
    v1, v2, v3 = vector
    return (
        m11 * v1 + m12 * v2 + m13 * v3, m12 * v1 + m22 * v2 + m23 * v3,
        m13 * v1 + m23 * v2 + m33 * v3,
    )
