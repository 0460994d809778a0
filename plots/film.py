#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A film of a simulation: the disks of every kept step, shaded by how far they have turned.

usage: film.py RUN.h5 OUTPUT.gif [--every N] [--width PIXELS]
"""
import argparse
import os
import sys

import style  # the journal look, and matplotlib without a screen

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.collections import EllipseCollection

FREE, DRIVEN = "#c6d8ea", "0.35"


def read(path, every):
    """Radii, driven flags, and (time, x, y, angle) of every `every`-th kept step."""
    frames = []
    with h5py.File(path) as run:
        radius = np.array(run["system/radius"])
        driven = np.array(run["system/driven_by"]) >= 0
        steps = run["steps"]
        for k in range(0, len(steps["time"]), every):
            frames.append((float(steps["time"][k]), *(steps[name][k] for name in ("x", "y", "angle"))))
    if not frames:
        raise style.DataError(f"{path}: no steps")
    return radius, driven, frames


def film(path, output, every, width):
    radius, driven, frames = read(path, every)
    x, y = np.concatenate([f[1] for f in frames]), np.concatenate([f[2] for f in frames])
    margin = radius.max()
    box = (x.min() - margin, x.max() + margin, y.min() - margin, y.max() + margin)
    dpi = 100
    height = width * (box[3] - box[2]) / (box[1] - box[0])
    fig = plt.figure(figsize=(width / dpi, height / dpi), dpi=dpi)
    axes = fig.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    axes.set_xlim(box[:2])
    axes.set_ylim(box[2:])
    size = 2 * radius
    zero = np.zeros(len(radius))
    colours = np.where(driven, DRIVEN, FREE)
    writer = PillowWriter(fps=12)
    with writer.saving(fig, output, dpi):
        for time, px, py, angle in frames:
            for artist in list(axes.collections) + list(axes.texts):
                artist.remove()
            axes.add_collection(EllipseCollection(size, size, zero, units="xy", offsets=np.column_stack([px, py]),
                                                  transOffset=axes.transData, facecolors=colours,
                                                  edgecolors="white", linewidths=0.1))
            # A spot on every grain shows its rotation.
            spots = np.column_stack([px + 0.6 * radius * np.cos(angle), py + 0.6 * radius * np.sin(angle)])
            axes.add_collection(EllipseCollection(0.5 * radius, 0.5 * radius, zero, units="xy", offsets=spots,
                                                  transOffset=axes.transData, facecolors="#1f5f99"))
            axes.text(0.5, 0.985, f"$t$ = {time:.2f} s", transform=axes.transAxes, ha="center", va="top")
            writer.grab_frame()
    plt.close(fig)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="RUN.h5", help="trajectory of nscdd simulate")
    parser.add_argument("output", metavar="OUTPUT.gif")
    parser.add_argument("--every", type=int, default=1, help="take every N-th kept step (default 1)")
    parser.add_argument("--width", type=int, default=420, help="pixels (default 420)")
    options = parser.parse_args()
    try:
        film(options.run, options.output, max(1, options.every), options.width)
    except (OSError, KeyError, style.DataError) as error:
        print(f"error: {options.run}: {error}", file=sys.stderr)
        return 2
    print(os.path.normpath(options.output))
    return 0


if __name__ == "__main__":
    sys.exit(main())
