# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Which effects recordings may show: what does not move, touch or return tells some of nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ...physics import EFFECTS

_ORDER, _UNTOLD = 4, 0.2  # of a polynomial in x; share of the variance of |v| that it leaves
_STROKES, _MANY_STROKES = 1.5, 3.0  # more than one; more than one and a return
_LITTLE, _MOST = 0.05, 0.5  # of the range of motion and of force, on the way back
_HELD = 0.05  # of the range of motion, before what sticks breaks away
_THERE_AND_BACK = 2.5  # one contact, with little to and fro
_OF_STROKE = 1.7  # times the least misfit worth a name: 1 % of the range of the force
_OF_SPEED, _OF_ACCELERATION = 'damping_law', 'inertia'  # families
_LOSSES = ('friction', 'hysteresis')  # families
_MOVES, _FASTEST = 0.2, 0.9  # of the speed that so many samples do not exceed
_OF_A_STROKE = 0.1  # over which a speed is averaged
# Deviation from the usual speed, and share of the samples, or of the means, of which a quarter may
# be of turns, that are within.
_ONE, _ABOUT_ONE = (0.1, 0.9), (0.2, 0.75)
_MOSTLY = 2.0  # times the force of the spring
_SLACK = 0.02  # of the range, by which a pressed wall may be pulled


def candidates_for(
    model: Model, with_robot: bool, pressed: bool = False, returns: bool = True,
    speeds: bool = True, paces: bool = True, plays: bool = True, breaks: bool = False,
) -> list[str]:
    """
    List the effects that may be added.

    Parameters
    ----------
    model : Model
        Its effects are no candidates.
    with_robot : bool
        Whether there is a robot.
    pressed : bool
        Whether a permanently attached wall is only pressed, never pulled.
    returns : bool
        Whether it is moved to and fro.
    speeds : bool
        Whether its depth does not tell its speed, but for the direction, or it is a damper or a
        drive.
    paces : bool
        Whether it moves at several speeds: at one a damping is no other than a hysteresis, and
        no mass is accelerated but at the turns.
    plays : bool
        Whether the motion reverses more than once, or the force vanishes in contact: else a wall
        that stays where it was pressed lets go as a play does.

    breaks : bool
        Whether it sticks before it slides.

    Returns
    -------
    names : list of str
        In the order of the registry; effects of touching only for a unilateral wall, those of
        attachment only for an attached one, those of penetration also for an attached one that is
        only pressed, those of a return also for one that is moved to and fro, those of a spring
        not for a drive, which has none, those of the magnitude of the speed only where depth does
        not tell it, and those that let go not for an attached mass.

    """
    wall = model.nominal.environment
    may_let_go = wall.unilateral or wall.inertia == 0.0  # a force does not move what it lets go
    return [
        name for name, cls in EFFECTS.items()
        if name not in model.effects and name not in model.excluded
        and (with_robot or not cls.needs_robot)
        and (wall.unilateral or not cls.needs_touch)
        and not (wall.unilateral and cls.needs_attachment)
        and (wall.unilateral or pressed or not cls.needs_penetration)
        and (returns or breaks and cls.breaks_away or not cls.needs_return)
        and (wall.unilateral or wall.stiffness > 0.0 or not cls.needs_spring)
        and (speeds or not cls.needs_speeds)
        and (wall.unilateral or paces or cls.family != _OF_SPEED)
        and (with_robot or paces or cls.family != _OF_ACCELERATION)
        and (plays and may_let_go or not cls.lets_go)
        and not (cls.base_parameter == 'inertia' and model.with_inertia)
    ]


def is_pressed(recordings: Recordings, model: Model) -> bool:
    """
    Return whether a permanently attached wall is only pressed in recordings, never pulled.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    model : Model
        Defines where the surface is.

    Returns
    -------
    pressed : bool
        But for a small part of the range.

    """
    surface = model.nominal.environment.location
    return all(float(np.min(one.observed.x)) - surface > -_SLACK * float(np.ptp(one.observed.x))
               for one in recordings)


def candidates_in(recordings: Recordings, model: Model, returns: bool = False) -> list[str]:
    """
    List the effects that recordings may show.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        To be fitted.
    model : Model
        Its effects are no candidates.
    returns : bool
        Whether to add those that a motion there and back would show.

    Returns
    -------
    names : list of str
        Of `candidates_for`.

    """
    return candidates_for(
        model, any(one.observed.reference is not None for one in recordings),
        is_pressed(recordings, model), returns or any(map(_returns, recordings)),
        any(map(_has_speeds, recordings)) or all(_damps(one, model) for one in recordings),
        has_paces(recordings), any(map(_plays, recordings)), all(map(_breaks_away, recordings)))


def told_by_a_return(recordings: Recordings, model: Model) -> list[str]:
    """
    List the losses that look like elastic laws and zeros until the motion returns.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    model : Model
        Its effects are no candidates.

    Returns
    -------
    names : list of str
        None if the motion returns.

    """
    if any(map(_returns, recordings)):
        return []
    known = candidates_in(recordings, model)
    return [name for name in candidates_in(recordings, model, returns=True)
            if name not in known and EFFECTS[name].family in _LOSSES]


def tells_time_from_path(recordings: Recordings) -> bool:
    """
    Return whether recordings tell a memory of time from one of the path.

    At one speed both are the same: s' = K_1 v - s / tau and z' = sigma v (1 - z / F_c sgn v) with
    F_c = sigma tau abs(v). A motion that repeats one cycle traces one loop, which either may trace
    where no law is exact.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.

    Returns
    -------
    tells : bool
        Whether the motion has several speeds, on average over a tenth of a stroke, or rests, and
        does not repeat itself alone.

    """
    repeats = all(one.carries_discrepancy and one.observed.cycle for one in recordings)
    return not (repeats or _is_one(_mean_speeds(recordings), _ABOUT_ONE))


def is_single_stroke(recordings: Recordings) -> bool:
    """
    Return whether all that is recorded is one way in or out.

    It passes each depth once: any imperfection of a rig is a curve of depth.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.

    Returns
    -------
    single : bool
        By the path of the motion, over its range.

    """
    if len(recordings) > 1 or _is_unloaded(recordings[0]):
        return False
    return _path_over_range(recordings[0].blocks(recordings[0].observed.x)) < _STROKES


def least_worth_a_name(recordings: Recordings) -> float:
    """
    Return the least misfit that is worth a name, in `least_material`: more in a single stroke.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.

    Returns
    -------
    share : float
        As for `material`.

    """
    return _OF_STROKE if is_single_stroke(recordings) else 1.0


def _returns(recording: PreparedRecording) -> bool:
    """Return whether the motion is more than one stroke and a hold."""
    return _strokes(recording) > _STROKES or _is_unloaded(recording)


def _breaks_away(recording: PreparedRecording) -> bool:
    """Return whether half of the force is reached before the motion has hardly begun."""
    x, force = map(recording.blocks, (recording.observed.x, recording.observed.force))
    held = np.abs(x - x[0]) < _HELD * np.ptp(x)
    end = int(np.argmin(held)) if not held.all() else 0
    return bool(np.ptp(force[:end]) > _MOST * np.ptp(force)) if end else False


def _is_unloaded(recording: PreparedRecording) -> bool:
    """Return whether the force returns with the motion, though that may return a little alone."""
    x, force = map(recording.blocks, (recording.observed.x, recording.observed.force))
    turn = int(np.argmax(np.abs(x - x[0])))  # of what yields
    most = _MOST * float(np.ptp(force))
    return bool(np.ptp(x[turn:]) > _LITTLE * np.ptp(x)
                and np.ptp(force[turn:]) > most > 0.0 and abs(force[turn] - force[0]) > most)


def _plays(recording: PreparedRecording) -> bool:
    """Return whether a play would show as one."""
    return recording.dropped is not None or _strokes(recording) > _THERE_AND_BACK


def _strokes(recording: PreparedRecording) -> float:
    return _path_over_range(recording.observed.x)


def _path_over_range(x: NDArray[np.float64]) -> float:
    """Return the length of the path of a motion, over its range."""
    return float(np.sum(np.abs(np.diff(x)))) / max(float(np.ptp(x)), 1e-300)


def _has_speeds(recording: PreparedRecording) -> bool:
    """Return whether the depth does not tell the speed: in a few strokes at a pace it does."""
    o, use = recording.observed, recording.use
    if _strokes(recording) < _MANY_STROKES:
        return False
    x, speed = o.x[use], np.abs(o.v[use])
    columns = np.vander((x - np.mean(x)) / max(float(np.std(x)), 1e-300), _ORDER + 1)
    left = speed - columns @ np.linalg.lstsq(columns, speed, rcond=None)[0]
    return float(np.var(left)) > _UNTOLD * float(np.var(speed))


def _damps(recording: PreparedRecording, model: Model) -> bool:
    """
    Return whether an attached environment resists by damping far more than by a spring, if any.

    What depends on the direction is then a law of the damper, even if the depth tells the speed.
    """
    wall, o = model.nominal.environment, recording.observed
    damper, spring = wall.damping * np.std(o.v), abs(wall.stiffness) * np.std(o.x)
    return not wall.unilateral and bool(damper >= _MOSTLY * spring)


def _mean_speed(recording: PreparedRecording) -> NDArray[np.float64]:
    """Return the speed over each tenth of a stroke that has the mean speed [m/s]."""
    o = recording.observed
    stroke = float(np.ptp(o.x)) / max(float(np.mean(np.abs(o.v))), 1e-300)
    count = max(round(_OF_A_STROKE * stroke / o.h), 1)
    x = o.x[:len(o.x) // count * count + 1:count]
    return np.asarray(np.abs(np.diff(x)) / (count * o.h))


def has_paces(recordings: Recordings) -> bool:
    """
    Return whether recordings move at several speeds, beside resting.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.

    Returns
    -------
    several : bool
        False if dry friction and damping are the same there.

    """
    speed = np.concatenate([np.abs(one.observed.v[one.use]) for one in recordings])
    # The speed of samples may be little but noise, that over tenths of a stroke blurs short ones.
    return not (_is_one(_moving(speed), _ONE) or _is_one(
        _moving(_mean_speeds(recordings)), _ABOUT_ONE))


def _moving(speed: NDArray[np.float64]) -> NDArray[np.float64]:
    return speed[speed > _MOVES * float(np.quantile(speed, _FASTEST))]


def _is_one(speed: NDArray[np.float64], nearly: tuple[float, float]) -> bool:
    """Return whether most speeds are nearly the usual one."""
    deviation, most = nearly
    usual = float(np.median(speed))
    return float(np.mean(np.abs(speed - usual) < deviation * usual)) >= most


def _mean_speeds(recordings: Recordings) -> NDArray[np.float64]:
    return np.concatenate([_mean_speed(one) for one in recordings])
