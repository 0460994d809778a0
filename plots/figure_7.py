#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 7: spectral radius of the nonsmooth case against eta."""
import sys

import numpy as np
import style

TICKS = [0.4, 0.6, 0.8, 1, 2, 4, 6, 10]


def draw(results, output, formats):
    rows, span = style.read_radii(results, "figure-7/radius.csv", "eta")
    fig, axes = style.figure(style.COLUMN, 76)
    limit = style.log_axis(axes.xaxis, *span, "∞", "high")
    style.log_axis(axes.yaxis, 0.33, 11)
    axes.set_yticks(TICKS, labels=[f"{v:g}" for v in TICKS])
    style.convergence_limit(axes)
    for disks, own in style.by_case(rows):
        look = style.case_style(disks)
        axes.plot(*style.curve(own, "eta"), **look)
        style.band(axes, own, "eta", disks)
        best = min(style.finite(own, "eta"), key=lambda row: row["spectral_radius"])
        style.points(axes, best["eta"], best["spectral_radius"], disks)
        for generic in style.radii(own, eta=np.inf):
            axes.axhline(generic, **{**look, "label": None, "linewidth": 0.7, "zorder": 1})
            style.limit_points(axes, limit, [generic], disks)
    handles, labels = axes.get_legend_handles_labels()
    handles += axes.plot([], [], "ko", markersize=4.2) + axes.plot([], [], "k-", linewidth=0.7)
    labels += [r"smallest $\rho(\bar B_\eta)$ of the sweep", r"generic $\rho(\bar B)$, $\eta = \infty$"]
    axes.legend(handles, labels, loc="upper right")
    axes.set(xlabel=style.ETA_LABEL, ylabel=r"spectral radius $\rho(\bar B_\eta)$")
    return style.save(fig, output, "figure-7", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
