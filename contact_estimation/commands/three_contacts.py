# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Example: eq. (6) on a tool whose three contact points touch, slide and release.

python -m contact_estimation.commands.three_contacts --output DIR
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np

from .command_line import command, Parser
from ..estimators.contact_points_estimator import ContactPointsEstimate
from ..studies.reproduction.three_contacts import (
    ALL_TOUCH_S, B_E, DURATION, errors_of, estimate, Instant, K_E, MU, plot_three_contacts, POINTS,
    RATE, simulate, VARIANTS)


def run(options: Any) -> int:
    """Simulate, estimate, print the results and plot them."""
    instants = simulate(options.seed)
    runs = {variant: estimate(instants, variant) for variant in VARIANTS}
    print(f'eq. (6), {len(POINTS)} points, {DURATION:g} s at {RATE:g} Hz, seed {options.seed}: '
          f'K_e {K_E:g} N/m, B_e {B_E:g} N s/m, mu {MU:g}')
    _print_touches(instants)
    _print_estimates(runs, round(ALL_TOUCH_S * RATE), f'at {ALL_TOUCH_S:g} s, all three sliding')
    _print_estimates(runs, -1, 'after the last contact')
    if options.output:
        folder = Path(options.output)
        folder.mkdir(parents=True, exist_ok=True)
        plot_three_contacts(instants, runs, folder / 'three_contacts.png')
        summary = {name: _summary(estimates[-1]) for name, estimates in runs.items()}
        (folder / 'three_contacts.json').write_text(json.dumps(summary, indent=1) + '\n')
        print(f'wrote {folder / "three_contacts.png"} and three_contacts.json')
    return 0


def _print_touches(instants: Sequence[Instant]) -> None:
    for point, name in enumerate(POINTS):
        presses = [i.t for i in instants if np.any(i.forces[point])]
        most = max(float(np.linalg.norm(i.forces[point])) for i in instants)
        print(f'  {name:<12} touches from {presses[0]:.2f} to {presses[-1]:.2f} s, '
              f'at most {most:.1f} N')


def _print_estimates(
    runs: Mapping[str, Sequence[ContactPointsEstimate]], place: int, when: str
) -> None:
    print(f'{when}:')
    for name, estimates in runs.items():
        e, off = estimates[place], errors_of(estimates[place])
        print(f'  {name:<19} K {e.stiffness:7.1f} +- {e.stiffness_std:.1f} N/m '
              f'({off.stiffness_percent:+.2f} %)  B {e.damping:6.1f} +- {e.damping_std:.1f} N s/m '
              f'({off.damping_percent:+.2f} %)  mu {e.friction:.4f} +- {e.friction_std:.4f}')


def _summary(e: ContactPointsEstimate) -> dict[str, float]:
    return {**{name: getattr(e, name) for name in ('stiffness', 'damping', 'friction')},
            **{f'{k}_error' if k == 'friction' else k.replace('_percent', '_error_percent'): v
               for k, v in errors_of(e)._asdict().items()}}


def make_parser() -> Parser:
    """Return the parser of the command line of the example."""
    parser = Parser(
        prog='three_contacts',
        description='Estimate K_e, B_e and friction from the force on a tool with three contact '
        'points that touch, slide and release (eq. 6), with friction estimated, known and '
        'ignored.',
    )
    parser.add_argument('--output', metavar='DIR', help='folder for figure and JSON')
    parser.add_argument('--seed', type=int, default=0, help='seed of the noise (0)')
    return parser


main = command(make_parser, run)


if __name__ == '__main__':
    raise SystemExit(main())
