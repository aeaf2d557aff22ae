# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""The figures of a diagnosis: what their axes show."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from contact_estimation.diagnosis.compare.shares import Share
from contact_estimation.diagnosis.report.figures import (
    COLOURS,
    plot_comparison,
    plot_dependences,
    plot_evidence,
    plot_parts,
    plot_plane,
    plot_residuals,
)
from contact_estimation.diagnosis.report.plot_data import plot_data
from contact_estimation.diagnosis.report.wording import tested_dependences as dependences_of
from contact_estimation.figures import INK
from diagnosed_worlds import diagnosed
import numpy as np
import pytest

pytest.importorskip('matplotlib')

EVERY = pytest.mark.parametrize('name', ('clean', 'stiffer', 'friction', 'unknown'))


def line(axis: Any, label: str) -> Any:
    """Return the line with a label."""
    (found,) = (line for line in axis.lines if line.get_label() == label)
    return found


@pytest.mark.slow
@EVERY
def test_held_out_spans_are_the_samples_excluded_from_fitting(name: str) -> None:
    recording = diagnosed(name).recordings[0]
    spans, t = plot_data(diagnosed(name)).held_out_s, recording.observed.t
    assert len(spans) == 3
    inside = np.any([(t >= first) & (t <= last) for first, last in spans], axis=0)
    assert not recording.use[inside].any()
    assert recording.use[~inside].mean() > 0.95


@pytest.mark.slow
def test_close_up_contains_the_greatest_mismatch() -> None:
    data = plot_data(diagnosed('unknown'))
    before = data.residuals[0].by_model[data.pair[0]]
    t = data.t[data.close_up]
    inside = (data.block_t >= t[0]) & (data.block_t <= t[-1])
    assert np.mean(before[inside] ** 2) > 1.2 * np.mean(before**2)


@pytest.mark.slow
def test_comparison_shows_recording_and_all_models() -> None:
    data = plot_data(diagnosed('friction'))
    whole, close = plot_comparison(data, data.force).axes
    assert [one.get_label() for one in whole.lines] == [
        'recorded', 'nominal', 'recalibrated', 'corrected']
    assert whole.get_ylabel() == 'force [N]' and close.get_xlabel() == 'time [s]'
    np.testing.assert_array_equal(line(close, 'recorded').get_ydata(),
                                  data.force.recorded[data.close_up])
    assert line(whole, 'corrected').get_color() == COLOURS['corrected']


@pytest.mark.slow
def test_position_is_plotted_in_millimetres() -> None:
    data = plot_data(diagnosed('friction'))
    assert data.position is not None
    whole, _ = plot_comparison(data, data.position).axes
    assert whole.get_ylabel() == 'position, free run [mm]'
    assert np.max(line(whole, 'recorded').get_ydata()) == pytest.approx(
        1e3 * np.max(diagnosed('friction').recordings[0].observed.raw_position), rel=1e-3)


def test_residuals_show_both_models_noise_and_held_out_part() -> None:
    data = plot_data(diagnosed('friction'))
    (axis,) = plot_residuals(data, data.residuals[0]).axes
    labels = axis.get_legend_handles_labels()[1]
    assert labels == ['held out', 'noise, ± 2 std', 'recalibrated', 'corrected',
                      'mismatch located']
    np.testing.assert_array_equal(line(axis, 'corrected').get_ydata(),
                                  data.residuals[0].by_model['corrected'])
    assert axis.get_ylabel() == 'force residual [N]'


def test_located_intervals_are_marked_in_the_channel_that_shows_them() -> None:
    data = plot_data(diagnosed('friction'))
    force, motion = (plot_residuals(data, one).axes[0] for one in data.residuals)
    location = diagnosed('friction').location
    assert location is not None
    assert len(force.lines) - len(motion.lines) == len(location.intervals_s)


def test_plane_shows_the_same_points_before_and_after() -> None:
    data = plot_data(diagnosed('friction'))
    before, after, bar = plot_plane(data).axes
    assert (before.get_title('left'), after.get_title('left')) == (
        'recalibrated model', 'corrected model')
    shown = [np.sort(axis.collections[0].get_offsets(), axis=0) for axis in (before, after)]
    np.testing.assert_allclose(shown[0], shown[1])
    assert len(shown[0]) == len(data.plane.x)
    assert bar.get_ylabel() == 'force residual [std of its noise]'


def test_dependences_are_titled_with_shares_before_and_after() -> None:
    tested = dependences_of(diagnosed('friction'))
    axes = plot_dependences(tested).axes
    before, after = tested['recalibrated'], tested['corrected']
    assert len(axes) == len(before)
    assert axes[1].get_title('left') == (
        f'velocity: {100 * before[1].share:.0f} → {100 * max(after[1].share, 0):.0f} %')
    np.testing.assert_array_equal(axes[1].lines[0].get_ydata(), before[1].mean)


def test_evidence_ranks_candidates_and_colours_named_effects() -> None:
    evidence = {'robot_friction': 0.3, 'coulomb_friction': 0.98, 'force_lag': 0.1}
    d = replace(diagnosed('friction'), evidence=evidence)
    (axis,) = plot_evidence(d).axes
    widths = [bar.get_width() for bar in axis.patches]
    assert widths == sorted(widths, reverse=True)
    assert widths[0] == pytest.approx(98.0)
    names = [label.get_text() for label in axis.get_yticklabels()]
    colours = {bar.get_facecolor() for bar in axis.patches}
    assert 'coulomb friction' in names and len(colours) == 2


def test_parts_show_shares_and_main_parameter_beside_those_of_all_parts() -> None:
    (effect,) = diagnosed('friction').effects
    shares, values = plot_parts(effect).axes
    assert [bar.get_height() for bar in shares.containers[0]] == [
        100.0 * part.share for part in effect.parts]
    assert line(shares, 'all parts').get_ydata() == [100.0 * effect.share] * 2
    np.testing.assert_array_equal(line(values, 'each part alone').get_ydata(),
                                  [part.parameters['F_c'] for part in effect.parts])
    assert line(values, 'all parts').get_ydata() == [effect.parameters['F_c'].value] * 2
    assert values.get_ylabel() == 'F_c [N]'
    assert [tick.get_text() for tick in values.get_xticklabels()] == [
        part.name for part in effect.parts]


def test_bands_of_parts_are_the_interval_and_two_standard_deviations() -> None:
    (effect,) = diagnosed('friction').effects
    shares, values = plot_parts(effect).axes
    (interval,) = [one for one in shares.patches if one.get_label() == '95 % interval']
    bounds = interval.get_extents().transformed(shares.transData.inverted())
    assert (bounds.y0, bounds.y1) == pytest.approx([100.0 * one for one in effect.share_interval])
    bounds = values.patches[0].get_extents().transformed(values.transData.inverted())
    F_c = effect.parameters['F_c']
    assert (bounds.y0, bounds.y1) == pytest.approx((F_c.value - 2 * F_c.std,
                                                    F_c.value + 2 * F_c.std))


def test_of_a_law_beside_zeros_the_share_of_what_they_leave_is_shown() -> None:
    (effect,) = diagnosed('friction').effects
    parts = np.linspace(0.5, 0.7, len(effect.parts))
    beside = Share(0.6, (0.5, 0.7), parts)
    shares, _ = plot_parts(replace(effect, share=1e-4, beside_zeros=beside)).axes
    heights = [bar.get_height() for bar in shares.containers[0]]
    np.testing.assert_allclose(heights, 100.0 * parts)
    assert line(shares, 'all parts').get_ydata() == [60.0] * 2
    assert shares.get_ylabel() == 'explained of what\nthe offsets leave [%]'


def test_share_of_a_part_with_hardly_any_misfit_does_not_dwarf_the_others() -> None:
    (effect,) = diagnosed('friction').effects
    parts = [replace(effect.parts[0], share=-40.0), *effect.parts[1:]]
    shares, _ = plot_parts(replace(effect, parts=parts, share_interval=(-np.inf, np.inf))).axes
    low, high = shares.get_ylim()
    assert -200.0 < low and high < 200.0


def test_all_figures_have_one_style() -> None:
    data = plot_data(diagnosed('friction'))
    d = diagnosed('friction')
    for figure in (plot_residuals(data, data.residuals[0]), plot_evidence(d),
                   plot_parts(d.effects[0])):
        axis = figure.axes[0]
        assert not axis.spines['top'].get_visible() and not axis.spines['right'].get_visible()
        assert axis.xaxis.label.get_color() == INK
