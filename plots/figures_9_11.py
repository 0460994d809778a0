#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 9 and 11: indicators of convergence against iterations of a step with friction."""
import os
import sys

import style


SOLVERS = {"two_stage_newton": ("two-stage Newton", {"color": "#7a4a94", "linewidth": 1.3}),
           "two_stage_admm": ("two-stage ADMM", {"color": "#c77f0a", "linewidth": 1.3}),
           "auto": ("auto, undivided", {"color": "#7a4a94", "linestyle": (0, (1, 1)), "linewidth": 1.6}),
           "newton": ("Newton, undivided", {"color": "0.6", "linewidth": 1.1})}
PASSES = "iteration $i$; passes of contact solvers"


def loglog(axes, last):
    style.log_axis(axes.xaxis, 1, last)
    axes.set_yscale("log")
    axes.set_xlabel("iteration $i$")


def read_solvers(results, name):
    """Rows of contact solvers with `passes`, what compares with an iteration of Algorithm 1: a solve of Stage 2 or a
    sweep; undivided, a sweep or a factorisation."""
    rows = style.read_table(results, name, texts="case algorithm",
                            numbers="sweeps factorisations interface_iterations natural_map")
    for r in rows:
        sweeps = 0 if r["algorithm"] == "two_stage_admm" else r["sweeps"]
        cut = r["algorithm"].startswith("two_stage")
        r["passes"] = sweeps + r["interface_iterations" if cut else "factorisations"]
    return [r for r in rows if r["passes"] >= 1 and 0 < r["natural_map"] < 10]


def draw_solvers(axes, rows):
    for algorithm, (label, look) in SOLVERS.items():
        own = style.where(rows, algorithm=algorithm)
        if own:
            axes.plot(style.column(own, "passes"), style.column(own, "natural_map"), label=label, **look)


def draw_one_9(results, output, formats, suffix="", study="figure-9", name=None):
    """The figure NAME of the table STUDY/indicators SUFFIX.csv, by default called after it. Contact solvers are those
    of figure-9/solvers.csv, which go with its own indicators only."""
    rows = style.read_table(results, f"{study}/indicators{suffix}.csv", texts="case",
                            numbers="iteration zeta interface_change natural_map")
    solvers = [] if suffix or name else read_solvers(results, f"{study}/solvers.csv")
    fig, axes = style.figure(style.COLUMN, 92 if solvers else 66)
    loglog(axes, max([r["iteration"] for r in rows] + [1.2 * r["passes"] for r in solvers]))
    for column, label, look in (("zeta", r"volume, $\zeta_i$ (39)", {"color": "black"}),
                                ("interface_change", "interface, $Z_i$ (40)",
                                 {"color": "#b03a2e", "linestyle": (0, (4.5, 1.8))}),
                                ("natural_map", "error of the contact law", {"color": style.GREY,
                                                                             "linestyle": (0, (1, 1.3))})):
        own = [r for r in rows if r[column] > 0]
        axes.plot(style.column(own, "iteration"), style.column(own, column), label=label, **look)
    axes.set_ylabel("indicator")
    if solvers:
        draw_solvers(axes, solvers)
        axes.set_xlabel(PASSES)
        axes.set_ylabel("indicator; error of the contact law")
        style.legend_above(fig, *axes.get_legend_handles_labels(), 2)
    else:
        axes.legend()
    return style.save(fig, output, name or f"{study}{suffix}", formats)


def draw_9(results, output, formats):
    paths = draw_one_9(results, output, formats)
    if os.path.exists(os.path.join(results, "figure-9/indicators-large.csv")):  # run on demand only
        paths += draw_one_9(results, output, formats, "-large")
    return paths


def draw_11(results, output, formats, study="figure-11", name=None):
    numbers = "iteration gauss_seidel_sweeps eta interface_change natural_map"
    rows = style.read_table(results, f"{study}/generic.csv", texts="case algorithm", numbers=numbers)
    rows += style.read_table(results, f"{study}/enriched.csv", texts="case algorithm", numbers=numbers)
    solvers = [] if name else read_solvers(results, f"{study}/solvers.csv")
    sweeps = sorted({r["gauss_seidel_sweeps"] for r in rows})
    etas = sorted({r["eta"] for r in rows}, reverse=True)
    looks = [{"color": "black"}, {"color": "#1f5f99", "linestyle": (0, (4.5, 1.8))},
             {"color": "#b03a2e", "linestyle": (0, (1, 1.3)), "linewidth": 1.5},
             {"color": "#3d7a3d", "linestyle": (0, (5, 1.5, 1, 1.5))}]
    fig, (above, below) = style.figure(style.COLUMN_AND_HALF, 146, 2, len(sweeps), sharey="row", squeeze=False)
    for axes, letter, n in zip(above, "abcdef", sweeps):
        own = style.where(rows, gauss_seidel_sweeps=n)
        loglog(axes, max(r["iteration"] for r in own))
        style.panel(axes, letter, rf"$n_{{\mathrm{{GS}}}} = {n:.0f}$")
    for axes, letter, n in zip(below, "abcdef"[len(sweeps):], sweeps):
        own = style.where(rows, gauss_seidel_sweeps=n)
        loglog(axes, 1.2 * max([r["iteration"] for r in own] + [r["passes"] for r in solvers]))
        axes.set_xlabel(PASSES if solvers else "iteration $i$")
        style.panel(axes, letter, rf"$n_{{\mathrm{{GS}}}} = {n:.0f}$" + (", and contact solvers" if solvers else ""))
    for column, line in (("interface_change", above), ("natural_map", below)):
        for axes, n in zip(line, sweeps):
            for eta, look in zip(etas, looks):
                own = [r for r in style.where(rows, gauss_seidel_sweeps=n, eta=eta) if 0 < r[column] < 1e3]
                label = "generic" if eta == float("inf") else rf"enriched, $\eta = {eta:.2g}$ 1/kg"
                axes.plot(style.column(own, "iteration"), style.column(own, column), label=label, **look)
    for axes in below:
        draw_solvers(axes, solvers)
    above[0].set_ylabel("interface indicator $Z_i$ (40)")
    below[0].set_ylabel("error of the contact law")
    style.legend_above(fig, *below[0].get_legend_handles_labels(), 3)
    return style.save(fig, output, name or study, formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw_9, draw_11))
