# SPDX-License-Identifier: GPL-3.0-or-later
"""Spectra from outside: what the library finds against dense spectra of NumPy and sparse ones of SciPy, which see only
M, H and A, or the operators."""
import contextlib
import inspect
import warnings

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse.linalg
from conftest import bed, lattice, literal_interface, literal_spectrum

import nscdd

PACKINGS = [
    pytest.param(lambda: lattice(7, 6, seed), (3, 2), id=f"lattice {seed}") for seed in range(3)
] + [
    pytest.param(lambda: lattice(9, 7, seed, missing=0.15), "metis:4", id=f"vacancies {seed}") for seed in range(3)
] + [
    pytest.param(lambda: bed(90, seed), (2, 2), id=f"deposit {seed}") for seed in (1, 2)
]

# Of very unequal masses: a ratio of 2e7 and 3e14.
MASSES_2E7 = """x,y,radius,mass
0.0,0.0,0.31552658804700734,2643.848691028663
-0.962004843918247,-0.7359183410853992,0.8956831891873316,0.00011263808137920897
0.6417605361032832,-0.7990380255447814,0.709323816629732,0.0004153279572931889
-0.05577351818797381,-1.6578325148184159,0.39705845532818407,0.11634369466261944
0.9474630547715756,-2.2382123911474574,0.7619602771223897,8.30154548579616
2.311392225065493,-2.004397245018161,0.621864966229573,0.0070081407566831
2.864843688864664,-0.7916380649429036,0.7112116825938379,0.0020792713788491714
-0.605319239318911,0.8385204396900643,0.7186532363876232,1298.1903505876874
2.8694040878098854,0.44472007119027324,0.5251548641960866,0.007622570414314897
"""
MASSES_3E14 = """x,y,radius,mass
0.0,0.0,0.6073600408265791,3.737954723945994e-07
0.8562324159850323,-1.0491768757847804,0.7468578393038958,1.425033122978048e-08
-0.8025088850635692,-1.3148190635777097,0.9330196787728897,4244637.379740468
0.4455966649965943,-2.6042866573455523,0.8615538470176847,104.1273385865001
2.1898021921145814,-2.1034731346458297,0.9531271457046839,6.247601837250767e-08
-1.1643893023084533,-3.007830964371663,0.7982361465213637,0.4469645054876375
-1.0665005722372212,0.05344496735799514,0.4604788211363192,0.0006661387690475709
-1.993356907334165,-0.0150655553237347,0.4689061139833877,43355.54679441781
-2.279754057801171,-1.0176817536956482,0.5738127210979436,7.869660541592231e-08
"""


def close(found, expected, tolerance=1e-9):
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance)


def test_radius_of_the_paper():
    """rho(B_0) of 4 disks in 2 subdomains is (29 + sqrt 57)/56 ([ADI12] section 4.1)."""
    parts = nscdd.decompose(nscdd.generate("strip", grains=4), (2, 1))
    found = nscdd.spectral_radius(nscdd.contraction(parts, epsilon=0), certify=True)
    close(found.value, (29 + np.sqrt(57)) / 56, 1e-14)
    assert found.converged and found.certified and float(found) == found.value
    assert "certified=True" in repr(found)


@pytest.mark.parametrize("rows", [1, 7, 20, 40])
def test_many_equal_eigenvalues(rows):
    """Rows of five disks, each cut in its middle: M + K of half a chain has the corner 5 / 5.5 of its inverse."""
    x, y = np.meshgrid(np.arange(5.0), np.arange(float(rows)))
    parts = nscdd.decompose(nscdd.Packing(x.ravel(), y.ravel(), np.full(5 * rows, 0.5)), (2, 1))
    b = nscdd.contraction(parts, epsilon=1)
    for solver in ("auto", "dense", "shift-invert", "arpack"):
        found = nscdd.spectral_radius(b, solver=solver)
        assert found.converged and found.failure == ""
        close(found.value, 6 / 11, 1e-8)
    assert nscdd.sweep(parts, epsilon=[1.0, 0.5])["converged"].all()


def test_why_a_spectrum_stays_open():
    parts = nscdd.decompose(lattice(7, 6, 0), (3, 2))
    found = nscdd.spectral_radius(nscdd.contraction(parts, epsilon=1, eta=1e-13), solver="shift-invert")
    assert not found.converged and found.failure.startswith("shift-invert: ")


@pytest.mark.parametrize("packing, subdomains", PACKINGS)
@pytest.mark.parametrize("epsilon, eta", [(1e-2, np.inf), (1.0, 0.3), (0.3, 5.0), (0.0, 0.7), (0.0, np.inf)])
def test_dense_spectrum_of_numpy(packing, subdomains, epsilon, eta):
    parts = nscdd.decompose(packing(), subdomains)
    expected = literal_spectrum(parts, epsilon, eta)
    for solver in ("dense", "shift-invert"):
        found = nscdd.spectral_radius(nscdd.contraction(parts, epsilon, eta), certify=True, solver=solver)
        units = np.count_nonzero(np.abs(expected - 1) < 1e-8) if epsilon == 0 else 0
        others = expected[:len(expected) - units] if units else expected
        assert found.converged and found.certified and found.solver == solver
        assert found.unit_multiplicity == units
        close(found.value, np.abs(expected).max())
        close([found.subdominant_min, found.subdominant_max], [others[0], others[-1]])
        close(found.subdominant, np.abs(others).max())
        for value, (low, high) in ((others[0], found.interval_min), (others[-1], found.interval_max)):
            assert low - 1e-9 <= value <= high + 1e-9


@pytest.mark.parametrize("packing, subdomains", PACKINGS)
def test_active_contacts_and_relaxation(packing, subdomains):
    parts = nscdd.decompose(packing(), subdomains, prescribed={0: (1, 0.5), -1: (-1, 0.25)})
    kept = nscdd.chosen_contacts(parts, "active")
    assert 0 < np.count_nonzero(kept) < parts.contacts
    b = nscdd.contraction(parts, epsilon=0.1, eta=2.0, contacts="active", relaxation=0.8)
    expected = literal_spectrum(parts, 0.1, 2.0, kept, 0.8)
    found = nscdd.spectral_radius(b)
    close([found.eigenvalue_min, found.eigenvalue_max], [expected[0], expected[-1]])
    # All contacts give another radius: the choice has an effect.
    other = nscdd.spectral_radius(nscdd.contraction(parts, epsilon=0.1, eta=2.0, relaxation=0.8))
    assert abs(other.value - found.value) > 1e-6


@pytest.mark.parametrize("packing, subdomains", PACKINGS)
def test_operators(packing, subdomains):
    parts = nscdd.decompose(packing(), subdomains)
    b = nscdd.contraction(parts, epsilon=0.2, eta=0.7, relaxation=0.9)
    p, s = literal_interface(parts, 0.7), literal_interface(parts, 0.2)
    n = parts.interface_size
    assert b.shape == (n, n) and (b.preconditioner.eta, b.system.eta, b.relaxation) == (0.7, 0.2, 0.9)
    identity = np.eye(n)
    close(b.preconditioner @ identity, p)
    close(b.system.dense(), s)
    close(b.preconditioner.solve(identity), np.linalg.inv(p))
    close(b.preconditioner.inverse @ identity, np.linalg.inv(p))
    close(b @ identity, identity - 0.9 * np.linalg.solve(p, s))
    close(b.H @ identity, (identity - 0.9 * np.linalg.solve(p, s)).T)
    close(b.rmatvec(identity[0]), identity[0] - 0.9 * s @ np.linalg.solve(p, identity[0]))
    close(b.system.H @ identity[:, :2], s[:, :2])
    assert not b.system.dense().flags.writeable
    with pytest.raises(nscdd.Error, match=f"expected {n} entries, met {n + 1}"):
        b.preconditioner.solve(np.zeros(n + 1))


def test_operators_are_linear_over_complex_numbers():
    """SciPy may hand over complex vectors: their imaginary part must not be lost."""
    b = nscdd.contraction(nscdd.decompose(lattice(5, 5), (2, 2)), epsilon=0.2, eta=0.7, relaxation=0.9)
    x = np.random.default_rng(1).normal(size=(b.shape[0], 2)) @ [1, 1j]
    for operator in (b, b.H, b.system, b.preconditioner, b.preconditioner.inverse):
        close(operator @ x, operator @ x.real + 1j * (operator @ x.imag), 1e-13)
    close(b.system.solve(x), b.system.solve(x.real) + 1j * b.system.solve(x.imag), 1e-13)
    assert b.system.solve(np.zeros((b.shape[0], 0))).shape == (b.shape[0], 0)
    with pytest.raises(nscdd.Error, match="expected real numbers"):
        b.system.solve(np.array(["a"] * b.shape[0]))


@pytest.mark.parametrize("epsilon, eta", [(0.05, np.inf), (0.4, 0.2)])
def test_eigsh_of_scipy_on_the_operators(epsilon, eta):
    """Both ends of S x = lambda P x by SciPy's Lanczos, which applies S, P and P^-1 alone."""
    parts = nscdd.decompose(bed(900, seed=3), "metis:8")
    b = nscdd.contraction(parts, epsilon, eta)
    p = b.preconditioner
    ends = [scipy.sparse.linalg.eigsh(b.system, k=1, M=p, Minv=p.inverse, which=which, tol=1e-10,
                                      return_eigenvectors=False)[0] for which in ("LA", "SA")]
    found = nscdd.spectral_radius(b, certify=True)
    close([found.eigenvalue_min, found.eigenvalue_max], [1 - ends[0], 1 - ends[1]], 1e-8)
    largest = scipy.sparse.linalg.eigs(b, k=2, which="LM", return_eigenvectors=False)
    close(found.value, np.abs(largest).max(), 1e-8)


def test_modes_are_eigenvectors():
    parts = nscdd.decompose(lattice(8, 8, 4), (2, 2))
    b = nscdd.contraction(parts, epsilon=0.1, eta=1.0)
    found = nscdd.spectral_radius(b)
    for value, mode in ((found.eigenvalue_min, found.mode_min), (found.eigenvalue_max, found.mode_max)):
        close(b @ mode, value * mode, 1e-8 * np.abs(mode).max())


def test_several_eigenvalues_at_each_end():
    parts = nscdd.decompose(lattice(8, 6, 5), (3, 1))
    expected = literal_spectrum(parts, 0.3, 2.0)
    found = nscdd.spectral_radius(nscdd.contraction(parts, 0.3, 2.0), eigenvalues=4)
    close(found.low, expected[:4])
    close(found.high, expected[:-5:-1])


def test_no_interface_is_data():
    found = nscdd.spectral_radius(nscdd.contraction(nscdd.decompose(lattice(3, 3)), 1.0), certify=True)
    assert (found.value, found.solver, found.certified) == (0, "none", True)
    assert np.isnan(found.eigenvalue_min) and len(found.mode_max) == 0


def test_relative_flexibilities():
    parts = nscdd.decompose(lattice(6, 6, 1), (2, 2))
    relative = nscdd.contraction(parts, "0.1W", "2W")
    close([relative.system.eta, relative.preconditioner.eta], [0.1 * parts.mean_w_nn, 2 * parts.mean_w_nn], 1e-15)
    w = (parts.H.T @ scipy.sparse.diags(1 / parts.M.diagonal()) @ parts.H).diagonal()
    close(parts.mean_w_nn, w.mean(), 1e-13)


@pytest.mark.parametrize("arguments, words", [
    (dict(epsilon=-1.0), "epsilon: expected a finite number >= 0, met -1"),
    (dict(epsilon=1.0, eta=0.0), r"eta: expected a number > 0 \(or inf for the generic algorithm\), met 0"),
    (dict(epsilon=[1.0, 2.0]), "epsilon: expected one value, met 2"),
    (dict(epsilon=1.0, contacts="activ"), "did you mean active"),
    (dict(epsilon=1.0, contacts="active"), "expected a prescribed velocity"),
    (dict(epsilon=1.0, relaxation=0.0), "relaxation"),
])
def test_errors_of_contraction(arguments, words):
    parts = nscdd.decompose(lattice(4, 4), (2, 1))
    with pytest.raises(nscdd.Error, match=words) as caught:
        nscdd.contraction(parts, **arguments)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("arguments, words", [
    (dict(solver="lanczos"), 'solver: expected one of "auto", "dense"'),
    (dict(solver="slepc"), "met slepc, which nscdd-mpi has"),
    (dict(solver="arpack", certify=True), "expected auto, dense or shift-invert with certify"),
    (dict(eigenvalues=0), "eigenvalues"),
    (dict(residual_tolerance=0.0), "residual_tolerance"),
    (dict(threads=-1), "threads: expected a finite number >= 0 and <= 4096, met -1"),
])
def test_errors_of_spectral_radius(arguments, words):
    b = nscdd.contraction(nscdd.decompose(lattice(4, 4), (2, 1)), 1.0)
    with pytest.raises(nscdd.Error, match=words):
        nscdd.spectral_radius(b, **arguments)


def test_options_are_named_by_signatures_and_documentation():
    """They come from one description; a function takes no others."""
    parameters = inspect.signature(nscdd.spectral_radius).parameters
    assert parameters["residual_tolerance"].default == 1e-8 and parameters["certify"].annotation == "bool"
    assert list(inspect.signature(nscdd.solve).parameters)[:3] == ["W", "q", "mu"]
    assert inspect.signature(nscdd.solve).parameters["maximum_sweeps"].default == 100_000
    assert "no eigenvalue was missed" in nscdd.spectral_radius.__doc__
    parts = nscdd.decompose(lattice(4, 4), (2, 1))
    with pytest.raises(TypeError, match="unexpected keyword argument 'certified'"):
        nscdd.spectral_radius(nscdd.contraction(parts, 1.0), certified=True)
    with pytest.raises(TypeError, match="'eigenvalues'"):
        nscdd.curve(parts, (1, 2), eigenvalues=2)
    with pytest.raises(nscdd.Error, match="certify: expected True or False, met 'yes'"):
        nscdd.spectral_radius(nscdd.contraction(parts, 1.0), certify="yes")


def test_the_scheme_schwarz_is_block_jacobi_on_all_contacts():
    parts = nscdd.decompose(lattice(6, 5, 1), (2, 2))
    h, mass = parts.H.toarray(), parts.M.diagonal()
    w = h.T @ (h / mass[:, None])
    owner = np.empty(parts.contacts, int)
    for e, one in enumerate(parts.subdomains):
        owner[one.contacts] = e
    epsilon = 0.2
    unit = epsilon * np.eye(len(w))
    j = np.eye(len(w)) - np.linalg.solve(w * (owner[:, None] == owner) + unit, w + unit)
    mu = np.sort(np.linalg.eigvals(j).real)
    b = nscdd.contraction(parts, epsilon, scheme="schwarz")
    found = nscdd.spectral_radius(b, certify=True)
    close([found.eigenvalue_min, found.eigenvalue_max], mu[[0, -1]])
    assert found.certified and b.scheme == "schwarz"
    close(b @ found.mode_min, found.eigenvalue_min * found.mode_min, 1e-8)
    table = nscdd.sweep(parts, epsilon, scheme="schwarz", relaxation=[1, "optimal"])
    close(table["spectral_radius"], [found.value, (mu[-1] - mu[0]) / (2 - mu[0] - mu[-1])])
    best = nscdd.optimum(parts, epsilon, contacts="all", scheme="schwarz")
    close(best["best_relaxation"], table["relaxation"][1:])
    assert abs(nscdd.mode(b).shares.sum() - 1) < 1e-10
    with pytest.raises(nscdd.Error, match="eta: expected none with scheme schwarz"):
        nscdd.contraction(parts, epsilon, 0.3, scheme="schwarz")


@pytest.mark.parametrize("contacts", ["active", "unilateral"])
def test_the_scheme_schwarz_on_chosen_contacts(contacts):
    parts = nscdd.decompose(lattice(6, 5, 1), (2, 2), prescribed={0: (1, 0.5), -1: (-1, 0.25)})
    kept = nscdd.chosen_contacts(parts, contacts)
    assert 0 < np.count_nonzero(kept) < parts.contacts
    h, mass = parts.H.toarray()[:, kept], parts.M.diagonal()
    w = h.T @ (h / mass[:, None])
    owner = np.empty(parts.contacts, int)
    for e, one in enumerate(parts.subdomains):
        owner[one.contacts] = e
    owner = owner[kept]
    epsilon = 0.2
    unit = epsilon * np.eye(len(w))
    values = scipy.linalg.eigh(w + unit, w * (owner[:, None] == owner) + unit, eigvals_only=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of relaxations
        b = nscdd.contraction(parts, epsilon, scheme="schwarz", contacts=contacts)
        swept = nscdd.sweep(parts, epsilon, scheme="schwarz", contacts=contacts)
        curve = nscdd.curve(parts, (epsilon, 1), scheme="schwarz", contacts=contacts)
    found = nscdd.spectral_radius(b, certify=True)
    close([found.eigenvalue_min, found.eigenvalue_max], 1 - values[[-1, 0]])
    close([swept["spectral_radius"][0], curve["spectral_radius"][0]], [found.value] * 2)
    best = nscdd.optimum(parts, epsilon, scheme="schwarz", **({} if contacts == "active" else {"contacts": contacts}))
    close(best["best_relaxation"], 2 / (values[0] + values[-1]))


@pytest.mark.parametrize("relaxation", [1, 0.45])
@pytest.mark.parametrize("solver, tolerance", [("dense", 1e-3), ("shift-invert", 1e-2)])
def test_curves_of_schwarz_hold_between_their_points(relaxation, solver, tolerance):
    """Both ends of the pencil (W + epsilon, D + epsilon), dense, against straight lines over log epsilon."""
    parts = nscdd.decompose(bed(60, 5), (3, 2))
    h, mass = parts.H.toarray(), parts.M.diagonal()
    w = h.T @ (h / mass[:, None])
    owner = np.empty(parts.contacts, int)
    for e, one in enumerate(parts.subdomains):
        owner[one.contacts] = e
    d = w * (owner[:, None] == owner)
    with pytest.warns(UserWarning, match="share a body") if relaxation == 1 else contextlib.nullcontext():
        curve = nscdd.curve(parts, (1e-4, 1e2), scheme="schwarz", relaxation=relaxation, tolerance=tolerance,
                            solver=solver)
    assert curve.proved and len(curve) > 10 and set(curve["scheme"]) == {"schwarz"}
    at, low, high = np.log(curve["epsilon"]), curve["curve_low"], curve["curve_high"]
    assert np.all(high - low <= tolerance * np.maximum(1, curve["subdominant_radius"]) * (1 + 1e-9))
    between = np.linspace(at[0], at[-1], 301)
    for x in between:
        unit = np.exp(x) * np.eye(len(w))
        ends = scipy.linalg.eigh(w + unit, d + unit, eigvals_only=True)[[0, -1]]
        radius = max(1 - relaxation * ends[0], relaxation * ends[1] - 1)
        assert np.interp(x, at, low) - 1e-9 <= radius <= np.interp(x, at, high) + 1e-9
    if relaxation == 1:  # the radius does not rise, and epsilon times the radius does not fall
        radius = curve["subdominant_radius"]
        assert np.all(np.diff(radius) <= 1e-10) and np.all(np.diff(curve["epsilon"] * radius) >= -1e-10)
    with pytest.raises(nscdd.Error, match="eta: expected none with scheme schwarz"):
        nscdd.curve(parts, 1, (0.1, 10), scheme="schwarz")


def test_a_curve_of_schwarz_knows_how_stiff_contacts_of_several_subdomains_are(tmp_path):
    """Four contacts with one normal on one body, each in a subdomain: W = 1 1^T, D = 1, and lambda_high = (4 + e) / (1 + e),
    which is concave over e / (e + L) from L = 4 on, as its inverse is not over e / (e + 1)."""
    h = np.zeros((3, 8))
    h[0, ::2] = 1
    h[1, 1::2] = 1
    problem = nscdd.ContactProblem.of_bodies(np.eye(3), h, np.zeros(3), np.ones(8), np.zeros(4))
    nscdd.write_contact_problem(tmp_path / "star.hdf5", problem)
    parts = nscdd.read_case(tmp_path / "star.hdf5", [0, 0, 1, 1, 2, 2, 3, 3])  # columns (n, t) of each
    with pytest.warns(UserWarning, match="up to 4 subdomains"):
        curve = nscdd.curve(parts, (1e-3, 1e3), scheme="schwarz", tolerance=1e-4)
    assert curve.proved
    at = np.log(curve["epsilon"])
    for x in np.linspace(at[0], at[-1], 1001):
        radius = 3 / (1 + np.exp(x))
        assert np.interp(x, at, curve["curve_low"]) <= radius * (1 + 1e-12) <= np.interp(x, at, curve["curve_high"]) * (
            1 + 2e-12)


def test_relaxations_with_which_schwarz_may_not_converge_are_warned_of():
    parts = nscdd.decompose(lattice(6, 5, 1), (2, 2))
    words = "up to 4 subdomains share a body, and schwarz may not converge with a relaxation of 0.5 or more, met 0.6"
    with pytest.warns(UserWarning, match=words):
        nscdd.sweep(parts, [0, 1], relaxation=[0.4, 0.6], scheme="schwarz")
    with pytest.warns(UserWarning, match=words) as told:
        nscdd.contraction(parts, 1, relaxation=0.6, scheme="schwarz")
        nscdd.sweep(parts, 1, relaxation=0.6, scheme="schwarz")
    assert [one.filename for one in told] == [__file__] * 2
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        nscdd.sweep(parts, 0, relaxation=[0.49, "optimal"], scheme="schwarz")
        nscdd.contraction(parts, 1, relaxation=0.5, scheme="schwarz")
        nscdd.contraction(parts, 1, relaxation=1.5)


def test_the_residual_holds_what_small_flexibilities_and_unequal_masses_lose():
    """0 <= mu < 1 where eta is above epsilon; an eigenvalue of B is within the residual of each end."""
    parts = nscdd.decompose(nscdd.generate("strip", grains=1200), (4, 1))
    found = nscdd.spectral_radius(nscdd.contraction(parts, 0, "1e-12W"))
    assert found.eigenvalue_min < -1e-5 and not found.converged



def test_unequal_masses_widen_intervals_and_show_in_residuals(tmp_path):
    """Ends of B_0 of nine disks, from 100 digits of arithmetic."""
    for text, eta, exact, end in ((MASSES_2E7, np.inf, 0.483974026010119, "min"),
                                  (MASSES_3E14, 9.603861436189502e-06, 0.00894721851049, "max")):
        (tmp_path / "masses.csv").write_text(text)
        parts = nscdd.decompose(nscdd.read_packing(tmp_path / "masses.csv"), (2, 1))
        found = nscdd.spectral_radius(nscdd.contraction(parts, 0, eta), certify=True)
        low, high = getattr(found, f"interval_{end}")
        assert abs(getattr(found, f"subdominant_{end}") - exact) <= found.residual + 1e-12
        assert not found.certified or low <= exact <= high
        assert found.certified == (eta == np.inf)


def test_velocities_that_move_all_grains_alike_load_no_contact():
    packing = nscdd.Packing(np.arange(4.0), np.zeros(4), np.full(4, 0.5), mass=[1, 3, 7, 11])
    turned = 0.3 + np.arange(4.0)
    rest = nscdd.Packing(np.cos(1.1) * turned, np.sin(1.1) * turned, np.full(4, 0.5), mass=[1, 3, 7, 11])
    for grains, velocities in ((packing, {k: (0.1, 0.7) for k in range(4)}),
                               (rest, {k: (-0.7 * rest.y[k], 0.7 * rest.x[k]) for k in range(4)})):
        parts = nscdd.decompose(grains, (2, 1), prescribed=velocities)
        for kind in ("active", "unilateral"):
            assert not nscdd.chosen_contacts(parts, kind).any()
    pushed = nscdd.decompose(packing, (2, 1), prescribed={0: (0.1, 0.7), 1: (0.1 - 1e-9, 0.7), 2: (0.1, 0.7)})
    assert nscdd.chosen_contacts(pushed, "unilateral").any()


def test_impulses_within_the_tolerance_of_the_solution_carry_nothing(tmp_path):
    """A disk pushed against one of four supports: the same contacts carry however the plane is turned."""
    for angle in (0, 0.1, 0.3, 0.5, 1.1):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        h = np.zeros((3, 8))
        for k, place in enumerate(((1, 0), (0, 1), (-1, 0), (0, -1))):
            x, y = turn @ place
            for j, (u, v) in enumerate(((-x, -y), (y, -x))):
                h[:, 2 * k + j] = u, v, x * v - y * u
        problem = nscdd.ContactProblem.of_bodies(2 * np.eye(3), h, [*(turn @ [1.0, 0]), 0], np.zeros(8), 0.3)
        nscdd.write_contact_problem(tmp_path / f"{angle}.hdf5", problem)
        carrying = nscdd.chosen_contacts(nscdd.read_case(tmp_path / f"{angle}.hdf5", "metis:2"), "frozen")
        assert list(carrying.reshape(4, 2).any(axis=1)) == [True, False, False, False]


def test_a_grid_over_a_periodic_cell_does_not_depend_on_the_order_of_grains(tmp_path):
    x, y = np.meshgrid(np.arange(6.0), np.arange(4.0))
    grains = np.column_stack([x.ravel(), y.ravel(), np.full(24, 0.5)])
    seen = []
    for k, order in enumerate((np.arange(24), np.arange(24)[::-1], np.random.default_rng(1).permutation(24))):
        np.savetxt(tmp_path / f"{k}.csv", grains[order], delimiter=",", header="x,y,radius", comments="")
        (tmp_path / f"{k}.toml").write_text(f"""[packing]
file = "{k}.csv"
[contacts]
period_x = 6
[partition]
grid = [2, 1]
""")
        parts = nscdd.read_case(tmp_path / f"{k}.toml")
        seen.append((parts.interface_size, nscdd.spectral_radius(nscdd.contraction(parts, 0.1)).value))
    assert {size for size, _ in seen} == {seen[0][0]} and seen[0][0] > 0
    close([value for _, value in seen], seen[0][1], 1e-12)
