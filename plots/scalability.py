#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Iterations that the radii predict, against the number of subdomains."""
import os
import sys

import numpy as np
import style

BLUE, RED = "#1f5f99", "#b03a2e"
LATTICE, DEPOSIT = {"color": BLUE}, {"color": RED}
STRIPS, GRIDS = {"marker": "o"}, {"marker": "s"}
ENRICHED = 0.1  # 1/kg, the finite eta of the tables
COLUMNS = "subdomains epsilon eta subdominant_radius"
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


def is_strip(row):
    return "1" in row["partition.grid"].split(",")


def rows_of(results, tables, study):
    """Rows of the tables (names, space-separated), of those that are run on demand only where they are."""
    rows = []
    for name in (f"{study}/{table}.csv" for table in tables.split()):
        if not name.endswith("-large.csv") or os.path.exists(os.path.join(results, name)):
            rows += style.read_table(results, name, numbers=COLUMNS, texts="partition.grid")
    return rows


def curves(results, axes, tables, epsilon, look, cuts="all", study="scalability"):
    """Both algorithms of the tables; CUTS: their strips, their grids, or all rows."""
    rows = rows_of(results, tables, study)
    if cuts != "all":
        rows = [row for row in rows if is_strip(row) == (cuts == "strips")]
    for eta, line, face in ((np.inf, GENERIC_LINE, {}), (ENRICHED, ENRICHED_LINE, {"markerfacecolor": "white"})):
        some = style.where(rows, epsilon=epsilon, eta=eta)
        if not tables.endswith("-large"):
            style.need(results, f"{study}/{tables}.csv", rows, epsilon=epsilon, eta=eta)
        axes.plot(style.column(some, "subdomains"), style.iterations(some), **{"linestyle": line, **look, **face})


def smaller_etas(results, axes):
    """Strips of rigid lattice at flexibilities below that of the other curves, labelled at their ends."""
    name = "scalability/lattice-strips-eta.csv"
    rows = style.read_table(results, name, numbers=COLUMNS)
    for eta in sorted(set(style.column(rows, "eta"))):
        some = style.where(rows, eta=eta)
        count = style.iterations(some)
        axes.plot(style.column(some, "subdomains"), count, linestyle=ENRICHED_LINE, linewidth=0.7, **LATTICE)
        axes.annotate(rf"$\eta = 10^{{{np.log10(eta):.0f}}}$", (some[-1]["subdomains"], count[-1]), (4, -5 if count[-1] < 1e4 else -2),
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


def fixed_size(results, lattice, deposit, soft):
    curves(results, lattice, "lattice-strips", 0, {**LATTICE, **STRIPS})
    curves(results, lattice, "lattice-grids", 0, {**LATTICE, **GRIDS})
    smaller_etas(results, lattice)
    curves(results, deposit, "deposit-strips", 1e-6, {**DEPOSIT, **STRIPS})
    curves(results, deposit, "deposit-grids", 1e-6, {**DEPOSIT, **GRIDS})
    for table, look in (("lattice-strips", {**LATTICE, **STRIPS}), ("lattice-grids-flexible", {**LATTICE, **GRIDS}),
                        ("deposit-strips", {**DEPOSIT, **STRIPS}), ("deposit-grids", {**DEPOSIT, **GRIDS})):
        curves(results, soft, table, 1e-2, look)


def fixed_total(results, stiff, soft):
    for cuts, look in (("strips", STRIPS), ("grids", GRIDS)):
        curves(results, stiff, "lattice-total-rigid lattice-total-rigid-strips", 0, {**LATTICE, **look}, cuts)
        curves(results, soft, "lattice-total-100k-large", 1e-2, {**LATTICE, **look}, cuts)
        curves(results, soft, "deposit-total-100k deposit-total-100k-large", 1e-2, {**DEPOSIT, **look}, cuts)
    curves(results, stiff, "deposit-total-strips", 1e-6, {**DEPOSIT, **STRIPS})
    curves(results, stiff, "deposit-total", 1e-6, {**DEPOSIT, **GRIDS})
    # 4 096 grains beside the 10^5: without marks
    for packing, colour in (("lattice", LATTICE), ("deposit", DEPOSIT)):
        for table in (f"{packing}-total", f"{packing}-total-strips"):
            curves(results, soft, table, 1e-2, {**colour, "linewidth": 0.5, "alpha": 0.7})
        # 10^6: crosses, upright of strips
        for cuts, mark in (("strips", "+"), ("grids", "x")):
            curves(results, soft, f"{packing}-total-1m-large", 1e-2,
                   {**colour, "linestyle": "none", "marker": mark, "markersize": 7, "markeredgewidth": 1}, cuts)


def sizes_of_total(results):
    millions = os.path.exists(os.path.join(results, "scalability/deposit-total-1m-large.csv"))
    return r"$10^5$ grains (thin: 4 096" + (r", +$\times$: $10^6$)" if millions else ")") + r", $\varepsilon = 10^{-2}$"


def draw(results, output, formats):
    fig, grid = style.figure(style.COLUMN_AND_HALF, 185, 3, 2)
    (lattice, deposit), (soft, stiff), (total, best) = grid
    fixed_size(results, lattice, deposit, soft)
    fixed_total(results, stiff, total)
    nonsmooth(results, best)
    for axes, limits in ((lattice, (1, 1e9)), (deposit, (100, 1e7)), (soft, (10, 1e5)), (stiff, (10, 1e7)),
                         (total, (10, 1e5)), (best, (10, 1e8))):
        style.log_axis(axes.xaxis, 1.7, 250 if axes is lattice else 75)
        axes.set_xticks([2, 4, 8, 16, 32, 64], labels=["2", "4", "8", "16", "32", "64"])
        axes.set_xticks([], minor=True)
        style.log_axis(axes.yaxis, *limits)
        axes.set(xlabel="number of subdomains", ylabel="iterations to $10^{-6}$")
    guide(lattice, [8, 32], 4e5, 4, "slope 4", (8.5, 1e7))
    guide(deposit, [8, 48], 1.3e5, 1.5, "slope 1.5", (8, 5e5))
    guide(best, [8, 48], 3e2, 2, "slope 2", (26, 1.2e3))
    texts = [r"fixed size, rigid ($\eta$ in 1/kg)", r"fixed size, $\varepsilon = 10^{-6}$ 1/kg",
             r"fixed size, $\varepsilon = 10^{-2}$ 1/kg", r"4 096 grains, rigid; $\varepsilon = 10^{-6}$ 1/kg",
             sizes_of_total(results), "strip of disks, nonsmooth"]
    for axes, letter, text in zip(grid.flat, "abcdef", texts):
        style.panel(axes, letter, text)
    key = [("lattice", {**LATTICE}), ("deposit", {**DEPOSIT})]
    key += [(text, {"color": "black", "linestyle": "none", **mark})
            for text, mark in (("strips", STRIPS), ("grids", GRIDS))]
    key += [("generic", {"color": "black", "linestyle": GENERIC_LINE}),
            (r"enriched, $\eta = 0.1$ 1/kg", {"color": "black", "linestyle": ENRICHED_LINE})]
    handles = [lattice.plot([], [], **look)[0] for _, look in key]
    style.legend_above(fig, handles, [text for text, _ in key], 3)
    return style.save(fig, output, "scalability", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
