#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grid against METIS: size of the interface and radii."""
import sys

import numpy as np
import style

ENRICHED = 0.1  # 1/kg, the finite eta of the tables
EPSILON = 1e-2
PACKINGS = [("lattice", "#1f5f99"), ("deposit", "#b03a2e")]
CUTS = [("blocks", "grid, blocks", {"marker": "s", "linestyle": "-"}),
        ("strips", "grid, strips", {"marker": "^", "linestyle": (0, (1, 1.3))}),
        ("metis", "METIS, three seeds", {"marker": "o", "linestyle": "none", "markerfacecolor": "white"})]
COLUMNS = "subdomains interface_dofs epsilon eta subdominant_radius"


def cuts(results, packing):
    """Rows of each way to cut at the flexibility EPSILON."""
    name = f"partition/{packing}-grid.csv"
    rows = style.read_table(results, name, numbers=COLUMNS, texts="partition.grid")
    rows = style.need(results, name, rows, epsilon=EPSILON)
    strips = [row for row in rows if row["partition.grid"].endswith(",1")]
    blocks = [row for row in rows if not row["partition.grid"].endswith(",1")]
    name = f"partition/{packing}-metis.csv"
    metis = style.need(results, name, style.read_table(results, name, numbers=COLUMNS), epsilon=EPSILON)
    return {"blocks": blocks, "strips": strips, "metis": metis}


def draw(results, output, formats):
    fig, (size, generic, enriched) = style.figure(style.COLUMN_AND_HALF, 66, 1, 3)
    for packing, colour in PACKINGS:
        for kind, rows in cuts(results, packing).items():
            look = {"color": colour, **next(look for cut, _, look in CUTS if cut == kind)}
            for axes, eta in ((generic, np.inf), (enriched, ENRICHED)):
                some = style.where(rows, eta=eta)
                axes.plot(style.column(some, "subdomains"), 1 - style.column(some, "subdominant_radius"), **look)
            some = style.where(rows, eta=np.inf)
            size.plot(style.column(some, "subdomains"), style.column(some, "interface_dofs"), **look)
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
    for axes, letter, text in zip((size, generic, enriched), "abc",
                                  ("size", r"generic, $\varepsilon = 10^{-2}$ 1/kg", r"enriched, $\eta = 0.1$ 1/kg")):
        style.panel(axes, letter, text)
    handles = [size.plot([], [], color=colour, linewidth=3)[0] for _, colour in PACKINGS]
    handles += [size.plot([], [], color="black", **look)[0] for _, _, look in CUTS]
    style.legend_above(fig, handles, [*[p for p, _ in PACKINGS], *[label for _, label, _ in CUTS]], 5)
    return style.save(fig, output, "partition", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
