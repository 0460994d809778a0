#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Divergence of the enriched algorithm at small eta, and its repair by relaxation."""
import sys

import numpy as np
import style

TICKS = [0.4, 0.6, 0.8, 1, 2, 4, 6, 10]


def pairs(rows):
    """Rows without relaxation, rows with the best one: the table holds both, in turn, for each eta."""
    return rows[0::2], rows[1::2]


def draw(results, output, formats):
    rows, span = style.read_radii(results, "relaxation/radius.csv", "eta", "relaxation")
    fig, (top, bottom) = style.figure(style.COLUMN, 112, 2, 1, gridspec_kw={"height_ratios": [1.7, 1]})
    limit = [style.log_axis(axes.xaxis, *span, "∞", "high") for axes in (top, bottom)][0]
    style.log_axis(top.yaxis, 0.33, 11)
    top.set_yticks(TICKS, labels=[f"{v:g}" for v in TICKS])
    style.convergence_limit(top)
    for disks, own in style.by_case(rows):
        look = style.case_style(disks)
        plain, relaxed = pairs(own)
        same = [r["eta"] for r in plain] == [r["eta"] for r in relaxed]
        if not same or any(r["relaxation"] != 1 for r in plain):
            raise style.DataError(f"{results}/relaxation/radius.csv: column 'relaxation' does not alternate "
                                  "between 1 and the best value")
        for some, change in ((plain, {"label": None, "linewidth": 0.7}), (relaxed, {})):
            top.plot(*style.curve(some, "eta"), **{**look, **change})
        for some, size in ((plain, 2.8), (relaxed, 4)):
            style.limit_points(top, limit, style.radii(some, eta=np.inf), disks, size)
        bottom.plot(*style.curve(relaxed, "eta", "relaxation"), **look)
        generic = style.column(style.where(relaxed, eta=np.inf), "relaxation")
        style.limit_points(bottom, limit, generic, disks)
    handles, labels = top.get_legend_handles_labels()
    handles += top.plot([], [], color=style.GREY) + top.plot([], [], color=style.GREY, linewidth=0.7)
    labels += ["thick: best relaxation", r"thin: no relaxation, $\omega = 1$"]
    top.legend(handles, labels, loc="upper right")
    top.set_ylabel(r"spectral radius $\rho$")
    bottom.axhline(1, color=style.GREY, linewidth=0.6, zorder=0.5)
    bottom.set(xlabel=style.ETA_LABEL, ylabel=r"best relaxation $\omega$", ylim=(0, 2.3))
    style.panel(top, "a")
    style.panel(bottom, "b")
    return style.save(fig, output, "relaxation", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
