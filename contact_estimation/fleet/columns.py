# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The columns of the fleet's table: each with its type, unit and meaning, once."""

from __future__ import annotations

from typing import NamedTuple


class Column(NamedTuple):
    """A column of the table."""

    name: str  # in the file
    kind: str  # 'text', 'integer', 'number', 'time', 'texts', 'numbers', 'checks' or 'parameters'
    unit: str  # SI; '' for what has none
    meaning: str  # in words; of an episode or, by default, of the whole recording


COLUMNS = (
    Column('recording', 'text', '', 'path as found'),
    Column('episode', 'integer', '', 'contact, from 1; 0 in the row of a recording without one'),
    Column('group', 'text', '', 'from --group-by'),
    Column('number', 'integer', '', 'place of the recording in time, from 1'),
    Column('start', 'time', 'ns', 'stamp of the first sample'),
    Column('duration_s', 'number', 's', 'from the first sample to the last'),
    Column('begin_s', 'number', 's', 'begin of the episode, since `start`'),
    Column('end_s', 'number', 's', 'end of the episode, since `start`'),
    Column('status', 'text', '', 'of the estimator at the end of the episode'),
    Column('stiffness', 'number', 'N/m', 'K_e estimated on line, at the end of the episode'),
    Column('stiffness_std', 'number', 'N/m', 'standard deviation of `stiffness`'),
    Column('damping', 'number', 'N s/m', 'B_e estimated on line, at the end of the episode'),
    Column('damping_std', 'number', 'N s/m', 'standard deviation of `damping`'),
    Column('model_fit', 'number', '1', 'rms of the residual over that of the noise'),
    Column('verdict', 'text', '', 'of the diagnosis'),
    Column('names', 'texts', '', 'effects named, strongest first'),
    Column('families', 'texts', '', 'family of each name'),
    Column('probabilities', 'numbers', '1', 'that the family of each name is right'),
    Column('shares', 'numbers', '1', 'part of the mismatch that each name explains'),
    Column('shares_low', 'numbers', '1', 'lower end of the 95 % interval of each share'),
    Column('shares_high', 'numbers', '1', 'upper end of the 95 % interval of each share'),
    Column('parameters', 'parameters', 'each its own', 'fitted parameters of the names'),
    Column('remainder_share', 'number', '1', 'part of the mismatch that no name explains'),
    Column('corrected_stiffness', 'number', 'N/m', 'K_e fitted together with the names'),
    Column('corrected_stiffness_std', 'number', 'N/m', 'its standard deviation'),
    Column('corrected_damping', 'number', 'N s/m', 'B_e fitted together with the names'),
    Column('corrected_damping_std', 'number', 'N s/m', 'its standard deviation'),
    Column('recalibrated_stiffness', 'number', 'N/m', 'K_e refitted without names'),
    Column('recalibrated_damping', 'number', 'N s/m', 'B_e refitted without names'),
    Column('noise_floor_n', 'number', 'N', 'noise of the force'),
    Column('force_rmse_nominal_n', 'number', 'N', 'held-out error of the given model'),
    Column('force_rmse_recalibrated_n', 'number', 'N', 'held-out error of the refitted model'),
    Column('force_rmse_corrected_n', 'number', 'N', 'held-out error of the model with names'),
    Column('motion_rmse_nominal_m', 'number', 'm', 'held-out error of the given model'),
    Column('motion_rmse_recalibrated_m', 'number', 'm', 'held-out error of the refitted model'),
    Column('motion_rmse_corrected_m', 'number', 'm', 'held-out error of the model with names'),
    Column('improvement_low', 'number', '1', 'lower end of the 95 % interval of '
           '1 - corrected / recalibrated'),
    Column('improvement_high', 'number', '1', 'its upper end'),
    Column('failed_checks', 'texts', '', 'names of the checks that failed'),
    Column('checks', 'checks', '', 'all checks: name, ok, text'),
    Column('diagnosed_s', 'number', 's', 'length of the part that was diagnosed'),
    Column('page', 'text', '', 'page of the diagnosis, relative to the table'),
    Column('error', 'text', '', 'why there is no result; empty where there is one'),
    Column('version', 'text', '', 'of contact_estimation'),
    Column('sha256', 'text', '', 'of the recording'),
    Column('model_sha256', 'text', '', 'of the parameters of the nominal model'),
)
