# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import contact_estimation as ce

sensors = ce.SensorParameters(force_noise=1.0, distribution='uniform')
plant = ce.PlantParameters(sensors=sensors)
session = ce.ContactSession(ce.EstimationParameters())
run = ce.run_closed_loop(plant, session, ce.experiment_named('sine'), duration=12.0)
estimate = run.last_estimate
print(f'K_e = {estimate.stiffness:.0f} +- {estimate.stiffness_std:.0f} N/m')
print(f'B_e = {estimate.damping:.0f} +- {estimate.damping_std:.1f} N s/m')
