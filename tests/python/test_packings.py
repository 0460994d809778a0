# SPDX-License-Identifier: GPL-3.0-or-later
"""Packings, contacts and matrices, as arrays that look at the memory of the library."""
import gc
import os
import pickle
import subprocess
import warnings

import numpy as np
import pytest
import scipy.sparse
import scipy.spatial
from conftest import bed, lattice

import nscdd


def test_a_packing_keeps_its_arrays():
    x, y, radius = np.arange(3.0), np.zeros(3), np.full(3, 0.5)
    packing = nscdd.Packing(x, y, radius)
    x[0] = 7  # it has a copy
    assert len(packing) == 3 and packing.mass is None and packing.x[0] == 0
    assert packing.x.base is not None and not packing.x.flags.owndata and not packing.x.flags.writeable
    assert np.shares_memory(packing.x, packing.x)
    with pytest.raises(ValueError):
        packing.x[0] = 1
    strided = nscdd.Packing(np.arange(6)[::2], [0, 0, 0], np.float32(0.5) * np.ones(3), mass=[1, 2, 3])
    np.testing.assert_array_equal(strided.x, [0, 2, 4])
    np.testing.assert_array_equal(strided.mass, [1, 2, 3])


def test_a_packing_in_space():
    """z makes it one, through files and pickles as well; normals and midpoints have three components."""
    height = np.sqrt(2 / 3)
    packing = nscdd.Packing([0, 1, 0.5, 0.5], [0, 0, np.sqrt(3) / 2, np.sqrt(3) / 6], np.full(4, 0.5),
                            z=[0, 0, 0, height])
    assert packing.dimension == 3 and packing.z[3] == height and not packing.z.flags.writeable
    assert repr(packing) == "<nscdd.Packing of 4 spheres, without masses>"
    again = pickle.loads(pickle.dumps(packing))
    np.testing.assert_array_equal(again.z, packing.z)
    network = nscdd.contacts(packing)
    assert len(network) == 6 and network.normal.shape == (6, 3) and network.midpoint.shape == (6, 3)
    centres = np.column_stack([packing.x, packing.y, packing.z])
    np.testing.assert_allclose(network.normal, centres[network.b] - centres[network.a], atol=1e-15)
    plane = nscdd.Packing([0, 2], [0, 0], [1, 1], [2, 3])
    assert plane.dimension == 2 and plane.z is None and pickle.loads(pickle.dumps(plane)).z is None
    assert repr(plane) == "<nscdd.Packing of 2 disks, with masses>"
    np.testing.assert_allclose(nscdd.decompose(packing, density=3).packing.mass, np.full(4, np.pi / 2), rtol=1e-15)


def test_arrays_outlive_their_objects():
    parts = nscdd.decompose(bed(50), (2, 1))
    h, x, a = parts.H, parts.packing.x, parts.subdomains[1].A
    expected = h.toarray(), x.copy(), a.toarray()
    del parts
    gc.collect()
    lattice(50, 50)  # takes memory that may have been freed
    for found, kept in zip((h.toarray(), x, a.toarray()), expected):
        np.testing.assert_array_equal(found, kept)


def test_pickle():
    packing = lattice(4, 3)
    again = pickle.loads(pickle.dumps(packing))
    for name in ("x", "y", "radius", "mass"):
        np.testing.assert_array_equal(getattr(again, name), getattr(packing, name))


@pytest.mark.parametrize("arguments, words", [
    (([0, 1], [0], [1, 1]), "packing: expected arrays of one length, met x of 2, y of 1, radius of 2"),
    (([0, 1], [0, 0], [1, 1], [1]), "mass of 1"),
    (([0, 1], [0, 0], [1, 1], None, [1]), "z of 1"),
    (([0, 1], [0, 0], [1, 1], None, []), "z of 0"),
    (([0, 1], [0, 0], [1, 1], None, [0, np.inf]), "grain 1: expected finite coordinates"),
    (([0, np.nan], [0, 0], [1, 1]), "grain 1: expected finite coordinates"),
    (([0, 1], [0, 0], [1, 0]), "grain 1: expected a finite radius > 0, met 0"),
    (([0, 2], [0, 0], [1, 1], [1, -1]), "grain 1: expected a finite mass > 0, met -1"),
    (([], [], []), "at least one grain"),
    (([[0, 1]], [0, 0], [1, 1]), "x: expected an array of one dimension, met one of 2"),
    ((0, 0, 1), "x: expected an array of one dimension, met one of 0"),
    ((np.array([0, 1j]), [0, 0], [1, 1]), "x: expected real numbers, met an array of complex128"),
    ((np.array(["0", "1"]), [0, 0], [1, 1]), "x: expected real numbers, met an array of <U1"),
    (([0, 1], np.array(["2020", "2021"], "datetime64[Y]"), [1, 1]), "y: expected real numbers, met an array of dat"),
    (([0, 1], [0, 0], np.ma.array([1, 2], mask=[False, True])), "radius: expected real numbers, met an array of which"),
    (([0, [1, 2]], [0, 0], [1, 1]), "x: expected real numbers"),
    ((iter([0.0, 1.0]), [0, 0], [1, 1]), "x: expected real numbers, met list_iterator"),
    ((np.array([0, "one"], object), [0, 0], [1, 1]), "x: expected real numbers"),
])
def test_errors_of_packings(arguments, words):
    with pytest.raises(nscdd.Error, match=words):
        nscdd.Packing(*arguments)


def test_arrays_of_any_kind_of_real_number():
    for x in (np.arange(3, dtype=">f8"), np.arange(3, dtype=np.int8), np.arange(3, dtype=np.float16), [0, 1, 2],
              np.array([0, 1, 2], dtype=object), np.ma.array([0, 1, 2]), np.arange(4.0)[2::-1][::-1], (0, 1, 2)):
        np.testing.assert_array_equal(nscdd.Packing(x, np.zeros(3), np.full(3, 0.5)).x, [0, 1, 2])


def test_contacts_by_brute_force():
    packing = bed(120, seed=2)
    network = nscdd.contacts(packing)
    centres = np.column_stack([packing.x, packing.y])
    distance = np.linalg.norm(centres[:, None] - centres, axis=2)
    reach = packing.radius[:, None] + packing.radius
    gap = distance - reach
    a, b = np.nonzero(np.triu(gap <= 1e-7 * np.minimum(packing.radius[:, None], packing.radius), 1))
    np.testing.assert_array_equal(network.a, a)
    np.testing.assert_array_equal(network.b, b)
    assert len(network) == len(a) > 120 and network.grains == 120
    np.testing.assert_allclose(network.gap, gap[a, b], atol=1e-12)
    np.testing.assert_allclose(network.normal, (centres[b] - centres[a]) / distance[a, b, None], atol=1e-12)
    np.testing.assert_allclose(network.midpoint, (centres[a] + centres[b]) / 2, atol=1e-12)
    assert not network.normal.flags.owndata and not network.a.flags.writeable
    assert len(nscdd.contacts(packing, tolerance=0.2)) > len(network)


def test_a_network_without_contacts():
    network = nscdd.contacts(nscdd.Packing([0, 5], [0, 0], [1, 1]))
    assert len(network) == 0 and network.a.shape == (0,) and network.normal.shape == (0, 2)


def test_errors_of_contacts():
    overlapping = nscdd.Packing([0, 1], [0, 0], [1, 1])
    with pytest.raises(nscdd.Error, match="grains 0 and 1 overlap by 1 m"):
        nscdd.contacts(overlapping)
    with pytest.raises(nscdd.Error, match="packing: grains 0 and 1 overlap"):
        nscdd.decompose(overlapping)
    with pytest.raises(nscdd.Error, match="tolerance"):
        nscdd.contacts(overlapping, tolerance=-1)


def test_the_whole_matrices():
    """M and H from geometry alone, and the load of a homogeneous deformation."""
    packing = bed(60)
    parts = nscdd.decompose(packing, (2, 2), compression=(1, -0.5), shear=0.25)
    network = nscdd.contacts(packing)
    expected = np.zeros((120, len(network)))
    for c, (i, j, normal) in enumerate(zip(network.a, network.b, network.normal)):
        expected[2 * i:2 * i + 2, c] = -normal
        expected[2 * j:2 * j + 2, c] = normal
    assert isinstance(parts.H, scipy.sparse.csc_matrix) and scipy.sparse.issparse(parts.M)
    np.testing.assert_allclose(parts.H.toarray(), expected, atol=1e-15)
    np.testing.assert_array_equal(parts.M.toarray(), np.diag(np.repeat(packing.mass, 2)))
    deformation = np.array([[-1, 0.25], [0.25, 0.5]])
    centres = np.column_stack([packing.x, packing.y])
    about = centres - np.average(centres, axis=0, weights=packing.mass)
    np.testing.assert_allclose(parts.arriving_velocity, (about @ deformation).ravel(), atol=1e-13)


@pytest.mark.parametrize("subdomains", [(3, 2), "3x2", "metis:5"])
def test_the_matrices_of_subdomains(subdomains):
    """Masses of copies add up, H_E are the columns of H, and A V = 0 holds for equal copies and for no others."""
    packing = lattice(9, 8, missing=0.1)
    parts = nscdd.decompose(packing, subdomains)
    where = parts.subdomain_of_contact
    mass, velocities = np.zeros(2 * len(packing)), []
    whole = np.random.default_rng(0).normal(size=2 * len(packing))
    for e, part in enumerate(parts.subdomains):
        np.testing.assert_array_equal(part.contacts, np.flatnonzero(where == e))
        rows = np.ravel(2 * part.grains[:, None] + [0, 1])
        np.testing.assert_array_equal(part.H.toarray(), parts.H[:, part.contacts].toarray()[rows])
        mass[rows] += part.M.diagonal()
        velocities.append(whole[rows])
    touched = np.diff(parts.H.tocsr().indptr) > 0
    np.testing.assert_allclose(mass[touched], parts.M.diagonal()[touched], rtol=1e-14)
    v = np.concatenate(velocities)
    assert parts.A.shape == (parts.interface_size, len(v))
    np.testing.assert_array_equal(parts.A @ v, np.zeros(parts.interface_size))
    shared = np.flatnonzero(np.diff(parts.A.indptr))
    v[shared[0]] += 1
    assert np.abs(parts.A @ v).max() == pytest.approx(1)
    copies = sum(len(part.grains) for part in parts.subdomains)
    assert parts.interface_size == 2 * (copies - np.count_nonzero(touched) // 2)
    assert np.linalg.matrix_rank(parts.A.toarray()) == parts.interface_size


@pytest.mark.parametrize("subdomains", [(2, 1, 2), "2x2x2", "metis:5"])
def test_spheres(subdomains):
    """M, H and the loads of a packing in space, and its radius against a dense spectrum of NumPy."""
    packing = nscdd.generate("fcc", columns=3, rows=3, layers=3, vacancies=0.1, seed=2)
    n, network = len(packing), nscdd.contacts(packing)
    parts = nscdd.decompose(packing, subdomains, compression=(1, -0.5, 0.25), shear=0.25, density=2,
                            prescribed={0: (1, 2, 3)})
    np.testing.assert_allclose(parts.M.diagonal(), np.repeat(2 * 4 / 3 * np.pi * packing.radius**3, 3), rtol=1e-14)
    assert parts.H.shape == (3 * n, len(network)) and network.normal.shape == (len(network), 3)
    for c, (a, b) in enumerate(zip(network.a, network.b)):
        column = np.zeros((n, 3))
        column[a], column[b] = -network.normal[c], network.normal[c]
        np.testing.assert_array_equal(parts.H[:, [c]].toarray(), column.reshape(-1, 1))
    arriving = parts.arriving_velocity.reshape(n, 3)
    np.testing.assert_array_equal(arriving[0], (1, 2, 3))
    deformation = np.array([[-1, 0.25, 0], [0.25, 0.5, 0], [0, 0, -0.25]])
    a, b = network.a[-1], network.b[-1]  # equal spheres in touch: their centres are the normal apart
    apart = 2 * packing.radius[0] * network.normal[-1]
    np.testing.assert_allclose(arriving[b] - arriving[a], deformation @ apart, atol=1e-12)

    epsilon = 0.1 * parts.mean_w_nn
    x = s = np.zeros((parts.interface_size, parts.interface_size))
    for part in parts.subdomains:
        m, h, g = (matrix.toarray() for matrix in (part.M, part.H, part.A))
        if m.size:
            x = x + g @ np.linalg.solve(m, g.T)
            s = s + g @ np.linalg.solve(m + h @ h.T / epsilon, g.T)
    expected = np.abs(np.linalg.eigvals(np.eye(len(x)) - np.linalg.solve(x, s))).max()
    found = nscdd.spectral_radius(nscdd.contraction(parts, "0.1W"), certify=True)
    assert found.value == pytest.approx(expected, abs=1e-9) and found.certified

    mode = nscdd.mode(nscdd.contraction(parts, "0.1W"))
    assert all(v.shape == (len(part.grains), 3) for part, v in zip(parts.subdomains, mode.velocities))


def test_numbers_for_each_direction_of_space():
    packing = nscdd.generate("fcc", columns=2, rows=2, layers=2)
    for arguments, words in ((dict(subdomains=(2, 2)), "partition.grid: expected three integers"),
                             (dict(compression=(1, 1)), "loads.compression: expected three numbers"),
                             (dict(prescribed={0: (1, 0)}), "expected three numbers for a packing in space")):
        with pytest.raises(nscdd.Error, match=words):
            nscdd.decompose(packing, **arguments)


def test_nothing_is_copied():
    parts = nscdd.decompose(lattice(5, 5), (2, 1))
    assert np.shares_memory(parts.H.data, parts.H.data)
    assert np.shares_memory(parts.H.indices, parts.H.indices)
    assert np.shares_memory(parts.M.data, parts.M.data)
    assert np.shares_memory(parts.subdomains[0].H.data, parts.subdomains[0].H.data)
    with pytest.raises(ValueError):
        parts.H.data[0] = 1


def test_a_partition_of_ones_own():
    packing = lattice(8, 6)
    of_grid = nscdd.decompose(packing, (2, 3))
    own = nscdd.decompose(packing, of_grid.subdomain_of_contact)
    assert len(own.subdomains) == 6
    assert (own.A != of_grid.A).nnz == 0
    swapped = nscdd.decompose(packing, 5 - of_grid.subdomain_of_contact)
    same, other = (nscdd.spectral_radius(nscdd.contraction(parts, 0.1)).value for parts in (of_grid, swapped))
    assert other == pytest.approx(same, rel=1e-12)
    for wrong, words in (([0, 1], "for each of"), (np.full(own.contacts, -1), "subdomain")):
        with pytest.raises(nscdd.Error, match=words):
            nscdd.decompose(packing, np.array(wrong))
    for wrong in (np.zeros(own.contacts), np.ma.array(np.zeros(own.contacts, int), mask=True)):
        with pytest.raises(TypeError, match="an array of integers"):
            nscdd.decompose(packing, wrong)
    with pytest.raises(nscdd.Error, match="expected numbers from 0 to 999999, met 1000000000000"):
        nscdd.decompose(packing, np.arange(own.contacts) * 10**12)
    with pytest.raises(nscdd.Error, match="expected an array of one dimension, met one of 2"):
        nscdd.decompose(packing, np.zeros((own.contacts, 1), int))


@pytest.mark.parametrize("arguments, words", [
    (dict(subdomains="2by3"), "subdomains: expected"),
    (dict(subdomains=(0, 2)), "met 0"),
    (dict(subdomains=(2, 2, 1)), "partition.grid: expected two integers for a packing in the plane"),
    (dict(prescribed={0: (1, 0, 0)}), "expected two numbers for a packing in the plane"),
    (dict(compression=(1, 1, 1)), "loads.compression: expected two numbers for a packing in the plane"),
    (dict(density=-1), "masses.density"),
    (dict(prescribed={99: (1, 0)}), "expected a grain in 0..15"),
    (dict(prescribed={-1: (1, 0), 15: (1, 0)}), "met grain 15 again"),
])
def test_errors_of_decompose(arguments, words):
    with pytest.raises(nscdd.Error, match=words):
        nscdd.decompose(lattice(4, 4), **arguments)


@pytest.mark.parametrize("prescribed, words", [
    ({0: (1, 0, 0, 0)}, "expected two components of the velocity of grain 0, or three in space"),
    ({0: (1,)}, "expected two components"),
    ({1.7: (1, 0)}, "cannot be interpreted as an integer"),
])
def test_velocities_are_pairs_of_numbers_of_a_grain(prescribed, words):
    with pytest.raises(TypeError, match=words):
        nscdd.decompose(lattice(4, 4), prescribed=prescribed)


def test_masses():
    packing = nscdd.Packing([0, 2], [0, 0], [1, 1])
    np.testing.assert_array_equal(nscdd.decompose(packing).M.diagonal(), np.ones(4))
    np.testing.assert_allclose(nscdd.decompose(packing, density=3).M.diagonal(), np.full(4, 3 * np.pi), rtol=1e-15)


def test_generators_and_files(tmp_path):
    """The bits of the program's generator, through either kind of file."""
    program = [os.environ["NSCDD_PROGRAM"], "generate", "deposit", "--set", "packing.grains=150", "--set",
               "packing.seed=4", "--set", "packing.distribution=lognormal"]
    expected = nscdd.generate("deposit", grains=150, seed=4, distribution="lognormal")
    for name in ("bed.csv", "bed.h5"):
        subprocess.run([*program, "-o", tmp_path / name], check=True, capture_output=True)
        found = nscdd.read_packing(tmp_path / name)
        for array in ("x", "y", "radius"):
            np.testing.assert_array_equal(getattr(found, array), getattr(expected, array))
    assert len(nscdd.generate("hexagonal", columns=5, rows=4)) == 20
    assert "grains = 1000: number of grains" in nscdd.generate.__doc__
    assert "vacancies = 0: fraction of the disks left out" in nscdd.generate.__doc__


@pytest.mark.parametrize("generator, parameters, words", [
    ("deposits", {}, 'generator: expected one of "strip", .*, met "deposits"; did you mean deposit'),
    ("deposit", {"grain": 3}, "packing.grain: no such parameter in this case; expected one of packing.grains"),
    ("deposit", {"grains": 0}, "packing.grains"),
    ("deposit", {"grains": 1.5}, "packing.grains"),
    ("deposit", {"distribution": "normal"}, 'packing.distribution: expected one of "uniform"'),
    ("deposit", {"radius_min": 2, "radius_max": 1}, "radius_min"),
])
def test_errors_of_generators(generator, parameters, words):
    with pytest.raises(nscdd.Error, match=words):
        nscdd.generate(generator, **parameters)


def test_errors_of_files(tmp_path):
    with pytest.raises(nscdd.Error, match="no-such.csv"):
        nscdd.read_packing(tmp_path / "no-such.csv")
    (tmp_path / "wrong.csv").write_text("x,y,radius\n0,0,1\n0,two,1\n")
    with pytest.raises(nscdd.Error, match="wrong.csv:3: "):
        nscdd.read_packing(tmp_path / "wrong.csv")


def test_what_stands_for_a_case_on_the_command_line(tmp_path):
    """A packing alone, a text of YADE, a contact problem of FCLIB, and a folder of LMGC90 with its seven digits."""
    (tmp_path / "three.txt").write_text("0 0 0.5\n1 0 0.5\n2 0 0.5\n")
    parts = nscdd.read_case(tmp_path / "three.txt", (2, 1))
    assert (parts.name, parts.grains, parts.contacts, len(parts.subdomains)) == ("three", 3, 2, 2)
    program = os.environ["NSCDD_PROGRAM"]
    case = os.path.join(os.environ["NSCDD_SOURCE"], "cases", "settle-1k.toml")
    run, problem, folder = tmp_path / "run.h5", tmp_path / "problem.hdf5", tmp_path / "lmgc90"
    subprocess.run([program, "simulate", case, "--steps", "40", "-o", run], check=True, capture_output=True)
    subprocess.run([program, "export", run, "--fclib", "40", "-o", problem], check=True, capture_output=True)
    subprocess.run([program, "export", run, "--lmgc90", folder], check=True, capture_output=True)
    bodies = nscdd.read_case(problem, "metis:3")
    assert bodies.H.shape[1] == 2 * nscdd.read_contact_problem(problem).contacts and bodies.M.shape[0] % 3 == 0
    packing = nscdd.read_packing(folder)
    assert len(packing) == 780
    with pytest.raises(nscdd.Error):
        nscdd.read_packing(tmp_path)
    assert nscdd.read_case(folder, (2, 1)).grains == 780
    back = nscdd.simulate(folder, settings={"dynamics.steps": 2, "dynamics.step": 1e-3})
    assert back.end == "completed" and len(back.packing) == 780
    with pytest.raises(nscdd.Error, match="expected the name of a file, met one with a zero in it"):
        nscdd.read_packing("bed\0.csv")


def test_cases():
    case = os.path.join(os.environ["NSCDD_SOURCE"], "cases", "disks8.toml")
    parts = nscdd.read_case(case)
    assert parts.name == "disks8" and parts.grains == 8 and len(parts.subdomains) > 1
    other = nscdd.read_case(case, subdomains=(3, 1), settings={"packing.grains": 20, "packing.radius": 0.25})
    assert other.grains == 20 and len(other.subdomains) == 3 and other.packing.radius[0] == 0.25
    with pytest.raises(nscdd.Error, match="packing.grain"):
        nscdd.read_case(case, settings={"packing.grain": 20})


def written(text):
    """Numbers as that format of C leaves them."""
    return np.vectorize(lambda value: float(text % value))


ROUNDED = {"%.6f": written("%.6f"), "%g": written("%g"), "%.4e": written("%.4e"), "%.15g": written("%.15g"),
           "%.3f": written("%.3f"), "float32": lambda values: values.astype(np.float32), "exact": lambda values: values}


@pytest.mark.parametrize("how", ROUNDED)
@pytest.mark.parametrize("far", [0.0, 1e6])
@pytest.mark.parametrize("radius", [0.5, 0.001, 1 / 3])
@pytest.mark.filterwarnings("ignore:.*coordinates with")
def test_rounded_packings_have_the_contacts_of_exact_ones(how, far, radius):
    """Those of a k-d tree over the exact lattice, turned, wherever the digits tell grains apart at all."""
    column, row = (k.ravel() for k in np.meshgrid(np.arange(12), np.arange(9)))
    x, y = radius * (2 * column + row % 2), radius * row * np.sqrt(3)
    angle = 0.3
    places = np.column_stack([np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y])
    tree = scipy.spatial.cKDTree(places)
    expected = sorted(tree.query_pairs(2 * radius * (1 + 1e-9)))
    changed = np.asarray(ROUNDED[how](places + far), dtype=float)
    radii = np.asarray(ROUNDED[how](np.full(len(x), radius)), dtype=float)
    if np.abs(changed - places - far).max() > 0.004 * radius:
        return  # digits that tell nothing
    network = nscdd.contacts(nscdd.Packing(changed[:, 0], changed[:, 1], radii))
    assert list(zip(network.a.tolist(), network.b.tolist())) == expected
    assert not network.ambiguous and network.open_pairs == 0


def test_contacts_that_depend_on_digits_are_warned_of():
    packing = lattice(8, 8)
    rounded = nscdd.Packing(np.round(packing.x, 6), np.round(packing.y, 6), packing.radius)
    with pytest.warns(UserWarning, match="coordinates with 6 decimals resolve gaps to") as told:
        network = nscdd.contacts(rounded)
    assert len(told) == 1 and told[0].filename == __file__
    beyond = np.abs(network.gap) > 0.5e-7
    assert len(network) == 161 and network.decided_by_rounding == beyond.sum() > 0
    assert network.digits == "6 decimals" and 1e-6 < network.uncertainty < 1e-5
    with pytest.warns(UserWarning, match="6 decimals"):
        parts = nscdd.decompose(rounded, (2, 1))
    assert parts.contacts == 161 and parts.network.decided_by_rounding == network.decided_by_rounding
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        exact = nscdd.contacts(packing)
        with pytest.raises(UserWarning, match="6 decimals"):
            nscdd.contacts(rounded)
    assert len(exact) == 161 and exact.decided_by_rounding == 0 and exact.digits == "double precision"
    # Rows that are apart by twice what digits tell.
    apart = nscdd.Packing(rounded.x, np.round(packing.y * (1 + 0.8e-5), 6), packing.radius)
    with pytest.warns(UserWarning, match="warning: packing: the contacts are ambiguous"):
        assert nscdd.contacts(apart).ambiguous


def test_float32_of_hdf5_is_read_as_what_it_is(tmp_path):
    h5py = pytest.importorskip("h5py")
    packing = lattice(8, 8)
    with h5py.File(tmp_path / "single.h5", "w") as file:
        for name in ("x", "y", "radius"):
            file[f"packing/{name}"] = (getattr(packing, name) * 0.37).astype(np.float32)
    with pytest.warns(UserWarning, match="single precision"):
        network = nscdd.contacts(nscdd.read_packing(tmp_path / "single.h5"))
    assert len(network) == 161 and network.digits == "single precision"
    with pytest.warns(UserWarning, match="single precision"):
        assert nscdd.read_case(tmp_path / "single.h5", (2, 1)).contacts == 161


def test_messages_show_bytes_that_are_no_text(tmp_path):
    (tmp_path / "latin.csv").write_bytes("x,y,größe\x1b[2J\n0,0,1\n".encode("latin-1"))
    with pytest.raises(nscdd.Error, match=r"gr\\xF6\\xDFe\\x1B\[2J"):
        nscdd.read_packing(tmp_path / "latin.csv")
    (tmp_path / "wide.csv").write_bytes("x,y,radius\n0,0,1\n".encode("utf-16"))
    with pytest.raises(nscdd.Error, match="expected UTF-8, met UTF-16"):
        nscdd.read_packing(tmp_path / "wide.csv")


@pytest.mark.parametrize("name, text, words", [
    ("none", None, "met no such file"),
    ("a.xyz", "4\n", "met a name that ends with '.xyz'"),
    ("dump.txt", "ITEM: TIMESTEP\n0\n", 'met the first line "ITEM: TIMESTEP"'),
    ("bad.toml", "[packings]\n[partition]\ngrid = [1, 1]\n",
     r"expected a section \[packing\], met none; sections here: \[packings\], \[partition\]"),
    ("order.txt", "#format r_x_y_z\n0.5 0 0 0.4\n0.5 1 0 0.6\n", "order.txt:2: .*the format 'r_x_y_z' of YADE"),
])
def test_what_is_no_case_is_told(tmp_path, name, text, words):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(nscdd.Error, match=words):
        nscdd.read_case(tmp_path / name)
    with pytest.raises(TypeError, match="subdomains: expected .*met 4"):
        nscdd.decompose(nscdd.Packing([0, 1], [0, 0], [0.5, 0.5]), subdomains=4)


def test_a_remark_that_begins_like_a_format_is_none(tmp_path):
    (tmp_path / "hand.txt").write_text("#formatted by hand\n0 0 0.5\n1 0 0.5\n")
    assert list(nscdd.read_packing(tmp_path / "hand.txt").x) == [0, 1]
