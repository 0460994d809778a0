#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure 5: spectral radius of the generic algorithm against the flexibility of the law."""
import sys

import style


def draw(results, output, formats):
    rows, span = style.read_radii(results, "figure-5/radius.csv", "epsilon")
    fig, axes = style.figure(style.COLUMN, 66)
    limit = style.log_axis(axes.xaxis, *span, "0", "low", every=2)
    for disks, own in style.by_case(rows):
        axes.plot(*style.curve(own, "epsilon"), **style.case_style(disks))
        style.band(axes, own, "epsilon", disks)
        style.limit_points(axes, limit, style.radii(own, epsilon=0), disks)
        style.points(axes, *style.curve(style.where(own, epsilon=1), "epsilon"), disks)
    handles, labels = axes.get_legend_handles_labels()
    for face, label in (("black", r"$\varepsilon = 1$"), ("white", r"limit $\varepsilon = 0$")):
        handles += axes.plot([], [], "o", color="black", markerfacecolor=face, markeredgewidth=0.9)
        labels.append(label)
    axes.legend(handles, labels, loc="upper right")
    axes.set(xlabel=style.EPSILON_LABEL, ylabel=r"spectral radius $\rho(B_\varepsilon)$", ylim=(0, 1.04))
    return style.save(fig, output, "figure-5", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
