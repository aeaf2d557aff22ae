# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The diagnosis of a whole arm: checks, comparison of models, names, verdict of each joint."""

from dataclasses import replace
from typing import Callable, Sequence

import numpy as np
from scipy.optimize import nnls

from .arm_recording import ArmRecording, joints_of, named_as, pressed_along
from .channels import Channels, Term
from .checks import check_description, check_efforts, check_units, check_wrench, examine
from .describe import ArmNames, described
from .gram import Gram
from .result import ArmDiagnosis, ArmEffect, HeldOutArm, JointResult, VERDICTS
from .space import ArmModels, group_of, label, MOST_LAWS
from ..checks.check import Check
from ..fit.beam import Compared, search
from ..fit.names import likely, Name, Named
from ...exceptions import ParameterRangeError, RecordingError
from ...kinematics.arm_dynamics import ArmDynamics
from ...physics.joint_effects import JOINT_EFFECTS

_WORTH = 0.005  # of the variance of a joint's torque: the least that is worth a name
_WORTH_CERTAIN, _BEYOND_DOUBT = 1e-4, 20.0  # the same of what the score would lose so much without
_TOLD = 2.0  # standard deviations of a value of any law
_SMALL, _LARGE, _MOSTLY = 0.02, 0.06, 0.9  # of the range of a torque, of its variance
_EXPLAINED = 0.5  # of a misfit, beyond which it is not unexplained
_SHOWN = 200  # samples of a motion for the apparent mass


def diagnose_arm(
    recordings: ArmRecording | Sequence[ArmRecording], urdf: str, *,
    held_out: Sequence[ArmRecording] = (), seed: int = 0, simulated: ArmDiagnosis | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> ArmDiagnosis:
    """
    Compare recordings of an arm with its description, and name the physics that this lacks.

    The torque of each joint is RNEA(q, q', q'') of the description, whose links are recalibrated
    by some 5 %, less J^T F of a measured contact, plus laws of JOINT_EFFECTS at their places. Laws
    that the diagnosis `simulated` of a simulator's recording names are recalibrated and not named.

    """
    fitted = [recordings] if isinstance(recordings, ArmRecording) else list(recordings)
    if not fitted or seed < 0:
        raise ParameterRangeError(
            f'diagnose_arm needs one recording or more and seed >= 0, got {len(fitted)} '
            f'and {seed}')
    progress('checks')
    arm = ArmDynamics(urdf)
    fitted, tested = ([named_as(one, arm) for one in every] for every in (fitted, held_out))
    arm = ArmDynamics(urdf, joints_of(fitted[0], arm))
    fitted, tested = ([_with_joints(one, arm) for one in every] for every in (fitted, tested))
    checks = [check_description(arm), *(check_units(one, arm) for one in fitted),
              *(check_wrench(one, arm) for one in (*fitted, *tested) if one.wrench),
              *check_efforts(fitted, arm)]
    if not all(one.ok for one in checks if one.name == 'wrench_frame'):
        fitted, tested = ([replace(one, wrench=None) for one in every]
                          for every in (fitted, tested))
    silent = {name: reason for reason, known in (
        ('rests', [one.moves for one in fitted]),
        ('publishes no effort', [one.has_effort for one in fitted]))
        for name, every in zip(arm.joints, np.all(known, axis=0)) if not every}
    begun = ArmDiagnosis('unexplained', [], [], silent, checks)
    if begun.refused:
        return begun
    channels = Channels(fitted, arm)
    checks += examine(channels)
    if begun.refused:
        return replace(begun, channels=channels)
    space = ArmModels(Gram(channels), progress)
    compared = search(space, progress, laws=MOST_LAWS)
    named = likely(compared, seed)
    return _concluded(space, compared, named, checks, silent, tested,
                      list(simulated.model) if simulated else [])


def _with_joints(recording: ArmRecording, arm: ArmDynamics) -> ArmRecording:
    """Return a recording with the joints of an arm in its order."""
    missing = [name for name in arm.joints if name not in recording.joints]
    if missing:
        raise RecordingError(
            f'{recording.name} must hold the joints of the other recordings, but lacks '
            f'{", ".join(missing)}; diagnose it alone')
    return recording.of_joints(arm.joints)


def _concluded(
    space: ArmModels, compared: Compared, named: Named, checks: list[Check],
    silent: dict[str, str], tested: Sequence[ArmRecording], known: Sequence[Term],
) -> ArmDiagnosis:
    channels = space.gram.channels
    names = ArmNames(space, compared, named)
    effects = [described(names, term, name) for term, name in _worth(names, named)]
    # A simulator may have a law of the same kind at the same place, or a richer one.
    effects = [one for one in effects if not any(
        group_of(one.term)[:2] == group_of(other)[:2] and JOINT_EFFECTS[one.term.effect].laws
        <= JOINT_EFFECTS[other.effect].laws for other in known)]
    # Every joint has friction: it comes last, and where it is large for its joint first of all.
    effects.sort(key=lambda one: (0.0, -one.gain) if one.family != 'friction' or one.term.effect
                 == 'coupled_friction' else (1.0, -names.of_range(one.term)))
    model, found = named.model.found
    joints = _joints(space, named, effects)
    verdict = max((one.verdict for one in joints), key=VERDICTS.index)
    diagnosis = ArmDiagnosis(
        verdict, effects, joints, silent, checks,
        channels=channels, model=model, fitted=found, compared=compared,
        apparent_mass=_apparent_mass(channels))
    return replace(diagnosis, holdouts=[_held_out(diagnosis, one) for one in tested],
                   next_experiment=_next(effects))


def _apparent_mass(channels: Channels) -> tuple[float, float, float] | None:
    """Return mean, least and most mass of the tip along the normal of its largest forces."""
    one = next((one for one in channels.pieces if one.outside is not None), None)
    if one is None:
        return None
    assert one.outside is not None
    frame, normal = one.outside.frame, pressed_along(channels.arm, one.q, one.outside)
    if not normal.any():
        return None
    mass = channels.arm.apparent_mass(one.q[::max(1, len(one.q) // _SHOWN)], frame, normal)
    return float(mass.mean()), float(mass.min()), float(mass.max())


def _worth(names: ArmNames, named: Named) -> list[tuple[Term, Name]]:
    """Return the laws that are large enough for a name: by their torque, or by what they take."""
    by_label = {label(term): term for term in names.model}
    found = []
    for one in named.names:
        term = by_label[one.effect]
        value, std, *_ = names.values(term)
        if not (np.abs(value) > _TOLD * std).any():
            continue  # its band holds zero
        size = max(names.sizes(term).max(), names.removed(term).max())
        if size >= _WORTH or size >= _WORTH_CERTAIN and names.gain(term) >= _BEYOND_DOUBT:
            found.append((term, one))
    return found


def _joints(space: ArmModels, named: Named, effects: Sequence[ArmEffect]) -> list[JointResult]:
    """Return errors and verdict of each joint."""
    gram, base = space.gram, space.evidence().base
    weights = gram.kept / gram.kept.sum(axis=0)
    nominal = (gram.s / gram.kept * weights).sum(axis=0)
    before, after = ((weights * (one.left_out - 1.0)).sum(axis=0) * gram.floor + gram.felt_noise
                     for one in (base, named.model))
    noise = np.mean([one.noise for one in gram.channels.pieces], axis=0)[gram.joints]
    results = []
    for k, j in enumerate(gram.joints):
        name = gram.channels.arm.joints[j]
        mine = any(one.torque_shares.get(name, 0.0) >= _WORTH for one in effects)
        left, was, first = (float(np.sqrt(max(one - noise[k], 0.0)) / gram.reach[k])
                            for one in (after[k], before[k], nominal[k]))
        share = 1.0 - float(after[k] / gram.variance[k])
        explained = 1.0 - left**2 / max(was**2, 1e-12)
        # What is small, or nearly all of a torque that is large, is not worth a search.
        bad = left >= _SMALL and (explained < _EXPLAINED or left >= _LARGE and share <= _MOSTLY)
        verdict = 'unexplained' if bad else 'physics_missing' if mine else (
            'recalibrate' if first >= _SMALL > left else 'consistent')
        errors = [float(np.sqrt(one[k])) for one in (nominal, before, after, noise)]
        results.append(JointResult(
            name, verdict, float(gram.span[k]), errors[0], errors[1], errors[2], errors[3],
            share, 1.0 - float(nominal[k] / gram.variance[k]),
            _plain_friction(gram.channels, j, [one.term for one in effects], named)))
    return results


def _plain_friction(
    channels: Channels, j: int, terms: Sequence[Term], named: Named
) -> tuple[float, float]:
    """Return F_c and B of sharp Coulomb and viscous friction nearest to a joint's laws."""
    model, theta = named.model.found[0], named.model.found[1].theta
    # Where one is named, those too small for a name belong to its friction.
    laws, names = ([term for term in every if term.place == j and JOINT_EFFECTS[
        term.effect].family == 'friction'] for every in (sorted(model, key=repr), terms))
    if not names:
        return 0.0, 0.0
    plain = [next(term for term in channels.terms if term[:2] == (name, j))
             for name in ('coulomb_friction', 'viscous_friction')]
    rows = [(np.concatenate([one.columns[term][j] for term in plain], axis=1),
             np.sum([one.columns[term][j] @ theta[term] for term in laws], axis=0))
            for one in channels.pieces]
    X, y = (np.concatenate(one) for one in zip(*rows))
    F_c, B = np.round(nnls(X, y)[0], 9)
    return float(F_c), float(B)


def _held_out(diagnosis: ArmDiagnosis, recording: ArmRecording) -> HeldOutArm:
    """Predict a recording that was not fitted; its zeros of torque are its own."""
    channels = diagnosis.channels
    assert channels is not None and diagnosis.fitted is not None
    other = Channels([recording], channels.arm, like=channels)
    shares: tuple[dict[str, float], ...] = {}, {}, {}
    for j in channels.measured:
        tau, nominal, moving = (np.concatenate([getattr(one, name)[:, j] for one in other.pieces])
                                for name in ('tau', 'residual', 'moving'))
        left = nominal - np.concatenate(
            [channels.predicted(one, j, diagnosis.fitted) for one in other.pieces])
        for share, error, rows in zip(
                shares, (nominal, left, left), (moving, moving, np.ones_like(moving))):
            error = error[rows] - (0.0 if error is nominal else error[rows].mean())
            share[channels.arm.joints[j]] = 1.0 - float(np.mean(error**2) / tau[rows].var())
    return HeldOutArm(recording.name, *shares)


def _next(effects: Sequence[ArmEffect]) -> str:
    """Recommend an experiment where laws of masses cannot be told apart."""
    masses = {name for name, effect in JOINT_EFFECTS.items() if effect.family == 'load'}
    open_ones = [one for one in effects if any(
        other.split(' ')[0] in masses for other in one.indistinguishable_from)]
    if not open_ones:
        gain = any('force_gain' in other for one in effects if one.name == 'payload'
                   for other in one.indistinguishable_from)
        return ('record the same motion without the payload, and diagnose both recordings '
                'together: the gains of the torques then matter less') if gain else ''
    return (f'{open_ones[0].name} cannot be told from other masses by this motion; record the '
            'exciting trajectory that --write-trajectory writes, with and without what the arm '
            'carries')
