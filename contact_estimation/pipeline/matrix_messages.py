# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The full matrices as raw messages, the same for node and replay."""

from __future__ import annotations

from ..estimators.stiffness_matrix import (
    LABELS, matrices, MatrixEstimate, PRINCIPAL_LABELS, principal_table)
from ..messages import encode_multi_array, encode_string, Vector3StampedEncoder

MULTI_ARRAY = 'std_msgs/msg/Float64MultiArray'
MATRIX_TOPICS = {
    'stiffness_matrix': MULTI_ARRAY,
    'principal_stiffness': MULTI_ARRAY,
    'contact_normal': 'geometry_msgs/msg/Vector3Stamped',
    'matrix_status': 'std_msgs/msg/String',
}
"""Name and type of the topics, below the name of the node."""


def encode_matrices(estimate: MatrixEstimate, vectors: Vector3StampedEncoder) -> dict[str, bytes]:
    """Encode an estimate for the topics of MATRIX_TOPICS."""
    quantities, columns = '/'.join(LABELS), '/'.join(PRINCIPAL_LABELS)
    return {
        'stiffness_matrix': encode_multi_array(
            [(quantities, 4), ('force x/y/z', 3), ('motion x/y/z', 3)],
            matrices(estimate).ravel().tolist()),
        'principal_stiffness': encode_multi_array(
            [('direction', 3), (columns, len(PRINCIPAL_LABELS))],
            principal_table(estimate).ravel().tolist()),
        'contact_normal': vectors.encode(estimate.stamp_ns, *estimate.normal.tolist()),
        'matrix_status': encode_string(status_text(estimate)),
    }


def status_text(estimate: MatrixEstimate) -> str:
    """Return the status of an estimate with its reason."""
    return ': '.join(filter(None, (estimate.status.value, estimate.reason)))
