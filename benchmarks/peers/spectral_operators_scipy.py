#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""SciPy baseline for any packing: rho(B_eps) from the operators of `nscdd export --operators --sparse-only`.

The best straightforward method: a sparse LU per subdomain with one dense right-hand side per interface unknown of it,
a dense interface matrix, and its largest eigenvalue by LAPACK. The rigid limit is out of its reach.

usage: spectral_operators_scipy.py FOLDER EPSILON
"""
import os
import sys
import time

import numpy as np
from scipy.io import mmread
from scipy.linalg import eigh
from scipy.sparse.linalg import splu

folder, epsilon = sys.argv[1], float(sys.argv[2])
read = lambda name: mmread(os.path.join(folder, f"{name}.mtx")).tocsc()
parts = [(read(f"M_{e}"), read(f"H_{e}"), read(f"A_{e}"))
         for e in range(sum(name.startswith("M_") for name in os.listdir(folder)))]
size = parts[0][2].shape[0]
start = time.perf_counter()
s, x = np.zeros((size, size)), np.zeros((size, size))
for m, h, a in parts:
    rows = np.flatnonzero(np.diff(a.tocsr().indptr))  # of the interface, that this subdomain has a part in
    own = a.tocsr()[rows]
    right = np.asfortranarray(own.T.toarray())
    factor = splu((m + h @ h.T / epsilon).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0,
                  options={"SymmetricMode": True})
    s[np.ix_(rows, rows)] += own @ factor.solve(right)
    x[np.ix_(rows, rows)] += (own.multiply(1 / m.diagonal()) @ own.T).toarray()
last = size - 1
rho = eigh(x - s, x, eigvals_only=True, subset_by_index=[last, last])[0]  # 0 <= S <= X: the other end is not below 0
print(f"unknowns={size} rho={rho:.12g} total={time.perf_counter() - start:.3f}s")
