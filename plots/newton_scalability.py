#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outer steps and iterations at the interface of the two-stage Newton method against the number of subdomains."""
import os
import sys

import numpy as np
import style

NETWORKS = [("none", "no contacts (generic)", style.GREY), ("all", "all contacts (enriched)", "#1f5f99"),
            ("active", "active contacts", "#b03a2e")]
LOCAL = [("lumped", "lumped", style.GREY, "v"), ("dirichlet", "Dirichlet", "#1f5f99", "s"),
         ("deluxe", "Dirichlet, deluxe", "#3d7a3d", "D"), ("geneo", r"the same, GenEO, $\kappa \leq 30$", "black", "o"),
         ("active", r"$X_\eta$, active contacts", "#b03a2e", "^")]
# Tables of a study and how they are drawn. Slices in space are what strips are in the plane.
CUTS = {"blocks": {"marker": "s", "linestyle": "-"}, "strips": {"marker": "^", "linestyle": (0, (1, 1.3))},
        "slices": {"marker": "^", "linestyle": (0, (1, 1.3))}, "metis": {"marker": "o", "linestyle": (0, (4, 2))}}
NAMES = {"metis": "METIS"}
DASHED, DOTTED = (0, (4, 2)), (0, (1, 1.3))
PREDICTED = {"linestyle": "none", "marker": "x", "markersize": 4, "markeredgewidth": 0.8, "zorder": 4}
RIVALS = ["generic", "enriched", "admm"]
NUMBERS = " ".join(["subdomains", "outer_steps", "outer_steps_undivided", "systems", "iterations_per_system",
                    *[f"{rival}_iterations" for rival in RIVALS],
                    *[f"{kind}_{network}" for network, *_ in NETWORKS + LOCAL[:-1]
                      for kind in ("iterations", "predicted", "richardson")]])


def rows_of(results, study, table):
    rows = style.read_table(results, f"{study}/{table}.csv", numbers=NUMBERS,
                            flags=" ".join(f"{rival}_converged" for rival in RIVALS))
    return sorted(rows, key=lambda row: row["subdomains"])


def line(axes, rows, values, colour, look):
    """VALUES is a column, or one number for each row."""
    values = style.column(rows, values) if isinstance(values, str) else values
    return axes.plot(style.column(rows, "subdomains"), values, color=colour, **look)[0]


def cuts_of(tables):
    return [(name, look) for name, look in CUTS.items() if name in tables]


def draw_outer(axes, tables):
    undivided = tables["blocks"][0]["outer_steps_undivided"]
    axes.axhspan(0.8 * undivided, 1.2 * undivided, color=style.GREY, alpha=0.15, linewidth=0)
    axes.axhline(undivided, color=style.GREY, linewidth=0.6, zorder=0.5)
    for cut, look in cuts_of(tables):
        line(axes, tables[cut], "outer_steps", "black", look)
    axes.annotate("one subdomain, ± 20 %", (0.5, 0.8 * undivided), xycoords=("axes fraction", "data"),
                  xytext=(0, -4), textcoords="offset points", ha="center", va="top", fontsize=7)
    axes.set(ylim=(0, 1.6 * undivided), ylabel="matrices factorised")


def draw_krylov(axes, tables):
    for cut, look in cuts_of(tables):
        for network, _, colour in NETWORKS:
            line(axes, tables[cut], f"iterations_{network}", colour, look)
            line(axes, tables[cut], f"predicted_{network}", "black", PREDICTED)
    largest = max(row[f"iterations_{network}"] for cut, _ in cuts_of(tables) for row in tables[cut]
                  for network, *_ in NETWORKS)
    style.log_axis(axes.yaxis, 10, max(1500, 1.5 * largest))
    axes.set(ylabel="iterations per linear system")


def draw_fixed_size(axes, tables):
    for network, _, colour in NETWORKS:
        line(axes, tables["fixed-size"], f"iterations_{network}", colour, {"marker": "D", "linestyle": "-"})
        line(axes, tables["fixed-size"], f"predicted_{network}", "black", PREDICTED)
    style.log_axis(axes.yaxis, 5, 1500)
    axes.set(ylabel="iterations per linear system")


def draw_local(axes, rows, key):
    for name, label, colour, marker in LOCAL:
        line(axes, rows, f"iterations_{name}", colour, {"marker": marker, "linestyle": "-", "label": label})
        line(axes, rows, f"predicted_{name}", "black", PREDICTED)
    style.log_axis(axes.yaxis, 1, max(1500, 1.5 * max(row["iterations_lumped"] for row in rows)))
    axes.set(ylabel="iterations per linear system")
    if key:
        axes.legend(loc="lower right", fontsize=7)


def draw_methods(axes, tables):
    """Richardson's iteration beside Krylov's for one system; then all iterations at the interface in the step."""
    rows = tables["blocks"]
    richardson = [row["richardson_none"] if np.isfinite(row["richardson_none"]) else np.nan for row in rows]
    handles = [line(axes, rows, richardson, style.GREY,
                    {"marker": "s", "linestyle": DASHED, "markerfacecolor": "white"})]
    newton = [row["systems"] * row["iterations_per_system"] for row in rows]
    handles.append(line(axes, rows, newton, "#b03a2e", {"marker": "s", "linestyle": "-"}))
    for rival, colour, look in (("admm", "#3d7a3d", {"marker": "v", "linestyle": "-"}),
                                ("generic", style.GREY, {"marker": "D", "markersize": 6.5, "markerfacecolor": "none",
                                                         "linestyle": "-"}),
                                ("enriched", "#1f5f99", {"marker": "D", "linestyle": DOTTED})):
        there = [row for row in rows if row[f"{rival}_converged"]]
        handles.append(line(axes, there, f"{rival}_iterations", colour, look))
    style.log_axis(axes.yaxis, 1e3, 3e6)
    axes.set(ylabel="iterations at the interface")
    axes.legend(handles, ["Richardson, one system, no contacts", "two-stage Newton, the step",
                          "two-stage ADMM, the step", r"Algorithm 1, generic, to $\zeta = 10^{-4}$",
                          r"Algorithm 1, enriched, to $\zeta = 10^{-4}$"],
                loc="upper left", fontsize=7)


def draw_study(results, output, formats, study, cuts, packing, grains):
    """PACKING: the grains of the shear test, in words; GRAINS: of what they are 32 in each subdomain. Cuts other than
    blocks are drawn where their tables are: in space they are run on demand only."""
    there = [cut for cut in cuts if cut == "blocks" or os.path.exists(os.path.join(results, study, f"{cut}.csv"))]
    tables = {name: rows_of(results, study, name) for name in (*there, "fixed-size")}
    fig, ((outer, krylov), (fixed, methods), (local, local_fixed)) = style.figure(style.COLUMN_AND_HALF, 190, 3, 2)
    draw_outer(outer, tables)
    draw_krylov(krylov, tables)
    draw_fixed_size(fixed, tables)
    draw_methods(methods, tables)
    draw_local(local, tables["blocks"], True)
    draw_local(local_fixed, tables["fixed-size"], False)
    titles = (f"outer steps, {packing}", f"Krylov's method, {packing}", f"the same, 32 {grains} in each",
              f"methods, {packing} in blocks", f"local preconditioners, {packing} in blocks",
              f"the same, 32 {grains} in each")
    for axes, letter, title in zip((outer, krylov, fixed, methods, local, local_fixed), "abcdef", titles):
        style.log_axis(axes.xaxis, 1.6, 82)
        axes.set_xticks([2, 4, 8, 16, 32, 64], labels=["2", "4", "8", "16", "32", "64"])
        axes.set_xticks([], minor=True)
        axes.set(xlabel="number of subdomains")
        style.panel(axes, letter, title)
    handles = [outer.plot([], [], color=colour, linewidth=3)[0] for *_, colour in NETWORKS]
    handles += [outer.plot([], [], color="black", **PREDICTED)[0]]
    handles += [outer.plot([], [], color="black", **look)[0] for _, look in cuts_of(tables)]
    labels = [label for _, label, _ in NETWORKS] + ["predicted"] + [NAMES.get(cut, cut) for cut, _ in cuts_of(tables)]
    style.legend_above(fig, handles, labels, 4)
    return style.save(fig, output, study, formats)


def draw(results, output, formats):
    return draw_study(results, output, formats, "newton-scalability", ("blocks", "strips", "metis"), "780 grains",
                      "grains")


def draw_in_space(results, output, formats):
    return draw_study(results, output, formats, "newton-scalability-in-space", ("blocks", "slices"),
                      "1 000 spheres", "spheres")


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw, draw_in_space))
