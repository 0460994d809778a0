# SPDX-License-Identifier: GPL-3.0-or-later
"""Sweeps and optima, against the program's own tables and against what they mean."""
import csv
import os
import subprocess

import numpy as np
import pytest
from conftest import bed, lattice, literal_spectrum

import nscdd


def program_table(folder, packing, *arguments, table=True):
    """What `nscdd VERB` prints of a packing, as columns of texts; nothing of a verb that writes its own tables."""
    path = folder / "packing.csv"
    names = ("x", "y", "radius", "mass")
    rows = zip(*(map(repr, map(float, getattr(packing, name))) for name in names))
    path.write_text("\n".join([",".join(names), *map(",".join, rows)]) + "\n")
    verb, *options = arguments
    found = subprocess.run([os.environ["NSCDD_PROGRAM"], verb, path, *options, *(["--csv", "-"] * table)], check=True,
                           capture_output=True, text=True).stdout
    if not table:
        return {}
    rows = list(csv.DictReader(found.splitlines()))
    return {name: [row[name] for row in rows] for name in rows[0]}


def same_as_text(table, texts):
    assert list(table) == list(texts)
    for name, column in table.items():
        assert len(column) == len(texts[name])
        if column.dtype == bool:
            assert [str(value).lower() for value in column] == texts[name]
        elif column.dtype.kind == "U":
            assert list(column) == texts[name]
        else:
            np.testing.assert_array_equal(column.astype(float), np.array(texts[name], dtype=float))


def test_a_sweep_has_the_rows_of_the_program(tmp_path):
    packing = lattice(8, 7, 2, missing=0.1)
    parts = nscdd.decompose(packing, (3, 2))
    table = nscdd.sweep(parts, [0, 1e-2, 1], [0.3, np.inf], relaxation=[1, "optimal"], certify=True, eigenvalues=2)
    same_as_text(table, program_table(
        tmp_path, packing, "sweep", "--subdomains", "3x2", "--epsilon", "0,1e-2,1", "--eta", "0.3,inf", "--relaxation",
        "1,optimal", "--certify", "--eigenvalues", "2"))
    assert table.rows == 12 and table.units["epsilon"] == "1/kg" and "flexibility" in table.descriptions["epsilon"]


def test_texts_of_the_command_line(tmp_path):
    packing = bed(80)
    table = nscdd.sweep(nscdd.decompose(packing, "metis:3"), "1e-2:1:4W", "1W,inf", gauss_seidel_sweeps=[2, None])
    same_as_text(table, program_table(tmp_path, packing, "sweep", "--subdomains", "metis:3", "--epsilon", "1e-2:1:4W",
                                      "--eta", "1W,inf", "--gauss-seidel-sweeps", "2,inf"))


def test_a_sweep_by_numpy():
    parts = nscdd.decompose(bed(70, 5), (2, 2))
    table = nscdd.sweep(parts, np.geomspace(1e-2, 10, 4), 0.7)
    expected = [np.abs(literal_spectrum(parts, epsilon, 0.7)).max() for epsilon in table["epsilon"]]
    np.testing.assert_allclose(table["spectral_radius"], expected, rtol=1e-9)
    assert table["converged"].all() and table["converged"].dtype == bool and table["grains"].dtype == np.int64


def test_a_curve_has_the_rows_of_the_program_and_holds_the_radius(tmp_path):
    packing = lattice(6, 5, 4)
    parts = nscdd.decompose(packing, (2, 2))
    for arguments in (dict(epsilon=(1e-2, 1e2)), dict(epsilon="1e-2:1e2")):
        table = nscdd.curve(parts, **arguments, eta=[0.5, np.inf], tolerance=0.02)
        same_as_text(table, program_table(tmp_path, packing, "sweep", "--subdomains", "2x2", "--epsilon", "1e-2:1e2",
                                          "--eta", "0.5,inf", "--curve", "0.02"))
    assert table.status == ["proved", "proved"] and table.proved
    for eta in (0.5, np.inf):
        rows = table["eta"] == eta
        x = np.log(table["epsilon"][rows])
        assert (np.diff(x) > 0).all()
        for at in np.random.default_rng(1).uniform(x[0], x[-1], 40):
            radius = np.abs(literal_spectrum(parts, np.exp(at), eta)).max()
            low, high = (np.interp(at, x, table[name][rows]) for name in ("curve_low", "curve_high"))
            assert low - 1e-12 <= radius <= high + 1e-12
    seen = []
    along_eta = nscdd.curve(parts, 0.5, (0.1, 10), tolerance=0.1, progress=lambda done, total: seen.append((done, total)))
    assert along_eta["eta"][0] == 0.1 and along_eta["eta"][-1] == 10 and seen[-1][0] == seen[-1][1]
    assert "    curve_low: " in nscdd.curve.__doc__


@pytest.mark.parametrize("arguments, words", [
    (dict(epsilon=1.0), "curve: expected one range FROM:TO"),
    (dict(epsilon=(1, 2), eta=(1, 2)), "curve: expected one range FROM:TO"),
    (dict(epsilon=(2, 1)), "0 < FROM < TO"),
    (dict(epsilon=(1, 2), tolerance=0), "curve: expected a finite tolerance > 0, met 0"),
    (dict(epsilon=(1, 2), relaxation="optimal"), "relaxation: expected numbers with curve"),
    (dict(epsilon=(1, 2), solver="arpack"), "solver: expected auto, dense or shift-invert with curve"),
])
def test_errors_of_curves(arguments, words):
    with pytest.raises(nscdd.Error, match=words):
        nscdd.curve(nscdd.decompose(lattice(4, 4), (2, 1)), **arguments)


def test_values_may_come_one_by_one():
    parts = nscdd.decompose(lattice(4, 4), (2, 1))
    np.testing.assert_array_equal(nscdd.sweep(parts, (10.0**k for k in range(3)))["epsilon"], [1, 10, 100])
    with pytest.raises(nscdd.Error, match="parts are masked"):
        nscdd.sweep(parts, np.ma.array([1.0, 2.0], mask=[False, True]))


def test_an_optimum_has_the_rows_of_the_program(tmp_path):
    packing = lattice(6, 5, 3)
    parts = nscdd.decompose(packing, (2, 1))
    table = nscdd.optimum(parts, [0.0, 0.1], contacts="all")
    same_as_text(table, program_table(tmp_path, packing, "optimum", "--subdomains", "2x1", "--epsilon", "0,0.1",
                                      "--contacts", "all"))


def test_an_optimum_is_one():
    """No eta beside it has a smaller radius, and the enriched algorithm diverges below `convergent_from`."""
    parts = nscdd.decompose(bed(60, 7), (2, 1))
    best = nscdd.optimum(parts, 0.05, contacts="all")
    assert best["status"][0] == "interior"
    eta, radius = best["best_eta"][0], best["best_radius"][0]
    around = [np.abs(literal_spectrum(parts, 0.05, eta * factor)).max() for factor in (0.97, 1, 1.03)]
    assert around[1] == pytest.approx(radius, rel=1e-6) and around[1] < min(around[0], around[2])
    if best["convergent_from"][0] > 0:
        below, above = (np.abs(literal_spectrum(parts, 0.05, best["convergent_from"][0] * factor)).max()
                        for factor in (0.99, 1.01))
        assert below > 1 > above


def test_pandas():
    table = nscdd.sweep(nscdd.decompose(lattice(4, 4), (2, 1)), [0.1, 1])
    frame = table.to_pandas()
    assert list(frame.columns) == list(table) and len(frame) == 2
    assert frame["spectral_radius"].dtype == float and frame["converged"].dtype == bool
    assert frame.loc[1, "spectral_radius"] == table["spectral_radius"][1]


def test_documentation_has_the_columns():
    assert "    spectral_radius: " in nscdd.sweep.__doc__ and "    best_eta: " in nscdd.optimum.__doc__


@pytest.mark.parametrize("arguments, words", [
    (dict(epsilon=[]), "epsilon"),
    (dict(epsilon="1:2"), "expected FROM:TO:COUNT"),
    (dict(epsilon=[1, np.nan]), "epsilon: expected a finite number >= 0, met nan"),
    (dict(epsilon=1, relaxation=-1), "relaxation: expected a finite number > 0"),
    (dict(epsilon=1, gauss_seidel_sweeps=1.5), "gauss_seidel_sweeps: expected an integer >= 1"),
    (dict(epsilon=1, gauss_seidel_sweeps=2, certify=True), "expected inf with certify"),
    (dict(epsilon=1, gauss_seidel_sweeps=2, relaxation="optimal"), "known for an exact Stage 1 only"),
])
def test_errors(arguments, words):
    with pytest.raises(nscdd.Error, match=words):
        nscdd.sweep(nscdd.decompose(lattice(4, 4), (2, 1)), **arguments)
