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

"""Checks of the contact: where its surface is, whether model and estimator suit it."""

from __future__ import annotations

import numpy as np

from .check import Check, Evidence, millimetres

_LEAST_CONTACT = 100
_DEVIATIONS = 5.0
_MOST_OF_DEPTH = 0.7  # a stiffening wall feigns up to half the depth
_FITS = 2.0  # residual over noise
_NOTABLE = 0.05  # of environment.location_std: a smaller shift is not worth a word


class Surface(Check):
    """A contact begins where the wall is."""

    name = 'surface'
    message = ('contact began 400 mm inside the wall, at x = 0.4 m; set environment.location to '
               '0.4, or to nan to take it at first touch')
    cause = '`environment.location` is not where the wall is.'
    remedy = ('Set `environment.location`, or `nan` to take it at first touch; or call '
              '`~/set_location` while touching.')
    invalidates = True
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return what the touch-down has shown."""
        return seen.touch_text


class SurfaceLine(Check):
    """The line of force against position meets zero where the wall is."""

    name = 'surface_line'
    message = ('the force in contact vanishes at x = 0.4 m, 400 mm inside the wall; set '
               'environment.location to 0.4')
    cause = ('`environment.location` is not where the wall is; the node was started in contact, '
             'so that no touch-down has shown it.')
    remedy = 'Set `environment.location`, or withdraw and touch down again.'
    invalidates = True

    def judge(self, seen: Evidence) -> str | None:
        """Fit K x + B v + c to the last contact."""
        chosen = np.flatnonzero(seen.contact)
        if seen.touch_text:
            return ''  # says the same of the same contact
        if len(chosen) < _LEAST_CONTACT:
            return None
        x, y = seen.x[chosen] - seen.location, -seen.force[chosen]
        table = np.stack([x, seen.rate[chosen], np.ones(len(x))], 1)
        scale = np.sqrt(np.mean(table**2, 0)) + 1e-15
        scaled = table / scale
        square = np.linalg.inv(scaled.T @ scaled + 1e-12 * len(x) * np.eye(3))
        theta = square @ (scaled.T @ y) / scale
        K, _, c = theta
        residual = y - table @ theta
        noise = max(float(np.sqrt(np.mean(residual**2))), seen.noise)
        if not K > 0.0 or noise > _FITS * max(seen.noise, seen.noise_std):
            return None
        inside, mean = float(-c / K), float(np.mean(x))
        std = noise * float(np.hypot(np.sqrt(square[2, 2]) / scale[2],
                                     mean * np.sqrt(square[0, 0]) / scale[0])) / float(K)
        if inside < seen.location_margin + _DEVIATIONS * std:
            return '' if std < seen.location_margin else None
        if inside < _MOST_OF_DEPTH * mean:
            return None
        place = seen.location + inside
        return (f'the force in contact vanishes at x = {place:.4g} m, {millimetres(inside)} '
                f'inside the wall; set environment.location to {place:.4g}')


class SurfaceShifted(Check):
    """The surface is at `environment.location`."""

    name = 'surface_shifted'
    message = 'the surface is +1.8 mm from environment.location; set it to 0.4018 m'
    cause = 'The surface was found within three `environment.location_std`, and is used.'
    remedy = 'Set `environment.location` to the value given.'
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return the shift found by the wall tracker."""
        shift, location = seen.pipeline.location_shift, seen.location
        environment = seen.parameters.of_axis(seen.axis).environment
        if abs(shift) <= _NOTABLE * environment.location_std or environment.location != location:
            return ''  # nowhere, or from a surface that the first touch has shown
        return (f'the surface is {1e3 * shift:+.3g} mm from environment.location; set it to '
                f'{location + shift:.6g} m')


class SurfaceUnchecked(Check):
    """The motion of a contact shows where its surface is."""

    name = 'surface_unchecked'
    message = ('the motion does not show where the surface is, so that stiffness relies on '
               'environment.location; touch down again or excite')
    cause = 'The tool rests: any spring through its point fits.'
    remedy = 'Touch down again, or excite.'
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return whether the location is unchecked in the present contact."""
        if seen.pipeline.contact and seen.pipeline.location_unchecked:
            return self.message
        return ''


class ModelMismatch(Check):
    """The model of the estimator fits the last 2 s of contact."""

    name = 'model_fit'
    message = 'residual 3.2 x noise, changes sign with velocity: friction? run diagnose'
    cause = ('The contact has physics that the model lacks; the text says what the residual '
             'depends on.')
    remedy = 'Run `diagnose` on a recording; compensate what it names by `physics.*`.'
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return the judgement of the monitor."""
        return str(seen.pipeline.model_fit.now.text)


class EstimatorHindrance(Check):
    """Nothing hinders the estimator that was chosen."""

    name = 'estimator'
    message = 'the gains of mrac are too small for this wall, or similar words of the estimator'
    cause = 'The estimator has a limit that this contact exceeds; the text says which.'
    remedy = 'Change the tuning as the text says, or choose another estimator.'
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return what the estimator says."""
        return str(seen.pipeline.hindrance)
