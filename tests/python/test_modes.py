# SPDX-License-Identifier: GPL-3.0-or-later
"""Modes from outside: eigenvectors of NumPy's dense matrices, velocities by the definition of Stage 1, and the tables of
the program."""
import os

import numpy as np
import pytest
from conftest import bed, lattice, literal_interface, literal_spectrum
from test_tables import program_table, same_as_text

import nscdd


@pytest.mark.parametrize("epsilon, eta, relaxation", [(0.1, np.inf, 1.0), (1.0, 0.3, 1.0), (0.0, 0.7, 1.0),
                                                      (0.2, 2.0, 0.6)])
@pytest.mark.parametrize("end", ["low", "high", "slowest"])
def test_an_eigenvector_of_numpy(epsilon, eta, relaxation, end):
    parts = nscdd.decompose(lattice(6, 5, 2, missing=0.1), (2, 2))
    found = nscdd.mode(nscdd.contraction(parts, epsilon, eta, relaxation=relaxation), end, certify=True)
    p, s = literal_interface(parts, eta), literal_interface(parts, epsilon)
    spectrum = literal_spectrum(parts, epsilon, eta, relaxation=relaxation)
    spectrum = spectrum[np.abs(spectrum - 1) > 1e-8] if epsilon == 0 else spectrum
    slow = {"low": spectrum[0], "high": spectrum[-1], "slowest": max(spectrum[[0, -1]], key=abs)}[end]
    assert found.found and found.converged and found.spectrum.certified and found.residual < 1e-9
    np.testing.assert_allclose(found.eigenvalue, slow, atol=1e-9)
    f = found.impulses
    np.testing.assert_allclose(f @ p @ f, 1, rtol=1e-12)  # 1 J
    np.testing.assert_allclose(f - relaxation * np.linalg.solve(p, s @ f), found.eigenvalue * f, atol=1e-8)
    np.testing.assert_allclose(found.jumps, -s @ f, atol=1e-8)
    np.testing.assert_allclose(found.shares.sum(), 1, rtol=1e-12)
    assert 1 <= found.spread <= len(found.shares) == parts.interface_size // 2


def test_velocities_are_those_of_stage_one():
    """V_E = -(M_E + H_E H_E^T / epsilon)^-1 A_E^T F, and the copies move against each other as the jumps say."""
    parts = nscdd.decompose(bed(60), (3, 1))
    found = nscdd.mode(nscdd.contraction(parts, 0.3, 2.0))
    assert len(found.velocities) == 3
    for part, v in zip(parts.subdomains, found.velocities):
        assert v.shape == (len(part.grains), 2) and not v.flags.writeable
        h = part.H.toarray()
        expected = np.linalg.solve(part.M.toarray() + h @ h.T / 0.3, -part.A.toarray().T @ found.impulses)
        np.testing.assert_allclose(v.ravel(), expected, atol=1e-10)
    np.testing.assert_allclose(parts.A @ np.concatenate([v.ravel() for v in found.velocities]), found.jumps, atol=1e-12)


@pytest.mark.parametrize("options", [{"eta": 1.0}, {"eta": 1.0, "contacts": "active"}, {"scheme": "schwarz"},
                                     {"scheme": "schwarz", "contacts": "active"}], ids=str)
@pytest.mark.filterwarnings("ignore:.*share a body")
def test_tables_are_those_of_the_program(tmp_path, options):
    packing = lattice(7, 6, 3, missing=0.1)
    prescribed = {0: (1, 0.5), -1: (-1, 0.25)}
    parts = nscdd.decompose(packing, (2, 2), prescribed=prescribed)
    assert 0 < np.count_nonzero(nscdd.chosen_contacts(parts, "active")) < parts.contacts
    found = nscdd.mode(nscdd.contraction(parts, 0.1, **options))
    program_table(tmp_path, packing, "modes", "--subdomains", "2x2", "--epsilon", "0.1", "--output",
                  str(tmp_path / "slow"), *(f"--prescribed={grain}:{x}:{y}" for grain, (x, y) in prescribed.items()),
                  *(f"--{key}={value}" for key, value in options.items()), table=False)
    for name, table in (("impulses", found.impulse_table()), ("velocities", found.velocity_table())):
        lines = (tmp_path / f"slow-{name}.csv").read_text().splitlines()
        heading, rows = lines[0].split(","), [line.split(",") for line in lines[1:]]
        same_as_text(table, {key: [row[k] for row in rows] for k, key in enumerate(heading)})
        assert table.rows > 10 and table.units["x"] == "m"


def test_where_there_is_none():
    whole = nscdd.mode(nscdd.contraction(nscdd.decompose(lattice(3, 3)), 1.0))
    assert not whole.found and len(whole.impulses) == 0 and whole.velocities == [] and np.isnan(whole.eigenvalue)
    assert whole.spread == 0 and whole.impulse_table().rows == 0 and "none was found" in repr(whole)


def test_a_mode_outlives_its_operator():
    found = nscdd.mode(nscdd.contraction(nscdd.decompose(lattice(5, 5), (2, 1)), 0.5))
    velocities, expected = found.velocities, [v.copy() for v in found.velocities]
    del found
    lattice(30, 30)
    for v, kept in zip(velocities, expected):
        np.testing.assert_array_equal(v, kept)


def test_errors():
    parts = nscdd.decompose(lattice(4, 4), (2, 1))
    with pytest.raises(nscdd.Error, match='end: expected one of "slowest", "low", "high"'):
        nscdd.mode(nscdd.contraction(parts, 1.0), "fast")
    with pytest.raises(TypeError, match="expected a Contraction"):
        nscdd.mode(parts)
    assert os.environ["NSCDD_PROGRAM"]
