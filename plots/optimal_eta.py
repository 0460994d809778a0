#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Best flexibility of the enriched algorithm, and what it brings, against the number of disks."""
import sys

import numpy as np
import style

BLUE = "#1f5f99"
ALGORITHMS = [  # radius, its relaxation, label, look
    ("generic_radius", None, "generic", {"color": "black", "marker": "s", "linestyle": "-"}),
    ("generic_relaxed_radius", "generic_relaxation", "generic, relaxed",
     {"color": "black", "marker": "s", "markerfacecolor": "white", "linestyle": (0, (4, 2))}),
    ("best_radius", None, r"enriched, best $\eta$", {"color": BLUE, "marker": "o", "linestyle": "-"}),
    ("relaxed_best_radius", "relaxed_best_relaxation", r"enriched, relaxed, best $\eta$ and $\omega$",
     {"color": BLUE, "marker": "o", "markerfacecolor": "white", "linestyle": (0, (4, 2))}),
]
ETAS = [
    ("best_eta", r"best $\eta$", {"color": BLUE, "marker": "o", "linestyle": "-"}),
    ("relaxed_best_eta", r"best $\eta$, relaxed",
     {"color": BLUE, "marker": "o", "markerfacecolor": "white", "linestyle": (0, (4, 2))}),
    ("better_from", "better than generic above", {"color": "black", "linestyle": (0, (1, 1.3))}),
    ("convergent_from", r"convergent ($\rho < 1$) above", {"color": style.GREY, "linestyle": "-"}),
]
TICKS = [0.1, 0.2, 0.5, 1, 2, 5, 10]


def disks_axis(axes, disks):
    style.log_axis(axes.xaxis, disks.min() / 1.15, disks.max() * 1.15)
    axes.set_xticks(disks[np.isin(disks, 4 * 2**np.arange(9))], labels=[], minor=False)
    axes.set_xticklabels([f"{n:g}" for n in axes.get_xticks()])
    axes.set_xticks([], minor=True)


def draw(results, output, formats):
    names = [name for row in ALGORITHMS for name in row[:2] if name] + [row[0] for row in ETAS]
    rows = style.read_table(results, "optimal-eta/optimum.csv", numbers=" ".join(["grains", *names]))
    rows.sort(key=lambda row: row["grains"])
    disks = style.column(rows, "grains")
    fig, grid = style.figure(style.COLUMN_AND_HALF, 122, 2, 2)
    for axes in grid.flat:
        disks_axis(axes, disks)
    for axes in grid[1]:
        axes.set_xlabel("number of disks")
    for name, relaxation, label, look in ALGORITHMS:
        radius = style.column(rows, name)
        grid[0, 0].plot(disks, radius, label=label, **look)
        grid[0, 1].plot(disks, 1 - radius, **look)
        if relaxation:
            grid[1, 1].plot(disks, style.column(rows, relaxation), **look)
    grid[0, 0].set(ylim=(0.3, 1.03), ylabel=r"spectral radius $\rho$")
    style.convergence_limit(grid[0, 0])
    style.log_axis(grid[0, 1].yaxis, 0.01, 1)
    grid[0, 1].set_ylabel(r"$1 - \rho$")
    slope = np.array([16.0, 64.0])
    grid[0, 1].plot(slope, 0.85 / slope, color=style.GREY, linewidth=0.6)
    grid[0, 1].text(21, 0.03, "slope $-1$", fontsize=8, ha="right")
    low, high = 0.09, 12
    style.log_axis(grid[1, 0].yaxis, low, high)
    grid[1, 0].set_yticks(TICKS, labels=[f"{v:g}" for v in TICKS])
    for name, label, look in ETAS:
        eta = style.column(rows, name)
        grid[1, 0].plot(disks, np.where(np.isfinite(eta), eta, np.nan), label=label, **look)
        for n in disks[np.isinf(eta)]:  # no finite eta beats the generic algorithm
            grid[1, 0].plot(n, high / 1.25, "^", color=look["color"], markerfacecolor="white", zorder=6)
            grid[1, 0].annotate(r"$\infty$", (n, high / 1.25), (5, 0), textcoords="offset points",
                                va="center", color=look["color"])
    grid[1, 0].set_ylabel(rf"$\eta$ ${style.FLEXIBILITY}$")
    grid[1, 0].legend(loc="upper right")
    grid[1, 1].set(ylabel=r"relaxation $\omega$", ylim=(0, 2.7))
    grid[1, 1].axhline(1, color=style.GREY, linewidth=0.6, zorder=0.5)
    for axes, letter in zip(grid.flat, "abcd"):
        style.panel(axes, letter)
    style.legend_above(fig, *grid[0, 0].get_legend_handles_labels(), 4)
    return style.save(fig, output, "optimal-eta", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
