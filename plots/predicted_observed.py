#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rates with friction: what the frozen statuses predict against what the run shows."""
import sys

import numpy as np
import style

MARKERS = {1: "o", 10: "s", 100: "^"}


def draw(results, output, formats):
    rows = style.read_table(results, "predicted-observed/rate.csv", texts="case algorithm",
                            numbers="grains gauss_seidel_sweeps predicted observed")
    known = [r for r in rows if np.isfinite(r["observed"]) and np.isfinite(r["predicted"])]
    if not known:
        raise style.DataError("predicted-observed/rate.csv: no row with both rates")
    fig, axes = style.figure(style.COLUMN, 80)
    gaps = [1 - r[c] for r in known for c in ("predicted", "observed")]
    low, high = min(g for g in gaps if g > 0) / 2, max(gaps) * 2
    axes.plot([low, high], [low, high], color=style.GREY, linewidth=0.6)
    for algorithm, colour in (("generic", "black"), ("enriched", "#b03a2e")):
        for sweeps, marker in MARKERS.items():
            own = style.where(known, algorithm=algorithm, gauss_seidel_sweeps=float(sweeps))
            if own:
                axes.plot(1 - style.column(own, "predicted"), 1 - style.column(own, "observed"), marker,
                          color=colour, markerfacecolor="none", markersize=4.5,
                          label=rf"{algorithm}, $n_{{\mathrm{{GS}}}} = {sweeps}$")
    for axis in (axes.xaxis, axes.yaxis):
        style.log_axis(axis, low, high)
    axes.set_xlabel(r"predicted at frozen statuses, $1 - \rho$")
    axes.set_ylabel(r"observed in the run, $1 - \rho$")
    axes.legend(loc="upper left")
    return style.save(fig, output, "predicted-observed", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
