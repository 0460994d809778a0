#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A film of a simulation: the grains of every kept step, with marks that show how far they have turned. Spheres are
seen in perspective.

usage: film.py RUN.h5 OUTPUT.gif [--every N] [--width PIXELS]
"""
import argparse
import os
import sys

import perspective
import style  # the journal look, and matplotlib without a screen

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.collections import EllipseCollection

FREE, DRIVEN, MARK = "#c6d8ea", "0.35", "#1f5f99"
PLANE, SPACE = ("x", "y", "angle"), ("x", "y", "z", "turn_w", "turn_x", "turn_y", "turn_z")
DPI = 100


def read(path, every):
    """Radii, driven flags, and the time and the arrays of every `every`-th kept step by their names."""
    frames = []
    with h5py.File(path) as run:
        radius = np.array(run["system/radius"])
        driven = np.array(run["system/driven_by"]) >= 0
        steps = run["steps"]
        names = SPACE if "z" in steps else PLANE
        for k in range(0, len(steps["time"]), every):
            frames.append((float(steps["time"][k]), {name: steps[name][k] for name in names}))
    if not frames:
        raise style.DataError(f"{path}: no steps")
    return radius, driven, frames


class Disks:
    """Disks in the plane. A spot on every grain shows its rotation."""
    clock = (0.5, "center")  # where the time stands, and how it is aligned

    def __init__(self, radius, driven, frames):
        self.radius, self.colours = radius, np.where(driven, DRIVEN, FREE)
        places = np.concatenate([self.places(now) for _, now in frames])
        self.low, self.high = places.min(axis=0) - radius.max(), places.max(axis=0) + radius.max()
        self.ratio = (self.high - self.low)[1] / (self.high - self.low)[0]

    @staticmethod
    def places(now):
        return np.column_stack([now["x"], now["y"]])

    def set_limits(self, axes):
        axes.set_xlim(self.low[0], self.high[0])
        axes.set_ylim(self.low[1], self.high[1])

    def draw(self, axes, now):
        places, radius, angle = self.places(now), self.radius, now["angle"]
        look = {"units": "xy", "offset_transform": axes.transData}
        zero = np.zeros(len(radius))
        axes.add_collection(EllipseCollection(2 * radius, 2 * radius, zero, offsets=places, facecolors=self.colours,
                                              edgecolors="white", linewidths=0.1, **look))
        spots = places + 0.6 * radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        axes.add_collection(EllipseCollection(0.5 * radius, 0.5 * radius, zero, offsets=spots, facecolors=MARK, **look))


class Spheres:
    """Spheres in space. The ends of three axes of each show its rotation."""
    clock = (0.02, "left")  # the middle has the box

    def __init__(self, radius, driven, frames):
        self.radius, self.colours = radius, perspective.rgb(np.where(driven, DRIVEN, FREE))
        places = np.concatenate([self.places(now) for _, now in frames])
        self.low, self.high = places.min(axis=0) - radius.max(), places.max(axis=0) + radius.max()
        self.camera = perspective.Camera(self.low, self.high)
        screen = self.camera.project(self.camera.box)[0]
        self.ratio = np.ptp(screen[:, 1]) / np.ptp(screen[:, 0])

    @staticmethod
    def places(now):
        return np.column_stack([now["x"], now["y"], now["z"]])

    def set_limits(self, axes):
        self.camera.frame(axes, 0.01 * self.camera.size)

    def draw(self, axes, now):
        turns = np.column_stack([now[f"turn_{k}"] for k in "wxyz"])
        perspective.draw_balls(axes, self.camera, self.places(now), self.radius, self.colours, turns, MARK)
        self.camera.draw_box(axes, self.low, self.high)


def film(path, output, every, width):
    radius, driven, frames = read(path, every)
    scene = (Spheres if "z" in frames[0][1] else Disks)(radius, driven, frames)
    fig = plt.figure(figsize=(width / DPI, width * scene.ratio / DPI), dpi=DPI)
    axes = fig.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    scene.set_limits(axes)
    writer = PillowWriter(fps=12)
    with writer.saving(fig, output, DPI):
        for time, now in frames:
            for artist in list(axes.collections) + list(axes.texts):
                artist.remove()
            scene.draw(axes, now)
            place, alignment = scene.clock
            axes.text(place, 0.985, f"$t$ = {time:.2f} s", transform=axes.transAxes, ha=alignment, va="top")
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
