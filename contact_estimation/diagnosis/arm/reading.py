# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
A recording as it may be read, and how likely its torques are if it is read so.

Each torque is scale times that of the calibrated links, plus friction, rotor, zero and spring of
its joint, all linear with Gaussian priors. The log evidence of that is what readings share: with
other signs, another order, another unit, gravity elsewhere, or torques stamped late.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.special import log_ndtr

from .arm_recording import Array
from .channels import Channels
from .gram import FLOOR, INEXACT, MOST_ERRORS
from ...kinematics.arm_dynamics import ArmDynamics, PER_LINK
from ...physics.carried_load import typical_inertial

_ROWS = 120  # samples: more than independent errors
_UNKNOWN = np.log(1e6) / np.sqrt(2.0 * np.pi)  # std of a gain that is any of six decades
_GAIN = INEXACT  # standard deviation of a gain as of a mass
_RUBS = 'coulomb_friction', 'presliding_friction'  # of all widths
_ROUNDS = 4  # of the variances, which converge by half a digit each


class ReadingEvidence(NamedTuple):
    """How likely a reading is, and what it finds."""

    nat: float  # log evidence
    gains: Array  # (C,) of the torques
    further: Array  # coefficients of further columns
    load: float  # mass at the flange [kg]
    lacking: float  # log odds that it is negative


@dataclass(frozen=True, eq=False)
class Reading:
    """
    Some samples of a recording, read in one way.

    q, v, a, tau (N, n), rubs: those of dry friction of 1 N m
    course: times of the samples, and of all torques, and these
    scale (n,): of the torques over those of the joints in N m; 0 for a torque without load
    errors: independent ones of each joint
    load: standard deviation of the mass at the flange [kg]
    """

    arm: ArmDynamics
    joints: list[int]
    q: Array
    v: Array
    a: Array
    tau: Array
    rubs: list[Array]
    course: tuple[Array, Array, Array]
    scale: Array
    errors: float
    load: float = 0.0

    @classmethod
    def of(cls, channels: Channels, file: int = 0) -> 'Reading':
        """Return a recording as it is."""
        pieces = [one for one in channels.pieces if one.file == file]
        q, v, tau, felt = (np.concatenate([getattr(one, name) for one in pieces])
                           for name in ('q', 'v', 'tau', 'felt'))
        a = np.concatenate([np.gradient(one.v, one.t, axis=0) for one in pieces])
        starts = np.cumsum([0.0, *(one.t[-1] - one.t[0] + 1.0 for one in pieces[:-1])])
        t = np.concatenate([one.t - one.t[0] + start for one, start in zip(pieces, starts)])
        every = [[term for term in channels.terms if term.place == j and term.effect in _RUBS]
                 for j in channels.measured]
        rubs = [np.zeros_like(q) for _ in every[0]]
        for j, terms in zip(channels.measured, every):
            for column, term in zip(rubs, terms):
                column[:, j] = np.concatenate([one.columns[term][j][:, 0] for one in pieces])
        some = np.linspace(0, len(t) - 1, min(len(t), _ROWS)).astype(int)
        return cls(
            channels.arm, channels.measured, q[some], v[some], a[some], (tau + felt)[some],
            [one[some] for one in rubs], (t[some], t, tau + felt), np.ones(q.shape[1]),
            min(MOST_ERRORS, len(t) / channels.samples_per_error))

    @cached_property
    def Y(self) -> Array:
        """Return the torques per parameter of the links, (N, C, 10 n)."""
        return self.arm.regressor(self.q, self.v, self.a)[:, self.joints]

    def moved(self, motion: Any, torque: bool) -> 'Reading':
        """Return the reading with a function of all positions, and of the torques."""
        return replace(self, q=motion(self.q), v=motion(self.v), a=motion(self.a), rubs=[
            *map(motion, self.rubs)], tau=motion(self.tau) if torque else self.tau)

    def but(self, **changes: Any) -> 'Reading':
        """Return the reading with the same motion."""
        other = replace(self, **changes)
        other.__dict__['Y'] = self.Y
        return other

    def late(self, lag: float) -> 'Reading':
        """Return the reading with torques that are stamped later than positions by a lag [s]."""
        at, t, tau = self.course
        return self.but(tau=np.stack([np.interp(at + lag, t, x) for x in tau.T], axis=1))

    @cached_property
    def modelled(self) -> Array:
        """Return the torques of the description in the unit of those measured, (C, N)."""
        return np.asarray((self.Y @ self.arm.neutral * self.scale[self.joints]).T)

    @property
    def sizes(self) -> Array:
        """Return the standard deviations of the links' parameters, (10 n,)."""
        masses = self.arm.masses
        sizes = INEXACT * np.concatenate(
            [typical_inertial(max(mass, 0.2 * masses.mean())) for mass in masses])
        sizes[-PER_LINK:] += typical_inertial(self.load)
        return sizes

    def _own(self) -> Array:
        """Return the columns of each joint alone, (C, N, K), as large as its torques."""
        at, turned = self.joints, np.where(self.scale < 0.0, -1.0, 1.0)
        tau, v, q = (x[:, at].T for x in (self.tau * turned, self.v, self.q))
        own = np.stack([*(one[:, at].T for one in self.rubs), v, self.a[:, at].T,
                        np.ones_like(q), np.sin(q), np.cos(q)], axis=2)
        rms = np.sqrt(np.mean(own**2, axis=1, keepdims=True)) + 1e-9
        return np.asarray(2.0 * (turned[at] * tau.std(axis=1))[:, None, None] * own / rms)

    def evidence(self, unknown: int = -1, further: Array | None = None) -> ReadingEvidence:
        """
        Return the evidence.

        unknown: joint whose gain may be any; further (C, N, K): columns that joints share, whose
        coefficients may be any
        """
        gains = np.where(np.array(self.joints) == unknown, _UNKNOWN, _GAIN)
        tau, nominal = self.tau[:, self.joints].T, self.modelled
        Y = self.Y.transpose(1, 0, 2) * (self.scale[self.joints, None, None] * self.sizes)
        shared = Y if further is None else np.concatenate([Y, _UNKNOWN * further], axis=2)
        own = self._own()
        P, driven = shared.shape[2], len(self.rubs) + 2  # dissipation and rotor are positive
        W = np.concatenate([shared, own, (gains[:, None] * nominal)[..., None],
                            (tau - nominal)[..., None]], axis=2)
        G = W.transpose(0, 2, 1) @ W * (self.errors / W.shape[1])
        floor = (FLOOR * np.ptp(np.percentile(tau, (0.5, 99.5), axis=1), axis=0)) ** 2 + 1e-18
        after = 0.05 * tau.var(axis=1) + floor
        for _ in range(_ROUNDS):
            var = after
            H = G / var[:, None, None]
            own = np.linalg.inv(H[:, P:-1, P:-1] + np.eye(W.shape[2] - P - 1))  # eliminated first
            U = own @ H[:, P:-1]
            S = H[:, :P, :P] - H[:, :P, P:-1] @ U[:, :, :P]
            A = S.sum(axis=0) + np.eye(P)
            C: Array = np.linalg.inv(A)
            theta = C @ (H[:, :P, -1] - np.einsum('kpi,ki->kp', H[:, :P, P:-1], U[..., -1])).sum(0)
            mine = U[:, :, -1] - U[:, :, :P] @ theta
            every = np.concatenate([np.tile(-theta, (len(mine), 1)), -mine,
                                    np.ones((len(mine), 1))], axis=1)
            rest = np.maximum(np.einsum('ki,kij,kj->k', every, G, every), 0.0)
            used = len(own[0]) - np.einsum('kii->k', own) + np.einsum('kij,ji->k', S, C)
            after = rest / np.maximum(self.errors - used, 0.2 * self.errors) + floor
        across = U[:, :driven, :P]
        stds = np.sqrt(np.einsum('kii->ki', own)[:, :driven]
                       + np.einsum('kip,pq,kiq->ki', across, C, across))
        nat = -0.5 * (self.errors * np.log(var).sum() + (rest / var).sum() + theta @ theta
                      + np.sum(mine**2) + np.linalg.slogdet(A)[1]
                      - np.linalg.slogdet(own)[1].sum())
        nat += np.sum(log_ndtr(mine[:, :driven] / stds) + np.log(2.0))
        at, size, mass = len(self.sizes) - PER_LINK, self.sizes[-PER_LINK], self.arm.masses[-1]
        load, std = size * theta[at], size * np.sqrt(C[at, at])
        # The last link with its load has a mass.
        nat += log_ndtr((mass + load) / std) - log_ndtr(mass / size)
        return ReadingEvidence(
            float(nat), 1.0 + gains * mine[:, -1], _UNKNOWN * theta[len(self.sizes):],
            float(load), float(log_ndtr(-load / std) - log_ndtr(load / std)))
