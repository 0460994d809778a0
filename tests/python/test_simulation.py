# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in memory, against the trajectories of the program and against what falls and rests."""
import os
import pickle
import subprocess

import h5py
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import nscdd

CASES = os.path.join(os.environ["NSCDD_SOURCE"], "cases")
SETTLE = os.path.join(CASES, "settle-1k.toml")
FALL = """title = "one disk above a floor"
[packing]
generator = "strip"
grains = 1
radius = 0.5
[masses]
model = "unit"
[partition]
grid = [1, 1]
[interaction]
law = "coulomb"
friction = 0.3
[dynamics]
step = 0.01
steps = 100
theta = 0.5
gravity = [0.0, -10.0]
[[boundary]]
name = "floor"
shape = "wall"
from = [-5.0, -2.0]
to = [5.0, -2.0]
"""
TIMES = ("setup_seconds", "solve_seconds")


def test_a_run_has_the_bits_of_the_program(tmp_path):
    settings = {"dynamics.steps": 6, "solver.algorithm": "generic", "interaction.law": "coulomb"}
    seen = []
    run = nscdd.simulate(SETTLE, subdomains=(2, 2), settings=settings, callback=seen.append)
    path = tmp_path / "run.h5"
    options = [f"--set={key}={value}" for key, value in settings.items()]
    subprocess.run([os.environ["NSCDD_PROGRAM"], "simulate", SETTLE, "--subdomains", "2x2", *options, "-o", path],
                   check=True, capture_output=True)
    with h5py.File(path) as file:
        steps = file["steps"]
        assert [step.number for step in seen] == [1, 2, 3, 4, 5, 6] == list(run.steps["step"])
        for name in ("x", "y", "angle", "velocity_x", "velocity_y", "spin"):
            np.testing.assert_array_equal([getattr(step, name) for step in seen], steps[name][1:])
        for name, column in run.steps.items():
            if name not in TIMES:
                found = file["summary"][name][:]
                found = np.array([value.decode() for value in found]) if column.dtype.kind == "U" else found
                np.testing.assert_array_equal(column, found, err_msg=name)
        np.testing.assert_array_equal(run.last.radius, file["system/radius"])
        np.testing.assert_array_equal(run.last.driven_by, file["system/driven_by"])
        begin, end = file["last/contacts/rows"][-1]
        contacts = {(a, b): (n, t) for a, b, n, t in zip(*(file["last/contacts"][name][begin:end] for name in (
            "a", "b", "impulse_n", "impulse_t")))}
    assert len(run.last.contact_a) > 100
    for a, b, n, t in zip(run.last.contact_a, run.last.contact_b, run.last.impulse_n, run.last.impulse_t):
        assert contacts[a, b] == (n, t)
    assert run.end == "completed" and run.reason == "" and run.last.number == 6
    assert run.last.report["iterations"] == run.steps["iterations"][-1]
    assert len(run.packing) == 780 and np.array_equal(run.packing.x, run.last.x[:780])


def test_a_disk_falls_and_rests(tmp_path):
    """g t^2 / 2 until it meets the floor, then m g h of impulse in every step."""
    (tmp_path / "fall.toml").write_text(FALL)
    steps = []
    run = nscdd.simulate(tmp_path / "fall.toml", callback=steps.append)
    assert run.end == "completed" and len(steps) == 100
    for step in steps[:40]:
        assert step.y[0] == pytest.approx(-5 * step.time**2, abs=1e-12)
        assert step.velocity_y[0] == pytest.approx(-10 * step.time, rel=1e-12)
    assert len(run.last.impulse_n) == 1 and run.last.impulse_n[0] == pytest.approx(0.1, rel=1e-9)
    assert (run.last.contact_a[0], run.last.contact_b[0]) == (0, 1)  # the disk and the wall behind all disks
    assert run.last.y[0] == pytest.approx(-1.5, abs=0.1) and abs(run.last.velocity_y[0]) < 1e-12
    assert steps[0].y[0] != run.last.y[0] and not steps[0].y.flags.writeable  # steps stay as they were


def test_a_clump_flies_as_a_rigid_body_and_goes_on_from_the_packing_of_its_run(tmp_path):
    """A dumbbell falls g t^2 / 2 with its grains, next to a free sphere and a floor that rises."""
    (tmp_path / "c.txt").write_text("#format x_y_z_r_clumpId\n0 0 8 0.5 7\n9 0 8 0.5 -1\n0.5 0 8.5 0.5 7\n")
    (tmp_path / "c.toml").write_text("""[packing]
file = "c.txt"
[masses]
density = 1000
[partition]
grid = [1, 1]
[dynamics]
step = 0.01
steps = 10
[[boundary]]
name = "floor"
shape = "wall"
point = [0, 0, 0]
normal = [0, 0, 1]
velocity = [0, 0, 0.5]
""")
    run = nscdd.simulate(tmp_path / "c.toml")
    step, t = run.last, 0.1
    fall = 9.81 * t**2 / 2
    assert step.boundaries == ["floor", "clump 7"] and list(step.driven_by) == [1, -1, 1]
    np.testing.assert_allclose(step.body_velocities, [[0, 0, 0.5, 0, 0, 0], [0, 0, -9.81 * t, 0, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(
        step.body_poses, [[0, 0, 0.05, 1, 0, 0, 0], [0.25, 0, 8.25 - fall, 1, 0, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(step.z, [8 - fall, 8 - fall, 8.5 - fall], atol=1e-12)
    found = run.packing
    assert len(found) == 3 and np.array_equal(found.z, step.z) and list(found.clump) == [1, -1, 1]
    assert list(pickle.loads(pickle.dumps(found)).clump) == [1, -1, 1]
    again = nscdd.simulate(tmp_path / "c.toml", packing=found)  # from rest
    assert again.last.boundaries == ["floor", "clump 1"]
    np.testing.assert_allclose(again.last.z, found.z - fall, atol=1e-12)
    with pytest.raises(nscdd.Error, match="free grains, met clumps"):
        nscdd.contacts(found)
    with pytest.raises(nscdd.Error, match="clump: expected integers"):
        nscdd.Packing([0], [0], [1], clump=[0.5])


def test_the_scheme_names_the_algorithm_of_a_run(tmp_path):
    def run(*options, code=0):
        done = subprocess.run([os.environ["NSCDD_PROGRAM"], "simulate", "shear-1k", "--subdomains", "2x2", "--steps", "1",
                               "--iterations", "2", "--force", "-o", tmp_path / "run.h5", *options],
                              capture_output=True, text=True)
        assert done.returncode == code, done.stderr
        if code == 2:
            return done.stderr
        with h5py.File(tmp_path / "run.h5") as file:
            return file["case"][()]

    assert run("--scheme", "nscdd") == run("--algorithm", "generic") != run("--scheme", "schwarz")
    assert "expected" in run("--scheme", "schwarz", "--algorithm", "nlgs", code=2)
    assert 'expected one of "nscdd", "schwarz"' in run("--scheme", "additive", code=2)


TOP = """[packing]
file = "top.csv"
[partition]
grid = [1, 1, 1]
[dynamics]
step = 0.001
steps = 1000
gravity = [0, 0, 0]
[[boundary]]
name = "top"
shape = "grains"
first = 0
last = 0
free = ["x", "y", "z", "spin_x", "spin_y", "spin"]
mass = 2
inertia = [1, 2, 3]
axes = [0.8, 0, 0.6, 0]
centre = [0, 0, 0]
initial_spin = [1, 2, -1]
torque = [3, 0, 1]
load_turns
"""


@pytest.mark.parametrize("turns", [False, True])
def test_torques_along_fixed_axes_and_along_those_of_a_body(tmp_path, turns):
    """Against Euler's equations, dL/dt = T with L = R I R^T w, where T is fixed or R T_0."""
    (tmp_path / "top.csv").write_text("x,y,z,radius\n0,0,0,1\n")
    (tmp_path / "top.toml").write_text(TOP.replace("load_turns", "torque_turns = true" if turns else ""))
    inertia, torque, spin = np.array([1, 2, 3]), np.array([3, 0, 1]), np.array([1, 2, -1])
    start = Rotation.from_quat([0, 0.6, 0, 0.8])

    def slope(_, state):
        axes = Rotation.from_quat(state[:4])
        own = axes.inv().apply(state[4:]) / inertia
        v, s = state[:3], state[3]
        return [*(0.5 * (s * own + np.cross(v, own))), -0.5 * v @ own, *(axes.apply(torque) if turns else torque)]

    momentum = start.apply(inertia * start.inv().apply(spin))
    end = solve_ivp(slope, (0, 1), [*start.as_quat(), *momentum], rtol=1e-10, atol=1e-12).y[:, -1]
    axes = Rotation.from_quat(end[:4])
    expected = axes.apply(axes.inv().apply(end[4:]) / inertia)
    run = nscdd.simulate(tmp_path / "top.toml")
    last = run.last
    np.testing.assert_allclose(last.body_velocities[0][3:], expected, atol=0.01)
    turned = (axes * start.inv()).as_quat()
    met = np.roll(last.body_poses[0][3:], -1)
    np.testing.assert_allclose(met * np.sign(met @ turned), turned, atol=0.005)
    assert np.abs(run.steps["numerical"]).sum() < 0.01 * np.abs(run.steps["boundary_work"]).sum()


def test_clumps_begin_with_the_mean_of_the_loads(tmp_path):
    """D (x - centre) of a single sphere, and the mean over a clump by mass."""
    x = np.array([[0, 0, 0], [0.15, 0, 0.02], [2, 1, 0.2]])
    radius = np.array([0.1, 0.12, 0.1])
    (tmp_path / "c.txt").write_text("#format x_y_z_r_clumpId\n" + "".join(
        f"{one[0]} {one[1]} {one[2]} {r} {clump}\n" for one, r, clump in zip(x, radius, (0, 0, -1))))
    (tmp_path / "c.toml").write_text("""[packing]
file = "c.txt"
[masses]
density = 1000
[partition]
grid = [1, 1]
[loads]
compression = [1, 2, 3]
shear = 0.5
[dynamics]
steps = 1
gravity = [0, 0, 0]
""")
    step = nscdd.simulate(tmp_path / "c.toml").last
    single = np.array([step.velocity_x[2], step.velocity_y[2], step.velocity_z[2]])
    rates = np.array([[-1, 0.5, 0], [0.5, -2, 0], [0, 0, -3]])
    mass = radius**3
    centre = x[2] - np.linalg.solve(rates, single)
    assert np.all(centre > x.min(axis=0)) and np.all(centre < x.max(axis=0))
    mean = mass[:2] @ (x[:2] - centre) / mass[:2].sum() @ rates
    np.testing.assert_allclose(step.body_velocities[0], [*mean, 0, 0, 0], rtol=1e-12, atol=1e-15)


def write_source(path, packing, dynamics, first, place, distance):
    """A case whose grains from `first` on wait in a source."""
    path.write_text(f"""[packing]
file = "{packing}"
[partition]
grid = [1, 1]
[dynamics]
{dynamics}
[[boundary]]
name = "source"
shape = "grains"
first = {first}
last = -1
release = {list(place)}
release_distance = {distance}
""")


def test_grains_that_a_source_releases_are_free(tmp_path):
    (tmp_path / "rain.csv").write_text("x,y,radius\n0.4,3,0.1\n0.7,3,0.1\n1.0,3,0.1\n")
    write_source(tmp_path / "rain.toml", "rain.csv", "step = 0.001\nsteps = 600", 0, (0.47, 1.5), 0.25)
    seen = []
    run = nscdd.simulate(tmp_path / "rain.toml", callback=seen.append)
    assert list(seen[0].driven_by) == [-1, 0, 0] and list(run.last.driven_by) == [-1, -1, -1]
    speeds = run.last.velocity_x**2 + run.last.velocity_y**2
    assert run.last.report["kinetic"] == pytest.approx(speeds.sum() / 2, rel=1e-12)  # 1 kg each
    for k, free in ((0, 1), (599, 3)):
        assert run.steps["mean_speed"][k] == pytest.approx(np.sqrt(2 * run.steps["kinetic"][k] / free), rel=1e-12)


def test_a_run_that_comes_to_rest_after_a_release_has_the_same_end_in_pieces(tmp_path):
    """The mean speed falls where the second grain is released: only slow steps after that count."""
    (tmp_path / "two.csv").write_text("x,y,radius\n0,0,0.1\n1,0,0.1\n")
    write_source(tmp_path / "rest.toml", "two.csv", """step = 0.01
steps = 200
gravity = [0, 0]
rest_speed = 0.17
[[prescribed]]
grain = 0
velocity = [0.2, 0]""", 1, (0, 0), 0.2)

    def steps_of(*pieces):
        for k, number in enumerate(pieces):
            subprocess.run([os.environ["NSCDD_PROGRAM"], "simulate", "rest.toml", "-o", f"{len(pieces)}.h5", "--steps",
                            str(number), *(["--restart"] if k else [])], cwd=tmp_path, check=True, capture_output=True)
        with h5py.File(tmp_path / f"{len(pieces)}.h5") as file:
            return len(file["summary/step"])

    whole = steps_of(200)
    assert 105 < whole < 200 and steps_of(103, whole - 1, 200) == whole


def test_force_chains_of_a_periodic_cell_reach_the_nearest_image(tmp_path):
    (tmp_path / "row.csv").write_text("x,y,radius\n" + "".join(f"{0.1 + 0.2 * k},0,0.1\n" for k in range(4)))
    (tmp_path / "row.toml").write_text("""[packing]
file = "row.csv"
[contacts]
period_x = 0.8
[partition]
grid = [1, 1]
[dynamics]
step = 0.001
steps = 10
gravity = [0, 0]
[[prescribed]]
grain = 3
velocity = [1.0, 0]
""")
    (tmp_path / "study.toml").write_text("""title = "chains"
[[table]]
name = "chains"
observable = "force_chains"
cases = ["row.toml"]
steps = [0]
""")
    subprocess.run([os.environ["NSCDD_PROGRAM"], "run", ".", "--output", "out"], cwd=tmp_path, check=True,
                   capture_output=True)
    path = next((tmp_path / "out").rglob("chains.csv"))
    table = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
    ends = np.abs([table["x_b"] - table["x_a"], table["y_b"] - table["y_a"]])
    assert ends.shape[1] > 1 and np.any(table["x_a"] < 0.15)
    np.testing.assert_allclose(ends[0], 0.2, rtol=1e-9)
    np.testing.assert_allclose(ends[1], 0, atol=1e-12)


def test_a_law_without_opening_acts_where_bodies_touch(tmp_path):
    """A disk falls freely until it touches the floor. Neither alert distance nor range of cohesion matter."""
    ends = set()
    for alert in (0.0, 0.05, 0.3):
        text = FALL.replace('"coulomb"\nfriction = 0.3', '"linear_viscous"\nepsilon = 1e-3')
        (tmp_path / "fall.toml").write_text(text.replace("theta = 0.5", f"theta = 0.5\nalert = {alert}"))
        steps = []
        nscdd.simulate(tmp_path / "fall.toml", settings={"dynamics.steps": 60, "solver.algorithm": "nlgs"},
                       callback=steps.append)
        free = [step for step in steps if step.y[0] > -1.5]
        assert len(free) > 50
        for step in free[:-1]:
            assert step.velocity_y[0] == pytest.approx(-10 * step.time, rel=1e-12)
        assert max(step.report["kinetic"] for step in steps) <= 10 * 1.6  # m g times the fall
        ends.add(tuple(steps[-1].y))
    cohesive = FALL.replace('"coulomb"', '"cohesive"').replace('friction = 0.3', 'cohesion = 5\ncohesion_range = 0.3')
    (tmp_path / "fall.toml").write_text(cohesive)
    run = nscdd.simulate(tmp_path / "fall.toml", settings={
        "dynamics.steps": 60, "solver.algorithm": "nlgs", "interaction.law": "linear_viscous",
        "interaction.epsilon": 1e-3})
    ends.add(tuple(run.last.y))
    assert len(ends) == 1


def test_a_law_without_opening_does_not_act_on_the_way_to_a_meeting(tmp_path):
    """Disks 0.6 m apart that meet within the step: with the condition on the gap they would be stopped before."""
    (tmp_path / "pair.csv").write_text("x,y,radius\n0,0,1\n2.6,0,1\n")
    case = """[packing]
file = "pair.csv"
[partition]
grid = [1, 1]
[interaction]
law = "LAW"
[dynamics]
step = 1
steps = 1
gravity = [0, 0]
[[prescribed]]
grain = 0
velocity = [1.2, 0.7]
"""
    for law, pushed in (('linear_viscous"\nepsilon = "0.1W', False), ("frictionless", True)):
        (tmp_path / "pair.toml").write_text(case.replace("LAW", law))
        run = nscdd.simulate(tmp_path / "pair.toml", settings={"solver.algorithm": "nlgs"})
        assert (run.steps["active"][0] > 0) == pushed, run.reason


def test_statuses_of_contacts_that_hold_without_an_impulse(tmp_path):
    text = FALL.replace('friction = 0.3', 'friction = 0.3\ncohesion = 5').replace('"coulomb"', '"cohesive"')
    (tmp_path / "hold.toml").write_text(text.replace("[0.0, -10.0]", "[0.0, 0.0]").replace("-2.0]", "-0.5]"))
    run = nscdd.simulate(tmp_path / "hold.toml", settings={"dynamics.steps": 2})
    assert list(run.steps["stick"]) == [1, 1] and list(run.steps["active"]) == [0, 0]


def test_bodies_in_the_plane(tmp_path):
    """A body that spins freely: its angle is spin times time."""
    (tmp_path / "s.toml").write_text(FALL.replace("grains = 1", "grains = 2") + """[[boundary]]
name = "pair"
shape = "grains"
first = 0
last = 1
centre = [0.25, 0.5]
free = ["x", "y", "spin"]
mass = 3
inertia = 2
initial_velocity = [1, 0]
initial_spin = 4
""")
    run = nscdd.simulate(tmp_path / "s.toml", settings={"dynamics.steps": 5})
    np.testing.assert_allclose(run.last.body_velocities, [[0, 0, 0], [1, -0.5, 4]], atol=1e-12)
    np.testing.assert_allclose(run.last.body_poses[1], [0.3, 0.5 - 5 * 0.05**2, 0.2], atol=1e-12)
    # The clump of the packing has the mass of the body, in proportion to the masses of its grains.
    assert list(run.packing.clump) == [1, 1]
    np.testing.assert_allclose(run.packing.mass, [1.5, 1.5], rtol=1e-14)


@pytest.mark.parametrize("radius", [0.5, 0.25])
def test_the_ends_of_two_planks_hold_a_disk_or_let_it_through(tmp_path, radius):
    """A hopper with round ends of radius 0.1 at x = -0.4 and 0.4: both carry m g / (2 cos beta), or it is free."""
    height = np.sqrt(0.6**2 - 0.4**2)
    text = FALL.replace("radius = 0.5", f"radius = {radius}").replace('"coulomb"', '"frictionless"')
    for name, ends in (("left", (-3, -0.4)), ("right", (0.4, 3))):
        text += f"""[[boundary]]
name = "{name}"
shape = "plank"
from = [{ends[0]}, {-height!r}]
to = [{ends[1]}, {-height!r}]
radius = 0.1
"""
    (tmp_path / "hopper.toml").write_text(text)
    run = nscdd.simulate(tmp_path / "hopper.toml", settings={"dynamics.steps": 50})
    if radius < 0.3:  # it is below the ends
        assert run.last.y[0] == pytest.approx(-5 * 0.5**2, abs=1e-12) and run.last.y[0] < -height - 0.35
    else:
        np.testing.assert_allclose(run.last.impulse_n, 2 * [0.1 / (2 * height / 0.6)], rtol=1e-6)
        assert abs(run.last.y[0]) < 1e-7


def clumps_that_meet(seed, friction):
    """Two bodies of three spheres each, with any masses and moments of inertia, that turn and fly to each other."""
    random = np.random.default_rng(seed)
    text = f"""[packing]
file = "c.csv"
[masses]
density = 1
[partition]
grid = [1, 1]
[interaction]
friction = {friction}
[dynamics]
step = 2e-4
steps = 400
gravity = [0, 0, 0]
[solver]
tolerance = 1e-12
"""
    spheres, bodies = [], []
    for k, side in enumerate((-1, 1)):
        shape = random.uniform(-0.3, 0.3, (3, 3))
        centre = np.array([0.72 * side, 0, 0])
        spheres += [(*(centre + one), random.uniform(0.3, 0.4)) for one in shape]
        axes = Rotation.random(random_state=int(random.integers(1000)))
        body = {"centre": centre, "mass": random.uniform(1, 4), "inertia": random.uniform(0.5, 1, 3), "axes": axes,
                "velocity": np.array([-6.0 * side, *random.uniform(-1, 1, 2)]), "spin": random.uniform(-3, 3, 3)}
        bodies.append(body)
        w = np.roll(axes.as_quat(), 1)
        text += f"""[[boundary]]
name = "{k}"
shape = "grains"
first = {3 * k}
last = {3 * k + 2}
free = ["x", "y", "z", "spin_x", "spin_y", "spin"]
centre = {centre.tolist()}
mass = {body["mass"]}
inertia = {body["inertia"].tolist()}
axes = {w.tolist()}
initial_velocity = {body["velocity"].tolist()}
initial_spin = {body["spin"].tolist()}
"""
    return text, "x,y,z,radius\n" + "".join(",".join(map(repr, map(float, one))) + "\n" for one in spheres), bodies


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("friction", [0, 0.4])
def test_bodies_that_meet_in_space_keep_their_momenta(tmp_path, seed, friction):
    """Momentum and moment of momentum of two bodies of any shape, before and after they meet; energy falls. Tangential
    impulses act on both surfaces, up to the gap that closes within a step apart: 12 m/s x 2e-4 s."""
    text, packing, bodies = clumps_that_meet(seed, friction)
    (tmp_path / "c.toml").write_text(text)
    (tmp_path / "c.csv").write_text(packing)

    def sums(poses, velocities):
        momentum, moment, energy = np.zeros(3), np.zeros(3), 0
        for body, pose, v in zip(bodies, poses, velocities):
            frame = (Rotation.from_quat(np.roll(pose[3:], -1)) * body["axes"]).as_matrix()
            spin = frame @ np.diag(body["inertia"]) @ frame.T @ v[3:]
            momentum += body["mass"] * v[:3]
            moment += np.cross(pose[:3], body["mass"] * v[:3]) + spin
            energy += (body["mass"] * v[:3] @ v[:3] + v[3:] @ spin) / 2
        return momentum, moment, energy

    steps = []
    run = nscdd.simulate(tmp_path / "c.toml", callback=steps.append)
    assert sum(np.abs(step.impulse).max(initial=0) > 0.1 for step in steps) > 0
    before, after = (sums(step.body_poses, step.body_velocities) for step in (steps[0], run.last))
    scale = sum(body["mass"] * 6 for body in bodies)
    np.testing.assert_allclose(after[0], before[0], atol=1e-10 * scale)
    np.testing.assert_allclose(after[1], before[1], atol=(friction * 12 * 2e-4 + 1e-10) * scale)
    assert after[2] < before[2] * (1 - 1e-3)  # inelastic


def test_bodies_have_the_same_bits_in_any_number_of_threads(tmp_path):
    text = FALL.replace('generator = "strip"\ngrains = 1\nradius = 0.5', 'generator = "deposit"\ngrains = 300')
    for before, after in ("[1, 1]", "[2, 2]"), ("[-5.0, -2.0]", "[-5.0, 0]"), ("[5.0, -2.0]", "[5.0, 0]"):
        text = text.replace(before, after)
    for first in (10, 120, 200):
        text += f"""[[boundary]]
name = "{first}"
shape = "grains"
first = {first}
last = {first + 2}
free = ["x", "y", "spin"]
centre = [{first / 100}, 2]
mass = 3
inertia = 2
"""
    (tmp_path / "t.toml").write_text(text)
    for algorithm in ("generic", "enriched", "schwarz"):
        settings = {"dynamics.steps": 3, "solver.algorithm": algorithm, "solver.maximum_iterations": 50}
        one, two = (nscdd.simulate(tmp_path / "t.toml", settings=settings, threads=n).last for n in (1, 2))
        for name in ("x", "y", "spin", "body_velocities", "impulse_n", "impulse_t"):
            np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
        assert len(one.impulse_n) > 300


def test_grains_of_a_body_that_is_driven_along_some_direction_are_not_in_the_packing(tmp_path):
    (tmp_path / "p.toml").write_text(FALL.replace("grains = 1", "grains = 3") + """[[boundary]]
name = "piston"
shape = "grains"
first = 0
last = 1
centre = [0, 0]
free = ["x"]
mass = 3
""")
    run = nscdd.simulate(tmp_path / "p.toml", settings={"dynamics.steps": 1})
    assert len(run.packing) == 1 and run.packing.clump is None


def test_a_packing_in_place_of_that_of_the_case():
    shear = os.path.join(CASES, "shear-1k.toml")
    with pytest.raises(nscdd.Error, match="packing.settled: expected a generator or a file"):
        nscdd.simulate(shear)
    settling = nscdd.simulate(SETTLE, settings={"dynamics.steps": 30})
    run = nscdd.simulate(shear, packing=settling.packing, settings={"dynamics.steps": 2})
    assert run.steps.rows == 2 and np.isfinite(run.last.x).all()
    np.testing.assert_array_equal(run.last.radius[:780], settling.packing.radius)


def test_a_callback_ends_a_run():
    run = nscdd.simulate(SETTLE, settings={"dynamics.steps": 50}, callback=lambda step: step.number < 3)
    assert run.end == "stopped" and run.steps.rows == 3 == run.last.number

    def refuse(step):
        raise RuntimeError(f"enough of {step.number}")

    with pytest.raises(RuntimeError, match="enough of 1"):
        nscdd.simulate(SETTLE, callback=refuse)
    seen = []
    nscdd.simulate(SETTLE, settings={"dynamics.steps": 3}, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (3, 3)


@pytest.mark.parametrize("arguments, words", [
    (dict(settings={"dynamics.step_size": 1}), "dynamics.step_size: no such parameter"),
    (dict(settings={"solver.eta": 1.0}), "solver.eta: expected solver.algorithm"),
    (dict(subdomains="2 by 2"), "subdomains: expected"),
    (dict(subdomains=(2, 1)), "subdomains: expected solver.algorithm .*met nlgs, which does not decompose"),
    (dict(settings={"contacts.tolerance": 1e-3}), "contacts.tolerance: expected a parameter of the motion"),
])
def test_errors(arguments, words):
    with pytest.raises(nscdd.Error, match=words):
        nscdd.simulate(SETTLE, **arguments)


def test_a_case_that_does_not_move():
    with pytest.raises(nscdd.Error, match=r"section \[dynamics\]"):
        nscdd.simulate(os.path.join(CASES, "disks4.toml"))


def test_a_step_without_a_solution_ends_a_run(tmp_path):
    walls = FALL.replace('-5.0, -2.0]\nto = [5.0, -2.0]', '-5.0, -0.5]\nto = [5.0, -0.5]') + """
[[boundary]]
name = "lid"
shape = "wall"
from = [5.0, 0.5]
to = [-5.0, 0.5]
velocity = [0.0, -0.2]
"""
    (tmp_path / "walls.toml").write_text(walls, encoding="utf-8")
    (tmp_path / "fall.toml").write_text(FALL, encoding="utf-8")
    run = nscdd.simulate(tmp_path / "walls.toml")
    assert run.end == "impossible" and run.steps.rows == 0
    assert run.reason.startswith("step 1: no solution: the wall of boundary 'floor', disk 0, the wall of boundary 'lid'"
                                 ": closing at 0.2 m/s")
    run = nscdd.simulate(tmp_path / "walls.toml", settings={"dynamics.steps": 3, "solver.impossible": "go_on"})
    assert run.end == "completed" and list(run.steps["verdict"]) == ["impossible"] * 3
    assert np.all(run.steps["margin"] < 0) and np.allclose(run.steps["closing_speed"], 0.2)
    run = nscdd.simulate(tmp_path / "fall.toml", settings={"dynamics.steps": 3, "solver.verdict": "every"})
    assert list(run.steps["verdict"]) == ["exists"] * 3 and np.all(np.isposinf(run.steps["margin"]))


def test_cases_of_equal_text_in_two_folders_are_two_cases(tmp_path):
    """A study keeps states by what the files of a case hold, not by their names."""
    grains = {"a": "x,y,radius\n0,1,0.1\n", "b": "x,y,radius\n5,7,0.1\n6,7,0.2\n"}
    for folder, text in grains.items():
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "grains.csv").write_text(text)
        (tmp_path / folder / "drop.toml").write_text("""[packing]
file = "grains.csv"
[masses]
density = 1000
[partition]
grid = [1, 1]
[dynamics]
step = 0.001
steps = 10
""")
    (tmp_path / "study.toml").write_text("""title = "two folders"
[[table]]
name = "conf"
observable = "configuration"
cases = ["a/drop.toml", "b/drop.toml"]
steps = [0, 10]
lead_in = "own"
""")
    subprocess.run([os.environ["NSCDD_PROGRAM"], "run", tmp_path, "--output", tmp_path / "res"], check=True,
                   capture_output=True)
    path, = (tmp_path / "res").glob("*/conf.csv")
    table = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert list(table["radius"]) == 2 * [0.1] + 2 * [0.1, 0.2]


def test_a_packing_that_did_not_come_to_rest_is_named_each_time(tmp_path):
    (tmp_path / "bed.toml").write_text(FALL.replace("steps = 100", "steps = 2\nrest_speed = 1e-3"))
    (tmp_path / "use.toml").write_text('[packing]\nsettled = "bed.toml"\n[partition]\ngrid = [1, 1]\n')
    for _ in range(2):  # the second time from the cache
        ended = subprocess.run([os.environ["NSCDD_PROGRAM"], "inspect", tmp_path / "use.toml"], check=True,
                               capture_output=True, text=True, env={**os.environ, "NSCDD_CACHE": str(tmp_path / "kept")})
        assert "case 'bed': not at rest after 2 steps, mean speed 0.2 m/s" in ended.stderr
