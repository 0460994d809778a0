# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres and lines in space, seen in perspective: what the figures of three dimensions share. Everything is projected
here and drawn from far to near; what is nearer hides what lies behind."""
import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import to_rgb

# Layers of a shaded ball, from its rim inwards: size, shift towards the light, and brightness, all relative.
SHADES = ((1.0, 0.0, 0.72), (0.88, 0.10, 0.90), (0.62, 0.26, 1.0), (0.26, 0.46, 1.18))
LIGHT = np.array([-0.55, 0.83])  # on the screen, to the upper left
HAZE = 0.45                      # part of white that the farthest thing is mixed with
# Points of a ball that show how it has turned: the ends of its axes.
AXES = np.vstack([np.eye(3), -np.eye(3)])
SPOT = 0.30                      # radius of these spots, times that of the ball


class Camera:
    """Looks at the middle of a box from a direction given by its azimuth (degrees from -y towards +x) and elevation.
    `screen` is in metres at the distance of that middle."""

    def __init__(self, low, high, azimuth=28.0, elevation=16.0, distance=3.2):
        low, high = np.asarray(low, float), np.asarray(high, float)
        self.target = (low + high) / 2
        self.size = np.linalg.norm(high - low)
        self.distance = distance * self.size
        a, e = np.radians(azimuth), np.radians(elevation)
        self.back = np.array([np.sin(a) * np.cos(e), -np.cos(a) * np.cos(e), np.sin(e)])  # from the target to the eye
        self.right = np.array([np.cos(a), np.sin(a), 0.0])
        self.up = np.cross(self.back, self.right)
        corners = np.array(np.meshgrid(*zip(low, high))).reshape(3, -1).T
        self.box = corners

    def project(self, points):
        """(screen, nearness, scale): places on the screen, the way from the target towards the eye, and the length on
        the screen of a metre there."""
        offset = np.asarray(points) - self.target
        nearness = offset @ self.back
        scale = self.distance / (self.distance - nearness)
        screen = np.column_stack([offset @ self.right, offset @ self.up]) * scale[:, None]
        return screen, nearness, scale

    def haze(self, nearness):
        """0 for the nearest corner of the box, 1 for the farthest."""
        of_box = (self.box - self.target) @ self.back
        return np.clip((of_box.max() - nearness) / np.ptp(of_box), 0, 1)

    def frame(self, axes, margin):
        """Limits of the axes that show the box, which has no ticks."""
        screen = self.project(self.box)[0]
        axes.set_xlim(screen[:, 0].min() - margin, screen[:, 0].max() + margin)
        axes.set_ylim(screen[:, 1].min() - margin, screen[:, 1].max() + margin)
        axes.set_aspect("equal")
        axes.set_axis_off()

    def draw_box(self, axes, low, high, **line):
        """The edges of a box, behind everything else."""
        low, high = np.asarray(low), np.asarray(high)
        edges = []
        for axis in range(3):
            others = [k for k in range(3) if k != axis]
            for first in (low, high):
                for second in (low, high):
                    ends = np.empty((2, 3))
                    ends[:, others[0]], ends[:, others[1]] = first[others[0]], second[others[1]]
                    ends[:, axis] = low[axis], high[axis]
                    edges.append(self.project(ends)[0])
        axes.add_collection(LineCollection(edges, **{"colors": "0.6", "linewidths": 0.5, "zorder": 0, **line}))

    def name_axes(self, axes, low, high):
        """The names of the axes beside the edges of a box that lie in front or on the left."""
        middle = (np.asarray(low) + np.asarray(high)) / 2
        for name, place, shift in (("x", (middle[0], low[1], low[2]), (-3, -8)),
                                   ("y", (high[0], middle[1], low[2]), (7, -6)),
                                   ("z", (low[0], low[1], middle[2]), (-7, 0))):
            axes.annotate(f"${name}$", self.project([place])[0][0], shift, textcoords="offset points", ha="center",
                          va="center", fontsize=8)


def rgb(colours):
    """An array of red, green and blue of a list of colours."""
    known = {}
    return np.array([known.setdefault(colour, to_rgb(colour)) for colour in colours])


def in_haze(colours, haze):
    part = HAZE * haze[:, None]
    return colours * (1 - part) + part


def turned(quaternions, vector):
    """The vector turned by each of the unit quaternions (w, x, y, z)."""
    w, axis = quaternions[:, :1], quaternions[:, 1:]
    cross = np.cross(axis, vector)
    return vector + 2 * (w * cross + np.cross(axis, cross))


def draw_balls(axes, camera, places, radii, colours, turns=None, spot_colour="#1f5f99", rasterized=True,
               zorder=1):
    """Shaded balls. COLOURS: an array of red, green and blue for each. TURNS: unit quaternions; with them the ends of
    the axes of each ball are marked where they face the eye."""
    if not len(places):
        return
    screen, nearness, scale = camera.project(places)
    order = np.argsort(nearness)
    screen, radius, haze = screen[order], (radii * scale)[order], camera.haze(nearness)[order]
    colours = np.asarray(colours)[order]
    centres, sizes, fills, flat = [], [], [], []
    for size, shift, brightness in SHADES:
        shade = colours * brightness if brightness <= 1 else colours + (1 - colours) * (brightness - 1) * 3
        centres.append(screen + shift * radius[:, None] * LIGHT)
        sizes.append(2 * size * radius)
        fills.append(in_haze(np.clip(shade, 0, 1), haze))
        flat.append(np.ones(len(radius)))
    if turns is not None:
        mark = np.broadcast_to(rgb([spot_colour]), colours.shape)
        for end in AXES:
            axis = turned(np.asarray(turns)[order], end)
            facing = axis @ camera.back
            seen = facing > 0.15
            side = np.column_stack([axis @ camera.right, axis @ camera.up])
            centres.append(screen + 0.92 * radius[:, None] * side)
            sizes.append(np.where(seen, 2 * SPOT * radius, 0))
            fills.append(in_haze(mark, haze))
            flat.append(np.clip(facing, 0, 1))  # a spot towards the rim is narrow
    layers = len(centres)
    stacked = [np.stack(parts, axis=1).reshape(layers * len(radius), *np.shape(parts[0])[1:])
               for parts in (centres, sizes, fills, flat)]
    places, sizes, fills, flat = stacked
    ball = np.repeat(np.arange(len(radius)), layers)
    way = places - screen[ball]
    angle = np.degrees(np.arctan2(way[:, 1], way[:, 0]))
    axes.add_collection(EllipseCollection(sizes * flat, sizes, np.where(flat < 1, angle, 0), units="xy",
                                          offsets=places, offset_transform=axes.transData, facecolors=fills,
                                          edgecolors="none", linewidths=0, rasterized=rasterized, zorder=zorder))


def draw_lines(axes, camera, first, second, widths, colours, rasterized=False, zorder=2):
    """Straight lines in space, WIDTHS in points at the middle of the box."""
    if not len(first):
        return
    ends = np.stack([camera.project(first)[0], camera.project(second)[0]], axis=1)
    _, nearness, scale = camera.project((np.asarray(first) + np.asarray(second)) / 2)
    order = np.argsort(nearness)
    faded = in_haze(np.asarray(colours), camera.haze(nearness) * 1.6)
    axes.add_collection(LineCollection(ends[order], linewidths=(widths * scale)[order],
                                       colors=np.clip(faded, 0, 1)[order], capstyle="round", rasterized=rasterized,
                                       zorder=zorder))
