#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the iteration is slow: a mode of the contraction operator, drawn from the tables of `nscdd modes`."""
import argparse
import os
import sys

import numpy as np
import style
from figures_2_3_4 import sector_angles, unit
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, PatchCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.patches import Wedge

WIDTH, TALLEST = 140.0, 190.0  # mm
ABOVE, BELOW, EDGE = 7.0, 14.5, 2.0  # mm: heading; colour bar and key; around the packing
# Light to dark, in grey as well, but not so dark that the arrows are lost.
MAP = ListedColormap(style.plt.get_cmap("YlOrBr")(np.linspace(0, 0.8, 256)))
ARROW = "#1f5f99"
CELLS = 28                     # across, over which velocities are averaged
SHORTEST = 0.04                # of the arrows, as a part of the longest
SLOWEST = 0.15                 # of the mean velocities shown, as a part of the fastest
PIXELS_FROM = 3000             # grains from which a vector format holds them as an image


def read(prefix):
    try:
        return read_tables(prefix)
    except style.NoRows:
        raise style.DataError(f"{prefix}: no mode in its tables (no interface, or no mode was found, as nscdd modes "
                              "says): nothing to draw") from None


def read_tables(prefix):
    folder, name = os.path.split(prefix)
    rows = style.read_table(folder, f"{name}-impulses.csv", texts="case end",
                            numbers="epsilon eta eigenvalue grain subdomain_first subdomain_second "
                                    "impulse_x impulse_y")
    copies = style.read_table(folder, f"{name}-velocities.csv", texts="case",
                              numbers="grain subdomain x y radius multiplicity velocity_x velocity_y", if_there="z")
    if "z" in copies[0]:
        raise style.DataError(f"{prefix}: expected a mode in the plane, met one of spheres in space, which this script "
                              "does not draw")
    return rows, copies


def power_of_ten(largest):
    return int(np.floor(np.log10(largest))) if largest > 0 else 0


def scaled(name, exponent):
    return name if exponent == 0 else rf"$10^{{{exponent}}}$ {name}"


class Picture:
    """The part of the packing that is shown, and what it shows."""

    def __init__(self, rows, copies, zoom):
        self.rows = rows
        self.copies = {c: style.column(copies, c) for c in ("grain", "subdomain", "x", "y", "radius",
                                                            "multiplicity", "velocity_x", "velocity_y")}
        self.pull()
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

    def pull(self):
        """Impulses that the copies of shared grains feel: those of the rows, which tie two copies each, with
        opposite signs. However the copies of a grain are tied, these are the same."""
        pulls = {}
        for row in self.rows:
            impulse = np.array([row["impulse_x"], row["impulse_y"]])
            for end, sign in (("first", -1), ("second", 1)):
                copy = row["grain"], row[f"subdomain_{end}"]
                pulls[copy] = pulls.get(copy, 0) + sign * impulse
        self.pulls = pulls
        self.strongest = max(np.hypot(*pull) for pull in pulls.values())

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


def number(value):
    """As a label has it: powers of ten as such, infinity by its sign."""
    if value == 0 or np.isinf(value):
        return "0" if value == 0 else r"\infty"
    exponent = power_of_ten(abs(value))
    if -2 <= exponent <= 3:
        return f"{value:.3g}"
    mantissa = f"{value / 10.0**exponent:.3g}"
    return (rf"{mantissa}\times " if mantissa != "1" else "") + rf"10^{{{exponent}}}"


def heading(row):
    return (rf"{row['case']}: $\varepsilon = {number(row['epsilon'])}$ 1/kg, $\eta = {number(row['eta'])}$ 1/kg, "
            rf"{row['end']} end, $\mu = {row['eigenvalue']:.6g}$; $F^T\!P F = 1$ J")


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


def draw(prefix, output, zoom):
    rows, copies = read(prefix)
    picture = Picture(rows, copies, zoom)
    tails, arrows = picture.arrows()
    page = Page(np.min([picture.low, *(tails + arrows)], axis=0), np.max([picture.high, *(tails + arrows)], axis=0))
    rim = float(np.clip(0.07 * page.points(picture.diameter), 0.06, 0.7))
    picture.draw_grains(page.axes, rim)
    picture.draw_split_grains(page.axes, rim)
    picture.draw_motion(page.axes)
    page.explain(picture, rows[0], picture.draw_arrows(page.axes, tails, arrows))
    folder, name = os.path.split(output)
    stem, kind = os.path.splitext(name)
    return style.save(page.fig, folder, stem, [kind[1:]])


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog="Example: nscdd modes hexagonal --epsilon "
                                     "1e-3 --output slow && plots/modes.py slow slow.svg")
    parser.add_argument("prefix", metavar="PREFIX", help="of PREFIX-impulses.csv and PREFIX-velocities.csv")
    parser.add_argument("output", metavar="OUTPUT", help="picture to write, .svg, .png or .pdf")
    parser.add_argument("--zoom", type=float, default=1, metavar="FACTOR",
                        help="show a part so many times narrower, around the strongest impulse (1)")
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
        for path in draw(options.prefix, options.output, options.zoom):
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
