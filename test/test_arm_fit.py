# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The channels of an arm and the fits of its models, against fits of all rows at once."""

from dataclasses import replace

from arm_worlds import arm_recording, motion, URDF
from contact_estimation.diagnosis.arm.channels import Channels, Term
from contact_estimation.diagnosis.arm.checks import check_reading
from contact_estimation.diagnosis.arm.covariance import without_each
from contact_estimation.diagnosis.arm.gram import CALIBRATION, GAIN_KNOWN, Gram, ZERO_KNOWN, ZEROS
from contact_estimation.diagnosis.arm.reading import Reading
from contact_estimation.kinematics.arm_dynamics import ArmDynamics
from contact_estimation.plant.arm_simulation import ArmLaw
import numpy as np
import pytest


def test_fits_equal_those_of_all_rows_at_once_and_of_all_but_a_block() -> None:
    channels = Channels([arm_recording()], ArmDynamics(URDF))
    gram = Gram(channels)
    model = [Term('viscous_friction', j) for j in range(3)] + [Term('force_delay')]
    found, (piece,), size = gram.fit(frozenset(model)), channels.pieces, gram.width(CALIBRATION)
    blocks = np.array_split(np.arange(len(piece.t)), len(gram.times))
    left_out = []
    for out in [*blocks, np.zeros(0, int)]:
        A, b, errors = np.eye(size + 10), np.zeros(size + 10), []
        for j in range(3):
            X = np.zeros((len(piece.t), size + 10))
            X[:, :size - 2] = channels.regressor(piece, j) @ gram.directions
            tilt = Term('base_tilt')
            X[:, size - 2:size] = ZEROS[tilt] * piece.columns[tilt][j]
            X[:, size + j:size + j + 1] = piece.columns[model[j]][j] * gram.scales[model[j]]
            X[:, size + 3:size + 4] = piece.columns[model[3]][j] * gram.scales[model[3]]
            load = piece.tau[:, j] - piece.residual[:, j]
            X[:, size + 4 + j] = GAIN_KNOWN * load
            X[:, size + 7 + j] = ZERO_KNOWN * gram.size[j]
            keep = piece.moving[:, j].copy()
            errors.append((X[out][keep[out]], piece.residual[out, j][keep[out]]))
            keep[out] = False
            A += gram.weights[j] * X[keep].T @ X[keep]
            b += gram.weights[j] * X[keep].T @ piece.residual[keep, j]
        theta = np.linalg.solve(A, b)
        left_out.append([np.mean((y - X @ theta) ** 2) for X, y in errors] if len(out) else [])
    assert found.theta[model[3]] == pytest.approx(theta[size + 3] * gram.scales[model[3]])
    assert found.left_out == pytest.approx(np.array(left_out[:-1]), rel=1e-6)


def test_a_law_less_is_what_a_fit_without_it_gives() -> None:
    gram = Gram(Channels([arm_recording()], ArmDynamics(URDF)))
    model = {Term('payload', 2), Term('force_delay'), Term('joint_spring', 1)}
    model |= {Term('viscous_friction', j) for j in range(3)}
    for term, found in without_each(gram, frozenset(model)).items():
        wanted = gram.fit(frozenset(model - {term}))
        assert found.left_out == pytest.approx(wanted.left_out, rel=1e-6)
        assert found.fitted == pytest.approx(wanted.fitted, rel=1e-6)
        assert found.known == pytest.approx(wanted.known)
        assert found.surprise == pytest.approx(wanted.surprise, abs=0.01)


def test_what_a_joint_leaves_while_it_rests_is_no_measure_of_its_noise() -> None:
    gram = Gram(Channels([arm_recording()], ArmDynamics(URDF)))
    gram.kept[3:] = 1.0
    errors = np.full_like(gram.kept, 4.0)
    moving = gram.weights_for(errors)
    errors[3:] = 0.0
    assert gram.weights_for(errors) == pytest.approx(moving)


def test_blocks_that_are_left_out_are_another_motion() -> None:
    short = arm_recording()
    rows = short.t < 8.0
    cut = replace(short, t=short.t[rows], q=short.q[rows], v=short.v[rows], tau=short.tau[rows])
    for one in (short, cut):
        channels = Channels([one], ArmDynamics(URDF))
        period = 6.0 / channels.cut_off
        times = Gram(channels).times
        assert len(times) <= 16
        assert min(last - first for _, first, last in times) > 0.5 * period or len(times) <= 5


def test_the_noise_of_a_joint_at_rest_sets_no_filter() -> None:
    noise = 1e-3 * np.random.default_rng(0).normal(size=motion().q.shape)
    one = arm_recording(q=lambda q: q * [1.0, 1.0, 0.0] + noise * [0.0, 0.0, 1.0])
    assert Channels([one], ArmDynamics(URDF)).cut_off < 1.2 * Channels(
        [arm_recording()], ArmDynamics(URDF)).cut_off


def test_the_evidence_of_a_reading_depends_on_no_unit_and_no_order() -> None:
    reading = Reading.of(Channels([arm_recording()], ArmDynamics(URDF)))
    nat = reading.evidence().nat
    milli = reading.but(tau=1000.0 * reading.tau, scale=1000.0 * reading.scale)
    assert milli.evidence().nat == pytest.approx(nat - 3.0 * reading.errors * np.log(1000.0))
    once = reading.moved(lambda x: x[:, [1, 0, 2]], True)
    assert once.evidence().nat < nat - 100.0
    assert once.moved(lambda x: x[:, [1, 0, 2]], True).evidence().nat == pytest.approx(nat)


def test_a_gain_of_all_torques_that_looks_like_a_load_is_said_to_be_open() -> None:
    one = arm_recording(tau=lambda tau: 1.5 * tau)
    checks = check_reading(Reading.of(Channels([one], ArmDynamics(URDF))))
    unit = next(one for one in checks if one.name == 'torque_unit')
    assert unit.ok and 'does not tell: gain of all joints (1.5)' in unit.text


def test_friction_that_reverses_over_a_travel_is_no_delay() -> None:
    rubs = [ArmLaw('presliding_friction', [size], j, 0.003) for j, size in enumerate((9., 5., 1.))]
    reading = Reading.of(Channels([arm_recording(rubs, friction=False)], ArmDynamics(URDF)))
    lags = {lag: reading.late(lag).evidence().nat for lag in (-0.02, 0.0, 0.02, 0.04)}
    assert max(lags, key=lambda lag: lags[lag]) == 0.0, lags


def test_a_load_that_leaves_no_mass_of_its_link_is_unlikely() -> None:
    load = ArmLaw('payload', [6.0, 1.2, 0.0, 0.6, 0.06, 0.0, 0.3, 0.0, 0.0, 0.3], 2)
    one = arm_recording([load], tau=lambda tau: -tau)
    reading = Reading.of(Channels([one], ArmDynamics(URDF)))
    found = reading.but(load=8.0).evidence()
    assert found.load < -2.0 * reading.arm.masses[-1] and found.nat < reading.evidence().nat


def test_a_load_hides_no_sign() -> None:
    tool = ArmLaw('payload', [3.0, 0.9, 0.0, 0.0, 0.06, 0.0, 0.3, 0.0, 0.0, 0.3], 2)
    turned = arm_recording([tool], tau=lambda tau: tau * [1.0, -1.0, 1.0])
    wrong = [one for one in check_reading(Reading.of(Channels([turned], ArmDynamics(URDF))))
             if not one.ok]
    assert [one.name for one in wrong] == ['torque_sign'] and 'direction' in wrong[0].text


def test_a_gain_of_all_torques_below_the_span_of_published_ones_is_not_refused() -> None:
    for gain, refused in ((0.75, False), (0.3, True)):
        one = arm_recording(tau=lambda tau, gain=gain: gain * tau)
        checks = check_reading(Reading.of(Channels([one], ArmDynamics(URDF))))
        assert [one.fatal for one in checks if not one.ok] == [refused], checks
