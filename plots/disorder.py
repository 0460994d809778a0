#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Radii from a lattice through vacancies to polydisperse deposits, and whether the size matters."""
import dataclasses
import os
import sys

import numpy as np
import style

BLUE, RED = "#1f5f99", "#b03a2e"
TABLES = [("vacancies", "lattice with vacancies", {"color": BLUE, "marker": "o"}),
          ("deposit", "deposits", {"color": RED, "marker": "s"})]
SMALLEST = 0.1  # m, radius_min of the deposits
ENRICHED = 0.1  # 1/kg, the finite eta of the tables
STIFF = (1e-4, 1e-2)
LOOKS = {  # of the packings followed through the sizes
    "vacancies": ("packing.vacancies", [{"color": "#123c63", "marker": "o"}, {"color": BLUE, "marker": "^"},
                                        {"color": "#6ea6d8", "marker": "v"}]),
    "deposit": ("packing.radius_max", [{"color": "#e08a80", "marker": "D"}, {"color": RED, "marker": "s"},
                                       {"color": "#6e1d15", "marker": "p"}]),
}


@dataclasses.dataclass
class Study:
    """A study of disorder: its folder, the endings of its tables by size (the main one is empty), which of their
    packings are followed through the sizes, and what its axes show."""
    name: str
    sizes: tuple
    vacancies: tuple
    largest: tuple           # m, radius_max of the deposits
    isostatic: int           # coordination number
    coordination: tuple      # limits
    ratios: tuple            # of radii, labelled
    grains: tuple            # limits
    title: str
    lowest: tuple            # 1 - rho: against the number of grains for rigid contacts, and elsewhere
    legend: tuple            # the panel below, from 0, that has the legend of the packings, and where

    def packings(self, table):
        """Parameter, and value, label and look of the packings followed."""
        parameter, looks = LOOKS[table]
        if table == "vacancies":
            values, labels = self.vacancies, [f"{100 * v:.0f} % vacancies" if v else "lattice" for v in self.vacancies]
        else:
            values = self.largest
            labels = [f"deposit, 1 : {v / SMALLEST:.0f}" if v > SMALLEST else "deposit, one size" for v in values]
        return parameter, list(zip(values, labels, looks))


# Tables of 1 024, 4 096, 16 384 and 10^5 grains, and what is run on demand only.
IN_PLANE = Study("disorder", ("-1k", "", "-16k", "-100k", "-100k-large", "-1m-large"), (0, 0.1, 0.25),
                 (0.1, 0.2, 0.8), 4, (3.7, 6.2), (1, 2, 4, 8), (500, 2e5), "4 096 grains, rigid", (1e-6, 1e-5),
                 (1, "upper right"))
IN_SPACE = Study("disorder-in-space", ("-500", "", "-8k", "-27k"), (0, 0.1, 0.3), (0.1, 0.2, 0.4), 6, (4.5, 11), (1, 2, 4),
                 (300, 5e4), "2 000 spheres, rigid", (1e-5, 3e-6), (2, "lower left"))
GENERIC_LINE, ENRICHED_LINE = "-", (0, (4, 2))


def coordination(rows):
    return 2 * style.column(rows, "contacts") / style.column(rows, "grains")


def size_ratio(rows):
    return style.column(rows, "packing.radius_max") / SMALLEST


def gap(rows):
    return 1 - style.column(rows, "subdominant_radius")


def scatter(axes, x, rows, look, eta):
    face = look["color"] if np.isinf(eta) else "white"
    return axes.plot(x, gap(rows), linestyle="none", markerfacecolor=face, markeredgewidth=0.7, **look)[0]


def of_one_size(results, study, rigid, stiff, sizes):
    """The panels of one size; handles and labels of their marks."""
    handles, labels = [], []
    for table, label, look in TABLES:
        name = f"{study.name}/{table}.csv"
        own = " packing.radius_max" if table == "deposit" else ""
        rows = style.read_table(results, name, numbers="grains contacts epsilon eta subdominant_radius" + own)
        for eta, text in ((np.inf, "generic"), (ENRICHED, r"enriched, $\eta = 0.1$ 1/kg")):
            some = style.need(results, name, rows, epsilon=0, eta=eta)
            handles.append(scatter(rigid, coordination(some), some, look, eta))
            labels.append(f"{label}, {text}")
            if own:
                scatter(sizes, size_ratio(some), some, look, eta)
            for epsilon in STIFF:
                some = style.need(results, name, rows, epsilon=epsilon, eta=eta)
                scatter(stiff, coordination(some), some, look, eta)
    for epsilon, text in zip(STIFF, ("10^{-4}", "10^{-2}")):
        stiff.axhline(epsilon / ENRICHED, color=style.GREY, linewidth=0.6, zorder=0.5)
        stiff.text(study.coordination[1] - 0.05, epsilon / ENRICHED / 1.2,
                   rf"$\varepsilon/\eta$, $\varepsilon = {text}$", fontsize=7,
                   ha="right", va="top")
    return handles, labels


def through_sizes(results, study, panels):
    """Geometric mean of 1 - rho over the seeds, with its range, against the number of grains; PANELS: axes of each
    epsilon."""
    for table in LOOKS:
        parameter, packings = study.packings(table)
        rows = []
        for name in (f"{study.name}/{table}{size}.csv" for size in study.sizes):
            if "large" not in name or os.path.exists(os.path.join(results, name)):
                rows += style.read_table(results, name, numbers=f"grains epsilon eta subdominant_radius {parameter}")
        for value, label, look in packings:
            for epsilon, axes in panels.items():
                for eta, line in ((np.inf, GENERIC_LINE), (ENRICHED, ENRICHED_LINE)):
                    some = style.need(results, f"{study.name}/{table}.csv", rows, epsilon=epsilon, eta=eta,
                                      **{parameter: value})
                    grains, mean, low, high = by_size(some)
                    face = look["color"] if np.isinf(eta) else "white"
                    axes.errorbar(grains, mean, yerr=(mean - low, high - mean), linestyle=line, elinewidth=0.6,
                                  linewidth=0.9, markersize=3.6, markeredgewidth=0.7, markerfacecolor=face,
                                  label=label if np.isinf(eta) else None, **look)


def by_millions(results, study):
    return os.path.exists(os.path.join(results, f"{study.name}/deposit-1m-large.csv"))


def by_size(rows):
    """Numbers of grains, and of each the geometric mean, the least and the largest 1 - rho."""
    result = []
    for grains in sorted(set(style.column(rows, "grains"))):
        values = gap(style.where(rows, grains=grains))
        mean = np.clip(np.exp(np.mean(np.log(values))), values.min(), values.max())  # equal values, rounded
        result.append((grains, mean, values.min(), values.max()))
    return np.array(result).T


def draw_study(results, output, formats, study):
    fig, ((rigid, stiff, sizes), below) = style.figure(style.COLUMN_AND_HALF, 128, 2, 3)
    handles, labels = of_one_size(results, study, rigid, stiff, sizes)
    for axes in (rigid, stiff):
        axes.axvline(study.isostatic, color=style.LIGHT, linewidth=0.6, zorder=0.4)
        axes.set(xlabel="coordination number", xlim=study.coordination)
    style.log_axis(sizes.xaxis, 0.9, 1.125 * study.ratios[-1])
    sizes.set_xticks(study.ratios, labels=[f"{ratio}" for ratio in study.ratios])
    sizes.set_xticks([], minor=True)
    sizes.set_xlabel("largest / smallest radius")
    through_sizes(results, study, dict(zip((0, *STIFF), below)))
    for axes in below:
        style.log_axis(axes.xaxis, study.grains[0], 2e6 if by_millions(results, study) else study.grains[1])
        axes.set_xlabel("number of grains")
    texts = [study.title, r"$\varepsilon = 10^{-4}$, $10^{-2}$ 1/kg", "deposits, rigid",
             "rigid contacts", r"$\varepsilon = 10^{-4}$ 1/kg", r"$\varepsilon = 10^{-2}$ 1/kg"]
    for axes, letter, text in zip((rigid, stiff, sizes, *below), "abcdef", texts):
        style.log_axis(axes.yaxis, study.lowest[0 if axes is below[0] else 1], 1)
        style.panel(axes, letter, text)
    for axes in (rigid, below[0]):
        axes.set_ylabel(r"$1 - \rho$")
    panel, place = study.legend
    below[panel].legend(loc=place, fontsize=7, labelspacing=0.15, handlelength=2, borderaxespad=0.3)
    style.legend_above(fig, handles, labels, 2)
    return style.save(fig, output, study.name, formats)


def draw(results, output, formats):
    return draw_study(results, output, formats, IN_PLANE)


def draw_in_space(results, output, formats):
    return draw_study(results, output, formats, IN_SPACE)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw, draw_in_space))
