# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What rejected messages say about drivers and parameters."""

from typing import Callable, Mapping, NamedTuple


class Rejection(NamedTuple):
    """Reasons for which messages are rejected, and the warning that they give."""

    name: str  # of the warning
    reasons: tuple[str, ...]  # as counted by a session
    message: str  # with {count}, and names of facts in braces
    # cause, remedy: for the table of warnings
    cause: str
    remedy: str


REJECTIONS = (
    Rejection(
        'zero_stamps', ('wrench_zero_stamp', 'joint_zero_stamp'),
        'rejected {count} messages of {topic}: their stamps are zero; the driver must fill '
        'header.stamp',
        'The driver publishes without a stamp, often from a hand-written bridge.',
        'Fill `header.stamp` with the time of the measurement.'),
    Rejection(
        'invalid_stamps', ('wrench_invalid_stamp', 'joint_invalid_stamp'),
        'rejected {count} messages of {topic}: their stamps are negative or no number; the driver '
        'must fill header.stamp with the time of the measurement',
        'The driver fills `header.stamp` from a variable that is not set, or subtracts a latency '
        'from a clock that begins at zero.',
        'Correct the driver; where it subtracts a latency, set `synchronisation.offset` instead.'),
    Rejection(
        'stamps_of_another_clock', ('wrench_future_stamp', 'wrench_past_stamp',
                                    'joint_future_stamp', 'joint_past_stamp'),
        'rejected {count} messages of {topic}: their stamps are further ahead of those before and '
        'after than synchronisation.maximum_gap_s, or further behind than time_jump_s; let one '
        'driver publish the topic, on a clock that is not stepped',
        'Two publishers with different clocks, a clock that NTP sets in steps, or a driver that '
        'now and then stamps from another clock. A clock that stays where it was set is accepted '
        'with the fifth consecutive message of a topic, and none of them is lost.',
        'Stop the second publisher (`ros2 topic info -v`), synchronise the clocks by slewing '
        '(`chrony`, PTP), or correct the driver.'),
    Rejection(
        'arm', ('robot_description_missing', 'transforms_missing', 'wrench_frame_unknown',
                'joint_lacking'),
        'rejected {count} messages of the arm: {text}',
        'The robot description, or with `pose_source: tf` a transform, is missing or does not '
        'fit the topics.',
        'Start `robot_state_publisher` or set `robot_description_file`; check '
        '`kinematics.base`, `kinematics.tip` and `force_sensor.frame`.'),
    Rejection(
        'tf', ('tf_malformed', 'tf_static_changed'),
        'rejected {count} messages of tf: {text}',
        'The topic has another type, or a static transform changed while the tool was in contact.',
        'Check the type with `ros2 topic info`; start the node again.'),
    Rejection(
        'frame', ('wrench_frame_id',),
        'rejected {count} wrenches of another frame: {text}',
        'Two sensors publish on one topic, or `frame_id` is wrong.',
        'Set `frame_id` to the frame of the sensor, and start again.'),
    Rejection(
        'joint', ('joint_states_joint_unknown', 'joint_states_joint_ambiguous',
                  'joint_states_joint_empty', 'joint_states_joint_lacking',
                  'joint_states_effort_missing'),
        'rejected {count} joint states: {text}',
        'The joint is not in `joint_states`, or several are and none was chosen; with '
        '`wrench_source: joint_efforts`, a joint of the arm or the efforts are missing.',
        'Set `joint`, or remap `joint_states`; let the driver publish efforts.'),
    Rejection(
        'malformed', ('wrench_malformed', 'joint_states_malformed'),
        'rejected {count} messages that cannot be read: {text}',
        'The topic has another type, or another version of it.',
        'Check the type with `ros2 topic info`.'),
    Rejection(
        'joint_gap', ('joint_gap',),
        'rejected {count} wrenches between joint states further apart than '
        'synchronisation.maximum_gap_s; publish joint states faster, or raise it',
        'Joint states are too slow, or get lost.',
        'Publish them at 100 Hz or more, or raise `synchronisation.maximum_gap_s`.'),
    Rejection(
        'joint_missing', ('joint_missing',),
        'rejected {count} wrenches without joint states around their stamps: {lag}',
        'The joint states are silent or began later, or the clocks differ.',
        'Start the driver, remap `joint_states`, synchronise the clocks, or set '
        '`synchronisation.offset`.'),
    Rejection(
        'not_finite', ('wrench_not_finite', 'joint_not_finite'),
        'rejected {count} messages of {topic} that are NaN or infinite; repair the driver',
        'The driver publishes NaN where it measures nothing.', 'Repair the driver.'),
    Rejection(
        'absurd', ('wrench_absurd', 'joint_absurd'),
        'rejected {count} messages of {topic} out of range; check their units, or '
        'synchronisation.maximum_*',
        'Units are not SI, or the limits are too narrow.',
        'Publish N and m, or correct `synchronisation.maximum_force` and its siblings.'),
)
"""In the order of importance."""

_LEAST_SHARE = 0.02  # of the messages since the last report: less is reported as a count alone


class Rejections:
    """Count what is new, and say the main reason."""

    def __init__(self, texts: Callable[[str], str], lag: Callable[[], str]) -> None:
        self._texts, self._lag = texts, lag
        self._before: dict[str, int] = {}
        self._processed = 0

    def new_warnings(self, counts: Mapping[str, int], processed: int) -> tuple[str, str]:
        """Compare with the last call."""
        new = {k: n - self._before.get(k, 0) for k, n in counts.items()}
        new = {k: n for k, n in new.items() if n > 0}
        done, self._processed = processed - self._processed, processed
        self._before = dict(counts)
        if not new:
            return '', ''
        total = sum(new.values())
        return self.main_reason(new) if total > _LEAST_SHARE * done else (
            'rejected', f'rejected {total} messages since the last report')

    def main_reason(self, counts: Mapping[str, int]) -> tuple[str, str]:
        """Return the most important reason that stands for a good part of the rejections."""
        total = sum(counts.values())
        for rejection in REJECTIONS:
            count = sum(counts.get(reason, 0) for reason in rejection.reasons)
            if count and count >= 0.2 * total:
                reason = max(rejection.reasons, key=lambda one: counts.get(one, 0))
                topic = 'wrench' if reason.startswith('wrench') else 'joint_states'
                return rejection.name, rejection.message.format(
                    count=count, topic=topic, text=self._texts(reason), lag=self._lag())
        reason = max(counts, key=lambda one: counts[one])
        return 'rejected', f'rejected {total} messages, most of them {reason}'


def lag_in_words(lag_s: float, topic: str) -> str:
    """
    Say how far the newest motion is from the newest wrench.

    lag_s: newest stamp of a wrench less that of a motion [s]; NaN before both
    """
    if lag_s != lag_s:
        return f'none has come; is {topic} published, or remapped?'
    where = 'ahead of' if lag_s < 0.0 else 'behind'
    return (f'the newest motion is {abs(lag_s):.3g} s {where} the wrench; start its driver, '
            'synchronise the clocks, or set synchronisation.offset')
