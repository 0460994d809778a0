#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rates with friction: what frozen statuses predict against what a run shows, from zero and next to the solution."""
import os
import sys

import numpy as np
import style

MARKERS = {1: "o", 10: "s", 100: "^"}


def label_two_and_five(axis, low, high):
    """Labels at 1, 2 and 5 of each decade, for axes of less than two."""
    ticks = {}
    for exponent in range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high)))):
        for digit in (1, 2, 5):
            if low <= digit * 10.0**exponent <= high:
                factor = "" if digit == 1 else rf"{digit}\cdot"
                ticks[digit * 10.0**exponent] = rf"${factor}10^{{{exponent}}}$"
    axis.set_ticks(list(ticks), labels=list(ticks.values()))


def read(results, name):
    rows = style.read_table(results, name, texts="case algorithm",
                            numbers="grains gauss_seidel_sweeps predicted observed relative_gap", flags="agree")
    return [r for r in rows if np.isfinite(r["observed"]) and np.isfinite(r["predicted"])]


def compare(rates, gaps, rows, filled, face):
    """|1 - rho| as observed and the gap, both against the prediction; markers are filled where FILLED(row)."""
    distance = {c: np.abs(1 - style.column(rows, c)) for c in ("predicted", "observed")}
    low, high = min(map(min, distance.values())) / 2, max(map(max, distance.values())) * 2
    rates.plot([low, high], [low, high], color=style.GREY, linewidth=0.6)
    for algorithm, colour in (("generic", "black"), ("enriched", "#b03a2e")):
        for sweeps, marker in MARKERS.items():
            own = style.where(rows, algorithm=algorithm, gauss_seidel_sweeps=float(sweeps))
            look = {"color": colour, "markersize": 4.5, "linestyle": "none", "marker": marker}
            rates.plot([], [], markerfacecolor="none", label=rf"{algorithm}, $n_{{\mathrm{{GS}}}} = {sweeps}$", **look)
            for fill in (False, True):
                some = [r for r in own if filled(r) == fill]
                for axes, y in ((rates, np.abs(1 - style.column(some, "observed"))),
                                (gaps, style.column(some, "relative_gap"))):
                    axes.plot(np.abs(1 - style.column(some, "predicted")), y, zorder=2 + fill,
                              markerfacecolor=face if fill else "none", **look)
    for axis in (rates.xaxis, rates.yaxis, gaps.xaxis):
        style.log_axis(axis, low, high)
        if high < 100 * low:
            label_two_and_five(axis, low, high)
    gaps.set_yscale("log")


def draw(results, output, formats):
    run = read(results, "predicted-observed/rate.csv")
    near = read(results, "predicted-observed/solution.csv")
    if os.path.exists(os.path.join(results, "predicted-observed/solution-large.csv")):  # run on demand only
        near += read(results, "predicted-observed/solution-large.csv")
    for rows, name in ((run, "rate"), (near, "solution")):
        if not rows:
            raise style.DataError(f"predicted-observed/{name}.csv: no row with both rates")
    fig, ((rates, gaps), (near_rates, near_gaps)) = style.figure(style.COLUMN_AND_HALF, 146, 2, 2)
    gaps.axhline(0.01, color=style.GREY, linewidth=0.6)
    compare(rates, gaps, run, lambda r: not r["agree"], "0.7")
    compare(near_rates, near_gaps, near, lambda r: r["predicted"] > 1, "0.7")
    for pair, sign in (((rates, gaps), r"1 - \rho"), ((near_rates, near_gaps), r"|1 - \rho|")):
        pair[0].set_ylabel(rf"observed, ${sign}$")
        pair[1].set_ylabel(r"$|$observed $-$ predicted$|$ / $|1 - \rho|$")
        for axes in pair:
            axes.set_xlabel(rf"predicted at frozen statuses, ${sign}$")
    style.panel(rates, "a", "in a run from zero")
    style.panel(gaps, "b", "their gap (grey: do not agree)")
    style.panel(near_rates, "c", r"next to the solution (grey: $\rho > 1$)")
    style.panel(near_gaps, "d", "their gap")
    handles, labels = rates.get_legend_handles_labels()
    style.legend_above(fig, handles, labels, 3)
    return style.save(fig, output, "predicted-observed", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
