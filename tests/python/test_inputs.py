# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of users, by the program: folders of LMGC90 as their authors write them, files of YADE and FCLIB, runs with
cohesion, steps that several ranks must refuse together, and spectra in which contacts nearly depend on each other."""
import csv
import io
import os
import subprocess

import h5py
import numpy as np
import pytest

PROGRAM = os.environ["NSCDD_PROGRAM"]


def run(folder, *arguments, code=0):
    """Standard output and standard error of nscdd in a folder."""
    done = subprocess.run([PROGRAM, *arguments], cwd=folder, text=True, capture_output=True, timeout=120)
    assert done.returncode == code, done.stderr
    return done.stdout, done.stderr


def refused(folder, *arguments):
    return run(folder, *arguments, code=2)[1]


def rows(folder, *arguments):
    return list(csv.DictReader(io.StringIO(run(folder, *arguments, "--csv", "-")[0])))


BODIES = """$bdyty
 RBDY2      1
$blmty
 PLAIN      1  behav  plexx  avrd= 0.0000000D+00  gyrd= 0.0000000D+00
$nodty
 NO3xx      1                coo1= 0.0000000D+00  coo2=-0.4000000D+00  coo3= 0.0000000D+00
$tacty
 DISKx      1  color  BLEUx  byrd= 0.5000000D+00
$$$$$$
$bdyty
 RBDY2      2
$blmty
 PLAIN      1  behav  plexx  avrd= 0.0000000D+00  gyrd= 0.0000000D+00
$nodty
 NO3xx      1                coo1= 0.0000000D+00  coo2=-0.1000000D+01  coo3= 0.0000000D+00
$tacty
 JONCx      1  color  VERTx  ax1 = 0.3000000D+01  ax2 = 0.1000000D+00
$$$$$$
"""
BULK = """$gravy
                   grv1= 0.0000000D+00  grv2=-0.9810000D+01  grv3= 0.0000000D+00
$behav  lawty
 plexx  RIGID                           Umas= 0.2000000D+04
"""
SEE = """$seety
 cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert
 RBDY2  DISKx  BLEUx  iqsc0  RBDY2  JONCx  VERTx       0.1000000D-01
"""
LAW = """$behav  lawty
 iqsc0  IQS_CLB                         fric= 0.3000000D+00
"""
DRIVEN = "$bdyty\n RBDY2      2\n$nodty\n NO3xx      1\n$dofty\n" + "".join(
    f" vlocy      {k}  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00\n"
    for k in (1, 2, 3)) + "$$$$$$\n"
CONTACT = """$icdan  DKJCx        1
 cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus   iadj
 RBDY2      1  DISKx      1  iqsc0  RBDY2      2  JONCx      1  stick      1
                             rlt/H 0.0000000D+00  rln/H 0.1540951D+05  rls/H 0.0000000D+00
                             vlt = 0.0000000D+00  vln = 0.0000000D+00  vls = 0.0000000D+00
                             gapTT 0.0000000D+00
                             n(1)= 0.0000000D+00  n(2)= 0.1000000D+01  n(3)= 0.0000000D+00
                             coo1= 0.0000000D+00  coo2=-0.9000000D+00  coo3= 0.0000000D+00
"""


def on_a_plank(folder, initial="", **changed):
    """A folder of LMGC90: a disk at rest on a plank. Texts by the names of their files; None for no file."""
    files = {"BODIES": BODIES, "BULK_BEHAV": BULK, "TACT_BEHAV": LAW + SEE, "DRV_DOF": DRIVEN, **changed}
    (folder / "DATBOX").mkdir(exist_ok=True)
    for name, text in files.items():
        path = folder / "DATBOX" / f"{name}.DAT"
        path.unlink(missing_ok=True) if text is None else path.write_text(text)
    if initial:
        (folder / "DATBOX" / "Vloc_Rloc.INI").write_text(initial)


def first_body(folder, steps=20):
    """Place and angle of the first body after some steps."""
    run(folder, "simulate", "DATBOX", "--set", "dynamics.step=0.005", "--steps", str(steps), "-o", "x.h5", "--force")
    with h5py.File(folder / "x.h5") as file:
        return [file["steps"][name][-1][0] for name in ("x", "y", "angle")]


def test_disk_stays_on_the_plank(tmp_path):
    on_a_plank(tmp_path)
    assert first_body(tmp_path) == pytest.approx([0, -0.4, 0], abs=1e-6)


@pytest.mark.parametrize("node, shift, place", [((0, 0), (0.2, 1), (0.2, 1)), ((0.1, 1), (0.2, 0.1), (0.3, 1.1)),
                                                ((0.1, 1), (5e-4, 0), (0.1, 1)), ((0, 0), (5e-4, 1), (5e-4, 1))])
def test_node_of_one_eccentric_disk_moves_to_it(tmp_path, node, shift, place):
    bodies = BODIES.replace("coo1= 0.0000000D+00  coo2=-0.4000000D+00", "coo1={:14.7E}  coo2={:14.7E}".format(*node), 1)
    disk = " DISKx      1  color  BLEUx  byrd= 0.5000000D+00\n"
    shifted = disk.replace("DISKx", "DISKb") + 29 * " " + "coo1={:14.7E}  coo2={:14.7E}\n".format(*shift)
    on_a_plank(tmp_path, BODIES=bodies.replace(disk, shifted), TACT_BEHAV=(LAW + SEE).replace("DISKx", "DISKb"))
    x, y, angle = first_body(tmp_path, 1)
    assert (x, y, angle) == pytest.approx((*place, 0), abs=1e-3)
    assert x == pytest.approx(place[0], abs=1e-9)


def test_number_that_begins_before_its_columns_is_refused(tmp_path):
    for name, right, wrong in (("BODIES", "NO3xx      1                coo1=", "NO3xx      1               coo1="),
                               ("BULK_BEHAV", "                   grv1=", "                  grv1="),
                               ("DRV_DOF", "vlocy      2  0.0", "vlocy      2-0.250")):
        text = {"BODIES": BODIES, "BULK_BEHAV": BULK, "DRV_DOF": DRIVEN}[name]
        on_a_plank(tmp_path, **{name: text.replace(right, wrong, 1)})
        error = refused(tmp_path, "simulate", "DATBOX", "--steps", "1", "-o", "x.h5")
        assert f"{name}.DAT:" in error and "columns" in error
    on_a_plank(tmp_path, BODIES=BODIES.replace(" coo3= 0.0", "coo3= 0.0"))  # 0 to the left is 0
    first_body(tmp_path, 1)


def test_what_rigid_bodies_do_not_need_is_read_over(tmp_path):
    """Tabs behind numbers, text behind the end of a body and of the file, exponents D and E, thermal data."""
    end = "$$$$$$\n"
    bodies = BODIES.replace("0.5000000D+00\n", "0.5000000E+00\t\t! radius\n").replace(end, "$$$$$$ of a body\n", 1)
    thermal = BULK.replace("RIGID       ", "THERMO_RIGID") + f"{'':29}anis:  isotropic\n{'':29}spco:  field\n"
    on_a_plank(tmp_path, BODIES=bodies, DRV_DOF=DRIVEN + "\t this is no body\n")
    assert first_body(tmp_path) == pytest.approx([0, -0.4, 0], abs=1e-6)
    on_a_plank(tmp_path, BULK_BEHAV=thermal)
    assert "BULK_BEHAV.DAT: of THERMO_RIGID 'plexx' only the density is used" in run(
        tmp_path, "simulate", "DATBOX", "--set", "dynamics.step=0.005", "--steps", "2", "-o", "t.h5")[1]


def test_what_bodies_see_each_other(tmp_path):
    turned = SEE.replace("BLEUx", "OTHER").replace("VERTx", "BLEUx").replace("OTHER", "VERTx")
    on_a_plank(tmp_path, TACT_BEHAV=LAW + turned)
    assert first_body(tmp_path) == pytest.approx([0, -0.4, 0], abs=1e-6)  # colours in either order
    on_a_plank(tmp_path, TACT_BEHAV=LAW + SEE.replace("VERTx", "BLEUx"))
    assert first_body(tmp_path)[1] < -0.42
    other = (LAW + SEE).replace("iqsc0", "iqsc1")
    on_a_plank(tmp_path, TACT_BEHAV=LAW + SEE + other)
    assert "expected one law for two contactors, met 'iqsc1' beside 'iqsc0'" in refused(tmp_path, "inspect", "DATBOX")
    for none in (None, "", LAW):
        on_a_plank(tmp_path, TACT_BEHAV=none)
        assert "TACT_BEHAV.DAT: expected contactors that see" in refused(tmp_path, "simulate", "DATBOX", "-o", "y.h5")
    on_a_plank(tmp_path, BODIES="")
    assert "BODIES.DAT: expected bodies, met none" in refused(tmp_path, "inspect", "DATBOX")


def test_contacts_of_lmgc90(tmp_path):
    begins = "$steps     1000              time= 0.1000000D+01\n"
    on_a_plank(tmp_path, initial=CONTACT)
    assert "expected a line $steps" in refused(tmp_path, "solve", "DATBOX/Vloc_Rloc.INI")
    (tmp_path / "DATBOX" / "DOF.INI").write_text(begins)
    disk = " DISKx      1  color  BLEUx  byrd= 0.5000000D+00\n"
    two = "".join(disk.replace("x      1", f"b      {k}") + 29 * " " + f"coo1={0.6 * k - 0.9:14.7E}  coo2={0:14.7E}\n"
                  for k in (1, 2))
    on_a_plank(tmp_path, initial=begins + CONTACT.replace("DISKx      1", "DISKb      9"),
               BODIES=BODIES.replace(disk, two))
    assert "with contactors that they have, met 1 and 2" in refused(tmp_path, "solve", "DATBOX/Vloc_Rloc.INI")
    on_a_plank(tmp_path, initial=begins + CONTACT.replace("iqsc0", "iqs 0"),
               TACT_BEHAV=(LAW + SEE).replace("iqsc0", "iqs 0"))
    run(tmp_path, "solve", "DATBOX/Vloc_Rloc.INI")
    (tmp_path / "OUT").mkdir()
    (tmp_path / "OUT" / "Vloc_Rloc.OUT.10").write_text(begins + CONTACT)
    assert "OUT/DOF.OUT.10: no such file" in refused(tmp_path, "solve", "OUT/Vloc_Rloc.OUT.10")


def test_periodic_packing_of_yade_is_refused(tmp_path):
    (tmp_path / "y.txt").write_text("##PERIODIC:: 4 4 4\n0 0 0 0.5\n1 0 0 0.5\n")
    assert "contacts.period_x" in refused(tmp_path, "inspect", "y.txt")


def test_room_of_a_compressed_matrix_is_not_read(tmp_path):
    (tmp_path / "pair.csv").write_text("x,y,radius\n0,0,1\n2,0,1\n4,0,1\n")
    run(tmp_path, "simulate", "pair.csv", "--steps", "1", "-o", "x.h5")
    run(tmp_path, "export", "x.h5", "--fclib", "1", "-o", "p.hdf5")
    with h5py.File(tmp_path / "p.hdf5", "a") as file:
        matrix = file["fclib_global/H"]
        assert matrix["nz"][()] == -1
        for name, spare in (("i", 123456789), ("x", 1.0)):
            longer = np.append(matrix[name][()], 3 * [spare])
            del matrix[name]
            matrix[name] = longer
        matrix["nzmax"][...] = matrix["nzmax"][()] + 3
    run(tmp_path, "solve", "p.hdf5")


COHESIVE = """[packing]
file = "grains.csv"
[partition]
grid = [1, 1]
[interaction]
law = "cohesive"
cohesion = 100
cohesion_range = 0.3
[dynamics]
step = 0.01
steps = 10
"""


def test_cohesion_may_bring_energy(tmp_path):
    (tmp_path / "grains.csv").write_text("x,y,radius,mass\n0,0,1,1\n2.1,0,1,1\n")
    (tmp_path / "two.toml").write_text(COHESIVE + "gravity = [0, 0]\n")
    out, _ = run(tmp_path, "simulate", "two.toml", "-o", "x.h5")
    assert "cohesion" in out and "overlaps" not in out
    with h5py.File(tmp_path / "x.h5") as file:  # 100 N for 0.01 s, on 1 kg
        assert file["steps/velocity_x"][1] == pytest.approx([1, -1])


@pytest.mark.parametrize("gravity, height", [(30, 1.08), (0, 1.02)])
@pytest.mark.parametrize("algorithm", ["auto", "nlgs", "newton", "admm", "accelerated"])
def test_pulls_that_close_contacts_together(tmp_path, algorithm, gravity, height):
    (tmp_path / "grains.csv").write_text("x,y,radius,mass\n" + "".join(f"{x},{height},1,100\n" for x in (0, 3, 6)))
    plate = (f"gravity = [{gravity}, 0]\n[[boundary]]\nname = 'plate'\nshape = 'wall'\nfrom = [0, 0]\nto = [1, 0]\n"
             "centre = [0, 0]\nfree = ['y']\nmass = 1\n")
    (tmp_path / "plate.toml").write_text(COHESIVE + plate)
    run(tmp_path, "simulate", "plate.toml", "--algorithm", algorithm, "-o", "x.h5")


def test_impulses_of_a_step_are_those_kept(tmp_path):
    (tmp_path / "jam.csv").write_text("x,y,radius\n0,0,1\n")
    walls = "".join(f"[[boundary]]\nname = '{name}'\nshape = 'wall'\nfrom = {begin}\nto = {end}\n{more}" for
                    name, begin, end, more in (("left", [-1, 1], [-1, 0], ""),
                                               ("right", [1, 0], [1, 1], "velocity = [-0.1, 0]\n")))
    (tmp_path / "jam.toml").write_text("[packing]\nfile = 'jam.csv'\n[partition]\ngrid = [1, 1]\n[interaction]\n"
                                       "friction = 0.5\n[dynamics]\nstep = 0.01\nsteps = 3\n[solver]\n"
                                       "verdict = 'never'\n" + walls)
    run(tmp_path, "simulate", "jam.toml", "-o", "x.h5")
    with h5py.File(tmp_path / "x.h5") as file:
        contacts = file["steps/contacts"]
        for step, (begin, end) in enumerate(contacts["rows"][1:]):
            norm = np.hypot(contacts["impulse_n"][begin:end], contacts["impulse_t"][begin:end])
            assert file["summary/impulses"][step] == pytest.approx(np.linalg.norm(norm))


TIED = """[packing]
file = "tied.csv"
[partition]
grid = [2, 1]
[interaction]
friction = 0.5
[dynamics]
step = 0.01
steps = 60
[solver]
algorithm = "generic"
[[boundary]]
name = "slope"
shape = "wall"
from = [0, 0]
to = [1, 0.1]
[[boundary]]
name = "piston"
shape = "grains"
first = 0
last = 0
centre = [0, 1.4]
free = ["y"]
mass = 1
"""


def test_ranks_refuse_a_contact_together(tmp_path):
    shared = os.path.join(os.environ["NSCDD_BUILD"], "nscdd-mpi")
    (tmp_path / "tied.csv").write_text("x,y,radius\n0,1.4,1\n6,1.62,1\n8,1.82,1\n")
    (tmp_path / "tied.toml").write_text(TIED)
    _, error = run(tmp_path, "simulate", "tied.toml", "-o", "x.h5", code=1)
    assert "free directions tie" in error
    if not os.path.exists(shared):
        return
    environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    ranks = ["mpiexec", "-q", "--oversubscribe", "-n", "2", shared]
    done = subprocess.run([*ranks, "simulate", "tied.toml", "-o", "y.h5"], cwd=tmp_path, env=environment, text=True,
                          capture_output=True, timeout=60)
    assert (done.returncode, done.stderr) == (1, error.replace("x.h5", "y.h5"))


def test_export_of_a_tilted_wall_is_simulated(tmp_path):
    (tmp_path / "s.csv").write_text("x,y,radius\n1,1,1\n5,5,1\n")
    (tmp_path / "s.toml").write_text("[packing]\nfile = 's.csv'\n[partition]\ngrid = [1, 1]\n[interaction]\n"
                                     "friction = 0.4\n[dynamics]\nstep = 0.01\nsteps = 5\nmaximum_push_speed = 1e9\n"
                                     "[[boundary]]\nname = 'left'\nshape = 'wall'\nfrom = [0, 1]\nto = [0, 0]\n"
                                     "[[boundary]]\nname = 'rod'\nshape = 'grains'\nfirst = 0\nlast = 0\n"
                                     "centre = [1, 1]\nfree = ['y']\nmass = 1\n")
    run(tmp_path, "simulate", "s.toml", "-o", "s.h5")
    run(tmp_path, "export", "s.h5", "--lmgc90", "lf", "--steps", "0")
    assert "GAP_SGR_CLB" in (tmp_path / "lf" / "DATBOX" / "TACT_BEHAV.DAT").read_text()  # 1e9 is no bound
    run(tmp_path, "simulate", "lf", "--set", "dynamics.step=0.01", "--steps", "5", "-o", "t.h5")


# 21 spheres, once on a lattice: of the eigenvalues of X_0 one is 0 and one 1.4e-9 (50 digits).
NEARLY_DEPENDENT = """x,y,z,radius
-8.6113247070031176e-05,4.0948484686920924e-05,-2.0698293397785885e-05,0.5
2.0001229751140888,0.00034525933620527217,-0.00031153533359724102,0.5
-5.2610021089231394e-05,1.0003130666220956,5.7050479277718056e-05,0.5
1.9997643714085489,1.0000178099061259,0.00014318917034100828,0.5
-0.00011921494776398008,2.0000130597740635,-0.00010189707025792273,0.5
0.99993742437358812,1.9999949244887061,-6.0715048901984239e-05,0.5
0.50015998234355441,0.49988186153124597,0.7070452991095626,0.5
1.5000657326139428,0.49997693300370677,0.70698971384569465,0.5
2.499782775403149,0.4998658370638252,0.70711143338236537,0.5
0.50015184577372307,1.4998882824673927,0.70696877000849367,0.5
1.5000564886402019,1.4998794067156465,0.70717511979936964,0.5
2.5001094582103458,1.4999851498975432,0.70734794983249794,0.5
0.49999817889601855,2.4999034762546004,0.7072602858955287,0.5
1.4998125706778465,2.5000056087598663,0.70701334790851578,0.5
-0.00010199220761648474,4.4013535412414762e-05,1.4144306996002278,0.5
1.9998456364071884,8.86547099408183e-05,1.4141050808706443,0.5
-8.7023090598480778e-06,1.0001251519357444,1.4141016519667602,0.5
0.99986266513310695,0.99984839512296431,1.4142900890164463,0.5
2.0001828495298515,1.0000107827206721,1.4142616723497641,0.5
1.0000575616502927,1.9999646010706511,1.4140399702574575,0.5
2.0000790383509801,1.9997382692764016,1.4141860044261878,0.5
"""


@pytest.mark.parametrize("solver", ["auto", "dense", "arpack"])
def test_nearly_dependent_contacts_are_not_certified(tmp_path, solver):
    (tmp_path / "near.csv").write_text(NEARLY_DEPENDENT)
    [row] = rows(tmp_path, "sweep", "near.csv", "--tolerance", "0.06", "--overlap-tolerance", "0.5", "--subdomains",
                 "2x1x1", "--epsilon", "0", "--solver", solver, *(["--certify"] if solver != "arpack" else []))
    assert row["converged"] == "false" and row.get("certified", "false") == "false"


@pytest.mark.parametrize("name, subdomains, modes", [("hexagonal", "2x1", 3), ("fcc", "2x1x1", 6)])
def test_rigid_motions_are_counted_once(tmp_path, name, subdomains, modes):
    size = ["--set", "packing.columns=6", "--set", "packing.rows=6", "--set", "packing.layers=6"]
    run(tmp_path, "generate", name, *(size if name == "fcc" else []), "-o", "p.csv")
    found = rows(tmp_path, "coarse", "p.csv", "--subdomains", subdomains, "--coarse-space", "rigid", "--scaling",
                 "multiplicity", "--epsilon", "1e-8W,1e-7W,1e-6W,1e-5W,1e-4W")
    assert [int(row["modes"]) for row in found] == 5 * [modes]
    kappa = np.array([float(row["kappa"]) for row in found]) * [1e-8, 1e-7, 1e-6, 1e-5, 1e-4]
    assert kappa == pytest.approx(kappa[0], rel=2e-3)
