# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of the contact: where its surface is, whether a law fits."""

from __future__ import annotations

from .check import Check, Evidence

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

    def judge(self, seen: Evidence) -> str:
        """Return what the contact has shown."""
        return str(seen.pipeline.surface_text)


class SurfaceShifted(Check):
    """The surface is at `environment.location`."""

    name = 'surface_shifted'
    message = 'the surface is +1.8 mm from environment.location; set it to 0.4018 m'
    cause = 'The surface was found within three `environment.location_std`, and is used.'
    remedy = 'Set `environment.location` to the value given.'
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return the shift that the contact has shown."""
        shift = seen.pipeline.location_shift
        environment = seen.parameters.of_axis(seen.axis).environment
        notable = max(_NOTABLE * environment.location_std, 3.0 * seen.pipeline.surface_std)
        if abs(shift) <= notable or seen.pipeline.surface_text:
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
    confirmations = 2  # just after a touch the motion has had no time to show it

    def judge(self, seen: Evidence) -> str:
        """Return what the present contact has not shown."""
        pipeline = seen.pipeline
        if not pipeline.contact:
            return ''
        if not pipeline.posterior.known.valid:
            return 'the motion does not show stiffness and surface yet; touch down again or excite'
        return self.message if pipeline.location_unchecked else ''


class ModelMismatch(Check):
    """One of the laws fits the last 2 s of contact."""

    name = 'model_fit'
    message = ('residuals are 3.2 times the noise under the best law (kelvin_voigt): none of the '
               'laws fits; record a contact and diagnose it')
    cause = 'The contact has physics that none of the laws of `~/wall_law` has.'
    remedy = 'Run `diagnose` on a recording; compensate what it names by `physics.*`.'
    of_state = True

    def judge(self, seen: Evidence) -> str:
        """Return the judgement of the monitor."""
        return str(seen.pipeline.model_fit.now.text)
