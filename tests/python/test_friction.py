# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact problems with friction: Signorini's and Coulomb's laws checked contact by contact in NumPy."""
import os
import subprocess

import numpy as np
import pytest
import scipy.sparse

import nscdd


def random_problem(contacts, seed):
    """M, H, f, w of bodies that are pressed together, H with full rank."""
    random = np.random.default_rng(seed)
    unknowns = 3 * contacts
    mass = random.uniform(0.5, 2, unknowns)
    h = scipy.sparse.random(unknowns, 2 * contacts, density=0.15, random_state=seed, data_rvs=random.standard_normal)
    h = (h + scipy.sparse.eye(unknowns, 2 * contacts)).tocsc()
    f = -(h @ np.tile([1.0, 0.3], contacts)) + random.normal(size=unknowns)
    return scipy.sparse.diags(mass).tocsc(), h, f, 0.1 * random.normal(size=2 * contacts)


def local(problem):
    mass, h, f, w = problem
    inverse = scipy.sparse.diags(1 / mass.diagonal())
    return h.T @ inverse @ h, h.T @ (inverse @ f) + w


def natural_maps(w, q, mu, r):
    """r - projection on the cone of r - rho (u + mu |u_t| n), contact by contact: zero for a solution (De Saxce)."""
    u = w @ r + q
    rho = 1 / w.diagonal()[::2]
    n, t = r[::2] - rho * (u[::2] + mu * np.abs(u[1::2])), r[1::2] - rho * u[1::2]
    on_edge = (n + mu * np.abs(t)) / (1 + mu**2)
    inside, polar = np.abs(t) <= mu * n, n <= -mu * np.abs(t)
    pn = np.where(inside, n, np.where(polar, 0, on_edge))
    pt = np.where(inside, t, np.where(polar, 0, np.sign(t) * mu * on_edge))
    return np.concatenate([r[::2] - pn, r[1::2] - pt])


@pytest.mark.parametrize("solver", ["auto", "newton", "nlgs", "admm"])
@pytest.mark.parametrize("seed", [1, 2])
def test_the_laws_hold(solver, seed):
    w, q = local(random_problem(12, seed))
    mu = np.linspace(0, 0.6, 12)
    found = nscdd.solve(w, q, mu, solver=solver, tolerance=1e-10)
    assert found.converged and found.status == "converged" and found.residual <= 1e-10
    r = found.impulses
    np.testing.assert_allclose(found.velocities, w @ r + q, atol=1e-12)
    assert np.linalg.norm(natural_maps(w, q, mu, r)) <= 1e-9 * np.linalg.norm(r)
    pressed = r[::2] > 0
    assert found.open == np.count_nonzero(~pressed) and found.open + found.stick + found.slide == 12
    assert 0 < np.count_nonzero(pressed)


def test_without_friction_it_is_a_linear_complementarity_problem():
    """All pressed contacts rest, all others open: the least of r^T W r / 2 + q^T r over r >= 0, by SciPy."""
    from scipy.optimize import nnls

    w, q = local(random_problem(10, 5))
    normal = w.toarray()[::2, ::2]
    root = np.linalg.cholesky(normal).T
    expected, _ = nnls(root, -np.linalg.solve(root.T, q[::2]))
    found = nscdd.solve(w, q, 0.0)
    np.testing.assert_allclose(found.impulses[::2], expected, atol=1e-7)
    np.testing.assert_array_equal(found.impulses[1::2], 0)


def test_one_contact_by_hand():
    """W = I, q = (-1, 0.3), mu = 0.2: it slides with r = (1, -0.2), and u = (0, 0.1)."""
    found = nscdd.solve(np.eye(2), [-1, 0.3], 0.2)
    np.testing.assert_allclose(found.impulses, [1, -0.2], atol=1e-9)
    np.testing.assert_allclose(found.velocities, [0, 0.1], atol=1e-9)
    assert (found.open, found.stick, found.slide) == (0, 0, 1)
    assert nscdd.solve(np.eye(2), [-1, 0.1], 0.2).stick == 1
    assert nscdd.solve(np.eye(2), [1, 0.1], 0.2).open == 1


def test_squares_that_vanish_or_overflow_are_refused():
    for size in (1e-200, 1e160):
        with pytest.raises(nscdd.Error, match="solve: largest |q|: expected a number from 1e-140".replace("|", "[|]")):
            nscdd.solve(np.eye(2), [-size, 0], 0.3)


def test_any_matrix_of_scipy_and_a_guess():
    w, q = local(random_problem(8, 3))
    expected = nscdd.solve(w, q, 0.3).impulses
    for other in (w.toarray(), w.tocsr(), w.tocoo(), w.tobsr()):
        np.testing.assert_allclose(nscdd.solve(other, q, 0.3).impulses, expected, atol=1e-7)
    again = nscdd.solve(w, q, 0.3, solver="nlgs", guess=expected)
    assert again.sweeps <= 10 and nscdd.solve(w, q, 0.3, solver="nlgs").sweeps > again.sweeps


def test_the_matrix_of_the_caller_stays_as_it_is():
    doubled = scipy.sparse.csc_matrix((np.full(4, 0.5), [0, 0, 1, 1], [0, 2, 4]), shape=(2, 2))
    found = nscdd.solve(doubled, [-1, 0], 0.5)
    np.testing.assert_allclose(found.impulses, [1, 0], atol=1e-9)
    assert doubled.nnz == 4


def test_bodies():
    problem = random_problem(9, 4)
    w, q = local(problem)
    found = nscdd.reduce_and_solve(*problem, 0.4, tolerance=1e-10)
    np.testing.assert_allclose(found.velocities, w @ found.impulses + q, atol=1e-10)
    assert found.converged
    assert np.linalg.norm(natural_maps(w, q, np.full(9, 0.4), found.impulses)) <= 1e-9 * np.linalg.norm(found.impulses)


def test_an_observer_sees_every_check_and_may_stop():
    w, q = local(random_problem(12, 1))
    seen = []
    full = nscdd.solve(w, q, 0.3, solver="nlgs", callback=lambda s: seen.append(s.sweeps))
    assert seen[0] == 0 and seen == sorted(seen) and seen[-1] == full.sweeps
    stopped = nscdd.solve(w, q, 0.3, solver="nlgs", check_every=1, callback=lambda s: s.sweeps < 2)
    assert stopped.status == "stopped" and stopped.sweeps == 2 and not stopped.converged

    def refuse(solution):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        nscdd.solve(w, q, 0.3, callback=refuse)


def test_what_does_not_converge_is_data():
    w, q = local(random_problem(12, 1))
    found = nscdd.solve(w, q, 0.3, solver="nlgs", maximum_sweeps=1, tolerance=1e-14)
    assert found.status == "maximum_reached" and not found.converged and "maximum_reached" in repr(found)


def test_a_callback_may_say_no_as_numpy_does():
    w, q = local(random_problem(12, 1))
    stopped = nscdd.solve(w, q, 0.3, solver="nlgs", check_every=1, callback=lambda s: np.bool_(s.sweeps < 2))
    assert stopped.status == "stopped" and stopped.sweeps == 2
    for goes_on in (None, 0, "", np.array(0)):  # only False stops
        assert nscdd.solve(w, q, 0.3, callback=lambda s: goes_on).converged


def same_matrix(a, b):
    return a.shape == b.shape and (a != b).nnz == 0


@pytest.mark.parametrize("name", ["problem.hdf5", "problem.h5", "problem.dat"])
def test_files_keep_every_bit(tmp_path, name):
    mass, h, f, w = random_problem(8, 2)
    of_bodies = nscdd.ContactProblem.of_bodies(mass, h, f, w, np.linspace(0, 0.5, 8))
    assert of_bodies.has_bodies and of_bodies.W is None and of_bodies.q is None
    for problem in (of_bodies, of_bodies.reduced()):
        nscdd.write_contact_problem(tmp_path / name, problem, force=True)
        back = nscdd.read_contact_problem(tmp_path / name)
        assert back.contacts == 8 and back.has_bodies == problem.has_bodies and back.solution is None
        for matrix in ("W", "M", "H"):
            expected, found = getattr(problem, matrix), getattr(back, matrix)
            assert (found is None and expected is None) or same_matrix(found, expected)
        for vector in ("q", "f", "w", "mu"):
            np.testing.assert_array_equal(getattr(back, vector), getattr(problem, vector))
    with pytest.raises(ValueError):
        back.W.data[0] = 1


def test_a_solution_is_written_and_another_program_reads_it(tmp_path):
    """By h5py, in the layout of FCLIB, and by `nscdd solve`, which solves the same problem."""
    import h5py

    problem = nscdd.ContactProblem.of_bodies(*random_problem(8, 2), 0.3)
    found = problem.solve(tolerance=1e-10)
    path = tmp_path / "solved.hdf5"
    nscdd.write_contact_problem(path, problem, found, title="eight contacts")
    with h5py.File(path) as file:
        np.testing.assert_array_equal(file["solution/r"][:], found.impulses)
        v = file["solution/v"][:]
        np.testing.assert_allclose(problem.M @ v, problem.H @ found.impulses + problem.f, atol=1e-10)
        np.testing.assert_allclose(file["solution/u"][:], problem.H.T @ v + problem.w, atol=1e-10)
        assert file["fclib_global/info/title"][()].decode() == "eight contacts"
    back = nscdd.read_contact_problem(path)
    assert back.info == {"title": "eight contacts"} and back.guesses == []
    np.testing.assert_array_equal(back.solution["r"], found.impulses)
    assert set(back.solution) == {"u", "r", "v"} and set(back.reduced().info) == set()
    report = subprocess.run([os.environ["NSCDD_PROGRAM"], "solve", path], check=True, capture_output=True, text=True)
    assert "title                eight contacts" in report.stdout and "converged" in report.stdout
    stopped = problem.solve(solver="nlgs", maximum_sweeps=1, tolerance=1e-14)
    nscdd.write_contact_problem(path, back, stopped, force=True)
    again = nscdd.read_contact_problem(path)
    np.testing.assert_array_equal(again.solution["r"], found.impulses)  # that of the file stays
    assert len(again.guesses) == 1
    ended = subprocess.run([os.environ["NSCDD_PROGRAM"], "solve", path, "--solver", "nlgs", "--maximum-sweeps", "0",
                            "-o", tmp_path / "kept.hdf5"], capture_output=True, text=True)
    assert ended.returncode == 1 and "the impulses are written as guess 2" in ended.stderr
    np.testing.assert_array_equal(nscdd.read_contact_problem(tmp_path / "kept.hdf5").solution["r"], found.impulses)
    np.testing.assert_array_equal(again.guesses[0]["r"], stopped.impulses)
    assert again.solve(solver="nlgs", guess=found.impulses).sweeps < again.solve(solver="nlgs").sweeps


def square_problem():
    """M, H, f and w of two disks side by side on a floor. H is square."""
    h = np.zeros((6, 6))
    for contact, normal, bodies in ((0, (0, 1), (0,)), (1, (0, 1), (1,)), (2, (1, 0), (1, 0))):
        for k, direction in enumerate((normal, (-normal[1], normal[0]))):
            for body, sign in zip(bodies, (1, -1)):
                h[3 * body:3 * body + 2, 2 * contact + k] = sign * np.array(direction)
                h[3 * body + 2, 2 * contact + k] = -0.5 * k
    return np.diag([1, 1, 0.125] * 2), h, np.array([0.3, -1, 0, -0.2, -1, 0.1]), np.zeros(6)


def write_triplets(path, mass, h, f, w, rows, columns):
    """As a file of FCLIB whose rows and columns have these names."""
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:  # as MATLAB does
        group = file.create_group("fclib_global")
        group["spacedim"] = np.array([2], "i4")
        for name, matrix in (("M", mass), ("H", h)):
            found, part = scipy.sparse.coo_matrix(matrix), group.create_group(name)
            for key, number in zip(("m", "n", "nzmax", "nz"), (*matrix.shape, found.nnz, found.nnz)):
                part[key] = np.array([number], "i4")
            part[rows], part[columns], part["x"] = found.row, found.col, found.data
        for name, values in (("f", f), ("w", w), ("mu", np.full(len(w) // 2, 0.3))):
            group[f"vectors/{name}"] = values
        group["info/title"] = np.bytes_(b"\xe9t\xe9")


def test_triplets_that_fit_in_either_order_are_those_of_rigid_bodies(tmp_path):
    """Siconos writes (i, p) where FCLIB documents (p, i); a square H fits both."""
    mass, h, f, w = square_problem()
    assert np.abs(h - h.T).max() > 0
    for rows, columns in (("p", "i"), ("i", "p")):
        write_triplets(tmp_path / "square.h5", mass, h, f, w, rows, columns)
        problem = nscdd.read_contact_problem(tmp_path / "square.h5")
        np.testing.assert_array_equal(problem.H.toarray(), h)
        assert problem.info["title"] == r"\xE9t\xE9"
    write_triplets(tmp_path / "odd.h5", mass, h + np.triu(np.ones((6, 6))), f, w, "p", "i")
    with pytest.raises(nscdd.Error, match="odd.h5.*H: expected triplets that fit in one order only"):
        nscdd.read_contact_problem(tmp_path / "odd.h5")


def test_a_limit_of_time_keeps_what_was_found(tmp_path):
    """`timeout` sends two signals at once: the first one asks, the second one must not kill."""
    nscdd.write_contact_problem(tmp_path / "p.hdf5", nscdd.ContactProblem.of_bodies(*random_problem(250, 3), 0.3))
    for attempt in range(2):
        path = tmp_path / f"{attempt}.hdf5"
        ended = subprocess.run(["timeout", "1.5", os.environ["NSCDD_PROGRAM"], "solve", tmp_path / "p.hdf5", "--solver",
                                "nlgs", "--tolerance", "1e-30", "--maximum-sweeps", "1000000000", "-o", path],
                               capture_output=True, text=True)
        assert ended.returncode == 124 and "interrupted after" in ended.stderr
        assert len(nscdd.read_contact_problem(path).guesses) == 1


def test_errors_of_files(tmp_path):
    problem = nscdd.ContactProblem(np.eye(2), [-1, 0], 0.3)
    found = problem.solve()
    nscdd.write_contact_problem(tmp_path / "p.hdf5", problem)
    other = nscdd.ContactProblem(np.eye(4), [-1, 0, -1, 0], 0.3).solve()
    for arguments, words in (
            ((tmp_path / "p.hdf5", problem), "p.hdf5.*force"),
            ((tmp_path / "p.dat", problem, found), "has no place for it"),
            ((tmp_path / "p.csv", problem), "p.csv"),
            ((tmp_path / "q.hdf5", nscdd.ContactProblem(2 * np.eye(2), [-1, 0], 0.3), found), "expected u = W r . q"),
            ((tmp_path / "q.hdf5", problem, other), "expected that of a problem of 1 contacts, met 2")):
        with pytest.raises(nscdd.Error, match=words):
            nscdd.write_contact_problem(*arguments)
    with pytest.raises(nscdd.Error, match="no-such.hdf5"):
        nscdd.read_contact_problem(tmp_path / "no-such.hdf5")
    (tmp_path / "wrong.dat").write_text("3\n1\n")
    with pytest.raises(nscdd.Error, match="wrong.dat"):
        nscdd.read_contact_problem(tmp_path / "wrong.dat")


@pytest.mark.parametrize("w, q, mu, options, words", [
    (np.eye(4), [0, 0], 0.1, {}, "problem"),
    (np.eye(2), [0, 0], -0.1, {}, "friction"),
    (np.array([[1, 0.5], [0, 1]]), [0, 0], 0.1, {}, "symmetric"),
    (np.zeros((2, 2)), [0, 0], 0.1, {}, "positive definite"),
    (np.eye(2), [0, np.nan], 0.1, {}, "finite"),
    (np.eye(2), [-1, 0], 0.1, {"solver": "nlg"}, 'solver: expected one of "auto"'),
    (np.eye(2), [-1, 0], 0.1, {"order": "backwards"}, 'order: expected one of "natural"'),
    (np.eye(2), [-1, 0], 0.1, {"relaxation": 2}, "relaxation"),
    (np.eye(2) * 1j, [-1, 0], 0.1, {}, "W: expected a matrix of real numbers, met complex128"),
    (np.ones(2), [-1, 0], 0.1, {}, r"W: expected a matrix of real numbers, met float64 of shape \(2,\)"),
    (np.eye(2), [-1j, 0], 0.1, {}, "q: expected real numbers, met an array of complex128"),
    (np.eye(2), [-1, 0], 0.1, {"maximum_sweeps": 1e5}, "maximum_sweeps: expected an integer, met 100000.0"),
    (np.eye(2), [-1, 0], 0.1, {"maximum_sweeps": 10**30}, "maximum_sweeps: expected an integer, met 1000000"),
    (np.eye(2), [-1, 0], 0.1, {"relaxation": "a"}, "relaxation: expected a number, met 'a'"),
    (np.eye(2), [-1, 0], 0.1, {"check_every": 0}, "check_every: expected a finite number >= 1, met 0"),
    (np.eye(2), [-1, 0], 0.1, {"guess": [np.nan, 0]}, "guess: expected finite numbers"),
    (np.eye(2), [-1, 0], 0.1, {"threads": -1}, "threads"),
    (np.eye(2), [-1, 0], 0.1, {"guess": [0]}, "guess of the impulses: expected 2 x contacts = 2 numbers, met 1"),
])
def test_errors(w, q, mu, options, words):
    with pytest.raises(nscdd.Error, match=words):
        nscdd.solve(w, q, mu, **options)


def test_a_contact_in_space_slides_in_the_direction_of_its_load(tmp_path):
    # W = diag(1, 3.5, 3.5): the normal impulse stops the fall, friction of 0.5 slows the slide.
    problem = nscdd.ContactProblem(np.diag([1, 3.5, 3.5]), [-1, 3, 4], [0.5])
    assert problem.dimension == 3 and problem.contacts == 1
    solution = problem.solve(tolerance=1e-12)
    assert solution.converged and solution.slide == 1
    np.testing.assert_allclose(solution.impulses, [1, -0.3, -0.4], atol=1e-12)
    np.testing.assert_allclose(solution.velocities, [0, 3 - 1.05, 4 - 1.4], atol=1e-12)
    nscdd.write_contact_problem(tmp_path / "space.hdf5", problem, solution)
    back = nscdd.read_contact_problem(tmp_path / "space.hdf5")
    assert back.dimension == 3
    np.testing.assert_array_equal(back.solution["r"], solution.impulses)


def test_a_run_ends_at_its_tolerance_and_doubts_stand_beside():
    """Two contacts that squeeze a body: after k sweeps r = (2 k - 1, 2 k) N s, and the natural map is 2 N s."""
    w = np.array([[1.0, 0, -1, 0], [0, 1, 0, 1], [-1, 0, 1, 0], [0, 1, 0, 1]])
    q, sweeps = [-1, 0, -1, 0], np.arange(1, 2000)
    expected = 2 / np.hypot(2 * sweeps - 1, 2 * sweeps)
    for tolerance in (0.1, 3e-3):
        found = nscdd.solve(w, q, 0.3, solver="nlgs", tolerance=tolerance, check_every=1)
        first = np.argmax(expected <= tolerance)
        assert found.converged and found.sweeps == sweeps[first]
        assert found.residual == pytest.approx(expected[first], rel=1e-12)
        assert not found.credible and found.driven_residual == pytest.approx(np.sqrt(2))
    assert not nscdd.solve(w, q, 0.3).converged
    sound = nscdd.solve(w + np.diag([1, 0, 1, 0]), q, 0.3)
    assert sound.converged and sound.credible and sound.driven_residual <= 1e-8


def test_verdicts_have_certificates():
    mass, h, f, w = random_problem(10, 3)
    problem = nscdd.ContactProblem.of_bodies(mass, h, f, w, 0.3)
    verdict = problem.verdict()
    assert verdict.kind == "exists" and verdict.chain == [] and np.isnan(verdict.normal_margin)
    u = h.T @ verdict.velocities + local((mass, h, f, w))[1]
    margin = np.min(u[::2] - 0.3 * np.abs(u[1::2]))
    assert 0 < verdict.margin <= margin < verdict.margin * (1 + 1e-9)

    h = h.tolil()
    h[:, 2] = -2 * h[:, 0]  # bodies press on one support as they leave the other, and both close
    closing = nscdd.ContactProblem.of_bodies(mass, h.tocsc(), 0 * f, np.where(np.arange(20) < 3, -0.1, 0.0), 0.3)
    verdict = closing.verdict()
    assert verdict.kind == "impossible" and verdict.chain == [0, 1]
    np.testing.assert_allclose(verdict.stress, [1, 0.5])
    assert verdict.closing_speed == pytest.approx(0.15) and verdict.proven_speed > 1e6
    assert "impossible" in repr(verdict)
