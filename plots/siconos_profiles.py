#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Performance profiles of contact solvers of nscdd and of Siconos, from RESULTS/siconos.csv, the table of
benchmarks/contact_solvers.py --siconos."""
import sys

import profiles
import style

FEWEST = 20  # contacts: of smaller problems a time is mostly that of a call


def draw(results, output, formats):
    residuals = ("1e-06", "1e-08")
    problems = [p for p in profiles.problems_of(results, "siconos.csv", ("seconds",), residuals)
                if all(row["contacts"] >= FEWEST for row in p.values())]
    if not problems:
        raise style.NoRows(f"{results}: siconos.csv: no problem with {FEWEST} contacts or more")
    fig = profiles.figure(problems, ("seconds",), residuals, style.COLUMN_AND_HALF, 62)
    return style.save(fig, output, "siconos-profiles", formats)


if __name__ == "__main__":
    sys.exit(style.run(__doc__, draw))
