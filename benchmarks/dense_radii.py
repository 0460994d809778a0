#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Radii per second for dense sizes 4 to 2 000: nscdd against a plain NumPy/SciPy script doing the same.

usage: OPENBLAS_NUM_THREADS=1 taskset -c 0 /usr/bin/python3 benchmarks/dense_radii.py [PROGRAM] [--repeat N]

The packings are lattices of 6 columns and more and more rows, cut in two. Both programs compute both ends of the
spectrum of B_eps for the same values of epsilon and must agree to 1e-9. The rival (function `scipy_radii`) is what a
competent user writes: sparse matrices, one sparse LU of W_E + eps I per subdomain and epsilon (dense Cholesky below 600
contacts), the interface matrices dense, scipy.linalg.eigh of the pencil. It is timed inside the process, after its
imports and after contact detection. nscdd is timed as a whole process, from start to the last row of its CSV. The times
are medians of N runs of each in turn.
"""
import argparse
import csv
import io
import os
import statistics
import subprocess
import tempfile
import time

import numpy as np
import scipy.linalg as dense_linalg
import scipy.sparse as sparse
import scipy.sparse.linalg as sparse_linalg

COLUMNS = 6


def lattice(rows):
    k = np.arange(COLUMNS * rows)
    row, column = k // COLUMNS, k % COLUMNS
    return column + 0.5 * (row % 2), row * np.sqrt(3) / 2


def contacts(x, y):
    """Pairs at unit distance, from the lattice's own numbering."""
    pairs = []
    for k in range(len(x)):
        for other in (k + 1, k + COLUMNS - 1, k + COLUMNS, k + COLUMNS + 1):
            if other < len(x) and abs(np.hypot(x[other] - x[k], y[other] - y[k]) - 1) < 1e-6:
                pairs.append((k, other))
    return np.array(pairs)


def scipy_radii(x, y, pairs, epsilons):
    """Both ends of the spectrum of B_eps, eqs. (10)-(11), for two subdomains and unit masses."""
    i, j = pairs.T
    normal = np.c_[x[j] - x[i], y[j] - y[i]]
    middle = 0.5 * (x[i] + x[j])
    owner = (middle > 0.5 * (x.min() + x.max()) + 1e-9).astype(int)
    members = [np.unique(pairs[owner == e]) for e in (0, 1)]
    shared = np.intersect1d(*members)
    size = 2 * len(shared)
    parts, mass_term = [], np.zeros(size)
    for e, sign in ((0, 1.0), (1, -1.0)):
        own = np.nonzero(owner == e)[0]
        local = np.full(len(x), -1)
        local[members[e]] = np.arange(len(members[e]))
        mass = np.repeat(np.where(np.isin(members[e], shared), 0.5, 1.0), 2)
        a, b, q = local[i[own]], local[j[own]], np.arange(len(own))
        h = sparse.csr_matrix((np.r_[-normal[own, 0], -normal[own, 1], normal[own, 0], normal[own, 1]],
                               (np.r_[2 * a, 2 * a + 1, 2 * b, 2 * b + 1], np.r_[q, q, q, q])), (2 * len(members[e]), len(own)))
        columns = np.c_[2 * local[shared], 2 * local[shared] + 1].ravel()
        gluing = sparse.csr_matrix((np.full(size, sign), (np.arange(size), columns)), (size, h.shape[0]))
        w = (h.T @ sparse.diags(1 / mass) @ h).tocsc()
        a_hat = (gluing @ sparse.diags(1 / mass) @ h).tocsr()
        parts.append((w, np.ascontiguousarray(a_hat.T.toarray()), a_hat))
        mass_term += (gluing @ sparse.diags(1 / mass) @ gluing.T).diagonal()
    results = []
    for epsilon in epsilons:
        interface = np.zeros((size, size))
        for w, right, a_hat in parts:
            if w.shape[0] < 600:
                solution = dense_linalg.cho_solve(dense_linalg.cho_factor(w.toarray() + epsilon * np.eye(w.shape[0])), right)
            else:
                factor = sparse_linalg.splu(w + epsilon * sparse.identity(w.shape[0], format="csc"),
                                            permc_spec="MMD_AT_PLUS_A", options=dict(SymmetricMode=True))
                solution = factor.solve(right)
            interface += a_hat @ solution
        values = dense_linalg.eigh(0.5 * (interface + interface.T), np.diag(mass_term), eigvals_only=True)
        results.append((values[0], values[-1]))
    return np.array(results)


def nscdd_radii(program, packing, epsilons):
    text = subprocess.run([program, "sweep", packing, "--subdomains", "2x1", "--epsilon", ",".join(map(repr, epsilons)),
                           "--solver", "dense", "--csv", "-"], check=True, capture_output=True, text=True).stdout
    rows = list(csv.DictReader(io.StringIO(text)))
    ends = np.array([(float(row["eigenvalue_min"]), float(row["eigenvalue_max"])) for row in rows])
    return ends, int(rows[0]["interface_dofs"])


def main():
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default=os.path.join(root, "build/release/nscdd"))
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    print(f"{'interface':>9} {'grains':>7} {'epsilons':>8} {'nscdd 1/s':>11} {'scipy 1/s':>11} {'ratio':>7} {'difference':>11}")
    for rows, number in ((2, 2000), (8, 1000), (32, 300), (125, 40), (250, 12), (500, 4), (1000, 2)):
        x, y = lattice(rows)
        pairs = contacts(x, y)
        epsilons = [float(e) for e in np.logspace(-3, 2, number)]
        with tempfile.TemporaryDirectory() as folder:
            packing = os.path.join(folder, "lattice.csv")
            np.savetxt(packing, np.c_[x, y, np.full(len(x), 0.5)], delimiter=",", header="x,y,radius", comments="", fmt="%.17g")
            ours, theirs = [], []
            for _ in range(options.repeat):
                start = time.perf_counter()
                ends, interface = nscdd_radii(options.program, packing, epsilons)
                ours.append(time.perf_counter() - start)
                start = time.perf_counter()
                reference = scipy_radii(x, y, pairs, epsilons)
                theirs.append(time.perf_counter() - start)
        difference = np.abs(ends - reference).max()
        if difference > 1e-9:
            raise SystemExit(f"nscdd and scipy differ by {difference} at {interface} interface unknowns")
        a, b = number / statistics.median(ours), number / statistics.median(theirs)
        print(f"{interface:9d} {len(x):7d} {number:8d} {a:11.4g} {b:11.4g} {a / b:7.2f} {difference:11.1e}", flush=True)


if __name__ == "__main__":
    main()
