#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Radii from a lattice through vacancies to polydisperse deposits, and whether the size matters."""
import os
import sys

import numpy as np
import style

BLUE, RED = "#1f5f99", "#b03a2e"
TABLES = [("vacancies", "lattice with vacancies", {"color": BLUE, "marker": "o"}),
          ("deposit", "deposits", {"color": RED, "marker": "s"})]
SMALLEST = 0.1  # m, radius_min of the deposits
ENRICHED = 0.1  # 1/kg, the finite eta of the tables
STIFF = (1e-4, 1e-2)
# endings of the tables of 1 024, 4 096, 16 384 and 10^5 grains, and of what is run on demand only
SIZES = ("-1k", "", "-16k", "-100k", "-100k-large", "-1m-large")
# parameter, the packings followed through the sizes: value, label, look
FOLLOWED = {
    "vacancies": ("packing.vacancies", [(0, "lattice", {"color": "#123c63", "marker": "o"}),
                                        (0.1, "10 % vacancies", {"color": BLUE, "marker": "^"}),
                                        (0.25, "25 % vacancies", {"color": "#6ea6d8", "marker": "v"})]),
    "deposit": ("packing.radius_max", [(0.1, "deposit, one size", {"color": "#e08a80", "marker": "D"}),
                                       (0.2, "deposit, 1 : 2", {"color": RED, "marker": "s"}),
                                       (0.8, "deposit, 1 : 8", {"color": "#6e1d15", "marker": "p"})]),
}
GENERIC_LINE, ENRICHED_LINE = "-", (0, (4, 2))


def coordination(rows):
    return 2 * style.column(rows, "contacts") / style.column(rows, "grains")


def size_ratio(rows):
    return style.column(rows, "packing.radius_max") / SMALLEST


def gap(rows):
    return 1 - style.column(rows, "subdominant_radius")


def scatter(axes, x, rows, look, eta):
    face = look["color"] if np.isinf(eta) else "white"
    return axes.plot(x, gap(rows), linestyle="none", markerfacecolor=face, markeredgewidth=0.7, **look)[0]


def of_4096(results, rigid, stiff, sizes):
    """The panels of one size; handles and labels of their marks."""
    handles, labels = [], []
    for table, label, look in TABLES:
        name = f"disorder/{table}.csv"
        own = " packing.radius_max" if table == "deposit" else ""
        rows = style.read_table(results, name, numbers="grains contacts epsilon eta subdominant_radius" + own)
        for eta, text in ((np.inf, "generic"), (ENRICHED, r"enriched, $\eta = 0.1$ 1/kg")):
            some = style.need(results, name, rows, epsilon=0, eta=eta)
            handles.append(scatter(rigid, coordination(some), some, look, eta))
            labels.append(f"{label}, {text}")
            if own:
                scatter(sizes, size_ratio(some), some, look, eta)
            for epsilon in STIFF:
                some = style.need(results, name, rows, epsilon=epsilon, eta=eta)
                scatter(stiff, coordination(some), some, look, eta)
    for epsilon, text in zip(STIFF, ("10^{-4}", "10^{-2}")):
        stiff.axhline(epsilon / ENRICHED, color=style.GREY, linewidth=0.6, zorder=0.5)
        stiff.text(6.15, epsilon / ENRICHED / 1.2, rf"$\varepsilon/\eta$, $\varepsilon = {text}$", fontsize=7,
                   ha="right", va="top")
    return handles, labels


def through_sizes(results, panels):
    """Geometric mean of 1 - rho over the seeds, with its range, against the number of grains; PANELS: axes of each
    epsilon."""
    for table, (parameter, packings) in FOLLOWED.items():
        rows = []
        for name in (f"disorder/{table}{size}.csv" for size in SIZES):
            if "large" not in name or os.path.exists(os.path.join(results, name)):
                rows += style.read_table(results, name, numbers=f"grains epsilon eta subdominant_radius {parameter}")
        for value, label, look in packings:
            for epsilon, axes in panels.items():
                for eta, line in ((np.inf, GENERIC_LINE), (ENRICHED, ENRICHED_LINE)):
                    some = style.need(results, f"disorder/{table}.csv", rows, epsilon=epsilon, eta=eta,
                                      **{parameter: value})
                    grains, mean, low, high = by_size(some)
                    face = look["color"] if np.isinf(eta) else "white"
                    axes.errorbar(grains, mean, yerr=(mean - low, high - mean), linestyle=line, elinewidth=0.6,
                                  linewidth=0.9, markersize=3.6, markeredgewidth=0.7, markerfacecolor=face,
                                  label=label if np.isinf(eta) else None, **look)


def by_millions(results):
    return os.path.exists(os.path.join(results, "disorder/deposit-1m-large.csv"))


def by_size(rows):
    """Numbers of grains, and of each the geometric mean, the least and the largest 1 - rho."""
    result = []
    for grains in sorted(set(style.column(rows, "grains"))):
        values = gap(style.where(rows, grains=grains))
        mean = np.clip(np.exp(np.mean(np.log(values))), values.min(), values.max())  # equal values, rounded
        result.append((grains, mean, values.min(), values.max()))
    return np.array(result).T


def draw(results, output, formats):
    fig, ((rigid, stiff, sizes), below) = style.figure(style.COLUMN_AND_HALF, 128, 2, 3)
    handles, labels = of_4096(results, rigid, stiff, sizes)
    for axes in (rigid, stiff):
        axes.axvline(4, color=style.LIGHT, linewidth=0.6, zorder=0.4)  # isostatic
        axes.set(xlabel="coordination number", xlim=(3.7, 6.2))
    style.log_axis(sizes.xaxis, 0.9, 9)
    sizes.set_xticks([1, 2, 4, 8], labels=["1", "2", "4", "8"])
    sizes.set_xticks([], minor=True)
    sizes.set_xlabel("largest / smallest radius")
    through_sizes(results, dict(zip((0, *STIFF), below)))
    for axes in below:
        style.log_axis(axes.xaxis, 500, 2e6 if by_millions(results) else 2e5)
        axes.set_xlabel("number of grains")
    texts = ["4 096 grains, rigid", r"$\varepsilon = 10^{-4}$, $10^{-2}$ 1/kg", "deposits, rigid",
             "rigid contacts", r"$\varepsilon = 10^{-4}$ 1/kg", r"$\varepsilon = 10^{-2}$ 1/kg"]
    for axes, letter, text in zip((rigid, stiff, sizes, *below), "abcdef", texts):
        style.log_axis(axes.yaxis, 1e-6 if axes is below[0] else 1e-5, 1)
        style.panel(axes, letter, text)
    for axes in (rigid, below[0]):
        axes.set_ylabel(r"$1 - \rho$")
    below[1].legend(loc="upper right", fontsize=7, labelspacing=0.15, handlelength=2, borderaxespad=0.3)
    style.legend_above(fig, handles, labels, 2)
    return style.save(fig, output, "disorder", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
