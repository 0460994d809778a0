#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Share of the contacts in switched subdomains over the steps of two runs, its errors and its price."""
import sys

import numpy as np
import style

NUMBERS = "step share iterations iterations_plain velocity_error impulse_error seconds seconds_plain"
COLUMNS = [("switch.csv", "shear-300", "shear, linear"), ("homogenised.csv", "shear-300", "shear, homogenised"),
           ("switch.csv", "piston-300", "piston, linear"), ("homogenised.csv", "piston-300", "piston, homogenised")]
FLEXIBILITIES = [("1e-6 W", "10^{-6}", "#1f5f99", "o"), ("1e-2 W", "10^{-2}", "#3d7a3d", "s"),
                 ("1 W", "1", "#b03a2e", "^")]
AFTER = [("30", "-", {}), ("300", (0, (4, 2)), {"markerfacecolor": "white"})]
ERRORS = (1e-4, 100)  # drawn; smaller ones, nearly all of which are 0, are at the tick 0


def panels(axes, rows, zeros):
    """Share, errors, iterations and times of one case and model, from top to bottom. ZEROS: where errors of 0 are."""
    for flexibility, _, colour, marker in FLEXIBILITIES:
        for after, line, face in AFTER:
            some = style.where(rows, **{"solver.switch_flexibility": flexibility, "solver.switch_after": after})
            if not some:
                continue
            look = {"color": colour, "marker": marker, "linestyle": line, "linewidth": 0.9, "markersize": 3.5, **face}
            steps = style.column(some, "step")
            axes[0].plot(steps, 100 * style.column(some, "share"), **look)
            for axis, zero, name in zip(axes[1:3], zeros, ("velocity_error", "impulse_error")):
                errors = style.column(some, name)
                axis.plot(steps, np.where(errors < ERRORS[0], zero, errors), **look)
            for axis, name in zip(axes[3:], ("iterations", "seconds")):
                axis.plot(steps, style.column(some, name) / style.column(some, f"{name}_plain"), **look)


def draw(results, output, formats):
    fig, axes = style.figure(style.FULL, 205, 5, 4, sharex=True)
    for place, (table, case, title) in enumerate(COLUMNS):
        rows = style.read_table(results, f"switch/{table}", numbers=NUMBERS,
                                texts="case solver.switch_after solver.switch_flexibility")
        own = style.where(rows, case=case)
        style.need(results, f"switch/{table}", own, step=1)
        column = axes[:, place]
        zeros = [style.log_axis(axis.yaxis, *ERRORS, limit="0", end="low", every=2) for axis in column[1:3]]
        panels(column, own, zeros)
        column[0].set(ylim=(-3, 100))
        style.log_axis(column[3].yaxis, 5e-3, 2)
        style.log_axis(column[4].yaxis, 0.1, 100)
        for row, axis in enumerate(column):
            style.panel(axis, "abcdefghijklmnopqrst"[4 * row + place], title if row == 0 else "")
            if place > 0:
                axis.tick_params(labelleft=False)
        for axis in column[3:]:
            axis.axhline(1, color=style.GREY, linewidth=0.6, zorder=0.5)
        column[-1].set_xlabel("step")
    for axis, label in zip(axes[:, 0], ("contacts switched (%)", "error of velocities", "error of impulses",
                                        "iterations, ratio", "time, ratio")):
        axis.set_ylabel(label)
    handles, labels = [], []
    for _, number, colour, marker in FLEXIBILITIES:
        handles += axes[0, 0].plot([], [], color=colour, marker=marker)
        labels.append(rf"$\alpha = {number}\,W$" if number != "1" else r"$\alpha = W$")
    for after, line, face in AFTER:
        handles += axes[0, 0].plot([], [], color="black", linestyle=line, marker="o", **face)
        labels.append(rf"$k = {after}$")
    handles += axes[0, 0].plot([], [], linestyle="none")
    labels.append(r"errors below $10^{-4}$: at 0")
    style.legend_above(fig, handles, labels, 6)
    return style.save(fig, output, "switch", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
