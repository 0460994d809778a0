#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""All figures in one process, those of the paper first. Studies without results are left out, and named."""
import os
import sys

import coarse_space
import disorder
import figure_5
import figure_6
import figure_7
import figures_2_3_4
import figures_8_10
import figures_9_11
import inexact_stage_one
import machines
import newton_scalability
import observed_rate
import optimal_eta
import paper_samples
import partition
import predicted_observed
import profiles
import relaxation
import scalability
import scalability_in_space
import schwarz
import shear_in_space
import size
import style
import switch
import verdicts

# What draws the results of a study.
DRAW = {
    "figures-2-3-4": figures_2_3_4.draw,
    "figure-5": figure_5.draw,
    "figure-6": figure_6.draw,
    "figure-7": figure_7.draw,
    "figure-8": figures_8_10.draw_8,
    "figure-9": figures_9_11.draw_9,
    "figure-10": figures_8_10.draw_10,
    "figure-11": figures_9_11.draw_11,
    "optimal-eta": optimal_eta.draw,
    "relaxation": relaxation.draw,
    "inexact-stage-one": inexact_stage_one.draw,
    "observed-rate": observed_rate.draw,
    "schwarz": schwarz.draw,
    "size": size.draw,
    "scalability": scalability.draw,
    "disorder": disorder.draw,
    "partition": partition.draw,
    "predicted-observed": predicted_observed.draw,
    "profiles": profiles.draw,
    "switch": switch.draw,
    "verdicts": verdicts.draw,
    "coarse-space": coarse_space.draw,
    "newton-scalability": newton_scalability.draw,
    "machines": machines.draw,
    "shear-in-space": shear_in_space.draw,
    "scalability-in-space": scalability_in_space.draw,
    "disorder-in-space": disorder.draw_in_space,
    "newton-scalability-in-space": newton_scalability.draw_in_space,
    "paper-samples": paper_samples.draw,
}
WITHOUT_FIGURE = ["semi-implicit"]
# Their own scripts measure them: `nscdd run` starts no processes, and has no samples of other authors.
MEASURED = ["machines", "paper-samples"]


def main():
    parser = style.arguments(__doc__)
    parser.add_argument("--study", choices=[*DRAW, *WITHOUT_FIGURE], help="draw the figures of this study alone")
    options = parser.parse_args()
    if options.study:
        return style.draw_each([DRAW[options.study]] if options.study in DRAW else [], options)
    there = [name for name in DRAW if os.path.isdir(os.path.join(options.results, name))]
    absent = [name for name in DRAW if name not in there]
    if absent:
        print(f"{options.results}: nothing of {', '.join(absent)}", file=sys.stderr)
    status = style.draw_each([DRAW[name] for name in there], options)
    return status if there else 2


if __name__ == "__main__":
    sys.exit(main())
