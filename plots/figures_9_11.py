#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 9 and 11: indicators of convergence against iterations of a step with friction."""
import os
import sys

import style


def loglog(axes, rows):
    last = max(r["iteration"] for r in rows)
    style.log_axis(axes.xaxis, 1, last)
    axes.set_yscale("log")
    axes.set_xlabel("iteration $i$")


def draw_one_9(results, output, formats, suffix=""):
    rows = style.read_table(results, f"figure-9/indicators{suffix}.csv", texts="case",
                            numbers="iteration zeta interface_change natural_map")
    fig, axes = style.figure(style.COLUMN, 66)
    loglog(axes, rows)
    for column, label, look in (("zeta", r"volume, $\zeta_i$ (39)", {"color": "black"}),
                                ("interface_change", "interface, $Z_i$ (40)",
                                 {"color": "#b03a2e", "linestyle": (0, (4.5, 1.8))}),
                                ("natural_map", "error of the contact law", {"color": style.GREY,
                                                                             "linestyle": (0, (1, 1.3))})):
        own = [r for r in rows if r[column] > 0]
        axes.plot(style.column(own, "iteration"), style.column(own, column), label=label, **look)
    axes.set_ylabel("indicator")
    axes.legend()
    return style.save(fig, output, f"figure-9{suffix}", formats)


def draw_9(results, output, formats):
    paths = draw_one_9(results, output, formats)
    if os.path.exists(os.path.join(results, "figure-9/indicators-large.csv")):  # run on demand only
        paths += draw_one_9(results, output, formats, "-large")
    return paths


def draw_11(results, output, formats):
    numbers = "iteration gauss_seidel_sweeps eta interface_change zeta"
    rows = style.read_table(results, "figure-11/generic.csv", texts="case algorithm", numbers=numbers)
    rows += style.read_table(results, "figure-11/enriched.csv", texts="case algorithm", numbers=numbers)
    sweeps = sorted({r["gauss_seidel_sweeps"] for r in rows})
    etas = sorted({r["eta"] for r in rows}, reverse=True)
    looks = [{"color": "black"}, {"color": "#1f5f99", "linestyle": (0, (4.5, 1.8))},
             {"color": "#b03a2e", "linestyle": (0, (1, 1.3)), "linewidth": 1.5},
             {"color": "#3d7a3d", "linestyle": (0, (5, 1.5, 1, 1.5))}]
    fig, grid = style.figure(style.COLUMN_AND_HALF, 70, 1, len(sweeps), sharey=True, squeeze=False)
    for axes, letter, n in zip(grid.flat, "abcdef", sweeps):
        loglog(axes, style.where(rows, gauss_seidel_sweeps=n))
        style.panel(axes, letter, rf"$n_{{\mathrm{{GS}}}} = {n:.0f}$")
        for eta, look in zip(etas, looks):
            own = [r for r in style.where(rows, gauss_seidel_sweeps=n, eta=eta)
                   if 0 < r["interface_change"] < 1e3]
            label = "generic" if eta == float("inf") else rf"enriched, $\eta = {eta:g}$ 1/kg"
            axes.plot(style.column(own, "iteration"), style.column(own, "interface_change"), label=label, **look)
    grid.flat[0].set_ylabel("interface indicator $Z_i$ (40)")
    style.legend_above(fig, *grid.flat[0].get_legend_handles_labels(), 4)
    return style.save(fig, output, "figure-11", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw_9, draw_11))
