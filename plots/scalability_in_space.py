#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Iterations in space that the radii predict, against the number of subdomains."""
import sys

import scalability
import style

STUDY = "scalability-in-space"
LATTICE, DEPOSIT = scalability.LATTICE, scalability.DEPOSIT
BLOCKS, SLICES = {"marker": "s"}, {"marker": "o"}


def draw(results, output, formats):
    fig, ((rigid, soft), (stiff, total)) = style.figure(style.COLUMN_AND_HALF, 130, 2, 2)
    for axes, epsilon in ((rigid, 0), (soft, 1e-2)):
        scalability.curves(results, axes, "lattice-blocks", epsilon, {**LATTICE, **BLOCKS}, study=STUDY)
        scalability.curves(results, axes, "lattice-slices", epsilon, {**LATTICE, **SLICES}, study=STUDY)
        scalability.curves(results, axes, "deposit-blocks", epsilon or 1e-6, {**DEPOSIT, **BLOCKS}, study=STUDY)
    for axes, epsilon in ((stiff, 0), (total, 1e-2)):
        scalability.curves(results, axes, "lattice-total", epsilon, {**LATTICE, **BLOCKS}, study=STUDY)
        scalability.curves(results, axes, "deposit-total", epsilon or 1e-6, {**DEPOSIT, **BLOCKS}, study=STUDY)
    for axes, limits in ((rigid, (1, 1e9)), (soft, (10, 1e5)), (stiff, (10, 1e6)), (total, (10, 1e5))):
        style.log_axis(axes.xaxis, 1.7, 75)
        axes.set_xticks([2, 4, 8, 16, 32, 64], labels=["2", "4", "8", "16", "32", "64"])
        axes.set_xticks([], minor=True)
        style.log_axis(axes.yaxis, *limits)
        axes.set(xlabel="number of subdomains", ylabel="iterations to $10^{-6}$")
    scalability.guide(rigid, [8, 32], 1.5e5, 4, "slope 4", (8.5, 4e6))
    scalability.guide(rigid, [8, 64], 14, 2 / 3, "slope 2/3", (20, 7))
    near_rigid = r"rigid; deposits $\varepsilon = 10^{-6}$"
    texts = [f"fixed size, {near_rigid}", r"fixed size, $\varepsilon = 10^{-2}$ 1/kg", f"4 096 spheres, {near_rigid}",
             r"4 096 spheres, $\varepsilon = 10^{-2}$ 1/kg"]
    for axes, letter, text in zip((rigid, soft, stiff, total), "abcd", texts):
        style.panel(axes, letter, text)
    key = [("lattice (fcc)", {**LATTICE}), ("deposit", {**DEPOSIT})]
    key += [(text, {"color": "black", "linestyle": "none", **mark})
            for text, mark in (("blocks", BLOCKS), ("slices", SLICES))]
    key += [("generic", {"color": "black", "linestyle": scalability.GENERIC_LINE}),
            (r"enriched, $\eta = 0.1$ 1/kg", {"color": "black", "linestyle": scalability.ENRICHED_LINE})]
    handles = [rigid.plot([], [], **look)[0] for _, look in key]
    style.legend_above(fig, handles, [text for text, _ in key], 3)
    return style.save(fig, output, STUDY, formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
