#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaps 1 - rho of Schwarz and of NSCDD against the cut: exact subdomains, one sweep, and Schwarz relaxed."""
import sys

import numpy as np
import style

CUTS = ["2,1", "8,1", "2,2", "4,4"]
PACKINGS = [("deposit", "deposit of 500"), ("hexagonal", "lattice of 256")]
LOOKS = {"nscdd": {"color": "#1f5f99", "marker": "o"}, "schwarz": {"color": "#b03a2e", "marker": "s"}}
FLOOR = 4e-5  # where radii of 1 and more are marked
COLUMNS = "epsilon_relative gauss_seidel_sweeps subdominant_radius"


def of_cuts(rows, value):
    """The value of each cut, in the order of CUTS."""
    return np.array([style.column([row for row in rows if row["partition.grid"] == cut], value)[0] for cut in CUTS])


def gaps(axes, radii, line, look, **options):
    """Gaps of the radii below 1; the others are written at the floor."""
    below = radii < 1 - 1e-9
    axes.plot(range(len(CUTS)), np.where(below, 1 - radii, np.nan), line, **{**look, **options})
    for place in np.flatnonzero(~below):
        axes.plot(place, FLOOR, "x", color=look["color"])
        axes.annotate(f"{radii[place]:.2f}", (place, FLOOR), (0, 4), textcoords="offset points", ha="center",
                      fontsize="small", color=look["color"])


def draw(results, output, formats):
    fig, grid = style.figure(style.COLUMN_AND_HALF, 115, 2, 2, sharey=True)
    best = style.read_table(results, "schwarz/relaxation.csv", numbers="epsilon_relative best_radius",
                            texts="case partition.grid")
    for column, (case, name) in enumerate(PACKINGS):
        for row, epsilon in enumerate((0, 1e-2)):
            axes = grid[row, column]
            for scheme, look in LOOKS.items():
                rows = style.read_table(results, f"schwarz/{scheme}.csv", numbers=COLUMNS, texts="case partition.grid")
                rows = style.need(results, f"schwarz/{scheme}.csv", rows, case=case, epsilon_relative=epsilon)
                for sweeps, line, words, face in ((np.inf, "-", "exact", look["color"]), (1, ":", "one sweep", "white")):
                    radii = of_cuts(style.where(rows, gauss_seidel_sweeps=sweeps), "subdominant_radius")
                    gaps(axes, radii, line, look, label=f"{scheme}, {words}", markerfacecolor=face)
            relaxed = style.need(results, "schwarz/relaxation.csv", best, case=case, epsilon_relative=epsilon)
            gaps(axes, of_cuts(relaxed, "best_radius"), "--", {"color": LOOKS["schwarz"]["color"]},
                 label="schwarz, relaxed")
            axes.set_yscale("log")
            axes.set_ylim(3e-5, 0.2)
            axes.set_xticks(range(len(CUTS)), labels=[cut.replace(",", "×") for cut in CUTS])
            style.panel(axes, "abcd"[2 * row + column],
                        rf"{name}, $\varepsilon = {epsilon:g}" + (r"\,\bar W$" if epsilon else "$"))
    for axes in grid[:, 0]:
        axes.set_ylabel(r"gap $1 - \rho$, or $\rho \geq 1$ (×)")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    style.legend_above(fig, handles, labels, 3)
    return style.save(fig, output, "schwarz", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
