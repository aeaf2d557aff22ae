# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Every number of the posterior, each with where it comes from.

Probabilities are stated beliefs; `python -m contact_estimation.studies online` shows what another
value does to errors and coverage.
"""

# -- contact, sample by sample ------------------------------------------------------------------
SHIFT = 0.75
"""Half of the shift of the mean that CUSUM is most sensitive to [deviations of the noise]: the
log-likelihood ratio of N(2 SHIFT, 1) to N(0, 1) is 2 SHIFT (z - SHIFT)."""

TOUCH = 12.0
"""Sum of z - SHIFT at which contact is declared. In free flight once in
exp(2 SHIFT TOUCH) / (2 SHIFT^2) = 6e7 samples, a day and a half at 500 Hz (Siegmund 1985)."""

RELEASE = 9.0
"""The same for the end of a contact, which costs little if it is wrong: 6e5 samples."""

CLIP = 8.0
"""Largest |z| that counts: a single outlier, CLIP + SHIFT, stays below TOUCH and RELEASE."""

NOISE_SAMPLES = 300
"""Samples over which the noise is averaged: 0.6 s at 500 Hz, standard error of 6 %."""

CLIPPED_SQUARE = 9.0
"""Largest second difference that counts, in variances: 0.3 % of Gaussian ones are larger."""

COLOUR, COLOURED = (5, 25), 30.0
"""Samples over which means show noise that is not white, 10 and 50 ms at 500 Hz: hum of 5 to
100 Hz; and how many times the variance of white noise theirs may be until they are seen."""

LEVEL_WALK = 5e-3
"""Random walk of the sensor's zero [deviations of the noise per sqrt(s)]: 0.1 in 400 s."""

SEGMENT_S = 0.3
"""Time over which a force is compared with the travel beside it [s]."""

SLOPE_STD = 4.0
"""Standard deviations for which a slope is significant: 6e-5."""

UNLIKELY = 6e-5
"""Probability of a hypothesis that counts: what a normal distribution has beyond SLOPE_STD."""

# -- surface ------------------------------------------------------------------------------------
ANYWHERE_M = 0.1
"""Standard deviation of a surface that nothing is known of [m]: the reach of one contact."""

EXACT_SURFACE_M = 5e-6
"""The same of one that is exactly where it is said to be [m]: the steps of encoders."""

AS_TOLD, NEAR, ELSEWHERE = 0.49, 0.49, 0.02
"""Prior of a surface as told, within its standard deviation, and anywhere."""

NEAR_DEPTH = 0.3
"""Standard deviation of a shift of the surface that (y - delta)^n = y^n - n delta y^(n-1) is used
for [mean depths]: the next term is (n - 1) / 2 delta / y of it, a tenth."""

LEAST_STIFFNESS, STIFFEST = 30.0, 1e6
"""Of a wall that is not known [N/m]: from foam to steel on a robot."""

STILL_THERE = 0.7
"""Prior of the same surface after the wall has changed."""

# -- changes of the wall ------------------------------------------------------------------------
NEW_WALL = 0.05
"""Prior of another wall at each touch: one in twenty contacts."""

CHANGES, OBSERVED_S = 1.0, 50.0
"""Prior of the rate of changes within a contact, as if so many had been seen in that time;
those that happen are counted too (gamma prior of a Poisson rate)."""

ZERO_STEPS, ZERO_STEP_N = 0.25, 3.0
"""Steps of the sensor's zero within a contact for each change of the wall, and their standard
deviation [N]: a cable that pulls, an estimate of joint torques that drifts."""

COMMIT = 4.0
"""Log odds of a change from which what was before is dropped: 50 to 1."""

RUNS = 10
"""Times since which the wall may be another, spaced like powers of 1.4: a factor of 30."""

FADE_S = 20.0
"""Memory of all else [s of contact]."""

WALK = 0.02
"""Random walk of the force of a wall that creeps or whose stiffness drifts, relative to it
[1/sqrt(s)]: 2 % of the stiffness, or at a depth of 10 mm 0.2 mm of the surface, in a second."""

SPEED = 1e-2
"""Speed of a wall that moves, and how much it changes in a second [m/s]: a hand, a conveyor.
`studies online --only followed` shows others."""

# -- noise and model error ----------------------------------------------------------------------
JITTER_S = 1e-4
"""Error of a stamp [s]: the resolution of drivers that stamp on arrival."""

NOISE_DOUBT = 0.3
"""Relative error of the noise of the position: it is measured as white, and seldom is."""

MODEL_ERROR, MODEL_ERROR_S = 2e-3, 0.05
"""Share of the force that no law predicts, and how long it stays the same [s]."""

STIFFNESS_FLOOR, DAMPING_FLOOR = 3e-4, 5e-3
"""Relative standard deviations that no data remove: scale errors of sensors, of lags."""

# -- priors of the laws' parameters -------------------------------------------------------------
DAMPING_S, DAMPING_STD_S = 0.02, 0.06
"""Mean and standard deviation of B_e / K_e [s]; the paper's wall has 0.04."""

FRICTION_N, MASS_KG = 5.0, 5.0
"""Standard deviations of friction and mass where a law has them."""

LAG_TAIL = 4.0
"""Exponent of the prior of the sensor's lag, a Student distribution with three degrees."""

TWO_POLES, POLES_STD = 0.75, 0.15
"""K tau^2 times this is the second-order term of a lag: 1/2 of a delay, 1 of one pole, 3/4 of
two equal ones."""

LONGEST_LAG_S = 6e-3
"""[s]"""
