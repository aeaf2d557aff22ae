# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Files of estimates: CSV and MCAP."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Sequence

from .matrix_messages import encode_matrices, MATRIX_TOPICS
from .result import AxesEstimates
from ..estimators.estimate import Estimate
from ..estimators.stiffness_matrix import MatrixEstimate
from ..messages import encode_float64, encode_string, Vector3StampedEncoder
from ..recordings.writing import RecordingWriter

_NAN = float('nan')
_VECTORS = ('stiffness', 'damping', 'stiffness_std', 'damping_std', 'location', 'inertia')
_VECTOR_TYPE = 'geometry_msgs/msg/Vector3Stamped'
_COLUMNS = ('stiffness', 'damping', 'stiffness_std', 'damping_std', 'status')


def stamp_text(stamp_ns: int) -> str:
    """
    Return a stamp in seconds, exact to the nanosecond.

    stamp_ns: stamp [ns]
    """
    sign, rest = ('-', -stamp_ns) if stamp_ns < 0 else ('', stamp_ns)
    return f'{sign}{rest // 10**9}.{rest % 10**9:09d}'


class CsvEstimates:
    """
    One row a sample: t, stiffness, damping, stiffness_std, damping_std, status.

    Numbers are written exactly: reading them returns the same bits. Axes beside the contact axis
    follow as further columns, stiffness_y and so on.

    axes: the estimated axes, the contact axis first
    """

    def __init__(self, path: Path, axes: str = 'x') -> None:
        self._file = open(path, 'w', encoding='utf-8')
        names = [*_COLUMNS, *(f'{name}_{axis}' for axis in axes[1:] for name in _COLUMNS)]
        self._file.write(','.join(['t', *names]) + '\n')

    def write(self, estimates: Sequence[AxesEstimates]) -> None:
        """Append the estimates of consecutive samples."""
        self._file.writelines(
            f'{stamp_text(axes[0].stamp_ns)},{",".join(map(_fields, axes))}\n'
            for axes in estimates
        )

    def write_matrices(self, estimates: Sequence[MatrixEstimate]) -> None:
        """Write nothing: matrices do not come with every sample."""

    def __enter__(self) -> 'CsvEstimates':
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file."""
        self._file.close()


class McapEstimates:
    """
    One message a sample on each topic of the estimator node.

    axes: the estimated axes, the contact axis first: the components of the vectors
    """

    def __init__(self, path: Path, axes: str) -> None:
        self._writer = RecordingWriter.file(path)
        self._vectors = Vector3StampedEncoder('')
        self._places = ['xyz'.index(axis) for axis in axes]

    def write(self, estimates: Sequence[AxesEstimates]) -> None:
        """Append the estimates of consecutive samples."""
        for axes in estimates:
            stamp_ns = axes[0].stamp_ns
            for name in _VECTORS:
                vector = [_NAN, _NAN, _NAN]
                for place, estimate in zip(self._places, axes):
                    vector[place] = getattr(estimate, name)
                self._writer.write(
                    f'/estimator_node/{name}', _VECTOR_TYPE,
                    self._vectors.encode(stamp_ns, *vector), stamp_ns,
                )
            status = encode_string(axes[0].status.value)  # of the contact axis
            fit = encode_float64(axes[0].model_fit)
            self._writer.write('/estimator_node/model_fit', 'std_msgs/msg/Float64', fit, stamp_ns)
            self._writer.write('/estimator_node/status', 'std_msgs/msg/String', status, stamp_ns)

    def write_matrices(self, estimates: Sequence[MatrixEstimate]) -> None:
        """Append estimates of three coupled axes."""
        for estimate in estimates:
            for name, raw in encode_matrices(estimate, self._vectors).items():
                self._writer.write(
                    f'/estimator_node/{name}', MATRIX_TOPICS[name], raw, estimate.stamp_ns)

    def __enter__(self) -> 'McapEstimates':
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Finish the file."""
        self._writer.close()


def _fields(e: Estimate) -> str:
    """Return the fields of one axis in a row."""
    return f'{e.stiffness!r},{e.damping!r},{e.stiffness_std!r},{e.damping_std!r},{e.status.value}'
