#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that are proved between their points against sweeps of 1 000 points.

usage: taskset -c 0 /usr/bin/python3 benchmarks/curves.py [PROGRAM] [--tolerance T] [--shift-invert]

The curves are those of Figures 5 to 7. For each the table gives the points of `nscdd sweep --curve T`, which are as many
dense spectra, and of the sweep; the seconds of both as whole processes; and how many of the 1 000 radii lie outside the
band, which must be none. --shift-invert adds a deposit of 5 000 disks in 16 strips, which takes half a minute.
"""
import argparse
import bisect
import csv
import io
import math
import os
import subprocess
import sys
import time

SAMPLES = 1000
FIGURES = [("5", "epsilon", "1e-4:1e4", "--eta inf"), ("6", "eta", "1e-4:1e4", "--epsilon 1"),
           ("6", "eta", "1e-4:1e4", "--epsilon 0"), ("7", "eta", "1e-4:1e3", "--epsilon 0 --contacts active")]


def table(program, arguments):
    start = time.perf_counter()
    text = subprocess.run([program, "sweep", *arguments, "--csv", "-"], check=True, capture_output=True, text=True).stdout
    return list(csv.DictReader(io.StringIO(text))), time.perf_counter() - start


def outside(curve, samples, swept):
    """Samples that do not lie between the straight lines from row to row."""
    x = [math.log(float(row[swept])) for row in curve]
    low, high = ([float(row[name]) for row in curve] for name in ("curve_low", "curve_high"))
    number = 0
    for row in samples:
        place, radius = math.log(float(row[swept])), float(row["subdominant_radius"])
        k = min(max(bisect.bisect_right(x, place), 1), len(x) - 1)
        t = (place - x[k - 1]) / (x[k] - x[k - 1])
        error = 1e-12 + float(row["residual"])
        number += not (low[k - 1] + t * (low[k] - low[k - 1]) - error <= radius
                       <= high[k - 1] + t * (high[k] - high[k - 1]) + error)
    return number


def compare(program, label, case, swept, span, rest, tolerance, samples):
    given = [*case.split(), *rest.split(), f"--{swept}"]
    curve, seconds = table(program, [*given, span, "--curve", str(tolerance)])
    dense, dense_seconds = table(program, [*given, f"{span}:{samples}"])
    missed = outside(curve, dense, swept)
    print(f"{label:28} {len(curve):7d} {len(dense):7d} {seconds:9.2f} {dense_seconds:9.2f} {missed:8d}", flush=True)
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    parser.add_argument("program", nargs="?", default=os.path.join(root, "build", "release", "nscdd"))
    parser.add_argument("--tolerance", type=float, default=1e-3)
    parser.add_argument("--shift-invert", action="store_true")
    options = parser.parse_args()
    print(f"{'curve':28} {'points':>7} {'sweep':>7} {'seconds':>9} {'sweep, s':>9} {'outside':>8}")
    missed = 0
    for name, swept, span, rest in FIGURES:
        for disks in (4, 8, 12):
            label = f"Figure {name}, {disks} disks" + (f", {rest[2:]}" if name == "6" else "")
            missed += compare(options.program, label, f"disks{disks}", swept, span, rest, options.tolerance, SAMPLES)
    if options.shift_invert:
        missed += compare(options.program, "deposit, 5 000, 16 strips",
                          "deposit --set packing.grains=5000 --subdomains 16x1 --solver shift-invert", "epsilon",
                          "1e-2:1e2", "--eta inf", options.tolerance, SAMPLES)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
