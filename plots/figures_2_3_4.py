#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 2, 3 and 4: packings in two subdomains and their networks of impulses."""
import sys

import numpy as np
import style
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon

FIGURES = {"disks4": "figure-2", "disks8": "figure-3", "disks12": "figure-4"}
FILLS = ["#e6f0f9", "#f3cf9b", "#c3dbb5", "#cbabc8"]  # apart in grey as well: each darker than the one before
RIM = {"edgecolor": "0.25", "linewidth": 0.6}
DIAMETER = 16.0  # mm on paper, the same in the three figures
GAP = 0.08       # between the parts of a split grain, in diameters


def unit(degrees):
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])


def degrees(vector):
    return np.degrees(np.arctan2(vector[1], vector[0]))


def sector_angles(subdomains, centroids):
    """Bisectors of the sectors of a split grain: equal sectors, as its mass is shared equally, each turned
    towards its subdomain."""
    around = np.mean([centroids[s] for s in subdomains], axis=0)
    offsets = {s: centroids[s] - around for s in subdomains}
    if len(subdomains) == 2:  # cells of a grid lie side by side or one above the other
        axis = int(np.argmax(np.abs(offsets[subdomains[0]])))
        return {s: 90.0 * axis + (0 if d[axis] > 0 else 180) for s, d in offsets.items()}
    order = sorted(subdomains, key=lambda s: degrees(offsets[s]))
    step = 360 / len(order)
    turn = np.mean([degrees(offsets[s]) - i * step for i, s in enumerate(order)])
    return {s: turn + i * step for i, s in enumerate(order)}


def part_outline(radius, angle, half):
    """Corner and outline, seen from the centre, of a sector of a disk. Its straight sides are drawn back by
    half the gap, so that the disk keeps its size and its contacts."""
    corner = GAP * radius / np.sin(np.radians(half)) * unit(angle)
    ends = []
    for side in (-half, half):  # where the sides meet the circle
        along = unit(angle + side)
        reach = -corner @ along + np.sqrt((corner @ along)**2 - corner @ corner + radius**2)
        ends.append(degrees(corner + reach * along))
    arc = ends[0] + (ends[1] - ends[0]) % 360 * np.linspace(0, 1, 90)
    return corner, np.vstack([corner, radius * unit(arc).T])


def number_angle(links, low, high):
    """Where a part of a grain, from LOW to HIGH degrees, has room for its number: amid the widest gap between
    links or, next to a split, nearer to the split, since the cut line runs further out."""
    edges = [low, *sorted(low + (a - low) % 360 for a in links if (a - low) % 360 < high - low), high]
    widest = int(np.argmax(np.diff(edges)))
    share = 0.5 if high - low > 359 else {0: 0.3, len(edges) - 2: 0.7}.get(widest, 0.5)
    return edges[widest] + share * (edges[widest + 1] - edges[widest])


class Packing:
    def __init__(self, grains, links):
        self.grains, self.links = grains, links
        self.size = 2 * np.mean(style.column(grains, "radius"))
        self.centres = {g["grain"]: np.array([g["x"], g["y"]]) for g in grains}
        self.midpoints = {}  # of the links of each subdomain: what the partition distributes
        for link in links:
            middle = [(link["x_a"] + link["x_b"]) / 2, (link["y_a"] + link["y_b"]) / 2]
            self.midpoints.setdefault(int(link["subdomain"]), []).append(middle)
        self.centroids = {s: np.mean(middles, axis=0) for s, middles in self.midpoints.items()}
        self.shifts = {}  # of the centre of each part of a split grain
        reach = style.column(grains, "radius")[:, None]
        centres = np.array(list(self.centres.values()))
        self.low, self.high = (centres - reach).min(axis=0), (centres + reach).max(axis=0)

    def draw_grain(self, axes, grain):
        index, radius, centre = grain["grain"], grain["radius"], self.centres[grain["grain"]]
        own = [k for k in self.links if index in (k["grain_a"], k["grain_b"])]
        others = [k["grain_b"] if k["grain_a"] == index else k["grain_a"] for k in own]
        towards = [degrees(self.centres[other] - centre) for other in others]
        subdomains = sorted({int(k["subdomain"]) for k in own})
        if len(subdomains) < 2:
            face = FILLS[subdomains[0] % len(FILLS)] if subdomains else "white"
            axes.add_patch(Circle(centre, radius, facecolor=face, **RIM))
            first = towards[0] if towards else 0
            numbers = [number_angle(towards, first, first + 360)]
        else:
            sectors, half = sector_angles(subdomains, self.centroids), 180 / len(subdomains)
            for s, angle in sectors.items():
                self.shifts[index, s], outline = part_outline(radius, angle, half)
                axes.add_patch(Polygon(centre + outline, facecolor=FILLS[s % len(FILLS)], **RIM))
            numbers = [number_angle(towards, angle - half, angle + half) for angle in sectors.values()]
        for angle in numbers:
            axes.text(*(centre + 0.68 * radius * unit(angle)), f"{index:g}", fontsize=7, color="0.2",
                      ha="center", va="center_baseline")

    def draw_links(self, axes):
        strongest = np.max(np.abs(style.column(self.links, "impulse")))
        for link in self.links:
            ends = np.array([self.centres[i] + self.shifts.get((i, int(link["subdomain"])), 0)
                             for i in (link["grain_a"], link["grain_b"])])
            pressed = link["impulse"] > 0
            width = 0.6 + 2.8 * abs(link["impulse"]) / strongest
            axes.plot(*ends.T, color="black" if pressed else style.GREY, linewidth=width,
                      linestyle="-" if link["active"] else (0, (3.2 / width, 2 / width)),
                      dash_capstyle="butt", solid_capstyle="butt", zorder=3 if pressed else 2.5)
            axes.plot(*ends.T, "o", color="black", markersize=2.2, zorder=4)

    def draw_velocity(self, axes, grain):
        """Double arrow along the prescribed velocity, on the outer side of the grain; returns its tail."""
        centre, velocity = self.centres[grain["grain"]], np.array([grain["velocity_x"], grain["velocity_y"]])
        along = velocity / np.hypot(*velocity)
        across = np.array([-along[1], along[0]])
        length, head, width = 0.6 * self.size, 0.2 * self.size, 0.055 * self.size
        reach = grain["radius"] + 0.06 * self.size
        inward = (centre - (self.low + self.high) / 2) @ along <= 0
        tip = centre - reach * along if inward else centre + (reach + length) * along
        lines = [[tip - length * along + side * width * across, tip - width * (along - side * across)]
                 for side in (-1, 1)]  # the shafts end on the barbs
        lines.append([tip - head * (along + 0.9 * across), tip, tip - head * (along - 0.9 * across)])
        for line in lines:
            axes.plot(*np.array(line).T, color="black", linewidth=1.1, solid_joinstyle="miter", zorder=6)
        return tip - length * along if inward else tip

    def draw_cut(self, axes):
        """Line of the grid between two subdomains: the middle of the centres, where the partition puts it."""
        x = [c[0] for c in self.centres.values()]
        cut = (min(x) + max(x)) / 2
        left, right = sorted(self.centroids, key=lambda s: self.centroids[s][0])
        if max(m[0] for m in self.midpoints[left]) > cut + 1e-9 * self.size or min(
                m[0] for m in self.midpoints[right]) < cut:
            return  # the links were distributed some other way
        bottom, top = self.low[1] - 0.12 * self.size, self.high[1] + 0.36 * self.size
        axes.plot([cut, cut], [bottom, top], color="black", linewidth=0.6, linestyle=(0, (6, 3)), zorder=5)
        for s, side, align in ((left, -1, "right"), (right, 1, "left")):
            axes.text(cut + side * 0.09 * self.size, top - 0.16 * self.size, f"subdomain {s + 1}", ha=align,
                      va="center", fontsize=8)

    def draw(self, axes):
        for grain in self.grains:
            self.draw_grain(axes, grain)
        self.draw_links(axes)
        if len(self.midpoints) == 2:
            self.draw_cut(axes)
        tails = [self.draw_velocity(axes, g) for g in self.grains if g["velocity_x"] or g["velocity_y"]]
        return np.min([self.low, *tails], axis=0), np.max([self.high, *tails], axis=0)

    def draw_legend(self, fig, columns):
        impulses = style.column(self.links, "impulse")
        speed = max(np.hypot(g["velocity_x"], g["velocity_y"]) for g in self.grains)
        pressed, pulled = (f"(up to {max(np.max(sign * impulses), 0):.2f} kg m/s)" for sign in (1, -1))
        fig.legend(loc="lower center", ncol=columns, columnspacing=1.6, borderpad=0.1, handles=[
            Line2D([], [], color="black", linewidth=2.2, label=f"compression, active {pressed}"),
            Line2D([], [], color=style.GREY, linewidth=1.4, linestyle=(0, (2.3, 1.4)),
                   label=f"tension, not active {pulled}"),
            Line2D([], [], marker="o", linestyle="none", markersize=8, fillstyle="left",
                   markerfacecolor=FILLS[0], markerfacecoloralt=FILLS[1], markeredgecolor=RIM["edgecolor"],
                   markeredgewidth=0.6, label="grain split between the subdomains"),
            Line2D([], [], marker=r"$\Leftarrow$", linestyle="none", color="black", markersize=11,
                   markeredgewidth=0.2, label=f"prescribed velocity ({speed:g} m/s)")])


def draw(results, output, formats):
    grains = style.read_table(results, "figures-2-3-4/grains.csv", texts="case",
                              numbers="grain x y radius velocity_x velocity_y")
    links = style.read_table(results, "figures-2-3-4/links.csv", texts="case", flags="active",
                             numbers="grain_a grain_b x_a y_a x_b y_b subdomain impulse")
    paths = []
    for case, name in FIGURES.items():
        own_grains = style.need(results, "figures-2-3-4/grains.csv", grains, case=case)
        own_links = style.need(results, "figures-2-3-4/links.csv", links, case=case)
        known = {g["grain"] for g in own_grains}
        if any(k[c] not in known for k in own_links for c in ("grain_a", "grain_b")):
            raise style.DataError(f"{results}/figures-2-3-4/links.csv: column 'grain_a' or 'grain_b' names "
                                  f"a grain of '{case}' that grains.csv lacks")
        fig = style.plt.figure(figsize=(style.COLUMN, style.COLUMN))
        axes = fig.add_axes([0, 0, 1, 1])
        packing = Packing(own_grains, own_links)
        low, high = packing.draw(axes)
        # The canvas follows the packing, so that a diameter measures DIAMETER mm in every figure.
        scale = packing.size / DIAMETER
        width = max(88, (high[0] - low[0]) / scale + 4)
        columns = 2 if width > 110 else 1
        below, above = (15 if columns == 2 else 23), 7.5
        fig.set_size_inches(width * style.MM, ((high[1] - low[1]) / scale + below + above) * style.MM)
        packing.draw_legend(fig, columns)
        middle = (low[0] + high[0]) / 2
        axes.set(xlim=(middle - width / 2 * scale, middle + width / 2 * scale),
                 ylim=(low[1] - below * scale, high[1] + above * scale), aspect="equal")
        axes.axis("off")
        paths += style.save(fig, output, name, formats)
    return paths


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
