#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what `nscdd export --operators` wrote with SciPy and h5py, checks it, and prints radii.

usage: read_operators.py FOLDER [EPSILON]

Checked are: every file has the numbers of operators.h5, bit for bit, and what the manifest says of it; the undivided
matrices are those of the subdomains put together; W, S, P and B are their formulas, evaluated with dense matrices.
Printed are, where there are S, P and B, the radius from the eigenvalues of B (dense), and from those of the pencil
(S, P) by eigh (pencil) and by ARPACK (arpack). With EPSILON, the radius of the generic algorithm by ARPACK from the
sparse files alone (sparse). A line is 'name value'. A check that fails raises.
"""
import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np
import scipy.io
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg


def same_bits(a, b):
    return a.shape == b.shape and np.array_equal(a.astype(float).view(np.int64), b.astype(float).view(np.int64))


def from_hdf5(member):
    if isinstance(member, h5py.Dataset):
        return member[()]
    assert member.attrs["format"].decode() == "csc"
    return scipy.sparse.csc_matrix((member["data"][()], member["indices"][()], member["indptr"][()]),
                                   shape=tuple(member["shape"][()]))


def check_file(folder, one, member):
    """The matrix of an operator, dense or sparse as it was written."""
    text = (folder / one["file"]).read_text().splitlines()
    remarks = "\n".join(line for line in text if line.startswith("%"))
    assert all(one[key] in remarks for key in ("meaning", "formula", "unit")) and "nscdd 0" in remarks, remarks
    assert (" symmetric" in text[0]) == one["symmetric"], text[0]
    for key in ("formula", "meaning", "unit"):
        assert member.attrs[key].decode() == one[key], key
    matrix, twin = scipy.io.mmread(folder / one["file"]), from_hdf5(member)
    if one["kind"] == "numbers":
        assert matrix.shape == (one["rows"], one["columns"]) and one["columns"] == 1
        assert np.array_equal(matrix[:, 0], twin)
        return twin
    assert scipy.sparse.issparse(matrix) == scipy.sparse.issparse(twin) == (one["kind"] == "sparse"), one
    assert matrix.shape == (one["rows"], one["columns"]), one
    if scipy.sparse.issparse(matrix):
        assert matrix.nnz == twin.nnz == one["entries"], one
        matrix, full = matrix.toarray(), twin.toarray()
    else:
        assert matrix.size == one["entries"], one
        full = twin
    assert same_bits(matrix, full), one["name"]
    assert not one["symmetric"] or same_bits(full, full.T.copy()), one["name"]
    return twin


def close(a, b, tolerance):
    a, b = dense(a), dense(b)
    assert a.shape == b.shape and np.abs(a - b).max(initial=0) <= tolerance * max(1, np.abs(b).max(initial=0)), (a, b)


def dense(matrix):
    return matrix.toarray() if scipy.sparse.issparse(matrix) else matrix


def subdomains(found):
    return [int(name[2:]) for name in found if name.startswith("M_")]


def rows_of(found, e, d):
    return (d * found[f"grains_{e}"][:, None] + np.arange(d)).ravel()


def check_undivided(found, d):
    mass = found["M"].diagonal()
    close(found["W"], found["H"].T @ scipy.sparse.diags(1 / mass) @ found["H"], 1e-13)
    summed, seen, jumps = np.zeros(len(mass)), np.zeros(found["H"].shape[1], int), np.zeros(1)
    velocity = np.random.default_rng(1).standard_normal(len(mass))
    for e in subdomains(found):
        rows, columns = rows_of(found, e, d), found[f"contacts_{e}"]
        close(found[f"H_{e}"], found["H"].tocsr()[rows][:, columns], 0)
        summed[rows] += found[f"M_{e}"].diagonal()
        seen[columns] += 1
        if f"A_{e}" in found:
            assert set(np.unique(found[f"A_{e}"].data)) <= {-1.0, 1.0}
            jumps = jumps + found[f"A_{e}"] @ velocity[rows]  # copies that move as one
        if f"G_{e}" in found:
            close(found[f"G_{e}"], found["H"].tocsr()[rows][:, found[f"active_contacts_{e}"]], 0)
    assert np.all(seen == 1)
    touched = summed > 0
    close(summed[touched], mass[touched], 1e-14)
    assert np.all(jumps == 0)


def condensed(found, letter, flexibility):
    """sum_E A_E M_{E,flexibility}^-1 A_E^T, dense."""
    total = 0
    for e in subdomains(found):
        a, mass, h = (found[f"{name}_{e}"].toarray() for name in ("A", "M", letter))
        if np.isinf(flexibility):
            inverse = np.linalg.inv(mass)
        elif flexibility == 0:
            root = np.diag(np.diag(mass) ** -0.5)
            scaled = root @ h
            inverse = root @ (np.eye(len(mass)) - scaled @ np.linalg.pinv(scaled)) @ root
        else:
            inverse = np.linalg.inv(mass + h @ h.T / flexibility)
        total = total + a @ inverse @ a.T
    return total


def largest_modulus(low, high):
    return float(max(abs(1 - low), abs(1 - high)))


def check_dense(found, manifest):
    s, p, b = (dense(found[name]) for name in "SPB")
    close(found["X"], condensed(found, "H", np.inf), 1e-12)
    close(s, condensed(found, "H" if manifest["contact_set"] == "all" else "G", manifest["epsilon"]), 1e-8)
    close(p, condensed(found, "H", manifest["eta"]), 1e-8)
    close(b, np.eye(len(b)) - manifest["relaxation"] * np.linalg.solve(p, s), 1e-8)
    print("dense", float(np.abs(np.linalg.eigvals(b)).max()))
    ends = scipy.linalg.eigh(s, p, eigvals_only=True)
    ends = manifest["relaxation"] * ends
    print("pencil", largest_modulus(ends[0], ends[-1]))
    if len(b) > 4:
        low, high = (scipy.sparse.linalg.eigsh(s, 1, M=p, which=which, return_eigenvectors=False)[0]
                     for which in ("SA", "LA"))
        low, high = manifest["relaxation"] * low, manifest["relaxation"] * high
        print("arpack", largest_modulus(low, high))


def sparse_radius(found, epsilon):
    factors = []
    for e in subdomains(found):
        h = found[f"H_{e}"]
        factors.append((found[f"A_{e}"], scipy.sparse.linalg.splu((found[f"M_{e}"] + h @ h.T / epsilon).tocsc())))
    x = found["X"].tocsc()
    system = scipy.sparse.linalg.LinearOperator(x.shape, lambda f: sum(a @ lu.solve(a.T @ f) for a, lu in factors))
    inverse = scipy.sparse.linalg.LinearOperator(x.shape, scipy.sparse.linalg.splu(x).solve)
    low, high = (scipy.sparse.linalg.eigsh(system, 1, M=x, Minv=inverse, which=which, return_eigenvectors=False)[0]
                 for which in ("SA", "LA"))
    print("sparse", largest_modulus(low, high))


def main():
    folder = Path(sys.argv[1])
    manifest = tomllib.loads((folder / "manifest.toml").read_text())
    with h5py.File(folder / "operators.h5") as file:
        found = {one["name"]: check_file(folder, one, file[one["hdf5"]]) for one in manifest["operator"]}
        assert set(file) == set(found) | {"provenance"}
        assert manifest["program"] == file["provenance/program"][()].decode()
    expected = {f"{name}.mtx" for name in found} | {"manifest.toml", "operators.h5"}
    assert {path.name for path in folder.iterdir()} == expected
    check_undivided(found, manifest["dofs_per_grain"])
    if "B" in found:
        check_dense(found, manifest)
    if len(sys.argv) > 2:
        sparse_radius(found, float(sys.argv[2]))
    print("operators", len(found))


main()
