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
SPACE = """[packing]
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
[[boundary]]
name = "pusher"
shape = "wall"
point = [-0.5, 0, 0]
normal = [1, 0, 0]
velocity = [0.1, 0, 0]
"""
SPHERES = "x,y,z,radius,mass\n0,0,0.5,0.5,1\n0.99,0.1,0.5,0.5,1\n0.5,0.05,1.3,0.5,1\n1.98,0,0.5,0.5,1\n"


def call(*arguments):
    return subprocess.run([os.environ["NSCDD_PROGRAM"], *map(str, arguments)], check=True, capture_output=True,
                          text=True)


def by_bodies(step):
    return {(a, b): impulse for a, b, impulse in zip(step.contact_a, step.contact_b, step.impulse)}


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
