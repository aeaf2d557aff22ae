# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of force and contact: sign, axis, noise, bias, surface, fit of a law."""

import numpy as np

from .check import (
    Array, Check, extremes, Forces, LOADED, loaded_correlation, median_of, millimetres, spread_of,
    Window)
from ...kinematics.parameters import JOINT_EFFORTS, TRACKED
from ...signals.stream_faults import CLEAR, TARE_DUE


_RELATED = 0.8  # correlation of force and position
_PULLS_LESS = 3.0  # standard deviations that a one-sided force may reach on the other side
_STRONGER = 3.0  # than the force of the contact axis
_TILTED = 0.7  # tangent of 35 degrees, more than the friction of most pairs
_NOISY = 10.0  # times the configured noise
_LEAST_FREE = 50  # samples
_MEDIAN = 0.6745  # of the size of a normal variable of variance 1
_DESCRIBE = 'correct friction and masses of the description by diagnose --nominal-robot'
_FRAME = 'contact.normal, and force_sensor.frame and force_sensor.rpy'


class ForceSign(Check):
    """F_e is negative while pressing, and +x points into the wall."""

    name = 'force_sign'
    message = ('force grows to +16 N with penetration, but F_e is negative while pressing; set '
               'force_sign to -1')
    cause = ('The driver publishes the force of the tool on the environment, or the position '
             'grows away from the wall; of an arm, `contact.normal` points out of the wall.')
    remedy = ('Set `force_sign` to the value given, or publish the position with +x into the '
              'wall; for an arm reverse `contact.normal`.')
    invalidates = True
    needs_axes = True

    def judge(self, seen: Window) -> str | None:
        """Look for a one-sided force with the wrong slope, or on the wrong side."""
        slope = _slope_by_least_force(seen) or seen.slope_sign
        if seen.spread < CLEAR * seen.noise or abs(seen.slope_sign) < _RELATED:
            return None
        low, high = extremes(seen.force - _level_outside(seen))
        # A contact beside a bias pulls as little; but where free flight read nothing, none is.
        unbiased = seen.memory['least_force'][0] < LOADED * seen.noise
        pulls = low > -_PULLS_LESS * seen.noise and (unbiased or not seen.contact.any())
        if slope < 0.0:
            return self._pulled(high, seen) if pulls and high > CLEAR * seen.noise else ''
        if pulls:
            return (f'force grows to {high:+.3g} N with penetration, but F_e is negative while '
                    f'pressing; set force_sign to {-seen.parameters.force_sign:g}'
                    f'{_unless_weight(seen)}')
        if high < _PULLS_LESS * seen.noise:
            remedy = ('reverse contact.normal and set force_sign to '
                      f'{-seen.parameters.force_sign:g}' if seen.is_arm
                      else 'change the sign of the position')
            return (f'the tool presses with {-low:.3g} N where x is smallest, but +x points into '
                    f'the wall; {remedy}{_unless_weight(seen)}')
        return None

    @staticmethod
    def _pulled(high: float, seen: Window) -> str:
        remedy = ('reverse contact.normal' if seen.is_arm else 'change the sign of the position '
                  f'and set force_sign to {-seen.parameters.force_sign:g}')
        return (f'the tool is pulled with {high:.3g} N where x is smallest, as by a wall on that '
                f'side, but +x points into the wall; {remedy}{_unless_weight(seen)}')


class ForceStill(Check):
    """The force of a contact changes with the motion, if by its noise alone."""

    name = 'force_still'
    message = ('the force has been exactly -27 N for 2 s while the tool moved by 15 mm; check '
               'that the force sensor is read, and not its last value repeated')
    cause = 'The driver has lost the sensor and repeats the last measurement.'
    remedy = 'Start the driver of the force sensor again.'
    invalidates = True

    def judge(self, seen: Window) -> str | None:
        """Look for a load without any noise beside a motion."""
        moved = spread_of(seen.x) if len(seen.x) else 0.0
        if len(seen.x) < _LEAST_FREE or moved <= CLEAR * seen.position_noise:
            return None
        level = float(seen.force[0])
        if np.ptp(seen.force) > 0.0 or abs(level) < CLEAR * seen.configured_noise:
            return ''
        return (f'the force has been exactly {level:.3g} N for {seen.end_s - seen.start_s:.2g} s '
                f'while the tool moved by {millimetres(moved)}; check that the force sensor is '
                'read, and not its last value repeated')


class OtherAxis(Check):
    """The force of a contact acts along the configured axis."""

    name = 'force_axis'
    message = ('force follows the motion along z (16 N) but not along x (0.9 N); set axis to z, '
               'or publish the wrench in a frame whose x is the contact normal')
    cause = ('`axis` does not name the component of the wrench along the contact normal; of an '
             'arm, `contact.normal` or the axes of the force sensor are wrong.')
    remedy = ('Set `axis` (and `frame_id`), for an arm `contact.normal`, `force_sensor.frame` or '
              '`force_sensor.rpy`, and start again.')
    invalidates = True
    needs_axes = True

    def judge(self, seen: Window) -> str | None:
        """Compare the other components with that of the contact axis."""
        if seen.spread > CLEAR * seen.noise and seen.contact.any():
            return ''
        for other in seen.others:
            if not self._follows(other, seen):
                continue
            size = spread_of(other.force)
            if seen.is_arm:
                return (f'force follows the motion along the wall ({size:.3g} N) but not along '
                        f'contact.normal ({seen.spread:.3g} N); check {_FRAME}'
                        f'{_unless_weight(seen)}')
            return (f'force follows the motion along {other.axis} ({size:.3g} N) but not '
                    f'along {seen.axis} ({seen.spread:.3g} N); set axis to {other.axis}, or '
                    f'publish the wrench in a frame whose {seen.axis} is the contact normal')
        return None

    @staticmethod
    def _follows(other: Forces, seen: Window) -> bool:
        if len(other.force) < len(seen.x) // 2 or not len(other.force):
            return False
        size = spread_of(other.force)
        if size < max(CLEAR * seen.noise, _STRONGER * seen.spread):
            return False
        # Along the wall an arm hardly moves where contact.normal lies in the wall.
        known = seen.is_arm and not seen.may_be_weight
        return known or abs(loaded_correlation(other.x, other.force, seen.noise)) > _RELATED


class ForceDirection(Check):
    """The wall presses an arm along the normal: friction alone does not tilt the force so far."""

    name = 'force_direction'
    message = ('the force of the contact is 45 degrees off contact.normal (16 N along it, 16 N '
               f'along the wall); check {_FRAME}')
    cause = ('`contact.normal` does not point into the wall, or `force_sensor.frame` or '
             '`force_sensor.rpy` turns the wrench; or the tool slides with high friction.')
    remedy = 'Correct `contact.normal`, `contact.normal_frame` or the frame of the sensor.'
    needs_axes = True

    def judge(self, seen: Window) -> str | None:
        """Compare the force along the wall that follows the motion with that along the normal."""
        if not seen.is_arm or not seen.contact.any() or seen.spread < CLEAR * seen.noise:
            return None
        along = [spread_of(other.force) for other in seen.others if len(other.force)
                 and abs(loaded_correlation(other.x, other.force, seen.noise)) > _RELATED]
        wall = float(np.hypot.reduce(along)) if along else 0.0
        if wall < _TILTED * seen.spread:
            return ''
        angle = np.degrees(np.arctan2(wall, seen.spread))
        return (f'the force of the contact is {angle:.0f} degrees off contact.normal '
                f'({seen.spread:.3g} N along it, {wall:.3g} N along the wall); check {_FRAME}')


class ForceNoise(Check):
    """The noise of the force is about the configured one."""

    name = 'force_noise'
    message = ('force noise of 12 N, 20 times contact.force_noise; check the sensor, its cable '
               'and its shield, or correct contact.force_noise')
    cause = ('The sensor is worse than configured, or something disturbs it; small contacts are '
             'found late.')
    remedy = 'Check sensor, cable and shield; then correct `contact.force_noise`.'
    of_state = True

    def judge(self, seen: Window) -> str:
        """Compare the noise with the configured one."""
        noise, ratio = seen.state.noise_std, seen.state.noise_std / seen.configured_noise
        if ratio < _NOISY:
            return ''
        return (f'force noise of {noise:.3g} N, {ratio:.3g} times contact.force_noise; '
                'check the sensor, its cable and its shield, or correct contact.force_noise')


class ForceBias(Check):
    """The sensor reads nothing in free flight."""

    name = 'force_bias'
    message = ('the sensor reads 3.1 N in free flight; call ~/tare there, or off line give --tare '
               'first-free-flight')
    cause = 'The force sensor has an offset, or carries the weight of the tool.'
    remedy = ('Call `~/tare` out of contact, replay with `--tare first-free-flight`, or set '
              '`physics.force_bias.bias` to the value given. If the sensor drifts, set '
              '`force_sensor.zero: tracked` (`--tare tracked`).')
    needs_axes = True

    def judge(self, seen: Window) -> str | None:
        """Compare the force of free flight, less the declared bias, with its noise."""
        free = seen.free
        if free.sum() < _LEAST_FREE or seen.state.neither:
            return None
        if seen.parameters.force_sensor.zero == TRACKED:
            return ''
        level, noise = _level(seen.force[free], seen)
        if abs(level) <= max(TARE_DUE * noise, 1e-3):
            return ''
        remedy = 'call ~/tare there, or off line give --tare first-free-flight'
        if seen.parameters.wrench_source == JOINT_EFFORTS:
            remedy = f'{_DESCRIBE}, or {remedy}'
        elif seen.may_be_weight:
            remedy = f'run calibrate_tool, or without a tool {remedy}'
        return f'the sensor reads {level:.3g} N in free flight; {remedy}'


def _slope_by_least_force(seen: Window) -> float:
    """
    Return the sign of force over x by the place of the least force so far; 0 if on both sides.

    Within a contact the force may fall with depth, as where a wall yields or buckles.
    """
    if not len(seen.force):
        return 0.0
    size, margin = np.abs(seen.force), LOADED * seen.noise
    least, low, high = seen.memory.get('least_force', (np.inf, np.inf, -np.inf))
    if size.min() < least - margin:
        least, low, high = float(size.min()), np.inf, -np.inf
    loaded = size > least + margin
    if not loaded.all():
        x = seen.x[~loaded]
        low, high = min(low, float(x.min())), max(high, float(x.max()))
    seen.memory['least_force'] = least, low, high
    if not loaded.any():
        return 0.0
    middle = median_of(seen.x[loaded])
    side = float(middle > high) - float(middle < low)
    return side * float(np.sign(median_of(seen.force[loaded])))


def _level_outside(seen: Window) -> float:
    """Return the steady force before the wall, such as a weight left by a wrong sign, or 0 [N]."""
    force = seen.force[seen.x < seen.location - seen.state.margin]
    steady = len(force) >= _LEAST_FREE and spread_of(force) < CLEAR * seen.noise
    return median_of(force) if steady else 0.0


def _unless_weight(seen: Window) -> str:
    """Return what else a force that follows the motion of an arm may be, '' without an arm."""
    if seen.parameters.wrench_source == JOINT_EFFORTS:
        return f'; or, in free flight, {_DESCRIBE}'
    if not seen.may_be_weight:
        return ''
    return '; or, in free flight, run calibrate_tool: it is the weight of the tool, as it turns'


def _level(force: Array, seen: Window) -> tuple[float, float]:
    """
    Return the middle of a force without contact, and its noise, at least as configured [N].

    What the detector learns is no measure: it takes time, and takes an offset for noise at first.
    """
    middle = median_of(force)
    spread = median_of(np.abs(force - middle)) / _MEDIAN
    return middle, max(spread, seen.configured_noise)


_NOTABLE = 0.05  # of environment.location_std: a smaller shift is not worth a word


class Surface(Check):
    """A contact begins where the wall is."""

    name = 'surface'
    message = ('the surface is at x = 0.4 m, 400 mm inside the wall; set environment.location to '
               '0.4, or to nan to take it at first touch')
    cause = '`environment.location` is not where the wall is. Where it was found is used.'
    remedy = ('Set `environment.location`, or `nan` to take it at first touch; or call '
              '`~/set_location` while touching.')
    of_state = True

    def judge(self, seen: Window) -> str:
        """Return what the contact has shown."""
        return seen.state.surface_text


class SurfaceShifted(Check):
    """The surface is at `environment.location`."""

    name = 'surface_shifted'
    message = 'the surface is +1.8 mm from environment.location; set it to 0.4018 m'
    cause = 'The surface was found within three `environment.location_std`, and is used.'
    remedy = 'Set `environment.location` to the value given.'
    of_state = True

    def judge(self, seen: Window) -> str:
        """Return the shift that the contact has shown."""
        shift = seen.state.shift
        environment = seen.parameters.of_axis(seen.axis).environment
        notable = max(_NOTABLE * environment.location_std, 3.0 * seen.state.surface_std)
        if abs(shift) <= notable or seen.state.surface_text:
            return ''
        return (f'the surface is {1e3 * shift:+.3g} mm from environment.location; set it to '
                f'{environment.location + shift:.6g} m')


class SurfaceUnchecked(Check):
    """The motion of a contact shows where its surface is."""

    name = 'surface_unchecked'
    message = ('the motion does not show where the surface is, so that stiffness relies on '
               'environment.location; touch down again or excite')
    cause = 'The tool rests: any spring through its point fits.'
    remedy = 'Touch down again, or excite.'
    of_state = True
    confirmations = 2  # just after a touch the motion has had no time to show it

    def judge(self, seen: Window) -> str:
        """Return what the present contact has not shown."""
        if not seen.state.contact:
            return ''
        if not seen.state.valid:
            return 'the motion does not show stiffness and surface yet; touch down again or excite'
        return '' if seen.state.is_shown else self.message


class ModelMismatch(Check):
    """One of the laws fits the last 2 s of contact."""

    name = 'model_fit'
    message = ('residuals are 3.2 times the noise under the best law (kelvin_voigt): none of the '
               'laws fits; record a contact and diagnose it')
    cause = 'The contact has physics that none of the laws of `~/wall_law` has.'
    remedy = 'Run `diagnose` on a recording; compensate what it names by `physics.*`.'
    of_state = True

    def judge(self, seen: Window) -> str:
        """Return the judgement of the monitor."""
        return seen.state.misfit
