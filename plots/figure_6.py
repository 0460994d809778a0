#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 6: spectral radius of the enriched algorithm against eta, for epsilon = 1 and epsilon = 0."""
import sys

import numpy as np
import style

TABLE = "figure-6/radius.csv"


def draw_panel(axes, rows, eta_range, floor=None):
    """Curves of one epsilon; on a log axis from FLOOR on where that is given."""
    limit = style.log_axis(axes.xaxis, *eta_range, "∞", "high", every=2)
    style.convergence_limit(axes)
    for disks, own in style.by_case(rows):
        eta, radius = style.curve(own, "eta")
        # rho = 0 is infinitely far down a log axis: let the curve leave the panel there
        axes.plot(eta, np.maximum(radius, floor / 3) if floor else radius, **style.case_style(disks))
        style.band(axes, own, "eta", disks, floor / 3 if floor else -np.inf)
        style.limit_points(axes, limit, style.radii(own, eta=np.inf), disks)


def draw(results, output, formats):
    rows, eta_range = style.read_radii(results, TABLE, "eta", "epsilon")
    one, zero = (style.need(results, TABLE, rows, epsilon=epsilon) for epsilon in (1, 0))
    # Linear axes as in the paper above; log axes below, where the largest and smallest radii show too.
    fig, grid = style.figure(style.COLUMN_AND_HALF, 118, 2, 2)
    for axes, own in zip(grid[0], (one, zero)):
        draw_panel(axes, own, eta_range)
        axes.set_ylim(-0.04, 1.12)
    for axes, own, low, high in zip(grid[1], (one, zero), (1e-2, 1e-5), (20, 3)):
        style.log_axis(axes.yaxis, low, high)
        draw_panel(axes, own, eta_range, low)
        axes.set_xlabel(style.ETA_LABEL)
    for axes, letter, epsilon in zip(grid.flat, "abcd", (1, 0, 1, 0)):
        style.panel(axes, letter, rf"$\varepsilon = {epsilon}$")
    for axes in grid[:, 0]:
        axes.set_ylabel(r"spectral radius $\rho(B_{\varepsilon,\eta})$")
    # eta = epsilon: one iteration is enough
    for row in style.where(one, eta=1):
        grid[0, 0].plot(1, row["spectral_radius"], "ko", zorder=6)
    for axes, height in ((grid[0, 0], 0.05), (grid[1, 0], 2e-2)):
        axes.text(4, height, r"$\eta = \varepsilon$: $\rho = 0$", fontsize=8, va="center")
    slope = np.array([eta_range[0], 3e-2])
    grid[1, 1].plot(slope, 0.15 * slope, color=style.GREY, linewidth=0.6)
    grid[1, 1].text(6e-3, 2.5e-4, r"$\propto \eta$")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    handles += grid[0, 0].plot([], [], "o", color="black", markerfacecolor="white", markeredgewidth=0.9)
    style.legend_above(fig, handles, [*labels, r"generic algorithm, $\eta = \infty$"], 4)
    return style.save(fig, output, "figure-6", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
