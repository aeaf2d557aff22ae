# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a link of an arm can be."""

from contact_estimation.diagnosis.arm.bodies import cost_of_body, possible_inertial
import numpy as np
import pytest

BODY = [1.0, 0.1, 0.02, 0.05, 0.01, -0.002, 0.02, -0.005, -0.001, 0.02]
LINK = np.array([1.0, 0.0, 0.0, 0.0, 0.02, 0.0, 0.02, 0.0, 0.0, 0.02])


def test_a_body_is_made_possible_where_it_is_not() -> None:
    wrong = np.array(BODY) - [0.0, 0.0, 0.0, 0.0, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0]
    for sign in (1.0, -1.0):  # a body too many, and one that lacks
        found = sign * possible_inertial(sign * wrong, np.diag(np.full(10, 1e-4)))
        mass, c = found[0], found[1:4] / found[0]
        xx, xy, yy, xz, yz, zz = found[4:]
        about_origin = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        moments = np.linalg.eigvalsh(about_origin - mass * (c @ c * np.eye(3) - np.outer(c, c)))
        assert mass == pytest.approx(1.0, abs=0.05)
        assert moments.min() > 0.0 and moments[2] <= moments[0] + moments[1] + 1e-12
    assert possible_inertial(np.array(BODY), np.eye(10)) == pytest.approx(BODY)


@pytest.mark.parametrize('precision', [1e4, 1e-5])
def test_a_lack_of_more_than_a_link_has_costs_what_the_data_say(precision: float) -> None:
    x, known = np.zeros(10), np.ones(10)
    x[0], known[0] = -1.3, precision  # data alone; the prior is 1
    fit, spread = x * known / (known + 1.0), np.diag(1.0 / (known + 1.0))
    assert cost_of_body(fit, spread, np.ones(10), LINK) == pytest.approx(
        0.5 * precision * 0.3**2, rel=0.01, abs=0.01)
    assert cost_of_body(0.7 * fit, spread, np.ones(10), LINK) == 0.0
