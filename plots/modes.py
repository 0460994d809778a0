#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the iteration is slow: a mode of the contraction operator, drawn from the tables of `nscdd modes`."""
import argparse
import os
import sys

import modes_in_space
import numpy as np
import style
from figures_2_3_4 import sector_angles, unit
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, PatchCollection
from matplotlib.colors import Normalize
from matplotlib.patches import Wedge
from mode_tables import ARROW, MAP, SHORTEST, SLOWEST, heading, number, power_of_ten, pulls_of, read, scaled

WIDTH, TALLEST = 140.0, 190.0  # mm
ABOVE, BELOW, EDGE = 7.0, 14.5, 2.0  # mm: heading; colour bar and key; around the packing
CELLS = 28                     # across, over which velocities are averaged
PIXELS_FROM = 3000             # grains from which a vector format holds them as an image


class Picture:
    """The part of the packing that is shown, and what it shows."""

    def __init__(self, rows, copies, zoom):
        self.copies = {c: style.column(copies, c) for c in ("grain", "subdomain", "x", "y", "radius",
                                                            "multiplicity", "velocity_x", "velocity_y")}
        self.pulls = pulls_of(rows, "xy")
        self.strongest = max(np.hypot(*pull) for pull in self.pulls.values())
        self.centroids = {s: np.array([self.copies[k][self.copies["subdomain"] == s].mean() for k in "xy"])
                          for s in np.unique(self.copies["subdomain"])}
        self.low, self.high = self.bounds()
        if zoom > 1:
            self.cut(zoom)
        c = self.copies
        self.split = self.split_copies()
        self.speed = np.hypot(c["velocity_x"], c["velocity_y"])
        self.diameter = 2 * np.median(c["radius"])
        self.longest = max(0.08 * (self.high - self.low)[0], 0.35 * self.diameter)  # of the arrows, m
        self.exponent = power_of_ten(self.speed.max())
        self.norm = Normalize(0, self.speed.max() / 10.0**self.exponent or 1)

    def bounds(self):
        c = self.copies
        centres, reach = np.column_stack([c["x"], c["y"]]), c["radius"][:, None]
        return (centres - reach).min(axis=0), (centres + reach).max(axis=0)

    def cut(self, zoom):
        """Leaves a part of the packing, ZOOM times narrower and lower, around its strongest impulse."""
        c = self.copies
        grain = max(self.pulls, key=lambda copy: np.hypot(*self.pulls[copy]))[0]
        half = (self.high - self.low) / 2 / zoom
        middle = np.array([c[k][c["grain"] == grain][0] for k in "xy"])
        middle = np.clip(middle, self.low + half, self.high - half)
        inside = np.all(np.abs(np.column_stack([c["x"], c["y"]]) - middle) <= half, axis=1)
        self.copies = {name: values[inside] for name, values in c.items()}
        self.low, self.high = self.bounds()

    def draw_grains(self, axes, rim):
        c = self.copies
        whole = c["multiplicity"] == 1
        size = 2 * c["radius"][whole]
        grains = EllipseCollection(size, size, np.zeros(len(size)), units="xy", cmap=MAP, norm=self.norm,
                                   offsets=np.column_stack([c["x"][whole], c["y"][whole]]),
                                   offset_transform=axes.transData, edgecolor="0.45", linewidth=0.4 * rim)
        grains.set_array(self.speed[whole] / 10.0**self.exponent)
        grains.set_rasterized(len(size) > PIXELS_FROM)
        axes.add_collection(grains)

    def split_copies(self):
        """Copies of grains of several subdomains, each a sector turned towards its own: (copy, half angle,
        middle angle), degrees."""
        c = self.copies
        shared = np.flatnonzero(c["multiplicity"] > 1)
        split = []
        for some in np.split(shared, np.flatnonzero(np.diff(c["grain"][shared])) + 1):
            angles = sector_angles(list(c["subdomain"][some]), self.centroids)
            split += [(i, 180 / len(some), angles[c["subdomain"][i]]) for i in some]
        return split

    def draw_split_grains(self, axes, rim):
        """They show the interface: dark rims."""
        c = self.copies
        sectors = [Wedge((c["x"][i], c["y"][i]), c["radius"][i], middle - half, middle + half)
                   for i, half, middle in self.split]
        patches = PatchCollection(sectors, cmap=MAP, norm=self.norm, edgecolor="black", linewidth=rim)
        patches.set_array(self.speed[[i for i, _, _ in self.split]] / 10.0**self.exponent)
        axes.add_collection(patches)

    def arrows(self):
        """Tails and vectors, m, of what the copies feel; each begins in its sector."""
        c, tails, arrows = self.copies, [], []
        for i, _, middle in self.split:
            arrow = self.pulls[c["grain"][i], c["subdomain"][i]] * self.longest / self.strongest
            if np.hypot(*arrow) > SHORTEST * self.longest:
                tails.append(np.array([c["x"][i], c["y"][i]]) + 0.5 * c["radius"][i] * unit(middle))
                arrows.append(arrow)
        return np.array(tails), np.array(arrows)

    def motion(self):
        """Places and velocities for thin arrows, and how far apart they are: those of the copies where there
        is room, else means over cells of the plane."""
        c = self.copies
        side = (self.high - self.low)[0] / CELLS
        velocities = np.column_stack([c["velocity_x"], c["velocity_y"]])
        places = np.column_stack([c["x"], c["y"]])
        if self.diameter > 0.8 * side:
            for i, _, middle in self.split:
                places[i] += 0.5 * c["radius"][i] * unit(middle)
            return places, velocities, self.diameter
        cells = np.floor((places - self.low) / side).astype(int)
        cell = np.unique(cells, axis=0, return_inverse=True)[1].ravel()

        def means(values):
            return np.column_stack([np.bincount(cell, v) / np.bincount(cell) for v in values.T])

        return means(places), means(velocities), side

    def draw_motion(self, axes):
        places, velocities, side = self.motion()
        speed = np.hypot(*velocities.T)
        visible = speed > SLOWEST * speed.max()
        if np.any(visible):
            axes.quiver(*places[visible].T, *velocities[visible].T, angles="xy", scale_units="xy",
                        scale=speed.max() / (0.8 * side), pivot="mid", color="black", width=0.0013, headwidth=4.5,
                        headlength=5, headaxislength=4.5, minlength=0, zorder=4)

    def draw_arrows(self, axes, tails, arrows):
        return axes.quiver(*tails.T, *arrows.T, angles="xy", scale_units="xy", scale=1, color=ARROW, width=0.003,
                           headwidth=3.8, headlength=4.4, headaxislength=4, minlength=0, zorder=5)


class Page:
    """A figure that shows LOW to HIGH, m, with room for a heading, a colour bar and a key."""

    def __init__(self, low, high):
        extent = high - low
        self.scale = min((WIDTH - 2 * EDGE) / extent[0], (TALLEST - ABOVE - BELOW - 2 * EDGE) / extent[1])  # mm/m
        self.height = self.scale * extent[1] + ABOVE + BELOW + 2 * EDGE
        self.fig = style.plt.figure(figsize=(WIDTH * style.MM, self.height * style.MM))
        self.axes = self.fig.add_axes([0, BELOW / self.height, 1, 1 - (ABOVE + BELOW) / self.height])
        middle, half, edge = (low + high) / 2, WIDTH / 2 / self.scale, EDGE / self.scale
        self.axes.set(xlim=(middle[0] - half, middle[0] + half), ylim=(low[1] - edge, high[1] + edge))
        self.axes.axis("off")

    def points(self, metres):
        return metres * self.scale / 25.4 * 72

    def explain(self, picture, row, arrows):
        self.fig.text(0.5, 1 - 2.0 / self.height, heading(row), ha="center", va="top", fontsize=9)
        bar = self.fig.colorbar(ScalarMappable(picture.norm, MAP), orientation="horizontal",
                                cax=self.fig.add_axes([0.07, 8.8 / self.height, 0.4, 2.0 / self.height]))
        bar.set_label(f"speed ({scaled('m/s', picture.exponent)}); thin arrows: velocities", labelpad=1)
        self.axes.quiverkey(arrows, 0.75, 9.8 / self.height, picture.longest,
                            f"interface impulse on a copy, ${number(picture.strongest)}$ kg m/s", labelpos="S",
                            coordinates="figure", fontproperties={"size": 9}, labelsep=0.09)


def draw(prefix, output, zoom, normal):
    rows, copies = read(prefix)
    folder, name = os.path.split(output)
    stem, kind = os.path.splitext(name)
    if "z" in copies[0]:
        return style.save(modes_in_space.figure(rows, copies, zoom, normal), folder, stem, [kind[1:]])
    if normal:
        raise style.DataError(f"{prefix}: --normal is of a section through spheres in space, met disks in the plane")
    picture = Picture(rows, copies, zoom)
    tails, arrows = picture.arrows()
    page = Page(np.min([picture.low, *(tails + arrows)], axis=0), np.max([picture.high, *(tails + arrows)], axis=0))
    rim = float(np.clip(0.07 * page.points(picture.diameter), 0.06, 0.7))
    picture.draw_grains(page.axes, rim)
    picture.draw_split_grains(page.axes, rim)
    picture.draw_motion(page.axes)
    page.explain(picture, rows[0], picture.draw_arrows(page.axes, tails, arrows))
    return style.save(page.fig, folder, stem, [kind[1:]])


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog="Example: nscdd modes hexagonal --epsilon "
                                     "1e-3 --output slow && plots/modes.py slow slow.svg")
    parser.add_argument("prefix", metavar="PREFIX", help="of PREFIX-impulses.csv and PREFIX-velocities.csv")
    parser.add_argument("output", metavar="OUTPUT", help="picture to write, .svg, .png or .pdf")
    parser.add_argument("--zoom", type=float, default=1, metavar="FACTOR",
                        help="show a part so many times narrower, around the strongest impulse (1)")
    parser.add_argument("--normal", choices="xyz", help="of the section through spheres in space (the axis along which "
                        "the mode moves least)")
    parser.add_argument("--dpi", type=int, default=200, metavar="DPI",
                        help="of .png, and of images in the others (200)")
    options = parser.parse_args()
    if not 1 <= options.zoom < np.inf:
        parser.error(f"--zoom: expected a number >= 1, met {options.zoom}")
    if os.path.splitext(options.output)[1][1:] not in style.FORMATS:
        parser.error(f"OUTPUT: '{options.output}' ends in none of {', '.join(style.FORMATS)}")
    if not 20 <= options.dpi <= 2000:
        parser.error(f"--dpi: expected a number in 20 ... 2000, met {options.dpi}")
    style.plt.rcParams["savefig.dpi"] = options.dpi
    try:
        for path in draw(options.prefix, options.output, options.zoom, options.normal):
            print(path)
    except style.DataError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
