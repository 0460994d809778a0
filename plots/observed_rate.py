#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rate observed in runs of Algorithm 1 against the spectral radius; their difference against its error."""
import sys

import numpy as np
import style
from matplotlib.lines import Line2D

MARKERS = {4: "^", 8: "s", 12: "o"}
RATES, DIFFERENCES = (0.03, 10), (1e-17, 1e-8)


def at(values, zero):
    """Sizes of the values, with those of zero put where the log axis has its tick for it."""
    values = np.abs(values)
    return np.where(values > 0, values, zero)


def draw(results, output, formats):
    rates = "predicted_rate observed_rate observed_rate_error difference"
    rows = style.read_table(results, "observed-rate/rate.csv", texts="case",
                            numbers=f"grains epsilon eta {rates}")
    fig, (left, right) = style.figure(style.COLUMN_AND_HALF, 74, 1, 2)
    zero = style.log_axis(left.xaxis, *RATES, "0", "low")
    style.log_axis(left.yaxis, *RATES, "0", "low")
    none = style.log_axis(right.xaxis, *DIFFERENCES, "0", "low", every=2)
    style.log_axis(right.yaxis, *DIFFERENCES, "0", "low", every=2)
    for axes, ends in ((left, RATES), (right, DIFFERENCES)):
        axes.plot(ends, ends, color="black", linewidth=0.6, zorder=1)
    left.axvline(1, color=style.GREY, linewidth=0.6, zorder=0.5)
    style.convergence_limit(left)
    rounding = np.finfo(float).eps
    right.axhline(rounding, color=style.GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0.5)
    right.text(6e-9, rounding / 2, "rounding unit", fontsize=8, ha="right", va="top", color="0.3")
    handles = []
    for disks, own in style.by_case(rows):
        marker = MARKERS.get(disks, "D")
        for generic, face in ((False, "none"), (True, style.colour(disks))):
            some = [r for r in own if np.isinf(r["eta"]) == generic]
            look = {"color": style.colour(disks), "marker": marker, "markerfacecolor": face,
                    "linestyle": "none", "markersize": 4.2, "markeredgewidth": 0.8, "clip_on": False}
            predicted, observed, error, difference = (style.column(some, name) for name in rates.split())
            left.plot(at(predicted, zero), at(observed, zero), **look)
            right.plot(at(error, none), at(difference, none), **look)
        handles.append(Line2D([], [], **{**look, "markerfacecolor": "none"}, label=f"{disks} disks"))
    for label, face in ((r"filled: generic, $\eta = \infty$", "black"),
                        (r"open: enriched, $\eta < \infty$", "none")):
        handles.append(Line2D([], [], color="black", marker="D", markerfacecolor=face, linestyle="none",
                              markersize=3.4, markeredgewidth=0.8, label=label))
    style.legend_above(fig, handles, [h.get_label() for h in handles], 5, handlelength=1)
    if all(r["eta"] == r["epsilon"] for r in rows if r["predicted_rate"] == 0):
        left.annotate(r"$\eta = \varepsilon$", (zero, zero), (7, 0), textcoords="offset points", fontsize=8,
                      va="center")
    left.set(xlabel=r"predicted rate, $\rho$", ylabel="observed rate")
    right.set(xlabel="error of the fit", ylabel="|observed $-$ predicted|")
    style.panel(left, "a")
    style.panel(right, "b")
    return style.save(fig, output, "observed-rate", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
