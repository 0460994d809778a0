#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rates with friction: what the frozen statuses predict against what the run shows."""
import sys

import numpy as np
import style

MARKERS = {1: "o", 10: "s", 100: "^"}


def label_two_and_five(axis, low, high):
    """Labels at 1, 2 and 5 of each decade: the rates span less than two decades."""
    ticks = {}
    for exponent in range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high)))):
        for digit in (1, 2, 5):
            if low <= digit * 10.0**exponent <= high:
                factor = "" if digit == 1 else rf"{digit}\cdot"
                ticks[digit * 10.0**exponent] = rf"${factor}10^{{{exponent}}}$"
    axis.set_ticks(list(ticks), labels=list(ticks.values()))


def draw(results, output, formats):
    rows = style.read_table(results, "predicted-observed/rate.csv", texts="case algorithm",
                            numbers="grains gauss_seidel_sweeps predicted observed relative_gap", flags="agree")
    known = [r for r in rows if np.isfinite(r["observed"]) and np.isfinite(r["predicted"])]
    if not known:
        raise style.DataError("predicted-observed/rate.csv: no row with both rates")
    fig, (rates, gaps) = style.figure(style.COLUMN_AND_HALF, 86, 1, 2)
    both = [1 - r[c] for r in known for c in ("predicted", "observed")]
    low, high = min(g for g in both if g > 0) / 2, max(both) * 2
    rates.plot([low, high], [low, high], color=style.GREY, linewidth=0.6)
    gaps.axhline(0.01, color=style.GREY, linewidth=0.6)
    for algorithm, colour in (("generic", "black"), ("enriched", "#b03a2e")):
        for sweeps, marker in MARKERS.items():
            own = style.where(known, algorithm=algorithm, gauss_seidel_sweeps=float(sweeps))
            look = {"color": colour, "markersize": 4.5, "linestyle": "none", "marker": marker}
            if own:
                rates.plot(1 - style.column(own, "predicted"), 1 - style.column(own, "observed"),
                           markerfacecolor="none", label=rf"{algorithm}, $n_{{\mathrm{{GS}}}} = {sweeps}$", **look)
            for agree, face in ((True, "none"), (False, "0.7")):
                some = [r for r in own if r["agree"] == agree]
                if some:
                    gaps.plot(1 - style.column(some, "predicted"), style.column(some, "relative_gap"),
                              markerfacecolor=face, zorder=2 if agree else 3, **look)
    for axis in (rates.xaxis, rates.yaxis, gaps.xaxis):
        style.log_axis(axis, low, high)
        label_two_and_five(axis, low, high)
    gaps.set_yscale("log")
    rates.set_ylabel(r"observed in the run, $1 - \rho$")
    gaps.set_ylabel(r"$|$observed $-$ predicted$|$ / ($1 - \rho$)")
    for axes, letter, title in ((rates, "a", "rates"), (gaps, "b", "their gap (grey: do not agree)")):
        axes.set_xlabel(r"predicted at frozen statuses, $1 - \rho$")
        style.panel(axes, letter, title)
    handles, labels = rates.get_legend_handles_labels()
    style.legend_above(fig, handles, labels, 3)
    return style.save(fig, output, "predicted-observed", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
