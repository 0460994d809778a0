# SPDX-License-Identifier: GPL-3.0-or-later
"""A run that goes on from a folder of LMGC90 starts with its contact forces and statuses."""
import os
import re
import subprocess

import h5py
import numpy as np
import pytest

import nscdd

# A clump leans on a side that is pushed in; both frictions act.
PLANE = """[packing]
file = "disks.csv"
[partition]
grid = [1, 1]
[interaction]
friction = 0.1
static_friction = 0.6
[dynamics]
step = 0.002
steps = 40
penetration_correction = 0
[solver]
algorithm = "nlgs"
criterion = "natural_map"
tolerance = 1e-10
[[boundary]]
name = "pusher"
shape = "wall"
from = [-0.5, 3]
to = [-0.5, 0]
velocity = [0.1, 0]
[[boundary]]
name = "floor"
shape = "wall"
from = [-0.5, 0]
to = [6, 0]
[[boundary]]
name = "clump"
shape = "grains"
first = 3
last = 4
centre = [1.5, 0.5]
free = ["x", "y", "spin"]
mass = 2
inertia = 1
"""
DISKS = "x,y,radius,mass\n0,0.5,0.5,1\n0.5,1.366,0.5,1\n1.5,1.366,0.5,1\n1,0.5,0.5,1\n2,0.5,0.5,1\n"
ON_FLOOR = """[packing]
file = "spheres.csv"
[partition]
grid = [1, 1, 1]
[interaction]
friction = 0.3
[dynamics]
step = 0.002
steps = 40
penetration_correction = 0
[solver]
algorithm = "nlgs"
criterion = "natural_map"
tolerance = 1e-10
[[boundary]]
name = "floor"
shape = "wall"
point = [0, 0, 0]
normal = [0, 0, 1]
"""
SPACE = ON_FLOOR + """[[boundary]]
name = "pusher"
shape = "wall"
point = [-0.5, 0, 0]
normal = [1, 0, 0]
velocity = [0.1, 0, 0]
"""
SPHERES = "x,y,z,radius,mass\n0,0,0.5,0.5,1\n0.99,0.1,0.5,0.5,1\n0.5,0.05,1.3,0.5,1\n1.98,0,0.5,0.5,1\n"


# A table on three spheres, with a plank at its end, slides under one sphere and against another.
SHAPES = np.array([[0, 0, 0.55], [0.75, 0, 0.7], [-0.4, -0.3, 0.15], [-0.4, 0.3, 0.15], [0.4, 0, 0.15]])  # middles
VOLUMES = np.array([8 * 0.6 * 0.5 * 0.1, 8 * 0.4 * 0.5 * 0.1, *3 * [4 / 3 * np.pi * 0.15**3]])
TABLE = ON_FLOOR.replace("steps = 40", "steps = 41") + """[[boundary]]
name = "table"
shape = "plank"
point = [0, 0, 0.55]
normal = [0, 0, 1]
axis = [1, 0, 0]
length = 1.2
width = 1
radius = 0.1
centre = {centre}
initial_velocity = [0.5, 0.2, 0]
free = ["x", "y", "z", "spin_x", "spin_y", "spin"]
mass = 3
inertia = [0.7, 0.9, 0.8]
[[boundary]]
part_of = "table"
shape = "plank"
point = [0.75, 0, 0.7]
normal = [1, 0, 0]
axis = [0, 0, 1]
length = 0.8
width = 1
radius = 0.1
[[boundary]]
part_of = "table"
shape = "grains"
grains = [1, 2, 3]
"""
ON_TABLE = ("x,y,z,radius,mass\n-0.1,0.1,1.05,0.4,1\n-0.4,-0.3,0.15,0.15,1\n-0.4,0.3,0.15,0.15,1\n0.4,0,0.15,0.15,1\n"
            "1.35,0.1,0.5,0.5,1.953125\n")


def call(*arguments):
    return subprocess.run([os.environ["NSCDD_PROGRAM"], *map(str, arguments)], check=True, capture_output=True,
                          text=True)


def by_bodies(step):
    return {(a, b): impulse for a, b, impulse in zip(step.contact_a, step.contact_b, step.impulse)}


# Three grains in a row that a wall draws along, and loses: within 0.006 m it pulls with 3 N, beyond not at all.
DRAWN = """[packing]
file = "row.csv"
[partition]
grid = {grid}
[interaction]
law = "cohesive"
cohesion = 3
cohesion_range = 0.006
friction = 0.05
static_friction = 0.1
[dynamics]
step = 5e-4
steps = 60
penetration_correction = 0
[solver]
algorithm = "nlgs"
criterion = "natural_map"
tolerance = 1e-12
maximum_iterations = 100000
"""
WALLS = """[[boundary]]
name = "puller"
shape = "wall"
{puller}
[[boundary]]
name = "floor"
shape = "wall"
{floor}
"""
IN_PLANE = (DRAWN.format(grid="[1, 1]") +
            WALLS.format(puller="from = [-0.5, 3]\nto = [-0.5, 0]\nvelocity = [-0.5, 0]",
                         floor="from = [-9, 0]\nto = [9, 0]"))
IN_SPACE = (DRAWN.format(grid="[1, 1, 1]") +
            WALLS.format(puller="point = [-0.5, 0, 0]\nnormal = [1, 0, 0]\nvelocity = [-0.5, 0, 0]",
                         floor="point = [0, 0, 0]\nnormal = [0, 0, 1]"))


@pytest.mark.parametrize("case, row", [
    (IN_PLANE, "x,y,radius,mass\n0,0.5,0.5,1\n1,0.5,0.5,1\n2,0.5,0.5,1\n"),
    (IN_SPACE, "x,y,z,radius,mass\n0,0,0.5,0.5,1\n1,0,0.5,0.5,1\n2,0,0.5,0.5,1\n")], ids=["plane", "space"])
def test_a_folder_has_the_cohesion_of_its_run(tmp_path, case, row):
    (tmp_path / "row.csv").write_text(row)
    (tmp_path / "case.toml").write_text(case)
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5")
    call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "out", "--steps", 10)
    law = (tmp_path / "out/DATBOX/TACT_BEHAV.DAT").read_text()
    assert "IQS_WET_DS_CLB" in law and "cohn= 0.3000000D+01  coht= 0.0000000D+00\n" in law
    call("simulate", tmp_path / "out", "-o", tmp_path / "back.h5", "--steps", 50, "--set=dynamics.step=5e-4",
         "--set=dynamics.boundary_instant=middle", "--set=solver.algorithm=nlgs", "--set=solver.criterion=natural_map",
         "--set=solver.tolerance=1e-12", "--set=solver.maximum_iterations=100000")
    with h5py.File(tmp_path / "run.h5") as run, h5py.File(tmp_path / "back.h5") as back:
        speed = np.abs(run["steps/velocity_x"][-1]).max()
        assert speed > 1e-3 and run["steps/velocity_x"][10].min() < 0
        for name in ("x", "y", "z", "velocity_x", "velocity_y", "velocity_z"):
            if name in run["steps"]:
                np.testing.assert_allclose(back["steps"][name][-1], run["steps"][name][-1], atol=1e-5 * speed + 1e-7)
    # The alert distance of LMGC90 is at least the range.
    far = case.replace("cohesion_range = 0.006", "cohesion_range = 0.75")
    (tmp_path / "far.toml").write_text(far.replace("steps = 60", "steps = 1"))
    call("simulate", tmp_path / "far.toml", "-o", tmp_path / "far.h5")
    call("export", tmp_path / "far.h5", "--lmgc90", tmp_path / "far", "--steps", 1)
    assert re.findall(r"BOUND +(0\.\S+)\n", (tmp_path / "far/DATBOX/TACT_BEHAV.DAT").read_text())[0] == "0.7500000D+00"


@pytest.mark.parametrize("case, row", [(IN_PLANE, DISKS), (IN_SPACE, SPHERES)], ids=["plane", "space"])
def test_a_network_has_the_cohesion_of_its_step(tmp_path, case, row):
    """Nearly at rest the next step has the impulses of the last one, those that pull among them (else 0.2 or more)."""
    (tmp_path / "row.csv").write_text(row)
    still = re.sub(r"velocity = \[-0.5.*\]\n", "", case).replace("steps = 60", "steps = 400")
    (tmp_path / "case.toml").write_text(still.replace("step = 5e-4", "step = 5e-3"))
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5")
    call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "out", "--steps", 400)
    said = call("solve", tmp_path / "out/OUTBOX/Vloc_Rloc.OUT.400", "--guess", 1, "--tolerance", "1e-10").stdout
    assert float(re.search(r"distance from guess  (\S+)", said)[1]) < 5e-3


@pytest.mark.parametrize("case, packing", [(PLANE, ("disks.csv", DISKS)), (SPACE, ("spheres.csv", SPHERES))],
                         ids=["plane", "space"])
def test_a_folder_starts_with_the_forces_of_its_last_step(tmp_path, case, packing):
    (tmp_path / packing[0]).write_text(packing[1])
    (tmp_path / "case.toml").write_text(case)
    ended = by_bodies(nscdd.simulate(tmp_path / "case.toml").last)
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5")
    call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "out", "--steps", 40)
    settings = {"dynamics.steps": 0, "dynamics.step": 0.002}
    started = nscdd.simulate(tmp_path / "out", settings=settings).last
    met = by_bodies(started)
    scale = max(np.abs(impulse).max() for impulse in ended.values())
    assert met.keys() == ended.keys() and len(met) >= 5, ended.keys()
    for pair, impulse in ended.items():
        np.testing.assert_allclose(met[pair], impulse, atol=2e-6 * scale)
    text = (tmp_path / "out/DATBOX/Vloc_Rloc.INI").read_text()
    # The other way round in the file: the candidate is the antagonist, normals turn, components along them stay.
    swapped = re.sub(r"(?m)^ (RBDY\d) +(\d+)  (\w{5}) +(\d+) +(\w{5})  RBDY\d +(\d+)  (\w{5}) +(\d+)",
                     r" \1  \6  \7  \8  \5  \1  \2  \3  \4", text)
    assert swapped != text
    swapped = re.sub(r"(n\(\d\)=)(.)(\S+)", lambda m: m[1] + (" " if m[2] == "-" else "-") + m[3], swapped)
    swapped = re.sub(r"([ts]\(\d\)=)(.)(\S+)", lambda m: m[1] + (" " if m[2] == "-" else "-") + m[3], swapped)
    (tmp_path / "out/DATBOX/Vloc_Rloc.INI").write_text(swapped)
    for pair, impulse in by_bodies(nscdd.simulate(tmp_path / "out", settings=settings).last).items():
        np.testing.assert_allclose(impulse, met[pair], atol=1e-15 * scale)
    (tmp_path / "out/DATBOX/Vloc_Rloc.INI").write_text(re.sub(r"RBDY(\d +)1 ", r"RBDY\g<1>99 ", text))
    left = by_bodies(nscdd.simulate(tmp_path / "out", settings=settings).last)
    assert left.keys() == {pair for pair in met if pair[0] > 0}  # body 99 is not there
    (tmp_path / "out/DATBOX/Vloc_Rloc.INI").unlink()
    assert len(nscdd.simulate(tmp_path / "out", settings=settings).last.contact_a) == 0
    if case is SPACE:
        (tmp_path / "out/DATBOX/COMMAND.DAT").write_text("TIME STEP :\n0.002 :\nYPERIODIC CONDITION :\n1.9 : m\n")
        with pytest.raises(nscdd.Error, match=r"DATBOX/COMMAND.DAT:4: contacts.period_y: .*two diameters.*met 1\.9 m"):
            nscdd.simulate(tmp_path / "out")


def test_a_body_of_planks_and_spheres_goes_on_from_its_folder(tmp_path):
    (tmp_path / "spheres.csv").write_text(ON_TABLE)
    (tmp_path / "case.toml").write_text(TABLE.format(centre=list(VOLUMES @ SHAPES / VOLUMES.sum())))
    went_on = nscdd.simulate(tmp_path / "case.toml").last
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5")
    note = call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "out", "--steps", 40)
    bodies = (tmp_path / "out/DATBOX/BODIES.DAT").read_text()
    assert bodies.count("PLANx") == 3 and bodies.count("SPHEb") == 3 and bodies.count("$bdyty") == 4, note.stderr
    met = nscdd.simulate(tmp_path / "out", settings={"dynamics.steps": 1, "dynamics.step": 0.002, **{
        f"solver.{key}": value for key, value in (("algorithm", "nlgs"), ("criterion", "natural_map"),
                                                   ("tolerance", 1e-10))}}).last
    # Its contacts as a problem: that of the last step, a step's motion apart, with spins along the axes of the body.
    call("export", tmp_path / "run.h5", "--fclib", 40, "-o", tmp_path / "step.hdf5")
    own, network = (np.linalg.eigvalsh(nscdd.read_contact_problem(file).reduced().W.toarray())
                    for file in (tmp_path / "step.hdf5", tmp_path / "out/DATBOX/Vloc_Rloc.INI"))
    np.testing.assert_allclose(network, own, rtol=3e-3, atol=1e-6)
    order = [0, 4, 1, 2, 3]  # free spheres are written first
    assert np.abs(went_on.velocity_x).min() > 1e-3 and len(met.contact_a) == len(went_on.contact_a) >= 4
    for name in ("x", "y", "z", "velocity_x", "velocity_y", "velocity_z", "spin_x", "spin_y", "spin"):
        np.testing.assert_allclose(getattr(met, name), getattr(went_on, name)[order], atol=2e-6)
    # The same with the spheres behind the planks.
    spheres, planks = (re.search(rf"( {kind}.*\n( {{27}}.*\n)+){{{many}}}", bodies)[0] for kind, many in
                       (("SPHEb", 3), ("PLANx      [45]", 2)))
    assert spheres + planks in bodies
    (tmp_path / "out/DATBOX/BODIES.DAT").write_text(bodies.replace(spheres + planks, planks + spheres))
    forces = tmp_path / "out/DATBOX/Vloc_Rloc.INI"
    number = re.search(r"\$bdyty\n RBDY3 *(\d+)\n(?:(?!\$bdyty)[\s\S])*SPHEb", bodies)[1]
    forces.write_text(re.sub(rf"(RBDY3 +{number}  )(\w{{5}})( +)(\d)",
                             lambda m: m[1] + m[2] + m[3] + "34512"[int(m[4]) - 1], forces.read_text()))
    started = nscdd.simulate(tmp_path / "out", settings={"dynamics.steps": 0, "dynamics.step": 0.002}).last
    went_to = nscdd.simulate(tmp_path / "case.toml", settings={"dynamics.steps": 40}).last
    assert len(started.contact_a) == len(went_to.contact_a) >= 4
    np.testing.assert_allclose(sorted(map(tuple, started.impulse)), sorted(map(tuple, went_to.impulse)), atol=1e-7)
    # Without its inertia LMGC90 computes other axes than those of the state; contacts within the body are left out.
    text = (tmp_path / "out/DATBOX/BODIES.DAT").read_text()
    start = text.index("$bdyty", text.index(f" RBDY3{number:>9}") - 20)
    own = text[start:text.index("$$$$$$", start)]
    (tmp_path / "out/DATBOX/BODIES.DAT").write_text(
        text.replace(own, re.sub(r"(I\d  =) \S+", r"\1 0.0000000D+00", own)))
    with pytest.raises(nscdd.Error, match="expected I1 to I3 of a body with several contactors"):
        nscdd.simulate(tmp_path / "out")
    with pytest.raises(nscdd.Error, match="BODIES.DAT:.*expected I1 to I3 of a body with several contactors"):
        nscdd.read_contact_problem(forces)
    # Nor without a state, if the body is driven in some rotations or has a moment.
    kept = {name: (tmp_path / "out/DATBOX" / name).read_text() for name in ("DOF.INI", "Vloc_Rloc.INI", "DRV_DOF.DAT")}
    for name in ("DOF.INI", "Vloc_Rloc.INI"):
        (tmp_path / "out/DATBOX" / name).unlink()
    nscdd.simulate(tmp_path / "out", settings={"dynamics.steps": 0})
    for kind, size in (("vlocy", "0.4"), ("vlocy", "0.0"), ("force", "0.4")):
        line = f" {kind}      5  {size}000000D+01" + 3 * "  0.0000000D+00" + "  0.1000000D+01  0.0000000D+00\n$$$$$$"
        (tmp_path / "out/DATBOX/DRV_DOF.DAT").write_text(kept["DRV_DOF.DAT"].replace("$$$$$$", line, 1))
        with pytest.raises(nscdd.Error, match="expected I1 to I3 of a body with several contactors"):
            nscdd.simulate(tmp_path / "out", settings={"dynamics.steps": 0})
    for name, content in kept.items():
        (tmp_path / "out/DATBOX" / name).write_text(content)
    (tmp_path / "out/DATBOX/BODIES.DAT").write_text(text.replace("PLANx      5", "ABCDx      5"))
    with pytest.raises(nscdd.Error, match="BODIES.DAT:.*expected contactors SPHER"):
        nscdd.read_contact_problem(forces)
    (tmp_path / "out/DATBOX/BODIES.DAT").write_text(text)
    within = re.sub(rf"(?m)^( RBDY3 +{number}  .*CLB_B  RBDY3 +)\d+  PLANx      1(  stick)",
                    rf"\g<1>{number}  PLANx      2\2", forces.read_text(), count=1)
    assert within != forces.read_text()
    forces.write_text(within)
    left = nscdd.simulate(tmp_path / "out", settings={"dynamics.steps": 0, "dynamics.step": 0.002}).last
    assert len(left.contact_a) == len(started.contact_a) - 1
    # Another centre than that of its shapes is not LMGC90's, and contacts within the body are not wanted.
    (tmp_path / "case.toml").write_text(TABLE.format(centre=[0, 0, 0.3]))
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5", "--steps", 0, "--force")
    note = call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "none", "--steps", 0).stderr
    assert "'table': expected its centre to be that of its shapes" in note
    (tmp_path / "spheres.csv").write_text(ON_TABLE.replace("0,0.15,", "0,0.3,"))
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5", "--steps", 0, "--force")
    note = call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "near", "--steps", 0).stderr
    assert "'table': expected its spheres farther than the alert distance" in note
    cylinder = 'shape = "cylinder"\nfrom = [0, 3, 0]\nto = [0, 4, 0]\nradius = 0.2\nside = "outside"\n'
    (tmp_path / "case.toml").write_text(TABLE.format(centre=[0, 0, 0.3]) + '[[boundary]]\npart_of = "table"\n' + cylinder)
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5", "--steps", 0, "--force")
    with pytest.raises(subprocess.CalledProcessError) as refused:
        call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "round", "--steps", 0)
    assert "'table': expected a free body of one wall, plank or cylinder" in refused.value.stderr


def test_what_slid_in_the_last_step_has_the_dynamic_friction(tmp_path):
    """A disk slides over a floor: it goes on sliding, but sticks if nothing says that it slid."""
    (tmp_path / "disk.csv").write_text("x,y,radius,mass\n0,0.5,0.5,1\n")
    (tmp_path / "case.toml").write_text("""[packing]
file = "disk.csv"
[partition]
grid = [1, 1]
[interaction]
friction = 0.1
static_friction = 50
[dynamics]
step = 0.002
steps = 1
[[prescribed]]
grain = 0
velocity = [1, 0]
[[boundary]]
name = "floor"
shape = "wall"
from = [-1, 0]
to = [9, 0]
""")
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5", "--set", "interaction.static_friction=-1")
    call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "out", "--steps", 1)
    law = tmp_path / "out/DATBOX/TACT_BEHAV.DAT"
    friction = "dfrc= 0.1000000D+00  sfrc= 0.5000000D+02"
    law.write_text(re.sub(r"(?m)^( CLB_.  \w+)_CLB.*$", lambda m: f"{m[1]}_DS_CLB".ljust(40) + friction,
                          law.read_text()))
    settings = {"dynamics.steps": 1, "dynamics.step": 0.002}

    def spin(case):
        return nscdd.simulate(case, settings=settings).last.spin[0]

    slid = 2 * 2 * 0.1 * 9.81 * 0.002 / 0.5  # two steps, I = m R^2 / 2
    assert abs(spin(tmp_path / "out")) == pytest.approx(slid, rel=1e-5)
    call("simulate", tmp_path / "out", "-o", tmp_path / "begun.h5", "--steps", 0, "--set", "dynamics.step=0.002")
    call("simulate", tmp_path / "out", "-o", tmp_path / "on.h5", "--steps", 1, "--set", "dynamics.step=0.002")
    call("export", tmp_path / "on.h5", "--fclib", 1, "-o", tmp_path / "first.hdf5")
    assert nscdd.read_contact_problem(tmp_path / "first.hdf5").mu == pytest.approx([0.1])
    (tmp_path / "out/DATBOX/Vloc_Rloc.INI").rename(tmp_path / "kept")
    assert abs(spin(tmp_path / "out")) > 1  # it rolls
    for name in ("on.h5", "begun.h5"):  # from its own state, also at the beginning
        call("simulate", tmp_path / "out", "-o", tmp_path / name, "--steps", 2, "--restart", "--set",
             "dynamics.step=0.002")
    with h5py.File(tmp_path / "on.h5") as one, h5py.File(tmp_path / "begun.h5") as other:
        np.testing.assert_array_equal(one["last/spin"], other["last/spin"])
        assert abs(one["last/spin"][0, 0]) == pytest.approx(1.5 * slid, rel=1e-5)
    # The same in a case file. Its boundaries have disks, which come before the floor.
    (tmp_path / "kept").rename(tmp_path / "out/DATBOX/Vloc_Rloc.INI")
    text = (tmp_path / "case.toml").read_text().replace('file = "disk.csv"', 'file = "disk.csv"\nforces = "out"')
    text += """[[boundary]]
name = "far"
shape = "disks"
from = [0, 9]
to = [1, 9]
radius = 0.1
"""
    (tmp_path / "case.toml").write_text(text)
    assert abs(spin(tmp_path / "case.toml")) == pytest.approx(slid / 2, rel=1e-5)
    (tmp_path / "case.toml").write_text(text[:text.index("[[boundary]]")])
    refused = "toml:3: packing.forces: expected contacts of {}, met those of 1 disks and 1 walls"
    with pytest.raises(nscdd.Error, match=refused.format("1 disks and 0 walls")):
        nscdd.simulate(tmp_path / "case.toml")
    (tmp_path / "case.toml").write_text(text)
    (tmp_path / "disk.csv").write_text("x,y,radius,mass\n0,0.5,0.5,1\n1,0.5,0.5,1\n")
    with pytest.raises(nscdd.Error, match=refused.format("2 disks and 1 walls")):
        nscdd.simulate(tmp_path / "case.toml")
    late = (tmp_path / "out/DATBOX/Vloc_Rloc.INI").read_text().replace("time= 0.2", "time= 0.3")
    (tmp_path / "out/DATBOX/Vloc_Rloc.INI").write_text(late)
    with pytest.raises(nscdd.Error, match=r"Vloc_Rloc.INI: expected the time of the initial state, 0.002 s, met 0.003 s"):
        nscdd.simulate(tmp_path / "case.toml")
    for changed, words in ((text.replace('"out"', '"nowhere"'), "packing.forces: .*nowhere: expected a folder"),
                           (text[:text.index("[interaction]")], r"toml:3: packing.forces: .*section \[dynamics\]")):
        (tmp_path / "case.toml").write_text(changed)
        with pytest.raises(nscdd.Error, match=words):
            nscdd.simulate(tmp_path / "case.toml")


def test_a_record_starts_a_run_and_names_a_contact_problem(tmp_path):
    (tmp_path / "disks.csv").write_text(DISKS)
    (tmp_path / "case.toml").write_text(PLANE)
    call("simulate", tmp_path / "case.toml", "-o", tmp_path / "run.h5", "--steps", 0)
    call("export", tmp_path / "run.h5", "--lmgc90", tmp_path / "box")
    record = tmp_path / "box/lmgc90.h5:ID_3"
    bodies = 6
    with h5py.File(tmp_path / "box/lmgc90.h5", "w") as file:
        group = file.create_group("Evolution/ID_3")
        for name, value in (("TPS", 0.25), ("dt", 0.004), ("NStep", np.int32(50))):
            group[name] = np.array([value])
        state = np.zeros((bodies, 6))
        state[0, [1, 3]] = 2e-3, 0.5  # m, m/s
        group["RBDY2/rdata"] = state
        group["RBDY2/idata"] = np.ones((bodies, 1), "i4")
    start = nscdd.simulate(record, settings={"dynamics.steps": 0}).last
    assert start.y[0] == pytest.approx(0.5 + 2e-3) and start.velocity_x[0] == 0.5
    none, file = "lmgc90.h5:(ID_3:)? expected contacts", tmp_path / "box/lmgc90.h5"
    for words, arguments in (("ID_3 to ID_3, met ID_4", ("simulate", f"{file}:ID_4", "-o", tmp_path / "new.h5")),
                             (none, ("solve", file)), (none, ("inspect", record)),
                             ("lmgc90.h5.*would be lost", ("solve", record, "-o", file, "--force"))):
        ended = subprocess.run([os.environ["NSCDD_PROGRAM"], *map(str, arguments)], capture_output=True, text=True)
        assert ended.returncode == 2 and re.search(words, ended.stderr), ended.stderr
    with h5py.File(tmp_path / "box/lmgc90.h5", "a") as file:  # one disk of the clump on the floor slides
        contact = [3, 1, 9, 9, 1, 1, 6, 5, 3, 4, 9, 9, 2, 1, 1, 1, 1, 0, 6, 0, 0, 0]
        file["Evolution/ID_3/VlocRloc/idata"] = np.array([contact], "i4")
        file["Evolution/ID_3/VlocRloc/rdata"] = np.array([[40.0, 200, 0, 0, 0, 2, 0, 0, 1, 0]])
    start = nscdd.simulate(record, settings={"dynamics.steps": 0}).last  # h = dt
    assert list(by_bodies(start)) == [(4, 6)]
    np.testing.assert_allclose(start.impulse, [[0.8, -0.16, 0]], rtol=1e-15)
