#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grid against METIS: size of the interface and radii."""
import os
import sys

import numpy as np
import style

ENRICHED = 0.1  # 1/kg, the finite eta of the tables
EPSILON = 1e-2
PACKINGS = [("lattice", "#1f5f99"), ("deposit", "#b03a2e")]
CUTS = [("blocks", "grid, blocks", {"marker": "s", "linestyle": "-"}),
        ("strips", "grid, strips", {"marker": "^", "linestyle": (0, (1, 1.3))}),
        ("metis", "METIS, by seed", {"marker": "o", "linestyle": "none", "markerfacecolor": "white"})]
PARTS = [(4, {"linestyle": (0, (1, 1.3))}), (16, {"linestyle": (0, (4, 2))}), (64, {"linestyle": "-"})]
# endings of the tables of 1 024, 4 096 and 10^5 grains, and of what is run on demand only
SIZES = ("-1k", "", "-100k", "-100k-large", "-1m-large")
COLUMNS = "grains subdomains interface_dofs epsilon eta subdominant_radius"


def cuts(results, packing, size=""):
    """Rows of each way to cut at the flexibility EPSILON."""
    name = f"partition/{packing}-grid{size}.csv"
    rows = style.read_table(results, name, numbers=COLUMNS, texts="partition.grid")
    rows = style.need(results, name, rows, epsilon=EPSILON)
    strips = [row for row in rows if row["partition.grid"].endswith(",1")]
    blocks = [row for row in rows if not row["partition.grid"].endswith(",1")]
    name = f"partition/{packing}-metis{size}.csv"
    metis = style.need(results, name, style.read_table(results, name, numbers=COLUMNS), epsilon=EPSILON)
    return {"blocks": blocks, "strips": strips, "metis": metis}


def interface(rows):
    return style.column(rows, "interface_dofs")


def gap(rows):
    return 1 - style.column(rows, "subdominant_radius")


def by_millions(results):
    return os.path.exists(os.path.join(results, "partition/deposit-grid-1m-large.csv"))


def of_4096(results, size, generic, enriched):
    for packing, colour in PACKINGS:
        for kind, rows in cuts(results, packing).items():
            look = {"color": colour, **next(look for cut, _, look in CUTS if cut == kind)}
            for axes, eta, value in ((size, np.inf, interface), (generic, np.inf, gap), (enriched, ENRICHED, gap)):
                some = style.where(rows, eta=eta)
                axes.plot(style.column(some, "subdomains"), value(some), **look)


def metis_over_blocks(results, size, generic, enriched):
    """Values of METIS over those of blocks against the number of grains, one mark per seed, a line for each
    number of subdomains (through the geometric means)."""
    for packing, colour in PACKINGS:
        found = [cuts(results, packing, ending) for ending in SIZES
                 if os.path.exists(os.path.join(results, f"partition/{packing}-grid{ending}.csv"))]
        blocks, metis = (sum((one[kind] for one in found), []) for kind in ("blocks", "metis"))
        for parts, look in PARTS:
            for axes, eta, value in ((size, np.inf, interface), (generic, np.inf, gap), (enriched, ENRICHED, gap)):
                means = []
                for grains in sorted({row["grains"] for row in blocks}):
                    where = {"grains": grains, "subdomains": parts, "eta": eta}
                    if not style.where(blocks, **where):
                        continue
                    ratio = value(style.where(metis, **where)) / value(style.where(blocks, **where))
                    axes.plot(np.full(len(ratio), grains), ratio, linestyle="none", marker="o", markersize=2.6,
                              markerfacecolor="white", markeredgewidth=0.6, color=colour)
                    means.append((grains, np.exp(np.mean(np.log(ratio)))))
                axes.plot(*np.array(means).T, color=colour, linewidth=0.9, **look)


def draw(results, output, formats):
    fig, ((size, generic, enriched), below) = style.figure(style.COLUMN_AND_HALF, 122, 2, 3)
    of_4096(results, size, generic, enriched)
    metis_over_blocks(results, *below)
    for axes, limits, label in ((size, (100, 4000), "interface unknowns"), (generic, (1e-3, 0.03), r"$1 - \rho$"),
                                (enriched, (0.05, 0.3), r"$1 - \rho$")):
        style.log_axis(axes.xaxis, 2.8, 92)
        axes.set_xticks([4, 16, 64], labels=["4", "16", "64"])
        axes.set_xticks([], minor=True)
        style.log_axis(axes.yaxis, *limits)
        axes.set(xlabel="number of subdomains", ylabel=label)
    enriched.set_yticks([0.05, 0.1, 0.2, 0.3], labels=["0.05", "0.1", "0.2", "0.3"])
    enriched.axhline(EPSILON / ENRICHED, color=style.GREY, linewidth=0.6, zorder=0.5)
    enriched.text(80, 0.097, r"$\varepsilon/\eta$", fontsize=7, ha="right", va="top")
    for axes, label, limits in zip(below, ("unknowns", r"$1 - \rho$", r"$1 - \rho$"),
                                   ((0.9, 1.3), (0.8, 1.8), (0.9, 1.3))):
        style.log_axis(axes.xaxis, 500, 2e6 if by_millions(results) else 2e5)
        axes.axhline(1, color=style.GREY, linewidth=0.6, zorder=0.5)
        axes.set(xlabel="number of grains", ylabel=f"{label}, METIS / blocks", ylim=limits)
    texts = ["4 096 grains", r"generic, $\varepsilon = 10^{-2}$ 1/kg", r"enriched, $\eta = 0.1$ 1/kg",
             "by size", r"generic, $\varepsilon = 10^{-2}$ 1/kg", r"enriched, $\eta = 0.1$ 1/kg"]
    for axes, letter, text in zip((size, generic, enriched, *below), "abcdef", texts):
        style.panel(axes, letter, text)
    below[0].legend([below[0].plot([], [], color="black", linewidth=0.9, **look)[0] for _, look in PARTS],
                    [f"{parts} subdomains" for parts, _ in PARTS], loc="upper right", fontsize=7)
    handles = [size.plot([], [], color=colour, linewidth=3)[0] for _, colour in PACKINGS]
    handles += [size.plot([], [], color="black", **look)[0] for _, _, look in CUTS]
    style.legend_above(fig, handles, [*[p for p, _ in PACKINGS], *[label for _, label, _ in CUTS]], 5)
    return style.save(fig, output, "partition", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
