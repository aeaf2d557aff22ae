# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Blocks of a recording for the calibration of a tool: mean wrenches and the motion."""

from array import array
from typing import Sequence

import numpy as np

from .robot_model import RobotModel
from .tool_calibration import CalibrationBlocks
from .tool_load import Array, load_regressor, specific_force
from ..exceptions import MessageError, RecordingError
from ..recordings import RecordingReader
from ..recordings.decoding import ForceTorqueDecoder, JointStateDecoder
from ..recordings.source import RecordingSource

BLOCK_S = 0.1
_FASTEST_TURN = 0.5  # [rad/s]
_FASTEST_START = 0.5  # [m/s^2]
_FASTEST_SPIN_UP = 0.3  # [rad/s^2]: the moments of inertia are not modelled
_JOINT_RATE = 100.0  # of the grid on which joints of different messages meet [Hz]
_LONGEST_GAP_S = 0.1  # between joint states


def recorded_frame(reader: RecordingReader, source: RecordingSource) -> str:
    """Return the frame of the first wrench; '' where the recording has none."""
    decoder = ForceTorqueDecoder()
    for message in reader.messages([source.wrench]):
        decoder.decode(message.data)
        return decoder.frame_id
    return ''


def read_blocks(
    reader: RecordingReader, source: RecordingSource, model: RobotModel, force_sign: float = 1.0,
    mount: Array = np.eye(3), base: str = '',
) -> CalibrationBlocks:
    """
    Read the blocks of a recording.

    reader: the recording
    source: its topics
    model: its tip is the frame of the wrench, its base has z up
    force_sign: -1 where the driver publishes the wrench that the robot applies
    mount (3, 3): turns the axes of the wrench into those of the model's tip
    base: link in whose axes the wrench is expressed; '' for those of the sensor
    """
    wrench_ns, wrench, joints = _read(reader, source, model.joint_names)
    begin = max(wrench_ns[0], *(times[0] for times, _ in joints))
    end = min(wrench_ns[-1], *(times[-1] for times, _ in joints))
    centres = np.arange(0.0, (end - begin) * 1e-9 - BLOCK_S, BLOCK_S) + 0.5 * BLOCK_S
    if not len(centres):
        raise RecordingError(
            f'wrench and joint states of {reader.path} overlap in time for '
            f'{(end - begin) * 1e-9:.3g} s, expected seconds; check the stamps of both topics')
    place = np.floor((wrench_ns - begin) * 1e-9 / BLOCK_S).astype(int)
    inside = (place >= 0) & (place < len(centres))
    counts = np.bincount(place[inside], minlength=len(centres))
    sums = np.array([np.bincount(place[inside], column, len(centres))
                     for column in force_sign * wrench[inside].T])
    q = np.array([_smoothed(centres, (times - begin) * 1e-9, values, continuous)
                  for (times, values), continuous in zip(joints, model.continuous)])
    have = (counts >= 3) & np.isfinite(q).all(axis=(0, 1))
    if not have.any():
        raise RecordingError(
            f'no 0.1 s of {reader.path} has 3 wrenches and joint states with gaps below '
            f'{_LONGEST_GAP_S:g} s; check the rates of both topics')
    f, w, alpha, a = _motion(model, q[:, :, have], mount)
    limits = ((w, _FASTEST_TURN), (alpha, _FASTEST_SPIN_UP), (a, _FASTEST_START))
    slow = np.all([np.linalg.norm(each, axis=1) < limit for each, limit in limits], axis=0)
    measured = (sums[:, have] / counts[have]).T
    if base:
        axes = np.array([model.pose(joints, base)[0].T @ model.pose(joints)[0] @ mount
                         for joints in q[:, 1, have].T])
        measured = np.einsum('nij,nki->nkj', axes, measured.reshape(-1, 2, 3)).reshape(-1, 6)
    return CalibrationBlocks(f, load_regressor(f, w, alpha), measured, slow)


def _read(
    reader: RecordingReader, source: RecordingSource, names: Sequence[str]
) -> tuple[np.ndarray, Array, list[tuple[np.ndarray, Array]]]:
    """Return stamps and wrenches, and stamps and positions of each joint, sorted by stamp."""
    wrenches, decoders = ForceTorqueDecoder(), [JointStateDecoder(name) for name in names]
    stamps = [array('q') for _ in range(len(names) + 1)]
    rows = [array('d') for _ in range(len(names) + 1)]
    seen = 'none at all'
    for topic, _, data in reader.messages([source.wrench, source.joint_states]):
        if topic == source.wrench:
            stamp_ns, values = wrenches.decode(data)
            stamps[-1].append(stamp_ns)
            rows[-1].extend(values)
            continue
        for k, decoder in enumerate(decoders):  # joints may come in several messages
            try:
                reading = decoder.decode(data)
            except MessageError as error:
                seen = str(error)
                continue
            stamps[k].append(reading.stamp_ns)
            rows[k].append(reading.position)
    for name, times in zip((*names, source.wrench), stamps):
        if len(times) < 2:
            raise RecordingError(
                f'{reader.path} has {len(times)} messages of {name}, expected a recording with '
                f'wrenches and the joints {", ".join(names)}; last refused: {seen}')
    signals = [_in_order(times, np.array(values, np.float64).reshape(len(times), -1))
               for times, values in zip(stamps, rows)]
    return *signals[-1], [(times, values[:, 0]) for times, values in signals[:-1]]


def _in_order(times: 'array[int]', values: Array) -> tuple[np.ndarray, Array]:
    stamps, first = np.unique(np.array(times, np.int64), return_index=True)
    finite = np.isfinite(values[first]).all(axis=1)
    return stamps[finite], values[first][finite]


def _smoothed(centres: Array, times: Array, values: Array, continuous: bool) -> Array:
    """Return a parabola's values at begin, middle and end of each block, (3, N), NaN in gaps."""
    values = np.unwrap(values) if continuous else values
    count = round(BLOCK_S * _JOINT_RATE) + 1
    offsets = np.linspace(-0.5, 0.5, count) * BLOCK_S
    at = centres[:, None] + offsets
    samples = np.interp(at, times, values)  # (N, count)
    parabola = np.polynomial.polynomial.polyfit(offsets / BLOCK_S, samples.T, 2)
    places = np.polynomial.polynomial.polyvander([-0.5, 0.0, 0.5], 2) @ parabola
    after = np.clip(np.searchsorted(times, centres), 1, len(times) - 1)
    places[:, times[after] - times[after - 1] > _LONGEST_GAP_S] = np.nan
    return np.asarray(places)


def _motion(model: RobotModel, q: Array, mount: Array) -> tuple[Array, Array, Array, Array]:
    """Return f, w, alpha and acceleration of the sensor, by differences over each block."""
    poses = [[model.pose(q[:, k, n]) for k in range(3)] for n in range(q.shape[2])]
    R = np.array([[pose[0] @ mount for pose in block] for block in poses])  # (N, 3, 3, 3)
    p = np.array([[pose[1] for pose in block] for block in poses])  # (N, 3, 3)
    h = 0.5 * BLOCK_S
    acceleration = (p[:, 2] - 2.0 * p[:, 1] + p[:, 0]) / h**2
    before, after = _turn(R[:, 0], R[:, 1]) / h, _turn(R[:, 1], R[:, 2]) / h
    f = specific_force(R[:, 1], acceleration)
    return f, 0.5 * (before + after), (after - before) / h, acceleration


def _turn(R_from: Array, R_to: Array) -> Array:
    """Return the rotation vector between orientations in the first one's frame, (N, 3) [rad]."""
    from scipy.spatial.transform import Rotation  # slow to import, and only arms need it

    step = np.einsum('nji,njk->nik', R_from, R_to)
    return np.asarray(Rotation.from_matrix(step).as_rotvec())
