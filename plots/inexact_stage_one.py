#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Spectral radius of one iteration with n_GS Gauss-Seidel sweeps in Stage 1, against n_GS."""
import sys

import numpy as np
import style


def name_of(eta):
    return r"generic, $\eta = \infty$" if np.isinf(eta) else rf"enriched, $\eta = {eta:g}$"


def draw(results, output, formats):
    rows, (fewest, most) = style.read_radii(results, "inexact-stage-one/radius.csv", "gauss_seidel_sweeps",
                                            "epsilon eta")
    epsilons = sorted({r["epsilon"] for r in rows})
    etas = sorted({r["eta"] for r in rows}, reverse=True)
    fig, grid = style.figure(style.COLUMN_AND_HALF, 55 * len(epsilons) + 8, len(epsilons), len(etas),
                             sharey=True, squeeze=False)
    combinations = [(epsilon, eta) for epsilon in epsilons for eta in etas]
    for axes, letter, (epsilon, eta) in zip(grid.flat, "abcdefghijkl", combinations):
        limit = style.log_axis(axes.xaxis, fewest / 1.15, most * 1.15, "∞", "high")
        axes.set_xticks([1, 10, 100, limit], labels=["1", "10", "100", r"$\infty$"])
        style.convergence_limit(axes)
        style.panel(axes, letter, rf"{name_of(eta)}; $\varepsilon = {epsilon:g}$")
        for disks, own in style.by_case(style.where(rows, epsilon=epsilon, eta=eta)):
            look = style.case_style(disks)
            axes.plot(*style.curve(own, "gauss_seidel_sweeps"), **look, marker="o", markersize=2.6)
            exact = style.radii(own, gauss_seidel_sweeps=np.inf)
            for radius in exact:
                axes.axhline(radius, **{**look, "label": None, "linewidth": 0.7, "zorder": 1})
            style.limit_points(axes, limit, exact, disks)
        axes.set_ylim(0, 1.5)
    for axes in grid[-1]:
        axes.set_xlabel(r"Gauss-Seidel sweeps $n_{\mathrm{GS}}$")
    for axes in grid[:, 0]:
        axes.set_ylabel(r"spectral radius $\rho(J_{n_{\mathrm{GS}}})$")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    handles += grid[0, 0].plot([], [], "k-o", markerfacecolor="white", linewidth=0.7)
    style.legend_above(fig, handles, [*labels, r"exact Stage 1: $\rho(B)$"], 4)
    return style.save(fig, output, "inexact-stage-one", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
