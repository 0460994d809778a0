#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Performance profiles of contact solvers (Dolan and More 2002): the share of problems that a solver brings to a residual
within so many times the time, or the work, of the best solver of each problem. What never gets there counts in no
share."""
import glob
import itertools
import os
import sys

import numpy as np
import style

RESIDUALS = {"1e-04": r"$10^{-4}$", "1e-06": r"$10^{-6}$", "1e-08": r"$10^{-8}$"}
MEASURES = {"seconds": "time", "work": "work"}
LOOKS = [("black", "-"), ("#b03a2e", (0, (4.5, 1.8))), ("#1f5f99", (0, (1, 1.3))), ("#3d7a3d", (0, (5, 1.5, 1, 1.5))),
         ("0.55", "-"), ("#8e6bb0", (0, (4.5, 1.8))), ("#c98a1b", (0, (1, 1.3)))]
FARTHEST = 1000  # times the best


def problems_of(folder, name, measures=tuple(MEASURES), residuals=tuple(RESIDUALS)):
    """The rows of each problem of a table, by solver: they follow one another, and each solver comes once."""
    numbers = " ".join(f"{measure}_{residual}" for measure in measures for residual in residuals)
    problems = []
    for row in style.read_table(folder, name, numbers=f"contacts {numbers}", texts="solver status"):
        if not problems or row["solver"] in problems[-1]:
            problems.append({})
        problems[-1][row["solver"]] = row
    # Without contacts or a readable file there is nothing to compare.
    return [p for p in problems if all(r["status"] != "refused" and r["contacts"] > 0 for r in p.values())]


def ratios(problems, solver, solvers, column):
    """Times the best of all solvers, per problem that any of them solves: inf where this one does not."""
    found = []
    for problem in problems:
        values = {name: problem[name][column] for name in solvers}
        known = [value for value in values.values() if np.isfinite(value)]
        if not known:
            continue
        own, best = values[solver], min(known)
        found.append(np.inf if not np.isfinite(own) else own / best if best > 0 else 1.0)
    return np.array(found)


def profile(axes, values, total, look):
    """The share of TOTAL problems within tau times the best."""
    tau = np.concatenate([[1], np.sort(values[(values > 1) & (values < FARTHEST)]), [FARTHEST]])
    share = [np.sum(values <= t) / total for t in tau]
    axes.step(tau, share, where="post", color=look[0], linestyle=look[1], clip_on=False)


def figure(problems, measures, residuals, width, height):
    """A panel for each measure and residual, of the solvers that every problem has."""
    solvers = [s for s in problems[0] if all(s in problem for problem in problems)]
    fig, grid = style.figure(width, height, len(measures), len(residuals), sharex=True, sharey=True, squeeze=False)
    letters = iter("abcdef")
    for line, measure in zip(grid, measures):
        for axes, residual in zip(line, residuals):
            for solver, look in zip(solvers, itertools.cycle(LOOKS)):
                profile(axes, ratios(problems, solver, solvers, f"{measure}_{residual}"), len(problems), look)
            style.log_axis(axes.xaxis, 1, FARTHEST)
            axes.set(ylim=(0, 1))
            style.panel(axes, next(letters), f"{MEASURES[measure]} to {RESIDUALS[residual]}")
        line[0].set_ylabel(f"share of {len(problems)} problems")
    for axes in grid[-1]:
        axes.set_xlabel(r"times the best, $\tau$")
    handles = [grid[0, 0].plot([], [], color=c, linestyle=s)[0] for _, (c, s) in zip(solvers, itertools.cycle(LOOKS))]
    style.legend_above(fig, handles, [s.replace("_", " ") for s in solvers], min(len(solvers), 5))
    return fig


def tables_of(results):
    return sorted(glob.glob(os.path.join(results, "profiles", "*.csv")))


def draw(results, output, formats, more=()):
    """The tables of the study, and MORE files of `nscdd solve FOLDER --csv`."""
    paths = [*tables_of(results), *more]
    if not paths:
        raise style.NoTable(f"{os.path.join(results, 'profiles')}: no table")
    problems = [problem for path in paths for problem in problems_of(*os.path.split(path))]
    if not problems:
        raise style.NoRows(f"{paths[0]}: no problem with contacts")
    return style.save(figure(problems, MEASURES, RESIDUALS, style.COLUMN_AND_HALF, 98), output, "profiles", formats)


def main():
    parser = style.arguments(__doc__)
    parser.add_argument("--table", action="append", default=[], metavar="FILE",
                        help="one more table, of nscdd solve FOLDER --csv; may be given again")
    options = parser.parse_args()
    return style.draw_each([lambda *where: draw(*where, more=options.table)], options)


if __name__ == "__main__":
    sys.exit(main())
