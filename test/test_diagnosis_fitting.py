# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Fits, parts that are held out, and repetition."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast, NamedTuple

from concealed_worlds import diagnosed, MODEL, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.diagnose import diagnose
from contact_estimation.diagnosis.fit.candidates import candidates_in
from contact_estimation.diagnosis.fit.discrepancy import discounted, standard_deviations
from contact_estimation.diagnosis.fit.evidence import explained, ranked
from contact_estimation.diagnosis.fit.fitting import Fit, fit, residual_function
from contact_estimation.diagnosis.fit.left_out import Linearised, parts_of, predict, Spared
from contact_estimation.diagnosis.fit.screening import measure_scales, Screening, Step
from contact_estimation.diagnosis.fit.space import ContactModels
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.parts import hold_out
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Recording, Signals
from contact_estimation.diagnosis.observe.usable_samples import updates
from contact_estimation.exceptions import ContactEstimationError, RecordingError
from contact_estimation.physics import EFFECTS
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.optimize import least_squares

K_e, B_e = MODEL['environment.stiffness'], MODEL['environment.damping']
STIFFER: dict[str, Any] = {'environment__stiffness': 5600.0, 'environment__damping': 90.0}


def test_fit_recovers_stiffness_and_damping() -> None:
    recording, model = prepared_from(recorded(**STIFFER))
    found = fit([recording], model)
    assert found.model.values == pytest.approx((5600.0, 90.0), rel=0.01)
    assert found.residual_count == recording.residual_count


def test_fit_stays_within_the_ranges_of_the_parameters() -> None:
    recording, model = prepared_from(recorded())
    found = fit([recording], model.with_effect('coulomb_friction', (1.0,)))
    low, high = found.model.bounds
    assert np.all(low <= found.model.values) and np.all(found.model.values <= high)
    assert found.model.values[-1] < 0.05


@pytest.mark.slow
def test_standard_deviations_cover_the_errors() -> None:
    errors = []
    for seed in (1, 2, 3):
        recording, model = prepared_from(recorded(seed=seed))
        recording = discounted(recording, model)
        found = fit([recording], model)
        errors += list((np.array(found.model.values) - (K_e, B_e))
                       / standard_deviations([recording], found))
    assert np.sqrt(np.mean(np.square(errors))) < 3.0


FRICTION = 6.0
LAWS = {'coulomb_friction': (FRICTION,), 'contact_offset': (4e-4,)}


def with_law(name: str) -> tuple[PreparedRecording, Fit, Fit]:
    """Fit a world with a law, without and with it."""
    recording, model = prepared_from(recorded(**physics(name, *LAWS[name])))
    base = fit([recording], model)
    start = tuple(0.3 * value for value in LAWS[name])
    return recording, base, fit([recording], base.model.with_effect(name, start))


@pytest.mark.parametrize('name', LAWS)
def test_left_out_error_is_that_of_a_full_refit(name: str) -> None:
    recording, base, found = with_law(name)
    parts = parts_of([recording], base)
    told = Linearised([recording], found, parts)
    function = residual_function([recording], found.model, robust=False)
    bent = residual_function([recording], found.model)
    for k, part in enumerate(parts):
        rest = ~part.there
        refitted = least_squares(
            lambda values, rest=rest: bent(values)[rest], found.model.coordinates,
            x_scale=found.model.steps, diff_step=1e-5)
        as_noise, here = told.in_noise[part.there], told.channel[part.there]
        linear, plain = (each(refitted.x)[part.there] ** 2 * as_noise for each in (bent, function))
        of_channels = [plain[here == k] for k in (0, 1)]
        outliers = [np.mean(np.minimum(one, 25.0 * max(1.0, np.median(one) / 0.455)))
                    for one in of_channels]  # count as five deviations
        expected = [[np.mean(linear[here == k]) for k in (0, 1)], outliers]
        np.testing.assert_allclose(told.left_out[:, k], expected, rtol=0.1)
    assert told.left_out.sum() > told.fitted.sum()


def test_coordinates_that_do_the_same_leave_the_others_their_step() -> None:
    model = SimpleNamespace(coordinates=np.zeros(3), steps=np.ones(3),
                            ranges=(np.full(3, -np.inf), np.full(3, np.inf)))
    told = Linearised([], cast(Any, SimpleNamespace(model=model)), [])
    columns = np.array([[1e3, 0.0, 0.0], [0.0, 2e11, 2e11]]).T  # rounding hides the prior
    change = told._step(columns @ columns.T, columns @ [1e3, 2e11])
    assert change == pytest.approx([-1.0, -0.5, -0.5], rel=1e-6)


def test_a_law_is_predicted_and_has_the_same_value_on_every_part() -> None:
    recording, base, found = with_law('coulomb_friction')
    models = ContactModels([recording], base)
    evidence = models.evidence()
    lawful = models.without(models._scored([recording], found), [])
    share = explained(evidence, lawful)
    assert share.share == pytest.approx(1.0, abs=0.05)
    assert share.interval[0] > 0.9 and (share.parts > 0.8).all()
    alone = [lawful.found.values_on(part).values[-1] for part in models.parts]
    assert alone == pytest.approx([FRICTION] * len(alone), rel=0.15)


def test_what_is_held_out_is_one_more_part_that_models_predict() -> None:
    recording, base, found = with_law('coulomb_friction')
    models = ContactModels([recording], base)
    spared = [Spared('late', recording, recording.observed.t > 4.0)]
    evidence = models.evidence()
    evidence = replace(evidence, base=predict(evidence.base, spared))
    lawful = predict(models.without(models._scored([recording], found), []), spared)
    assert len(lawful.left_out) == len(models.parts) + 1
    assert explained(evidence, lawful).parts[-1] == pytest.approx(1.0, abs=0.05)


def recalibrated(**changes: Any) -> tuple[PreparedRecording, Fit]:
    """Recalibrate the nominal model on a world's recording."""
    recording, model = prepared_from(recorded(**changes))
    return recording, fit([recording], model)


def steps(recording: PreparedRecording, base: Fit, *names: str) -> dict[str, list[Step]]:
    """Take the steps of effects beside the recalibrated model."""
    every = names or candidates_in([recording], base.model)
    screening = Screening([recording], base, every, measure_scales([recording], base))
    return screening.steps(base.model, every)


@pytest.mark.slow
@pytest.mark.parametrize('name, values', [
    ('quadratic_damping', (600.0,)), ('cubic_stiffness', (3e6,)), ('coulomb_friction', (2.0,)),
    ('robot_drag', (600.0,)), ('force_bias', (2.0,))])
def test_the_true_effect_is_among_the_first(name: str, values: tuple[float, ...]) -> None:
    recording, base = recalibrated(**physics(name, *values))
    found = steps(recording, base)
    assert set(found) == set(candidates_in([recording], base.model))
    foretold = [each[0].foretold for each in found.values()]
    assert foretold == pytest.approx(sorted(foretold), rel=2e-6)
    assert name in list(found)[:5]


Array = NDArray[np.float64]

ATTACHED = nominal(environment__unilateral=False, environment__stiffness=60.0,
                   environment__damping=20.0)


class Scored(NamedTuple):
    """A candidate with its score."""

    name: str
    score: float


def score_of(one: Scored) -> float:
    return one.score


def names(*given: tuple[str, float]) -> list[str]:
    return [one.name for one in ranked((Scored(*each) for each in given), score_of)]


def test_of_equal_scores_the_zero_of_the_sensor_goes_before_that_of_the_surface() -> None:
    for score in (1e-30, 0.2, 1e6):
        given = ('contact_offset', score), ('force_bias', score * (1.0 - 1e-9))
        assert names(*given) == names(*reversed(given)) == ['force_bias', 'contact_offset'], score


def test_of_equal_scores_fewest_parameters_go_first_then_the_order_of_effects() -> None:
    order = ['force_bias', 'coulomb_friction', 'force_gain', 'presliding_friction']
    assert names(*((name, 1.0) for name in sorted(order, reverse=True))) == order
    assert len(set(names(*((name, 1.0) for name in EFFECTS)))) == len(EFFECTS)


def told(perturbation: float) -> list[tuple[str, list[str], float]]:
    """Diagnose a biased sensor on an attached wall, pushed one way, with data rounded anew."""
    t, draw = np.arange(0.0, 30.0, 0.02), np.random.default_rng(5)
    x = 0.1 * t / 30.0 + 0.002 * np.sin(t)
    force = -60.0 * x - 20.0 * np.gradient(x, t) - 12.0 + draw.normal(0.0, 0.05, len(t))
    x, force = (each * (1.0 + perturbation * draw.uniform(-1.0, 1.0, len(t)))
                for each in (x, force))
    found = diagnose(Recording('', Signals(t, force, t, x, t[:0], np.empty((4, 0)))), ATTACHED)
    return [(one.name, one.indistinguishable_from, round(one.probability, 2))
            for one in found.effects]


@pytest.mark.slow
def test_rounding_of_the_data_changes_neither_names_nor_their_order() -> None:
    first = told(0.0)
    assert [name for name, _, _ in first] == ['force_bias']
    assert told(2e-12) == told(3e-12) == first


def test_one_stroke_of_a_wall_that_yields_is_a_second_softer_spring() -> None:
    t, draw = np.linspace(0.0, 30.0, 600), np.random.default_rng(3)
    x = 0.1 * t / 30.0
    force = -60.0 * x + 54.0 * np.maximum(x - 0.04, 0.0) + draw.normal(0.0, 0.02, len(t))
    found, = diagnose(Recording('', Signals(t, force, t, x, t[:0], np.empty((4, 0)))),
                      ATTACHED).effects
    assert found.name == 'bilinear_stiffness'
    for value, true in zip(found.parameters.values(), (-54.0, 0.04)):
        assert abs(value.value - true) < 3.0 * value.std < 0.05 * abs(true)


def test_a_law_that_held_out_data_refute_is_not_named() -> None:
    t, draw = np.arange(0.0, 30.0, 0.02), np.random.default_rng(4)
    x = 0.05 * np.sin(1.3 * t)
    rubs = np.ones(len(t), bool)
    for _ in range(3):  # where friction pauses changes what is held out
        force = -60.0 * x - np.where(rubs, 2.0, 0.0) * np.sign(np.cos(1.3 * t))
        force = force + draw.normal(0.0, 0.02, len(t))
        recording = Recording('', Signals(t, force, t, x, t[:0], np.empty((4, 0))))
        rubs = ~hold_out(Model.of(ATTACHED), observe(recording.signals, ATTACHED)).samples
    found = diagnose(recording, ATTACHED)
    assert (found.verdict, found.effects, found.held_out_chose) == ('unexplained', [], True)


def held(values: Array, count: int) -> Array:
    """Repeat every so manieth value until the next."""
    return np.repeat(values[::count], count)[:len(values)]


@pytest.mark.parametrize('count', [2, 3, 10])
def test_of_repeated_values_the_first_is_kept(count: int) -> None:
    long = np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, 100 * count))
    assert updates(held(long, count)).tolist() == list(range(0, len(long), count))


def changed(**rows: Any) -> Signals:
    """Change some of a recording's signals."""
    return recorded()._replace(**rows)


def refused(signals: Signals, match: str) -> None:
    """Require an error with a text."""
    with pytest.raises(RecordingError, match=match):
        diagnosed(signals)


@pytest.mark.slow
def test_constant_force_is_refused() -> None:
    refused(changed(force=np.full(1825, -3.0)), 'wrench is constant at -3.*topic, axis')


@pytest.mark.parametrize('row', ['force', 'position'])
@pytest.mark.parametrize('value', [np.nan, np.inf])
def test_signals_that_are_no_numbers_are_refused(row: str, value: float) -> None:
    values: Array = getattr(recorded(), row).copy()
    values[700] = value
    with pytest.raises(ContactEstimationError, match='finite'):
        diagnosed(changed(**{row: values}))
