#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps judged by the study verdicts: what `auto` takes against the margin of a step, and a box whose walls close."""
import sys

import numpy as np
import style

TABLES = [("friction", "shear, 0.1 to 0.8", "#1f5f99", "o"), ("shear", "shear, 0.3", "black", "s"),
          ("compression", "compression, piston", "#3d7a3d", "^"), ("box", "closing box", "#b03a2e", "D")]
COLUMNS = "step margin_over_speed factorisations"


def rows_of(results, table):
    texts = "case verdict status" + (" interaction.friction" if table in ("friction", "box") else "")
    return style.read_table(results, f"verdicts/{table}.csv", numbers=COLUMNS, texts=texts)


def foretold(axes, results):
    """Factorisations against margin over speed, of steps with a solution; open marks were not solved."""
    for table, words, colour, marker in TABLES:
        rows = [row for row in rows_of(results, table) if row["verdict"] == "exists"]
        solved = np.array([row["status"] == "converged" for row in rows])
        x, y = style.column(rows, "margin_over_speed"), 1 + style.column(rows, "factorisations")
        axes.plot(x[solved], y[solved], marker, color=colour, markersize=3, label=words)
        axes.plot(x[~solved], y[~solved], marker, color=colour, markersize=4, markerfacecolor="white")
    axes.set(xscale="log", yscale="log", xlabel=r"margin over speed, $s/|v'|$", ylabel="1 + factorisations of auto")
    style.panel(axes, "a", "steps with a solution")


def closing(axes, results):
    """The margin over speed of the box, by steps."""
    for friction, colour, line in (("0", "0.45", ":"), ("0.3", "#b03a2e", "-")):
        rows = [row for row in rows_of(results, "box") if row["interaction.friction"] == friction]
        steps, margins = style.column(rows, "step"), style.column(rows, "margin_over_speed")
        axes.plot(steps, margins, line, color=colour, label=rf"friction {friction}")
        for verdict, mark in (("exists", "o"), ("undecided", "x"), ("impossible", "s")):
            kept = np.array([row["verdict"] == verdict for row in rows])
            axes.plot(steps[kept], margins[kept], mark, color=colour, markersize=4, markerfacecolor="white")
    axes.axhline(0, color="0.8", linewidth=0.6, zorder=0)
    axes.set(xlabel="step", ylabel=r"margin over speed, $s/|v'|$")
    for verdict, mark in (("exists", "o"), ("undecided", "x"), ("impossible", "s")):
        axes.plot([], [], mark, color="0.3", markersize=4, markerfacecolor="white", label=verdict)
    axes.legend(loc="lower left", fontsize="small")
    style.panel(axes, "b", "a box whose side walls close")


def draw(results, output, formats):
    fig, (left, right) = style.figure(style.COLUMN_AND_HALF, 70, 1, 2)
    foretold(left, results)
    closing(right, results)
    handles, labels = left.get_legend_handles_labels()
    style.legend_above(fig, handles, labels, 4)
    return style.save(fig, output, "verdicts", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
