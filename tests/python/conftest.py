# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the Python package share. Nothing is skipped: a test that is counts as failed."""
import numpy as np
import pytest

import nscdd


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    report = (yield).get_result()
    if report.skipped:
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid} was skipped, and no test may be"


def lattice(columns, rows, seed=0, missing=0.0):
    """A piece of triangular lattice of equal disks with random masses, some of them left out: hyperstatic."""
    random = np.random.default_rng(seed)
    places = [((2 * c + r % 2) * 0.5, r * np.sqrt(3) * 0.5) for r in range(rows) for c in range(columns)]
    kept = np.array([place for place in places if random.uniform() >= missing])
    return nscdd.Packing(kept[:, 0], kept[:, 1], np.full(len(kept), 0.5), random.uniform(0.5, 2, len(kept)))


def bed(grains, seed=1):
    """A deposit with random masses: isostatic, disordered."""
    packing = nscdd.generate("deposit", grains=grains, seed=seed)
    masses = np.random.default_rng(seed).uniform(0.5, 2, grains)
    return nscdd.Packing(packing.x, packing.y, packing.radius, masses)


def literal_interface(parts, eta, kept=None):
    """X_eta = sum_E A_E (M_E + H_E H_E^T / eta)^-1 A_E^T, dense and as printed; its limits for eta = inf and eta = 0
    (projection of the velocities on those that open no contact). `kept`: flags of the contacts in H_E."""
    x = np.zeros((parts.interface_size, parts.interface_size))
    for part in parts.subdomains:
        a, mass, h = part.A.toarray(), part.M.diagonal(), part.H.toarray()
        if kept is not None:
            h = h[:, kept[part.contacts]]
        if eta == 0:
            root = 1 / np.sqrt(mass)
            u, s, _ = np.linalg.svd(root[:, None] * h, full_matrices=True)
            free = u[:, np.count_nonzero(s > 1e-10):]
            inverse = root[:, None] * free @ free.T * root
        else:
            inverse = np.linalg.inv(np.diag(mass) + h @ h.T / eta)
        x += a @ inverse @ a.T
    return x


def literal_spectrum(parts, epsilon, eta, kept=None, relaxation=1.0):
    """Eigenvalues of B = I - omega P^-1 S by NumPy's solver for matrices without symmetry, ascending."""
    p, s = literal_interface(parts, eta), literal_interface(parts, epsilon, kept)
    values = np.linalg.eigvals(np.eye(len(p)) - relaxation * np.linalg.solve(p, s))
    assert np.abs(values.imag).max() < 1e-9
    return np.sort(values.real)
