# SPDX-License-Identifier: GPL-3.0-or-later
"""A mode of a packing of spheres: a section through the strongest impulse, and in perspective the spheres behind it, all
velocities, and the interface with its impulses."""
import numpy as np
import perspective
import style
from figures_2_3_4 import degrees, unit
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, PatchCollection
from matplotlib.colors import Normalize
from matplotlib.patches import Wedge
from mode_tables import (ARROW, MAP, SHORTEST, SLOWEST, heading, number, power_of_ten, pulls_of, scaled, vectors)

AXES = "xyz"
WIDTH = 140.0                      # mm
ABOVE, BELOW, TITLE = 8.0, 15.0, 5.0  # mm: heading; colour bar and key; names of the panels
LEFT, UNDER, GAP = 12.0, 9.0, 5.0  # mm: numbers and name of an axis of the section, and between the panels
LAYERS = 24                        # from far to near, so that what is nearer hides what lies behind
TALLEST = 80.0                     # mm, of a panel
CELLS = 9                          # across, over which velocities are averaged
MOST = 400                         # velocities that are drawn one by one
# Degrees, by the normal of the section, which is seen from the front.
AZIMUTH, ELEVATION = {"x": 62.0, "y": 28.0, "z": 28.0}, {"x": 16.0, "y": 16.0, "z": 42.0}
SHRUNK = 0.5                       # size of the spheres of the interface, which must not hide the arrows
EVEN = 0.9                         # parts of the motion along two axes are as good as equal above it


class Mode:
    """The copies that are shown, and the impulses on them."""

    def __init__(self, rows, copies, zoom):
        self.places, self.velocities = vectors(copies, "", AXES), vectors(copies, "velocity_", AXES)
        self.radius, self.multiplicity = style.column(copies, "radius"), style.column(copies, "multiplicity")
        self.grain, self.subdomain = style.column(copies, "grain"), style.column(copies, "subdomain")
        self.centroids = {s: self.places[self.subdomain == s].mean(axis=0) for s in np.unique(self.subdomain)}
        pulls = pulls_of(rows, AXES)
        none = np.zeros(3)
        self.pulls = np.array([pulls.get((g, s), none) for g, s in zip(self.grain, self.subdomain)])
        self.strongest = np.linalg.norm(self.pulls, axis=1).max()
        self.middle = self.places[np.argmax(np.linalg.norm(self.pulls, axis=1))]  # of the strongest impulse
        if zoom > 1:
            self.cut(zoom)
        self.low, self.high = self.bounds()
        self.speed = np.linalg.norm(self.velocities, axis=1)
        self.exponent = power_of_ten(self.speed.max())
        self.norm = Normalize(0, self.speed.max() / 10.0**self.exponent or 1)
        self.colours = MAP(self.norm(self.speed / 10.0**self.exponent))[:, :3]
        self.diameter = 2 * np.median(self.radius)
        self.longest = max(0.16 * (self.high - self.low).max(), 0.5 * self.diameter)  # of the arrows, m
        # Copies of a grain one behind the other, the first of which stands for it where it is drawn whole.
        self.first = np.append(True, np.diff(self.grain) != 0)

    def bounds(self):
        reach = self.radius[:, None]
        return (self.places - reach).min(axis=0), (self.places + reach).max(axis=0)

    def cut(self, zoom):
        """Leaves a part of the packing, ZOOM times smaller along each axis, around its strongest impulse."""
        low, high = self.bounds()
        half = (high - low) / 2 / zoom
        middle = np.clip(self.middle, low + half, high - half)
        inside = np.all(np.abs(self.places - middle) <= half, axis=1)
        for name in ("places", "velocities", "radius", "multiplicity", "grain", "subdomain", "pulls"):
            setattr(self, name, getattr(self, name)[inside])

    def normal(self):
        """The axis along which the mode moves least; where two are as good as equal, that along which one looks
        first: y, x, z."""
        motion = dict(zip(AXES, np.sum(self.velocities**2, axis=0)))
        return next(axis for axis in "yxz" if EVEN * motion[axis] <= min(motion.values()))

    def visible_pulls(self):
        """The copies whose impulse is seen as an arrow, and the arrows, m."""
        size = np.linalg.norm(self.pulls, axis=1)
        seen = np.flatnonzero(size > SHORTEST * self.strongest)
        return seen, self.pulls[seen] * self.longest / self.strongest

    def motion(self):
        """Places and velocities of arrows: those of the copies where there is room, else means over cells. And the
        length of the longest, m."""
        if len(self.places) <= MOST:
            return self.places, self.velocities, 1.3 * self.diameter
        side = (self.high - self.low).max() / CELLS
        cells = np.floor((self.places - self.low) / side).astype(int)
        cell = np.unique(cells, axis=0, return_inverse=True)[1].ravel()

        def means(values):
            return np.column_stack([np.bincount(cell, v) / np.bincount(cell) for v in values.T])

        return means(self.places), means(self.velocities), 0.95 * side


class Section:
    """What a plane through the strongest impulse cuts."""

    def __init__(self, mode, normal):
        self.mode, self.normal = mode, normal
        self.axis = AXES.index(normal)
        self.plane = [k for k in range(3) if k != self.axis]
        self.at = mode.middle[self.axis]
        off = np.abs(mode.places[:, self.axis] - self.at)
        self.copies = np.flatnonzero(off < mode.radius)
        self.cut_radius = np.sqrt(np.maximum(mode.radius**2 - off**2, 0))
        self.split()
        seen, arrows = mode.visible_pulls()
        here = np.isin(seen, self.copies)
        self.from_copies, self.arrows = self.tails[seen[here]], arrows[here][:, self.plane]
        ends = self.from_copies + self.arrows
        self.low = np.min([mode.low[self.plane], *ends], axis=0)
        self.high = np.max([mode.high[self.plane], *ends], axis=0)

    def split(self):
        """Sectors of the copies of shared grains, and where the arrows of copies begin: each in its own sector."""
        mode, places = self.mode, self.mode.places[:, self.plane]
        self.shared = self.copies[mode.multiplicity[self.copies] > 1]
        self.sectors, self.tails = [], places + 0.0
        ends = np.flatnonzero(np.diff(mode.grain[self.shared])) + 1
        for some in np.split(self.shared, ends) if len(self.shared) else []:
            for i, middle in zip(some, self.bisectors(some)):
                half = 180 / len(some)
                self.sectors.append(Wedge(places[i], self.cut_radius[i], middle - half, middle + half))
                self.tails[i] += 0.5 * self.cut_radius[i] * unit(middle)

    def bisectors(self, some):
        """Of the equal sectors of the copies SOME of one grain, each turned towards its subdomain; degrees."""
        centroids = np.array([self.mode.centroids[s][self.plane] for s in self.mode.subdomain[some]])
        towards = [degrees(offset) for offset in centroids - centroids.mean(axis=0)]
        order = np.argsort(towards, kind="stable")
        step = 360 / len(some)
        turn = np.mean([towards[i] - k * step for k, i in enumerate(order)])
        angles = np.empty(len(some))
        angles[order] = turn + step * np.arange(len(some))
        return angles

    def draw(self, axes, points_per_metre):
        mode, plane = self.mode, self.plane
        places, radius = mode.places[:, plane], self.cut_radius
        rim = float(np.clip(0.05 * points_per_metre * mode.diameter, 0.06, 0.7))
        many = len(self.copies) > 3000
        whole = self.copies[mode.multiplicity[self.copies] == 1]
        axes.add_collection(EllipseCollection(
            2 * radius[whole], 2 * radius[whole], np.zeros(len(whole)), units="xy", offsets=places[whole],
            offset_transform=axes.transData, facecolors=mode.colours[whole], edgecolors="0.45", linewidths=0.4 * rim,
            rasterized=many))
        axes.add_collection(PatchCollection(self.sectors, facecolors=mode.colours[self.shared], edgecolors="black",
                                            linewidths=rim, rasterized=many))
        self.draw_velocities(axes)
        draw_flat(axes, self.from_copies, self.arrows, 0.9, ARROW, 5)

    def draw_velocities(self, axes):
        """In the plane; of each copy where there is room, else means over cells."""
        mode, places = self.mode, self.tails[self.copies]
        velocities = mode.velocities[self.copies][:, self.plane]
        extent = (mode.high - mode.low)[self.plane]
        side = mode.diameter
        if side < 0.7 * extent.max() / (2 * CELLS):
            side = extent.max() / (2 * CELLS)
            cells = np.floor((places - mode.low[self.plane]) / side).astype(int)
            cell = np.unique(cells, axis=0, return_inverse=True)[1].ravel()
            places, velocities = (np.column_stack([np.bincount(cell, v) / np.bincount(cell) for v in values.T])
                                  for values in (places, velocities))
        speed = np.linalg.norm(velocities, axis=1)
        seen = speed > SLOWEST * speed.max()
        arrows = velocities[seen] * side / (speed.max() or 1)
        draw_flat(axes, places[seen] - arrows / 2, arrows, 0.5, "black", 4)


def draw_flat(axes, tails, arrows, width, colour, zorder):
    """Arrows with heads; WIDTH of the shaft in points, COLOUR one or a list."""
    if len(tails):
        axes.quiver(*np.asarray(tails).T, *np.asarray(arrows).T, angles="xy", scale_units="xy", scale=1, units="dots",
                    color=colour, width=width * axes.figure.dpi / 72, headwidth=4.2, headlength=5, headaxislength=4.4,
                    minlength=0, zorder=zorder)


def layers(camera, *places):
    """For each of PLACES the layer of each of its points, from far to near."""
    reach = camera.project(camera.box)[1]
    ends = np.linspace(reach.min(), reach.max(), LAYERS + 1)
    return [np.digitize(camera.project(some)[1], ends) if len(some) else np.zeros(0, int) for some in places]


def draw_arrows(axes, camera, tails, arrows, width, colour, zorder):
    """Arrows in space, paler the farther they are."""
    if not len(tails):
        return
    start, nearness, _ = camera.project(tails)
    end = camera.project(tails + arrows)[0]
    colours = perspective.in_haze(np.broadcast_to(perspective.rgb([colour]), (len(tails), 3)),
                                  np.clip(1.5 * camera.haze(nearness), 0, 1))
    order = np.argsort(nearness)
    draw_flat(axes, start[order], (end - start)[order], width, colours[order], zorder)


def draw_spheres(axes, camera, mode, section):
    """Those that the section cuts or that lie behind it."""
    behind = (section.at - mode.places[:, section.axis]) * np.sign(camera.back[section.axis])
    seen = mode.first & (behind > -mode.radius)
    perspective.draw_balls(axes, camera, mode.places[seen], mode.radius[seen], mean_colours(mode)[seen])
    camera.draw_box(axes, mode.low, mode.high)


def mean_colours(mode):
    """A grain that is drawn whole has the mean speed of its copies."""
    group = np.cumsum(mode.first) - 1
    mean = np.bincount(group, mode.speed) / np.bincount(group)
    return MAP(mode.norm(mean[group] / 10.0**mode.exponent))[:, :3]


def draw_velocities(axes, camera, mode, _):
    places, velocities, longest = mode.motion()
    speed = np.linalg.norm(velocities, axis=1)
    seen = speed > SLOWEST * speed.max()
    arrows = velocities[seen] * longest / (speed.max() or 1)
    camera.draw_box(axes, mode.low, mode.high)
    draw_arrows(axes, camera, places[seen] - arrows / 2, arrows, 0.6, "black", 3)


def draw_interface(axes, camera, mode, _):
    """The grains of the interface, shrunk, in the colours of their speeds, and the impulses on their copies."""
    shared = np.flatnonzero((mode.multiplicity > 1) & mode.first)
    seen, arrows = mode.visible_pulls()
    tails = mode.places[seen]
    colours = mean_colours(mode)
    of_ball, of_arrow = layers(camera, mode.places[shared], tails)
    camera.draw_box(axes, mode.low, mode.high)
    for layer in range(LAYERS + 2):
        ball, arrow = shared[of_ball == layer], of_arrow == layer
        perspective.draw_balls(axes, camera, mode.places[ball], SHRUNK * mode.radius[ball], colours[ball],
                               zorder=1 + layer)
        draw_arrows(axes, camera, tails[arrow], arrows[arrow], 0.9, ARROW, 1.5 + layer)


def figure(rows, copies, zoom, normal):
    mode = Mode(rows, copies, zoom)
    section = Section(mode, normal or mode.normal())
    camera = perspective.Camera(mode.low, mode.high, AZIMUTH[section.normal], ELEVATION[section.normal])
    margin = 0.035 * camera.size
    flat, seen = 1.04 * (section.high - section.low), np.ptp(camera.project(camera.box)[0], axis=0) + 2 * margin
    wide = (WIDTH - LEFT - 3 * GAP) / 2                    # mm, of a panel
    lower = min(wide * seen[1] / seen[0], TALLEST)
    upper = max(lower, min(wide * flat[1] / flat[0], TALLEST))
    height = ABOVE + 2 * TITLE + upper + lower + UNDER + GAP + BELOW
    fig = style.plt.figure(figsize=(WIDTH * style.MM, height * style.MM))

    def panel(row, column, letter, text):
        left = LEFT + GAP / 2 + column * (wide + GAP)
        tall, bottom = (upper, height - ABOVE - TITLE - upper) if row == 0 else (lower, BELOW)
        axes = fig.add_axes([left / WIDTH, bottom / height, wide / WIDTH, tall / height])
        fig.text((left - (LEFT - 3 if column == 0 else 0)) / WIDTH, (bottom + tall + 1.2) / height,
                 f"({letter}) {text}", fontsize=9)
        return axes

    cut = panel(0, 0, "a", rf"section, ${section.normal} = {section.at:.3g}$ m")
    low, high = section.low - 0.02 * flat, section.high + 0.02 * flat
    scale = min(wide / flat[0], upper / flat[1])  # mm/m
    first, second = (AXES[k] for k in section.plane)
    cut.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel=f"${first}$ (m)", ylabel=f"${second}$ (m)",
            aspect="equal")
    section.draw(cut, scale / 25.4 * 72)
    for axes, draw in ((panel(0, 1, "b", "spheres behind it"), draw_spheres),
                       (panel(1, 0, "c", "velocities"), draw_velocities),
                       (panel(1, 1, "d", "interface (spheres shrunk), impulses"), draw_interface)):
        draw(axes, camera, mode, section)
        camera.name_axes(axes, mode.low, mode.high)
        camera.frame(axes, margin)
    explain(fig, height, mode, rows[0], scale)
    return fig


def explain(fig, height, mode, row, scale):
    """SCALE: mm for a metre of the section."""
    fig.text(0.5, 1 - 2.0 / height, heading(row), ha="center", va="top", fontsize=9)
    bar = fig.colorbar(ScalarMappable(mode.norm, MAP), orientation="horizontal",
                       cax=fig.add_axes([0.07, 9.3 / height, 0.36, 2.0 / height]))
    bar.set_label(f"speed ({scaled('m/s', mode.exponent)})", labelpad=1)
    key = fig.add_axes([0.5, 1.5 / height, 0.49, 11 / height])
    key.set(xlim=(0, 0.49 * WIDTH), ylim=(0, 11))
    key.axis("off")
    longest = mode.longest * scale
    for level, colour, width, length, text in (
            (7.6, ARROW, 0.9, longest, rf"impulse on a copy, ${number(mode.strongest)}$ kg m/s in (a)"),
            (2.6, "black", 0.5, 7, "velocity (small spheres: means over cells)")):
        draw_flat(key, [[0.5, level]], [[length, 0]], width, colour, 1)
        key.text(max(longest, 7) + 2.5, level, text, va="center", fontsize=8)
