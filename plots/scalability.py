#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Iterations that the radii predict, against the number of subdomains."""
import sys

import numpy as np
import style

BLUE, RED = "#1f5f99", "#b03a2e"
LATTICE, DEPOSIT = {"color": BLUE}, {"color": RED}
ENRICHED = 0.1  # 1/kg, the finite eta of the tables
COLUMNS = "subdomains epsilon eta subdominant_radius"
# table, look, for each panel of the linear law
FIXED = [("lattice-strips", {**LATTICE, "marker": "o"}), ("lattice-grids", {**LATTICE, "marker": "s"}),
         ("deposit-strips", {**DEPOSIT, "marker": "o"}), ("deposit-grids", {**DEPOSIT, "marker": "s"})]
TOTAL = [("lattice-total", {**LATTICE, "marker": "^"}), ("deposit-total", {**DEPOSIT, "marker": "^"})]
GENERIC_LINE, ENRICHED_LINE = "-", (0, (4, 2))
ALGORITHMS = [  # radius of the table of optima, label, look
    ("generic_radius", "generic", {"color": "black", "linestyle": GENERIC_LINE, "marker": "o"}),
    ("generic_relaxed_radius", "generic, relaxed",
     {"color": style.GREY, "linestyle": GENERIC_LINE, "marker": "o", "markerfacecolor": "white"}),
    ("best_radius", r"enriched, best $\eta$", {"color": BLUE, "linestyle": ENRICHED_LINE, "marker": "s"}),
    ("relaxed_best_radius", r"enriched, relaxed, best $\eta$ and $\omega$",
     {"color": BLUE, "linestyle": ENRICHED_LINE, "marker": "s", "markerfacecolor": "white"}),
]


def conjugate_gradient(rows, radius):
    """Rate of conjugate gradients from that of the relaxed iteration: (k - 1)/(k + 1) = rho, k = sqrt(kappa)."""
    relaxed = style.column(rows, radius)
    root = np.sqrt((1 + relaxed) / (1 - relaxed))
    return (root - 1) / (root + 1)


def curves(results, axes, table, epsilon, look):
    name = f"scalability/{table}.csv"
    rows = style.read_table(results, name, numbers=COLUMNS)
    for eta, line, face in ((np.inf, GENERIC_LINE, {}), (ENRICHED, ENRICHED_LINE, {"markerfacecolor": "white"})):
        some = style.need(results, name, rows, epsilon=epsilon, eta=eta)
        axes.plot(style.column(some, "subdomains"), style.iterations(some), linestyle=line, **{**look, **face})


def smaller_etas(results, axes):
    """Strips of rigid lattice at flexibilities below that of the other curves, labelled at their ends."""
    name = "scalability/lattice-strips-eta.csv"
    rows = style.read_table(results, name, numbers=COLUMNS)
    for eta in sorted(set(style.column(rows, "eta"))):
        some = style.where(rows, eta=eta)
        count = style.iterations(some)
        axes.plot(style.column(some, "subdomains"), count, linestyle=ENRICHED_LINE, linewidth=0.7, **LATTICE)
        axes.annotate(rf"$\eta = 10^{{{np.log10(eta):.0f}}}$", (some[-1]["subdomains"], count[-1]), (4, -2),
                      textcoords="offset points", fontsize=7, color=LATTICE["color"])


def guide(axes, x, start, power, text, place):
    x = np.array(x)
    axes.plot(x, start * (x / x[0])**power, color=style.GREY, linewidth=0.6)
    axes.text(*place, text, fontsize=7)


def nonsmooth(results, axes):
    rows = style.read_table(results, "scalability/best-strip.csv",
                            numbers=" ".join(["subdomains", *[a[0] for a in ALGORITHMS]]))
    x = style.column(rows, "subdomains")
    for radius, label, look in ALGORITHMS:
        axes.plot(x, style.iterations(rows, radius=radius), label=label, **look)
    rate = conjugate_gradient(rows, "relaxed_best_radius")
    axes.plot(x, np.log(1e-6) / np.log(rate), color="#3d7a3d", marker="d", linestyle=(0, (1, 1.3)),
              label="conjugate gradients at that $\\eta$")
    axes.legend(loc="upper left", fontsize=7, labelspacing=0.2)


def draw(results, output, formats):
    fig, grid = style.figure(style.COLUMN_AND_HALF, 130, 2, 2)
    (lattice, deposit), (soft, best) = grid
    for table, look in FIXED[:2]:
        curves(results, lattice, table, 0, look)
    smaller_etas(results, lattice)
    for table, look in [*FIXED[2:], TOTAL[1]]:
        curves(results, deposit, table, 1e-6, look)
    for table, look in [FIXED[0], *FIXED[2:], *TOTAL]:
        curves(results, soft, table, 1e-2, look)
    nonsmooth(results, best)
    for axes, limits in ((lattice, (1, 1e9)), (deposit, (100, 1e7)), (soft, (10, 1e5)), (best, (10, 1e8))):
        style.log_axis(axes.xaxis, 1.7, 250 if axes is lattice else 75)
        axes.set_xticks([2, 4, 8, 16, 32, 64], labels=["2", "4", "8", "16", "32", "64"])
        axes.set_xticks([], minor=True)
        style.log_axis(axes.yaxis, *limits)
        axes.set(xlabel="number of subdomains", ylabel="iterations to $10^{-6}$")
    guide(lattice, [8, 32], 4e5, 4, "slope 4", (8.5, 1e7))
    guide(deposit, [8, 48], 1.3e5, 1.5, "slope 1.5", (8, 5e5))
    guide(best, [8, 48], 3e2, 2, "slope 2", (26, 1.2e3))
    texts = [r"lattice, rigid contacts ($\eta$ in 1/kg)", r"deposit, $\varepsilon = 10^{-6}$ 1/kg",
             r"both, $\varepsilon = 10^{-2}$ 1/kg", "strip of disks, nonsmooth"]
    for axes, letter, text in zip(grid.flat, "abcd", texts):
        style.panel(axes, letter, text)
    key = [("lattice", {**LATTICE}), ("deposit", {**DEPOSIT})]
    key += [(text, {"color": "black", "marker": mark, "linestyle": "none"})
            for text, mark in (("strips, fixed size each", "o"), ("grids, fixed size each", "s"),
                               ("grids, fixed total", "^"))]
    key += [("generic", {"color": "black", "linestyle": GENERIC_LINE}),
            (r"enriched, $\eta = 0.1$ 1/kg", {"color": "black", "linestyle": ENRICHED_LINE})]
    handles = [lattice.plot([], [], **look)[0] for _, look in key]
    style.legend_above(fig, handles, [text for text, _ in key], 4)
    return style.save(fig, output, "scalability", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
