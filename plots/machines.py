#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What processes do for a radius and an iteration of Algorithm 1, the model's laws beside it, and its prediction."""
import sys

import numpy as np
import style
from machine_model import (ARCHER2, LARGEST_FITTED, PROCESSES, TABLE, Model, fitted_and_held_out,
                           measured_speeds, predict_iteration, predict_radius, read, rows_of)

BLUE, RED, GREEN = "#1f5f99", "#b03a2e", "#3d7a3d"
HELD_OUT = (0, (4, 2))
DOTTED, DASH_DOTTED = (0, (1, 1.3)), (0, (5, 1.5, 1, 1.5))
# Of grains: label, colour, marker.
LATTICES = {10_000: (r"$10^4$", GREEN, "o"), 99_856: (r"$10^5$", BLUE, "s"), 1_000_000: (r"$10^6$", RED, "D")}
BEDS = {10_000: LATTICES[10_000], 100_000: LATTICES[99_856]}
PARTS = {"8x8": {}, "16x16": {"markerfacecolor": "white"}}
CHECKED = {  # quantities of the check: label
    "radius": {"memory": "memory", "path_flops": "operations", "message_bytes": "bytes", "messages": "messages",
               "sum_bytes": "bytes in sums", "iterations": "iterations"},
    "iteration": {"memory": "memory", "contact_updates": "updates", "message_bytes": "bytes", "messages": "messages"},
}
TIMED = [("nscdd", 1, 1, "1 thread"), ("nscdd", 1, 2, "2 threads"), ("nscdd-mpi", 1, 1, "1 process"),
         ("nscdd-mpi", 2, 1, "2 processes"), ("nscdd-mpi", 4, 1, "4 on 2 cores")]


def by_processes(axes, ticks):
    style.log_axis(axes.xaxis, ticks[0] / 1.25, ticks[-1] * 1.25)
    axes.set_xticks(ticks, labels=[str(tick) for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set(xlabel="number of processes")


def strong(axes, rows, model, sizes, quantity, limits, label, scale=1.0):
    """Measured values against processes at fixed sizes, and the law with constants from the smaller sizes."""
    for grains, (_, colour, marker) in sizes.items():
        own = style.where(rows, series="strong", grains=grains)
        for subdomains, face in PARTS.items():
            some = [row for row in style.where(own, subdomains=subdomains) if row[quantity] > 0]
            if some:
                axes.plot(style.column(some, "processes"), scale * style.column(some, quantity), color=colour,
                          linestyle="none", marker=marker, zorder=3, **face)
        first = next(row for row in style.need("", TABLE, own, subdomains="8x8") if row[quantity] > 0)
        every = [{"grains": grains, "subdomains": "8x8", "processes": processes}
                 for processes in (1, 2, 4, 8, 16, 32, 64) if processes >= first["processes"]]
        axes.plot([row["processes"] for row in every], [scale * model.value(quantity, row) for row in every],
                  color=colour, linestyle="-" if grains <= LARGEST_FITTED else HELD_OUT, zorder=2)
    by_processes(axes, [1, 2, 4, 8, 16, 32, 64])
    style.log_axis(axes.yaxis, *limits)
    axes.set(ylabel=label)


def weak(axes, rows):
    """Values over those of one process, with as many grains for each process."""
    looks = [("radius", 2_500, "path_flops", {"color": BLUE, "marker": "o", "markerfacecolor": "white"},
              "operations, 2 500"),
             ("radius", 10_000, "path_flops", {"color": BLUE, "marker": "o"}, "operations, 10 000"),
             ("radius", 10_000, "memory", {"color": RED, "marker": "s"}, "memory, 10 000"),
             ("iteration", 1_250, "contact_updates", {"color": GREEN, "marker": "D"}, "Algorithm 1, updates, 1 250")]
    for work, each, quantity, look, label in looks:
        some = [row for row in style.where(rows, series="weak", work=work)
                if row["grains"] == each * row["processes"]]
        values = style.column(some, quantity)
        axes.plot(style.column(some, "processes"), values / values[0], label=label, linestyle="-", **look)
    by_processes(axes, [1, 2, 4, 8, 16, 32, 64])
    style.log_axis(axes.yaxis, 0.7, 3e3)
    axes.set(ylabel="over that of one process")
    axes.legend(loc="upper left", fontsize=7, labelspacing=0.25, title="grains for each process:", title_fontsize=7,
                alignment="left")


def check(axes, rows):
    """Predicted over measured on the rows that were held out."""
    place, labels = 0, []
    axes.axhline(1, color=style.GREY, linewidth=0.6, zorder=0.5)
    for work, quantities in CHECKED.items():
        fitted, held_out = fitted_and_held_out(rows, work)
        model = Model(work, fitted)
        for quantity, label in quantities.items():
            ratios = np.sort(model.ratios(quantity, held_out))
            spread = 0.5 * (np.arange(len(ratios)) / max(1, len(ratios) - 1) - 0.5)
            axes.plot(place + spread, ratios, linestyle="none", marker="o", markersize=2.6,
                      color=BLUE if work == "radius" else GREEN)
            labels.append(label)
            place += 1
        place += 0.4
    count = len(CHECKED["radius"])
    places = [*range(count), *(count + 0.4 + np.arange(len(CHECKED["iteration"])))]
    style.log_axis(axes.yaxis, 0.4, 2.5)
    axes.set_yticks([0.5, 0.7, 1, 1.4, 2], labels=["0.5", "0.7", "1", "1.4", "2"])
    axes.set_yticks([], minor=True)
    axes.set_xticks(places, labels=labels, rotation=55, ha="right", rotation_mode="anchor", fontsize=7)
    axes.tick_params(axis="x", length=0)
    axes.set(ylabel="predicted over measured")
    axes.text(0.02, 0.96, "radius", transform=axes.transAxes, color=BLUE, fontsize=7, va="top")
    axes.text(0.98, 0.96, "Algorithm 1", transform=axes.transAxes, color=GREEN, fontsize=7, va="top", ha="right")


def draw_counts(results, output, formats):
    rows = read(results)
    radius, iteration = rows_of(rows, "radius"), rows_of(rows, "iteration")
    laws = {work: Model(work, fitted_and_held_out(rows, work)[0]) for work in ("radius", "iteration")}
    fig, grid = style.figure(style.COLUMN_AND_HALF, 190, 3, 2)
    (path, memory), (sent, exchanged), (growing, checked) = grid
    strong(path, radius, laws["radius"], LATTICES, "path_flops", (1e8, 2e12), "operations one after the other")
    strong(memory, radius, laws["radius"], LATTICES, "memory", (40, 1e4), "memory of a process (MB)", 1e-6)
    strong(sent, radius, laws["radius"], LATTICES, "message_bytes", (0.5, 1e3), "sent by a process (MB)", 1e-6)
    strong(exchanged, iteration, laws["iteration"], BEDS, "message_bytes", (1, 20), "sent by a process (kB)", 1e-3)
    weak(growing, rows_of(rows, "iteration") + style.where(rows, work="radius", program="nscdd-mpi"))
    check(checked, rows)
    titles = ("radius, longest way of work", "radius, process that takes most", "radius, process that sends most",
              "Algorithm 1, an iteration", "grains grow with processes", "rows held out")
    for axes, letter, title in zip(grid.flat, "abcdef", titles):
        style.panel(axes, letter, title)
    key = [(f"{label} grains", {"color": colour, "marker": marker, "linestyle": "none"})
           for label, colour, marker in LATTICES.values()]
    key += [("8 × 8 subdomains", {"color": "black", "marker": "o", "linestyle": "none"}),
            ("16 × 16", {"color": "black", "marker": "o", "linestyle": "none", "markerfacecolor": "white"}),
            ("law (8 × 8), fitted", {"color": "black", "linestyle": "-"}),
            ("law (8 × 8), held out", {"color": "black", "linestyle": HELD_OUT})]
    handles = [path.plot([], [], **look)[0] for _, look in key]
    style.legend_above(fig, handles, [text for text, _ in key], 4)
    return style.save(fig, output, "machines", formats)


def measured_seconds(axes, rows, work, sizes):
    """Seconds over those of one thread: of an iteration with the least and the most of the runs, of a radius without
    what every process does with the whole packing and without the start of the programs."""
    seconds = "work_seconds" if work == "radius" else "seconds"
    own = style.where(rows, work=work, series="strong", subdomains="8x8")
    sizes = [(grains, look) for grains, look in sizes.items()
             if any(np.isfinite(row["seconds"]) for row in style.where(own, grains=grains))]
    for offset, (grains, (label, colour, marker)) in zip(np.linspace(-0.2, 0.2, len(sizes)), sizes):
        some = style.where(own, grains=grains)
        one = style.need("", TABLE, some, program="nscdd", threads=1)[0][seconds]
        for place, (program, processes, threads, _) in enumerate(TIMED):
            for row in style.where(some, program=program, processes=processes, threads=threads):
                if not np.isfinite(row["seconds"]):
                    continue
                least, most = (row[seconds], row[seconds]) if work == "radius" else (
                    row["seconds_least"], row["seconds_most"])
                axes.errorbar(place + offset, row[seconds] / one,
                              [[(row[seconds] - least) / one], [(most - row[seconds]) / one]], color=colour,
                              marker=marker, linestyle="none", linewidth=0.8, capsize=1.5,
                              label=f"{label} grains" if not place else None)
    axes.axhline(1, color=style.GREY, linewidth=0.6, zorder=0.5)
    axes.axhline(0.5, color=style.GREY, linewidth=0.6, linestyle=DOTTED, zorder=0.5)
    axes.set_xticks(range(len(TIMED)), labels=[label for *_, label in TIMED], rotation=30, ha="right",
                    rotation_mode="anchor", fontsize=7)
    axes.set(ylabel="seconds over those of one thread", ylim=(0, 1.2), xlim=(-0.5, len(TIMED) - 0.5))


def predicted(axes, found, looks, limits, label, scale=1.0):
    axes.plot(PROCESSES, [scale * one["seconds"] for one in found], color="black", marker="o", linestyle="-",
              label="together")
    for part, (text, look) in looks.items():
        axes.plot(PROCESSES, [scale * one["parts"][part] for one in found], label=text, **look)
    by_processes(axes, PROCESSES)
    style.log_axis(axes.yaxis, *limits)
    axes.set(ylabel=label)
    axes.legend(loc="lower left", fontsize=7, labelspacing=0.2)


def draw_prediction(results, output, formats):
    rows = read(results)
    speeds = measured_speeds(rows)
    radius, iteration = (Model(work, rows_of(rows, work)) for work in ("radius", "iteration"))
    fig, (first, second) = style.figure(style.COLUMN_AND_HALF, 68, 1, 2)
    looks = {"operations": ("operations, one after the other", {"color": BLUE, "linestyle": "-"}),
             "whole packing": ("the whole packing, in each", {"color": RED, "linestyle": HELD_OUT}),
             "messages": ("messages", {"color": style.GREY, "linestyle": DOTTED}),
             "sums": ("sums over all", {"color": GREEN, "linestyle": DASH_DOTTED})}
    if speeds is None:
        del looks["whole packing"]
    predicted(first, [predict_radius(radius, processes, ARCHER2, speeds) for processes in PROCESSES], looks,
              (1e-4, 1e4), "seconds, predicted" + (" at least" if speeds is None else ""))
    predicted(second, [predict_iteration(iteration, processes, ARCHER2) for processes in PROCESSES],
              {"sweeps": ("sweeps", {"color": BLUE, "linestyle": "-"}),
               "messages": ("messages to neighbours", {"color": style.GREY, "linestyle": DOTTED}),
               "sums": ("the sum over all", {"color": GREEN, "linestyle": DASH_DOTTED})}, (3e-4, 1e2),
              "milliseconds, predicted", 1e3)
    style.panel(first, "a", r"a radius, $10^7$ grains, ARCHER2")
    style.panel(second, "b", r"an iteration of Algorithm 1, the same")
    return style.save(fig, output, "machines-prediction", formats)


def draw_seconds(results, output, formats):
    """Where they were measured."""
    rows = read(results)
    if measured_speeds(rows) is None:
        return []
    fig, (first, second) = style.figure(style.COLUMN_AND_HALF, 68, 1, 2)
    measured_seconds(first, rows, "radius", LATTICES)
    measured_seconds(second, rows, "iteration", BEDS)
    style.legend_above(fig, *first.get_legend_handles_labels(), 3)
    style.panel(first, "a", "a radius, measured")
    style.panel(second, "b", "an iteration of Algorithm 1, measured")
    return style.save(fig, output, "machines-seconds", formats)


def draw(results, output, formats):
    paths = [one(results, output, formats) for one in (draw_counts, draw_prediction, draw_seconds)]
    return sum(paths, [])


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
