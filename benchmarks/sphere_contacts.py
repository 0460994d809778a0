#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Beds and lattices of spheres: seconds to make them, and to find their contacts, against SciPy's k-d tree.

usage: PYTHONPATH=build/release/python taskset -c 0 /usr/bin/python3 benchmarks/sphere_contacts.py [--sizes 1e4,1e5,1e6]

Both find every pair of spheres whose gap is at most 10^-7 of the smaller radius, on one thread: nscdd.contacts with the
normals, midpoints and gaps of contacts, sorted; SciPy the pairs alone, by query_pairs with the largest sum of radii and
a look at the gaps. The pairs must be the same. Times are the best of --runs (3); a bed is made once for each of them.
SciPy runs once. From 1 : 10 on it is left out: nearly all pairs that it has to look at are far apart.
"""
import argparse
import sys
import time

import nscdd
import numpy as np
from scipy.spatial import cKDTree

TOLERANCE = 1e-7


def best(runs, work):
    """The result and the least seconds."""
    least = float("inf")
    for _ in range(runs):
        start = time.perf_counter()
        result = work()
        least = min(least, time.perf_counter() - start)
    return result, least


def by_tree(packing):
    centres = np.column_stack((packing.x, packing.y, packing.z))
    radius = packing.radius
    reach = 2 * radius.max() * (1 + TOLERANCE)
    pairs = cKDTree(centres).query_pairs(reach, output_type="ndarray")
    a, b = pairs[:, 0], pairs[:, 1]
    gap = np.linalg.norm(centres[b] - centres[a], axis=1) - radius[a] - radius[b]
    found = pairs[gap <= TOLERANCE * np.minimum(radius[a], radius[b])]
    return found[np.lexsort((found[:, 1], found[:, 0]))]


def kinds(grains):
    side = round(grains ** (1 / 3))
    deposit = {"generator": "sphere_deposit", "grains": grains, "radius_min": 0.1}
    yield f"fcc lattice, {side}^3", {"generator": "fcc", "columns": side, "rows": side, "layers": side}
    yield "deposit, equal", {**deposit, "radius_max": 0.1}
    yield "deposit, 1 : 2", {**deposit, "radius_max": 0.2}
    yield "deposit, 1 : 10, equal volumes", {**deposit, "radius_max": 1.0, "distribution": "uniform_volume"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=lambda text: [int(float(part)) for part in text.split(",")],
                        default=[10_000, 100_000, 1_000_000])
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    print("spheres  packing                          make, s   contacts  per sphere  nscdd, s  SciPy, s  ratio")
    for grains in options.sizes:
        for name, keys in kinds(grains):
            packing, made = best(options.runs, lambda keys=keys: nscdd.generate(**keys))
            network, own = best(options.runs, lambda packing=packing: nscdd.contacts(packing))
            line = (f"{len(packing):7}  {name:31}  {made:7.3f}  {len(network):9}  {len(network) / len(packing):10.3f}  "
                    f"{own:8.3f}")
            if "1 : 10" not in name:
                pairs, other = best(1, lambda packing=packing: by_tree(packing))
                line += f"  {other:8.3f}  {other / own:5.1f}"
                if not (np.array_equal(pairs[:, 0], network.a) and np.array_equal(pairs[:, 1], network.b)):
                    sys.exit(f"{line}\n{name}: nscdd and SciPy find other pairs")
            print(line, flush=True)


if __name__ == "__main__":
    main()
