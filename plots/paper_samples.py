#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples of the paper's authors: their versions of Figures 8 to 11, whole runs, and LMGC90 side by side."""
import os
import sys

import figures_8_10
import figures_9_11
import numpy as np
import style

STUDY = "paper-samples"
RUNS = {("generic", 1): {"color": "black"},
        ("enriched", 1): {"color": "#b03a2e", "linestyle": (0, (4.5, 1.8))},
        ("generic", 100): {"color": "#1f5f99"},
        ("enriched", 100): {"color": "#c77f0a", "linestyle": (0, (4.5, 1.8))}}
DASHED = (0, (4, 2))
AT_THE_WALL = ((52, 65), (-0.3, 3.2))  # m, of the 10 000 disks: they lie 1.6 m deep in a box of 64 m
METHODS = {"nlgs": "undivided", "generic": "NSCDD", "nscdd": "NSCDD", "schwarz": "Schwarz"}
PARTITIONS = {"1x1": "black", "2x1": "#1f5f99", "2x2": "#b03a2e", "4x1": "#3d7a3d"}
SAMPLES = {"Ddm_exemple1": "1 000 grains in shear", "DDM_DDM_2d_rough_box": "rough box"}


def running(values, width=21):
    """Medians of WIDTH values around each; of fewer at both ends."""
    half = width // 2
    return [np.median(values[max(0, k - half):k + half + 1]) for k in range(len(values))]


def draw_steps(results, output, formats):
    """Iterations of every step, and LMGC90's three indicators at the end of the steps of the authors' algorithm."""
    numbers = "gauss_seidel_sweeps step iterations quad_dv quad_dvr mean_dv_over_r normal_change"
    rows = style.read_table(results, f"{STUDY}/steps.csv", texts="case algorithm status", numbers=numbers)
    fig, (above, below) = style.figure(style.COLUMN_AND_HALF, 120, 2, 1, sharex=True)
    for (algorithm, sweeps), look in RUNS.items():
        own = style.where(rows, algorithm=algorithm, gauss_seidel_sweeps=float(sweeps))
        if own:
            above.plot(style.column(own, "step"), running(style.column(own, "iterations")),
                       label=rf"{algorithm}, $n_{{\mathrm{{GS}}}} = {sweeps}$", **look)
            above.plot(style.column(own, "step"), style.column(own, "iterations"), linewidth=0.4, alpha=0.3,
                       color=look["color"])
    style.panel(above, "a", "iterations of each step, and medians of 21 steps")
    above.set(yscale="log", ylabel="iterations")
    own = style.need(results, f"{STUDY}/steps.csv", rows, algorithm="generic", gauss_seidel_sweeps=1.0)
    for name, label, look in (("normal_change", r"$\sum|\Delta r_n|/\sum r_n$", {"color": "black"}),
                              ("quad_dv", "Quad/DV", {"color": "#1f5f99"}),
                              ("quad_dvr", "Quad/DVR", {"color": "#b03a2e"}),
                              ("mean_dv_over_r", "|mean DV over r|", {"color": style.GREY})):
        below.plot(style.column(own, "step"), abs(style.column(own, name)), label=label, linewidth=0.8, **look)
    style.panel(below, "b", r"at the end of a step, generic, $n_{\mathrm{GS}} = 1$")
    below.set(yscale="log", xlabel="step", ylabel="indicator")
    pairs = zip(above.get_legend_handles_labels(), below.get_legend_handles_labels())
    style.legend_above(fig, *([one for two in zip(a, b) for one in two] for a, b in pairs), 4)
    return style.save(fig, output, STUDY, formats)


def draw_sides(results, output, formats):
    """Iterations of both programs, added up over the steps."""
    rows = style.read_table(results, f"{STUDY}/iterations.csv", texts="sample program algorithm partition",
                            numbers="step iterations")
    fig, grid = style.figure(style.COLUMN_AND_HALF, 90, 1, len(SAMPLES), squeeze=False)
    handles = {}
    for axes, letter, (sample, title) in zip(grid.flat, "ab", SAMPLES.items()):
        for partition, colour in PARTITIONS.items():
            for program, algorithm, look in (("nscdd", ("nlgs", "generic"), {"linewidth": 1.1}),
                                             ("nscdd", ("schwarz",), {"linewidth": 1.1, "linestyle": (0, (1, 1.3))}),
                                             ("LMGC90", ("nlgs", "nscdd"), {"linewidth": 0.8, "linestyle": DASHED}),
                                             ("LMGC90", ("schwarz",), {"linewidth": 0.8, "linestyle": (0, (1, 1.3))})):
                own = [r for r in style.where(rows, sample=sample, program=program, partition=partition)
                       if r["algorithm"] in algorithm]
                if not own:
                    continue
                label = f"{'nscdd' if program == 'nscdd' else program}, {METHODS[own[0]['algorithm']]}, {partition}"
                line, = axes.plot(style.column(own, "step"), np.cumsum(style.column(own, "iterations")) / 1000,
                                  color=colour, **look)
                handles.setdefault(label.replace("undivided, 1x1", "undivided"), line)
        style.panel(axes, letter, title)
        axes.set(xlabel="step", xlim=(0, None), ylim=(0, None))
    grid.flat[0].set_ylabel("thousand iterations so far")
    style.legend_above(fig, list(handles.values()), list(handles), 3)
    return style.save(fig, output, f"{STUDY}-lmgc90", formats)


def draw(results, output, formats):
    """Draws what there are tables of: parts of the study can be run by themselves."""
    parts = {"disks-10k": lambda: figures_8_10.draw_one(results, output, formats, STUDY, "-10k", "figure-8-authors",
                                                        AT_THE_WALL),
             "indicators": lambda: figures_9_11.draw_one_9(results, output, formats, "", STUDY, "figure-9-authors"),
             "disks": lambda: figures_8_10.draw_one(results, output, formats, STUDY, "", "figure-10-authors"),
             "generic": lambda: figures_9_11.draw_11(results, output, formats, STUDY, "figure-11-authors"),
             "steps": lambda: draw_steps(results, output, formats),
             "iterations": lambda: draw_sides(results, output, formats)}
    there = [part for part in parts if os.path.exists(os.path.join(results, f"{STUDY}/{part}.csv"))]
    if not there:
        raise style.NoTable(f"{os.path.join(results, STUDY)}: expected a table of studies/{STUDY}/measure, met none")
    return [path for part in there for path in parts[part]()]


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
