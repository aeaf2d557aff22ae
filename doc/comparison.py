# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Print the best models in a file of `diagnose --write-comparison`, and the nominal one."""

import json
from pathlib import Path
import sys

from contact_estimation.diagnosis.fit.beam import of_dict
from contact_estimation.diagnosis.fit.constants import CONSTANTS

MODELS = 3

compared = of_dict(json.loads(Path(sys.argv[1]).read_text()), CONSTANTS)
evidence, models = compared.evidence, compared.models
weights = evidence.weights(models, seed=0)
print('                        errors left out       log evidence       log')
print('model                    force   motion      exact inexact     prior   score  weight')
for model in [*models[:MODELS], evidence.base]:
    name, (force, motion) = ' + '.join(model.effects), model.left_out.mean(axis=0)
    exact, inexact = (parts.sum() for parts in evidence.log_likelihoods(model))
    print(f'{name or "(recalibrated)":<22}{force:8.2f} {motion:8.2f} {exact:10.0f} '
          f'{inexact:7.0f} {evidence.log_prior(model) + 0.0:9.1f} '
          f'{evidence.score(model):7.1f} {weights[models.index(model)]:7.3f}')
