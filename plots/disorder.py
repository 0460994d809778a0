#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Radii from a lattice through vacancies to polydisperse deposits."""
import sys

import numpy as np
import style

TABLES = [("vacancies", "lattice with vacancies", {"color": "#1f5f99", "marker": "o"}),
          ("deposit", "deposits", {"color": "#b03a2e", "marker": "s"})]
SMALLEST = 0.1  # m, radius_min of the deposits
ENRICHED = 0.1  # 1/kg, the finite eta of the tables
STIFF = (1e-4, 1e-2)


def coordination(rows):
    return 2 * style.column(rows, "contacts") / style.column(rows, "grains")


def size_ratio(rows):
    return style.column(rows, "packing.radius_max") / SMALLEST


def scatter(axes, x, rows, look, eta):
    face = look["color"] if np.isinf(eta) else "white"
    return axes.plot(x, 1 - style.column(rows, "subdominant_radius"), linestyle="none", markerfacecolor=face,
                     markeredgewidth=0.7, **look)[0]


def draw(results, output, formats):
    fig, (rigid, stiff, sizes) = style.figure(style.COLUMN_AND_HALF, 72, 1, 3)
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
    for axes in (rigid, stiff):
        axes.axvline(4, color=style.LIGHT, linewidth=0.6, zorder=0.4)  # isostatic
        axes.set(xlabel="coordination number", xlim=(3.7, 6.2))
    style.log_axis(sizes.xaxis, 0.9, 9)
    sizes.set_xticks([1, 2, 4, 8], labels=["1", "2", "4", "8"])
    sizes.set_xticks([], minor=True)
    sizes.set_xlabel("largest / smallest radius")
    texts = ["rigid contacts", r"$\varepsilon = 10^{-4}$, $10^{-2}$ 1/kg", "deposits, rigid contacts"]
    for axes, letter, text in zip((rigid, stiff, sizes), "abc", texts):
        style.log_axis(axes.yaxis, 1e-5, 1)
        style.panel(axes, letter, text)
    rigid.set_ylabel(r"$1 - \rho$")
    style.legend_above(fig, handles, labels, 2)
    return style.save(fig, output, "disorder", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
