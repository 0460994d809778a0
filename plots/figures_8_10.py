#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 8 and 10: shear tests before and after, grains by subdomain, force chains by width."""
import os
import sys

import numpy as np
import style
from matplotlib.collections import EllipseCollection, LineCollection

# Subdomains in turn; grains that several of them share, and disks that boundaries drive.
SUBDOMAINS = ["#c6d8ea", "#f3d9b1", "#cfe3c5", "#e4cbe0"]
SHARED, DRIVEN, CHAIN = "#b03a2e", "0.35", "black"


def look(rows):
    """Widths in points of the edge of a disk and of a strong contact, and whether an SVG holds them as pixels."""
    if len(rows) < 3000:
        return 0.15, 2.2, False
    return (0.0, 0.7, False) if len(rows) < 30000 else (0.0, 0.35, True)


def draw_disks(axes, rows):
    colours = []
    for row in rows:
        if row["driven"]:
            colours.append(DRIVEN)
        elif row["multiplicity"] > 1:
            colours.append(SHARED)
        else:
            colours.append(SUBDOMAINS[int(max(row["subdomain"], 0)) % len(SUBDOMAINS)])
    size = 2 * style.column(rows, "radius")
    places = np.column_stack([style.column(rows, "x"), style.column(rows, "y")])
    edge, _, pixels = look(rows)
    axes.add_collection(EllipseCollection(size, size, np.zeros(len(rows)), units="xy", offsets=places,
                                          transOffset=axes.transData, facecolors=colours, edgecolors="white",
                                          linewidths=edge, rasterized=pixels))
    margin = size.max()
    axes.set_xlim(places[:, 0].min() - margin, places[:, 0].max() + margin)
    axes.set_ylim(places[:, 1].min() - margin, places[:, 1].max() + margin)
    axes.set_aspect("equal")


def draw_chains(axes, rows, largest, widest, pixels):
    strong = [r for r in rows if r["impulse_n"] > 0.02 * largest]
    segments = [[(r["x_a"], r["y_a"]), (r["x_b"], r["y_b"])] for r in strong]
    widths = np.minimum(style.column(strong, "impulse_n") / largest, 1.5) * widest if strong else []
    axes.add_collection(LineCollection(segments, linewidths=widths, colors=CHAIN, capstyle="round",
                                       rasterized=pixels))


def draw_one(results, output, formats, study, suffix="", name=None, window=None):
    """The figure NAME, by default called after the tables STUDY/disks SUFFIX.csv and STUDY/chains SUFFIX.csv. WINDOW,
    ((x from, to), (y from, to)), is shown of packings that are much wider than high, one state below the other."""
    disks = style.read_table(results, f"{study}/disks{suffix}.csv", texts="case",
                             numbers="step x y radius subdomain multiplicity", flags="driven")
    chains = style.read_table(results, f"{study}/chains{suffix}.csv", texts="case",
                              numbers="step x_a y_a x_b y_b impulse_n")
    steps = sorted({r["step"] for r in disks})
    if window:
        (left, right), (low, high) = window
        disks = [r for r in disks if left <= r["x"] <= right and low <= r["y"] <= high]
        chains = [r for r in chains if left <= r["x_a"] <= right]
    rows, columns = (len(steps), 1) if window else (1, len(steps))
    fig, grid = style.figure(style.COLUMN_AND_HALF, 98, rows, columns, squeeze=False, sharex=bool(window),
                             sharey=not window)
    for axes, letter, step in zip(grid.flat, "abcdefgh", steps):
        own = style.where(disks, step=step)
        draw_disks(axes, own)
        links = style.where(chains, step=step)
        # Widths relative to the impulse that one contact in fifty exceeds in this state.
        largest = np.quantile(style.column(links, "impulse_n"), 0.98) if links else 1.0
        _, widest, pixels = look(own)
        draw_chains(axes, links, largest, widest, pixels)
        if window:
            axes.set(xlim=window[0], ylim=window[1], ylabel="$y$ (m)")
        style.panel(axes, letter, f"after {step:.0f} steps" if step else "initial")
        if not window or axes is grid.flat[-1]:
            axes.set_xlabel("$x$ (m)")
    grid.flat[0].set_ylabel("$y$ (m)")
    number = int(max(r["subdomain"] for r in disks)) + 1
    handles = [grid.flat[0].plot([], [], "o", color=SUBDOMAINS[k % len(SUBDOMAINS)])[0]
               for k in range(min(number, len(SUBDOMAINS)))]
    handles += [grid.flat[0].plot([], [], "o", color=SHARED)[0], grid.flat[0].plot([], [], "o", color=DRIVEN)[0],
                grid.flat[0].plot([], [], color=CHAIN, linewidth=2)[0]]
    labels = [f"subdomain {k + 1}" for k in range(min(number, len(SUBDOMAINS)))]
    labels += ["interface grains", "boundaries", "normal impulse (width)"]
    style.legend_above(fig, handles, labels, 3)
    return style.save(fig, output, name or f"{study}{suffix}", formats)


def draw_8(results, output, formats):
    paths = draw_one(results, output, formats, "figure-8")
    if os.path.exists(os.path.join(results, "figure-8/disks-large.csv")):  # run on demand only
        paths += draw_one(results, output, formats, "figure-8", "-large")
    return paths


def draw_10(results, output, formats):
    return draw_one(results, output, formats, "figure-10")


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw_8, draw_10))
