#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Radii and best flexibility against the number of grains, 2 x 2 subdomains."""
import os
import sys

import numpy as np
import style

BLUE, RED = "#1f5f99", "#b03a2e"
PACKINGS = {"lattice": {"color": BLUE, "marker": "o"}, "deposit": {"color": RED, "marker": "s"}}
ENRICHED = 0.1  # 1/kg, the finite eta of the tables
GENERIC_LINE, ENRICHED_LINE = "-", (0, (4, 2))


def open_marker(look):
    return {**look, "markerfacecolor": "white"}


def gap(rows, name="subdominant_radius"):
    """1 - rho."""
    return 1 - style.column(rows, name)


def against_grains(axes, rows, y, **look):
    axes.plot(style.column(rows, "grains"), y, **look)


def linear_panels(results, rigid, stiff):
    for packing, look in PACKINGS.items():
        for axes, name, epsilons in ((rigid, f"size/rigid-{packing}.csv", [0]),
                                     (stiff, f"size/{packing}.csv", [1e-4, 1e-2])):
            numbers = "grains epsilon eta subdominant_radius"
            rows = style.read_table(results, name, numbers=numbers)
            beyond = f"size/rigid-{packing}-100k-large.csv"  # run on demand only
            if axes is rigid and os.path.exists(os.path.join(results, beyond)):
                rows += style.read_table(results, beyond, numbers=numbers)
            for epsilon in epsilons:
                for eta, line, change in ((np.inf, GENERIC_LINE, dict), (ENRICHED, ENRICHED_LINE, open_marker)):
                    some = style.need(results, name, rows, epsilon=epsilon, eta=eta)
                    against_grains(axes, some, gap(some), linestyle=line, **change(look))
        large = f"size/{packing}-large.csv"  # run on demand only
        if os.path.exists(os.path.join(results, large)):
            rows = style.read_table(results, large, numbers="grains subdominant_radius")
            against_grains(stiff, rows, gap(rows), linestyle="none", **look)
    # lambda >= epsilon/eta whatever the packing
    for epsilon in (1e-4, 1e-2):
        stiff.axhline(epsilon / ENRICHED, color=style.GREY, linewidth=0.6, zorder=0.5)
    for x, y, text in ((1.5e6, 0.105, r"$10^{-2}$"), (1.5e6, 1.1e-3, r"$10^{-4}$")):
        stiff.annotate(rf"$\varepsilon/\eta$, $\varepsilon=${text}", (x, y), (0, -8), textcoords="offset points",
                       fontsize=7, ha="right", color="0.35")


def nonsmooth_panels(results, radii, etas):
    for packing, look in PACKINGS.items():
        rows = []
        for name in (f"size/best-{packing}.csv", f"size/best-{packing}-large.csv"):
            if "large" not in name or os.path.exists(os.path.join(results, name)):  # run on demand only
                rows += style.read_table(results, name,
                                         numbers="grains generic_radius best_radius best_eta convergent_from")
        against_grains(radii, rows, gap(rows, "generic_radius"), linestyle=GENERIC_LINE, **look)
        against_grains(radii, rows, gap(rows, "best_radius"), linestyle=ENRICHED_LINE, **open_marker(look))
        against_grains(etas, rows, style.column(rows, "best_eta"), linestyle=ENRICHED_LINE, **open_marker(look))
        against_grains(etas, rows, style.column(rows, "convergent_from"), color=look["color"],
                       linestyle=(0, (1, 1.3)))
    etas.set(ylim=(0, 3.9), ylabel=rf"$\eta$ ${style.FLEXIBILITY}$")


def draw(results, output, formats):
    fig, grid = style.figure(style.COLUMN_AND_HALF, 122, 2, 2)
    (rigid, stiff), (radii, etas) = grid
    linear_panels(results, rigid, stiff)
    nonsmooth_panels(results, radii, etas)
    for axes, limits in ((rigid, (150, 2e5)), (stiff, (600, 1.7e6)), (radii, (40, 2e5)), (etas, (40, 2e5))):
        style.log_axis(axes.xaxis, *limits)
        axes.set_xlabel("number of grains")
    for axes, limits in ((rigid, (1e-7, 1)), (stiff, (1e-5, 1)), (radii, (5e-4, 0.3))):
        style.log_axis(axes.yaxis, *limits)
        axes.set_ylabel(r"$1 - \rho$")
    guide = np.array([1.5e3, 8e3])
    rigid.plot(8 * guide, 0.11 * (guide / guide[0])**-0.5, color=style.GREY, linewidth=0.6)
    rigid.text(2.2e4, 0.095, "slope $-1/2$", fontsize=7, ha="left", va="bottom")
    rigid.plot(guide, 5e-5 * (guide / guide[0])**-1.3, color=style.GREY, linewidth=0.6)
    rigid.text(2.6e3, 1.7e-5, "slope $-1.3$", fontsize=7, ha="right", va="top")
    texts = [r"rigid contacts, $\eta = 0.1$ 1/kg", r"$\eta = 0.1$, $\varepsilon = 10^{-2}$ and $10^{-4}$ 1/kg",
             "nonsmooth, best $\\eta$", r"best $\eta$; dots: diverges below"]
    for axes, letter, text in zip(grid.flat, "abcd", texts):
        style.panel(axes, letter, text)
    handles, labels = [], []
    for packing, look in PACKINGS.items():
        handles += rigid.plot([], [], linestyle=GENERIC_LINE, **look)
        handles += rigid.plot([], [], linestyle=ENRICHED_LINE, **open_marker(look))
        labels += [f"{packing}, generic", f"{packing}, enriched"]
    style.legend_above(fig, handles, labels, 4)
    return style.save(fig, output, "size", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
