#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse spaces: how many vectors the interface needs (docs/theory.md, section 18)."""
import sys

import numpy as np
import style

NUMBERS = "interface_dofs primal_dofs rank_x0 epsilon_relative modes_30 subdomains kappa"
NETWORKS = [("lattice", "lattices, vacancies", "#1f5f99", "s"), ("deposit", "deposits of disks", "#b03a2e", "o"),
            ("lattice-in-space", "lattices in space", "#3d7a3d", "D"), ("space", "deposit of spheres", "#8a5a9e", "^"),
            ("sheared", "sheared bed, friction", "#c77a1a", "P")]
EPSILONS = (1e-6, 1e-4, 1e-3, 1e-2)
CROSSINGS = [("2,2", 1, "o"), ("4,2", 3, "v"), ("4,4", 9, "s"), ("8,4", 21, "D"), ("8,8", 49, "^")]


def rows_of(results, table, texts="", **where):
    name = f"coarse-space/{table}.csv"
    rows = style.read_table(results, name, numbers=NUMBERS, texts="case scaling coarse_space " + texts)
    rows = [row for row in rows if row["coarse_space"] == "geneo" and (table != "space" or row["case"] == "spheres")]
    return style.need(results, name, rows, **where)


def near(rows, epsilon):
    return [row for row in rows if abs(row["epsilon_relative"] / epsilon - 1) < 1e-6]


def law_1(axes, results):
    axes.plot([1, 2000], [1, 2000], color=style.GREY, linewidth=0.6, zorder=0.5)
    for table, label, colour, marker in NETWORKS:
        rows = near(rows_of(results, table, scaling="multiplicity"), 1e-6)
        limit = np.minimum(style.column(rows, "rank_x0"), style.column(rows, "primal_dofs"))
        axes.plot(limit, style.column(rows, "modes_30"), linestyle="none", marker=marker, color=colour,
                  markerfacecolor="white", label=label)
    for axis in (axes.xaxis, axes.yaxis):
        style.log_axis(axis, 50, 1500)
    axes.set(xlabel=r"rank $X_0$, at most $n_P$", ylabel=r"vectors for $\kappa \leq 30$")
    axes.legend(loc="upper left", fontsize=7)


def against_hyperstaticity(axes, results):
    """Vectors over interface unknowns against the share of the interface that self-stresses hold."""
    for scaling, face in (("multiplicity", "full"), ("deluxe", "none")):
        for table, _, colour, marker in NETWORKS:
            rows = near(rows_of(results, table, scaling=scaling), 1e-6)
            unknowns = style.column(rows, "interface_dofs")
            axes.plot(1 - style.column(rows, "rank_x0") / unknowns, style.column(rows, "modes_30") / unknowns,
                      linestyle="none", marker=marker, color=colour, fillstyle=face)
    axes.set(xlim=(-0.03, 0.85), ylim=(0, 1), xlabel=r"self-stresses over $n_\Gamma$",
             ylabel=r"vectors over $n_\Gamma$")
    axes.text(0.05, 0.93, "multiplicity (filled)\ndeluxe (open)", transform=axes.transAxes, fontsize=7, va="top",
              ha="left", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1})


def law_2(axes, results):
    for grid, crossings, marker in CROSSINGS:
        rows = rows_of(results, "cuts", "partition.grid")
        rows = [row for row in rows if row["partition.grid"] == grid]
        axes.plot(style.column(rows, "epsilon_relative"), style.column(rows, "modes_30") / crossings,
                  linestyle="none", marker=marker, color="#b03a2e", markerfacecolor="white",
                  label=grid.replace(",", r" $\times$ "))
    epsilon = np.logspace(-6, -2.2, 60)
    axes.plot(epsilon, 2.1 * np.log10(1e-2 / epsilon) ** 2, color="black", linewidth=0.9)
    style.log_axis(axes.xaxis, 5e-7, 2e-3)
    style.log_axis(axes.yaxis, 1, 60)
    axes.set(xlabel=r"$\varepsilon/W$", ylabel=r"vectors per inner corner, $\kappa \leq 30$")
    axes.legend(loc="lower left", fontsize=7)


def draw(results, output, formats):
    fig, (one, two, three) = style.figure(style.FULL, 62, 1, 3)
    law_1(one, results)
    against_hyperstaticity(two, results)
    law_2(three, results)
    style.panel(one, "a", r"rank $X_0$ counts, $\varepsilon = 10^{-6}\,W$")
    style.panel(two, "b", "isostatic on the left")
    style.panel(three, "c", "deluxe, 4 000 disks")
    return style.save(fig, output, "coarse-space", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
