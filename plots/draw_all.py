#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""All figures in one process."""
import sys

import disorder
import figure_5
import figure_6
import figure_7
import figures_2_3_4
import figures_8_10
import figures_9_11
import inexact_stage_one
import observed_rate
import optimal_eta
import partition
import predicted_observed
import relaxation
import scalability
import size
import style

SCRIPTS = [figures_2_3_4, figure_5, figure_6, figure_7, optimal_eta, relaxation, inexact_stage_one,
           observed_rate, size, scalability, disorder, partition, predicted_observed]

if __name__ == "__main__":
    sys.exit(style.run(__doc__, *[script.draw for script in SCRIPTS], figures_8_10.draw_8,
                       figures_8_10.draw_10, figures_9_11.draw_9, figures_9_11.draw_11))
