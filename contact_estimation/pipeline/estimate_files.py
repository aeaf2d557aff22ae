# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Estimates as CSV, MCAP and as a figure."""

from pathlib import Path
from types import TracebackType
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .axes import encode_matrices, MATRIX_TOPICS
from ..estimators.estimate import AxesEstimates, Estimate
from ..estimators.stiffness_matrix import MatrixEstimate
from ..figures import BLUE, figure_style, INK, MUTED, new_figure, ORANGE
from ..recordings.encoding import encode_float64, encode_string, Vector3StampedEncoder
from ..recordings.recorded_signals import RecordedSignals, Signal
from ..recordings.writing import RecordingWriter
from ..texts import writing


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
        self._path, self._file = path, open(path, 'w', encoding='utf-8')
        names = [*_COLUMNS, *(f'{name}_{axis}' for axis in axes[1:] for name in _COLUMNS)]
        self._file.write(','.join(['t', *names]) + '\n')

    def write(self, estimates: Sequence[AxesEstimates]) -> None:
        """Append the estimates of consecutive samples."""
        with writing(self._path):
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
        with writing(self._path):
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


ESTIMATES = ('stiffness', 'damping', 'stiffness_std', 'damping_std')
_MOST_TRACED = 20_000  # points kept: more than a picture shows


class EstimateTrace:
    """Collect estimates of the contact axis; long recordings are thinned evenly."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []
        self._count, self._stride = 0, 1

    def write(self, estimates: Sequence[AxesEstimates]) -> None:
        """Take the estimates of consecutive samples."""
        for contact, *_ in estimates[-self._count % self._stride::self._stride]:
            values = (getattr(contact, name) for name in ESTIMATES)
            self._rows.append((contact.stamp_ns, *values))
        self._count += len(estimates)
        while len(self._rows) > _MOST_TRACED:
            self._rows, self._stride = self._rows[::2], 2 * self._stride

    def write_matrices(self, estimates: Sequence[MatrixEstimate]) -> None:
        """Leave out estimates of coupled axes."""

    def series(self, begin_ns: int) -> dict[str, NDArray[np.float64]]:
        """
        Return the estimates over time.

        begin_ns: stamp of time 0 [ns]
        Returns series (N, 2): time [s] and value of each of `ESTIMATES`; empty without any
        estimate
        """
        if not self._rows:
            return {}
        stamps = np.array([row[0] for row in self._rows], np.int64)
        t = (stamps - begin_ns) * 1e-9
        return {name: np.column_stack((t, [row[place] for row in self._rows]))
                for place, name in enumerate(ESTIMATES, 1)}


Series = NDArray[np.float64]

_QUANTITIES = {'stiffness': 'K_e [N/m]', 'damping': 'B_e [N s/m]'}
_NOTHING = np.empty((0, 2))
_MOST_POINTS = 40_000  # points of a signal: more than a picture shows


@figure_style()
def plot_contact(
    series: Mapping[str, Series], title: str, true: Mapping[str, float] | None = None,
    force_note: str = '', warning: str = '',
) -> Any:
    """
    Plot a contact.

    series (N, 2): time [s] and value of force, desired_force, position, desired and reference; of
    stiffness, damping, stiffness_std and damping_std where they are estimated. What is missing or
    empty is not plotted.
    true: True stiffness and damping, where they are known
    """
    shown = {name: label for name, label in _QUANTITIES.items() if name in series}
    count = 2 + len(shown)
    figure, axes = new_figure((9.0, 2.5 * count), count, sharex=True)
    figure.suptitle(title, x=0.01, ha='left', fontsize=12)
    if warning:
        axes[0].set_title(warning, color=ORANGE)
    _plot_force(axes[0], series, force_note)
    _plot_motion(axes[1], series)
    for axis, (name, label) in zip(axes[2:], shown.items()):
        _plot_estimate(axis, series, name, (true or {}).get(name), label)
    axes[-1].set_xlabel('time [s]')
    for axis in axes:
        axis.legend(loc='upper left', ncols=3)
    return figure


def signal_series(signals: RecordedSignals) -> dict[str, Series]:
    """
    Return the signals of a recording over time since its first wrench, thinned for a picture.

    Returns series (N, 2): force, position, reference and desired_force, as in `plot_contact`
    """
    begin = int(signals.wrench.stamp_ns[0])

    def over_time(signal: Signal, row: int) -> Series:
        step = 1 + len(signal) // _MOST_POINTS
        t = (signal.stamp_ns[::step] - begin) * 1e-9
        return np.column_stack((t, signal.values[row, ::step]))

    reference = signals.reference_trajectory
    series = {'force': over_time(signals.wrench, 0),
              'position': over_time(signals.joint_states, 0)}
    if len(reference):
        series['reference'] = over_time(reference, 0)
        if np.any(reference.values[3]):
            series['desired_force'] = over_time(reference, 3)
    return series


def _plot_force(axis: Any, series: Mapping[str, Series], note: str) -> None:
    force, desired = series['force'], series.get('desired_force', _NOTHING)
    axis.plot(force[:, 0], -force[:, 1], color=INK, linewidth=0.7, label='-F_e measured')
    if len(desired):
        axis.plot(desired[:, 0], desired[:, 1], color=ORANGE, linewidth=1.0, label='F_r desired')
    axis.set_ylabel('pressing force [N]')
    if note:
        axis.set_xlabel(note, loc='left', color=INK)


def _plot_motion(axis: Any, series: Mapping[str, Series]) -> None:
    for name, colour, width, label in (
        ('desired', MUTED, 2.0, 'x_d desired'),
        ('reference', ORANGE, 1.0, 'x_r reference'),
        ('position', INK, 1.0, 'x measured'),
    ):
        if name in series:
            own = series[name]
            axis.plot(own[:, 0], 1e3 * own[:, 1], color=colour, linewidth=width, label=label)
    axis.set_ylabel('position [mm]')


def _plot_estimate(
    axis: Any, series: Mapping[str, Series], name: str, true: float | None, label: str
) -> None:
    own, std = series[name], series.get(f'{name}_std', _NOTHING)
    high = 1.0
    if true is not None:
        axis.axhline(true, color=ORANGE, linewidth=1.0, label=f'true {true:g}')
        high = 1.5 * true or high
    if len(own):
        t, value = own[:, 0], own[:, 1]
        axis.plot(t, value, color=BLUE, linewidth=1.2, label='estimate')
        if len(std) and np.isfinite(std[:, 1]).any():
            band = 2.0 * np.interp(t, std[:, 0], std[:, 1])
            axis.fill_between(t, value - band, value + band, color=BLUE, alpha=0.2,
                              linewidth=0, label='± 2 std')
        high = max(high, float(np.nanpercentile(value, 99)))
    axis.set_ylim(0.0, 1.1 * high)  # room for the legend
    axis.set_ylabel(label)
