# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Events that change a running estimation, as text that is recorded and replayed."""

import json
from math import isfinite
from typing import Any, Mapping, NamedTuple

from .axes import Moment
from .session import ContactSession
from ..exceptions import ContactEstimationError, RecordingError
from ..texts import json_content

START, CHANGE, RESET, TARE = 'start', 'set_parameters', 'reset', 'tare'
DESCRIPTION, LOCATION = 'robot_description', 'set_location'
STATIC, READY = 'static_transforms', 'arm_ready'


class EstimationEvent(NamedTuple):
    """A change of parameters, a reset or a tare, and when it took effect."""

    # 'start', 'set_parameters', 'set_location', 'reset', 'tare', 'robot_description',
    # 'static_transforms' or 'arm_ready'
    kind: str
    after_stamp_ns: int  # stamp of the sample after which it took effect [ns]
    # all parameters at start, those changed, those of `biases` at a tare, the text of the URDF of
    # an arm, static transforms of tf, or what came before the arm was known, see `StartUp`
    parameters: Mapping[str, Any]
    jumps: int = 0  # number of backward clock jumps before it

    @property
    def moment(self) -> Moment:
        """Return the sample after which it took effect."""
        return Moment(self.jumps, self.after_stamp_ns)

    def to_text(self) -> str:
        """Return the event as one line of JSON."""
        return json.dumps(
            {'event': self.kind, 'after_stamp_ns': self.after_stamp_ns,
             'time_jumps': self.jumps, 'parameters': dict(self.parameters)}
        )

    @classmethod
    def from_text(cls, text: str) -> 'EstimationEvent':
        """Return the event that `to_text` has written."""
        try:
            content = json_content(text)
            parameters = dict(content['parameters'])
            if not _is_usable(content['event'], parameters):
                raise ValueError(f'unusable parameters of {content["event"]!r}')
            return cls(content['event'], int(content['after_stamp_ns']), parameters,
                       int(content['time_jumps']))
        except (ValueError, KeyError, TypeError, OverflowError) as error:
            raise RecordingError(
                f'expected an estimation event as JSON, got {text[:200]!r}; write a copy without '
                'the topic by `convert`, which leaves events out'
            ) from error


def _is_usable(kind: str, parameters: Mapping[str, Any]) -> bool:
    """Return whether an event holds what its kind needs; errors of Python mean no, too."""
    if kind == TARE:
        return 'force_bias' in parameters and all(map(isfinite, parameters.values()))
    if kind == DESCRIPTION:
        return isinstance(parameters['text'], str)
    if kind == READY:
        return {'wrench_ns': int, 'motion_ns': int} == {
            name: type(value) for name, value in parameters.items()}
    return kind != STATIC or all(
        isinstance(parent, str) and isinstance(child, str) and len(pose) == 7
        and all(map(isfinite, pose)) for parent, child, *pose in parameters['transforms'])


def event_now(
    session: ContactSession, kind: str, parameters: Mapping[str, Any]
) -> EstimationEvent:
    """Return the event that describes a change just made."""
    jumps, stamp_ns = session.moment
    return EstimationEvent(kind, stamp_ns, parameters, jumps)


def set_location(session: ContactSession) -> tuple[bool, str, dict[str, float]]:
    """
    Return the change of parameters that sets x_e to where the tool is.

    session: whose last sample counts; along the contact axis alone
    Returns done, message, changes: False without a sample so far; what is set and what makes it
    doubtful, or why nothing is set; dotted name to value
    """
    x = session.last_position
    if x != x:
        return False, 'no sample yet; see /diagnostics for the reason', {}
    done, caution = f'environment.location is now {x:.6g} m', warn_about_location(session)
    return True, f'{done}; {caution}' if caution else done, {'environment.location': x}


def warn_about_location(session: ContactSession) -> str:
    """
    Return why the surface may not be where the tool is.

    session: whose last sample counts; along the contact axis alone
    Returns caution: '' where the tool touches lightly: K_hat puts it within
    `environment.location_std` of the surface
    """
    pipeline, std = session.pipeline, session.parameters.environment.location_std
    if not pipeline.contact:
        return ('caution: the tool is not in contact, so that the surface is here only if the '
                'tool just reaches it; touch lightly and call again')
    pressing, K_hat = pipeline.bias - session.last_force, session.estimates[0].stiffness
    if pressing <= std * K_hat:
        return ''
    return (f'caution: the tool presses with {pressing:.3g} N, which takes it '
            f'{1e3 * pressing / K_hat:.3g} mm into the wall at K_hat = {K_hat:.4g} N/m; touch '
            'lightly and call again')


def biases(session: ContactSession) -> dict[str, float]:
    """
    Return the force biases of a session as parameters of a tare event.

    Returns parameters: force_bias of the contact axis [N]; with several axes, also force_bias.AXIS
    of each
    """
    by_axis = {f'force_bias.{axis}': p.bias for axis, p in session.pipelines.items()}
    own = {'force_bias': session.pipeline.bias}
    return {**own, **by_axis} if len(by_axis) > 1 else own


def apply_event(session: ContactSession, event: EstimationEvent) -> None:
    """
    Repeat a recorded event on a session.

    event: the event; those of the arm have no effect here, see `ArmStage`, and 'start' none, since
    it must be known before the first sample
    """
    if event.kind in (CHANGE, LOCATION):
        try:
            session.change_parameters(event.parameters)
        except ContactEstimationError:
            # Recorded changes were accepted once; with other parameters chosen for replay they
            # may no longer fit, and the choice of the user takes precedence.
            return
    elif event.kind == RESET:
        session.reset()
    elif event.kind == TARE:
        own, *others = session.pipelines
        recorded = event.parameters
        # By axis where recorded so: replay may have chosen another contact axis.
        bias = {own: recorded.get(f'force_bias.{own}', recorded['force_bias'])}
        bias.update((axis, recorded[f'force_bias.{axis}']) for axis in others
                    if f'force_bias.{axis}' in recorded)
        limit = session.parameters.synchronisation.maximum_force
        if any(abs(value) > limit for value in bias.values()):
            raise RecordingError(
                f'recorded tare must be within synchronisation.maximum_force = {limit:g} N, got '
                f'{", ".join(f"{value:g} N" for value in bias.values())}; write a copy without '
                'events by `convert`, or raise the limit')
        session.set_bias(bias)
