# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

import contact_estimation as ce

sensors = ce.SensorParameters(force_noise=1.0, distribution='uniform')
plant = ce.PlantParameters(sensors=sensors)
session = ce.ContactSession(ce.EstimationParameters())
run = ce.run_closed_loop(plant, session, ce.experiment_named('sine'), duration=12.0)
estimate = run.last_estimate
print(f'K_e = {estimate.stiffness:.0f} +- {estimate.stiffness_std:.0f} N/m')
print(f'B_e = {estimate.damping:.0f} +- {estimate.damping_std:.1f} N s/m')
