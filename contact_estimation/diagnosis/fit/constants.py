# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The constants of the decision, in `constants.json`: fitted by `blind_trials --calibrate`."""

import json
from pathlib import Path
from typing import NamedTuple


class Constants(NamedTuple):
    """Prior and error model of a comparison."""

    # parameter, law, curve: log prior odds against a parameter, a law, and a law that is a curve
    # through any slow misfit [nat]
    parameter: float
    law: float
    curve: float
    independent: float  # degrees of freedom of a discrepancy in a part, at most
    ideal: float  # part of the squared misfit that no law explains, since every law idealises
    # discrepancy that every instrument and rig has, as a share of the range of the force
    instrument: float
    # share of the squared misfit that an exact law leaves: integration, the course of a signal
    # between samples
    exact: float
    # error of an accurate force sensor, as a share of the range of the force: OIML R 60, class C2
    accuracy: float
    # weight of the errors on parts left out; that on the parts as fitted has the rest (.632
    # bootstrap: B. Efron, JASA 78, 1983)
    left_out: float
    # divisor of log posteriors that makes probabilities as large as names are often right
    temperature: float
    named: float  # probability of a family, or of a further law of any, from which on it is named
    # worth, worth_exact: least share of what zeros leave that is worth a name, of a law that is
    # inexact or exact
    worth: float
    worth_exact: float
    confirmed: float  # least share that names explain of what held-out data show
    listed: float  # weight of a law that is listed beside another, in that of the other


CONSTANTS = Constants(**json.loads(Path(__file__).with_name('constants.json').read_text()))

ARM = CONSTANTS._replace(ideal=0.0, instrument=0.006)
"""
Those of a whole arm.

Many laws share the misfit of a joint, so none may leave a share of it, and cables and other laws
of every rig are within what an instrument leaves.
"""
