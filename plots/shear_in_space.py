#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shear tests in space before and after: a section, the spheres in perspective, force chains and the interface."""
import os
import sys

import numpy as np
import perspective
import style
from figures_8_10 import SHARED, SUBDOMAINS
from matplotlib.collections import EllipseCollection, LineCollection

STRONG = style.plt.get_cmap("YlOrBr")  # of normal impulses
LAYERS = 24


def places_of(rows):
    return np.column_stack([style.column(rows, axis) for axis in "xyz"])


def colours_of(rows):
    """By subdomain; spheres that several of them share stand out."""
    return [SHARED if row["multiplicity"] > 1 else SUBDOMAINS[int(max(row["subdomain"], 0)) % len(SUBDOMAINS)]
            for row in rows]


def ends_of(rows):
    return tuple(np.column_stack([style.column(rows, f"{axis}_{end}") for axis in "xyz"]) for end in "ab")


def draw_section(axes, spheres, links, largest, low, high):
    """The disks in which a vertical plane in the middle cuts the spheres, and the contacts near it."""
    places, radii = places_of(spheres), style.column(spheres, "radius")
    middle = (low[1] + high[1]) / 2
    cut = np.abs(places[:, 1] - middle) < radii
    size = 2 * np.sqrt(radii[cut]**2 - (places[cut, 1] - middle)**2)
    colours = [colour for colour, inside in zip(colours_of(spheres), cut) if inside]
    few = cut.sum() < 1500
    axes.add_collection(EllipseCollection(size, size, np.zeros(len(size)), units="xy", offsets=places[cut][:, [0, 2]],
                                          offset_transform=axes.transData, facecolors=colours, edgecolors="white",
                                          linewidths=0.2 if few else 0, rasterized=not few))
    first, second = ends_of(links)
    impulse = style.column(links, "impulse_n")
    near = np.abs((first[:, 1] + second[:, 1]) / 2 - middle) < radii.max()
    near &= impulse > 0.05 * largest
    widest = 2.4 if few else 1.0
    axes.add_collection(LineCollection(np.stack([first[near], second[near]], axis=1)[:, :, [0, 2]],
                                       linewidths=np.minimum(impulse[near] / largest, 1.5) * widest, colors="black",
                                       capstyle="round", rasterized=not few))
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[2], high[2])
    axes.set_aspect("equal")


def draw_chains(axes, camera, spheres, links, largest):
    """Contacts that carry more than a quarter of what one in fifty exceeds, and the spheres of the interface; in
    layers, so that what is nearer hides what lies behind."""
    shared = [row for row in spheres if row["multiplicity"] > 1]
    places, radii = places_of(shared), style.column(shared, "radius")
    pale = np.broadcast_to(perspective.rgb([SHARED]) * 0.35 + 0.65, places.shape)
    impulse = style.column(links, "impulse_n")
    strong = impulse > 0.25 * largest
    first, second = (end[strong] for end in ends_of(links))
    part = np.minimum(impulse[strong] / largest, 1.5)
    colours = STRONG(np.clip(0.35 + 0.6 * part, 0, 1))[:, :3]
    many = len(links) > 12000
    reach = camera.project(camera.box)[1]
    layers = np.linspace(reach.min(), reach.max(), LAYERS + 1)
    of_ball = np.digitize(camera.project(places)[1], layers)
    of_line = np.digitize(camera.project((first + second) / 2)[1], layers)
    for layer in range(LAYERS + 2):
        ball, line = of_ball == layer, of_line == layer
        perspective.draw_balls(axes, camera, places[ball], radii[ball], pale[ball], zorder=1 + layer)
        perspective.draw_lines(axes, camera, first[line], second[line], part[line] * (1.1 if many else 2.6),
                               colours[line], rasterized=many, zorder=1.5 + layer)


def draw_one(results, output, formats, study, suffix=""):
    spheres = style.read_table(results, f"{study}/spheres{suffix}.csv", texts="case",
                               numbers="step x y z radius subdomain multiplicity")
    chains = style.read_table(results, f"{study}/chains{suffix}.csv", texts="case",
                              numbers="step x_a y_a z_a x_b y_b z_b impulse_n")
    steps = sorted({row["step"] for row in spheres})
    places, radii = places_of(spheres), style.column(spheres, "radius")
    low, high = (places - radii[:, None]).min(axis=0), (places + radii[:, None]).max(axis=0)
    camera = perspective.Camera(low, high)
    fig, grid = style.figure(style.COLUMN_AND_HALF, 200, 3, len(steps), squeeze=False)
    letters = iter("abcdefghij")
    for column, step in enumerate(steps):
        own = style.where(spheres, step=step)
        links = style.need(results, f"{study}/chains{suffix}.csv", chains, step=step)
        # Widths relative to the impulse that one contact in fifty exceeds in this state.
        largest = np.quantile(style.column(links, "impulse_n"), 0.98)
        section, balls, lines = grid[:, column]
        draw_section(section, own, links, largest, low, high)
        section.set_xlabel("$x$ (m)")
        section.set_ylabel("$z$ (m)")
        perspective.draw_balls(balls, camera, places_of(own), style.column(own, "radius"),
                               perspective.rgb(colours_of(own)))
        draw_chains(lines, camera, own, links, largest)
        for axes in (balls, lines):
            camera.draw_box(axes, low, high)
            camera.name_axes(axes, low, high)
            camera.frame(axes, 0.02 * camera.size)
    for row, text in enumerate(("section", "spheres", "strong contacts")):
        for column, step in enumerate(steps):
            when = f"after {step:.0f} steps" if step else "initial"
            style.panel(grid[row, column], next(letters), f"{text}, {when}")
    number = int(max(row["subdomain"] for row in spheres)) + 1
    shown = min(number, len(SUBDOMAINS))
    axes = grid[0, 0]
    handles = [axes.plot([], [], "o", color=SUBDOMAINS[k])[0] for k in range(shown)]
    handles += [axes.plot([], [], "o", color=SHARED)[0], axes.plot([], [], color="black", linewidth=2)[0]]
    labels = [f"subdomain {k + 1}" for k in range(shown)] + ["interface spheres", "normal impulse (width, colour)"]
    style.legend_above(fig, handles, labels, 4)
    return style.save(fig, output, f"{study}{suffix}", formats)


def draw(results, output, formats):
    paths = draw_one(results, output, formats, "shear-in-space")
    if os.path.exists(os.path.join(results, "shear-in-space/spheres-large.csv")):  # run on demand only
        paths += draw_one(results, output, formats, "shear-in-space", "-large")
    return paths


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
