#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Share of the contacts in switched subdomains over the steps of two runs, its error and its price."""
import sys

import numpy as np
import style

NUMBERS = "step share iterations iterations_plain velocity_error impulse_error seconds seconds_plain"
CASES = [("shear-300", "shear"), ("piston-300", "bed under a piston")]
FLEXIBILITIES = [("1e-6 W", "10^{-6}", "#1f5f99", "o"), ("1e-2 W", "10^{-2}", "#3d7a3d", "s"),
                 ("1 W", "1", "#b03a2e", "^")]
AFTER = [("30", "-", {}), ("300", (0, (4, 2)), {"markerfacecolor": "white"})]
SMALLEST = 1e-4  # errors below it are drawn on it


def panels(axes, rows):
    """Share, error and times of one case, from top to bottom."""
    for flexibility, _, colour, marker in FLEXIBILITIES:
        for after, line, face in AFTER:
            some = [r for r in rows if r["solver.switch_flexibility"] == flexibility
                    and r["solver.switch_after"] == after]
            look = {"color": colour, "marker": marker, "linestyle": line, "linewidth": 0.9, "markersize": 3.5, **face}
            steps = style.column(some, "step")
            axes[0].plot(steps, 100 * style.column(some, "share"), **look)
            axes[1].plot(steps, np.maximum(SMALLEST, style.column(some, "velocity_error")), **look)
            axes[2].plot(steps, style.column(some, "iterations") / style.column(some, "iterations_plain"), **look)
            axes[3].plot(steps, style.column(some, "seconds") / style.column(some, "seconds_plain"), **look)


def draw(results, output, formats):
    rows = style.read_table(results, "switch/switch.csv", numbers=NUMBERS,
                            texts="case solver.switch solver.switch_after solver.switch_flexibility")
    fig, axes = style.figure(style.COLUMN_AND_HALF, 190, 4, 2, sharex=True, sharey="row")
    for place, (case, title) in enumerate(CASES):
        own = [r for r in rows if r["case"] == case and r["solver.switch"] == "linear"]
        style.need(results, "switch/switch.csv", own, step=1)
        panels(axes[:, place], own)
        for row, letter in enumerate("aceg" if place == 0 else "bdfh"):
            style.panel(axes[row, place], letter, title if row == 0 else "")
        axes[-1, place].set_xlabel("step")
    axes[0, 0].set(ylabel="contacts switched (%)", ylim=(0, 100))
    axes[1, 0].set(ylabel="error of velocities", yscale="log", ylim=(0.7 * SMALLEST, 2))
    axes[2, 0].set(ylabel="iterations, ratio", yscale="log")
    axes[3, 0].set(ylabel="time, ratio", yscale="log")
    for some in axes[2:].flat:
        some.axhline(1, color=style.GREY, linewidth=0.6, zorder=0.5)
    handles, labels = [], []
    for _, number, colour, marker in FLEXIBILITIES:
        handles += axes[0, 0].plot([], [], color=colour, marker=marker)
        labels.append(rf"$\alpha = {number}\,W$" if number != "1" else r"$\alpha = W$")
    for after, line, face in AFTER:
        handles += axes[0, 0].plot([], [], color="black", linestyle=line, marker="o", **face)
        labels.append(rf"$k = {after}$")
    style.legend_above(fig, handles, labels, 5)
    return style.save(fig, output, "switch", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
