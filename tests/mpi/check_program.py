#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""nscdd-mpi as users run it: the tables and runs of nscdd by 1 to 6 processes, refusals, killed runs.

usage: check_program.py MPIEXEC NSCDD NSCDD_MPI SOURCE
"""
import csv
import os
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

MPIEXEC, SERIAL, SHARED, SOURCE = sys.argv[1:5]
THOROUGH = "NSCDD_THOROUGH" in os.environ  # set by tools/nightly
os.environ["NSCDD_DATA"] = SOURCE
BED = ["deposit", "--set", "packing.grains=600", "--set", "packing.width=6", "--subdomains", "3x2"]
# Numbers that depend on the way to the result, not on the result.
OF_THE_WAY = {"solver", "applications", "residual", "factorisations", "program_seconds"}
checks = 0


def check(condition, what):
    global checks
    checks += 1
    if not condition:
        sys.exit(f"check_program: {what}")


def with_one(*many, always=False):
    """A single rank runs the code of nscdd: most comparisons with it are left to thorough tests."""
    return (1, *many) if always or THOROUGH else many


def start(processes, arguments):
    return launch(["-n", str(processes), SHARED, *arguments])


def launch(arguments):
    return subprocess.Popen([MPIEXEC, "-q", *arguments], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def end(process):
    try:
        out, err = process.communicate(timeout=120)
    except subprocess.TimeoutExpired:
        process.terminate()  # mpirun then ends its processes, which would go on for ever
        process.wait(timeout=20)
        raise
    return process.returncode, out, err


def run(processes, *arguments):
    """Exit code, standard output and standard error; by nscdd alone for 0 processes."""
    if processes == 0:
        done = subprocess.run([SERIAL, *arguments], text=True, capture_output=True, timeout=120)
        return done.returncode, done.stdout, done.stderr
    return end(start(processes, arguments))


def run_apart(one, other):
    """Two processes with arguments of their own."""
    return end(launch(["-n", "1", SHARED, *one, ":", "-n", "1", SHARED, *other]))


def rows(text):
    return list(csv.DictReader(text.splitlines()))


def read(path):
    with open(path) as file:
        return file.read()


def write(path, text):
    with open(path, "w") as file:
        file.write(text)
    return path


def check_refused(processes, arguments, message):
    """Exit code 2, one error with `message`, and no output."""
    code, out, err = run(processes, *arguments)
    check(code == 2, f"{arguments}: exit code 2 expected, {code} met: {err}")
    check(err.count("nscdd: error:") == 1 and message in err, f"{arguments}: one message expected, met {err!r}")
    check(out == "", f"{arguments}: no output expected, met {out!r}")


def compare(expected, met, where):
    """Texts and counts are equal, numbers agree to the residuals."""
    check(len(expected) == len(met) > 0, f"{where}: {len(expected)} rows expected, {len(met)} met")
    for number, (one, other) in enumerate(zip(expected, met)):
        slack = 1e-9 + float(one.get("residual", 0)) + float(other.get("residual", 0))
        for column in one:
            if column in OF_THE_WAY:
                continue
            a, b = one[column], other[column]
            try:
                close = a == b or abs(float(a) - float(b)) <= slack * max(1, abs(float(a)))
            except ValueError:
                close = False
            check(close, f"{where}: row {number}, {column}: expected {a}, met {b}")


def same_tables(_folder):
    work = {
        "sweep": ["sweep", *BED, "--epsilon", "0,1e-3,1", "--eta", "inf,0.3", "--certify", "--csv", "-"],
        "sweep by shift-invert": ["sweep", *BED, "--epsilon", "0,1e-3,1", "--eta", "inf,0.3", "--certify",
                                  "--eigenvalues", "3", "--solver", "shift-invert", "--csv", "-"],
        "active contacts": ["sweep", "disks12", "--epsilon", "0", "--eta", "0.1,inf", "--contacts", "active",
                            "--csv", "-"],
        "relaxed": ["sweep", *BED, "--epsilon", "1", "--relaxation", "0.5,optimal", "--csv", "-"],
        "a proved curve": ["sweep", *BED, "--epsilon", "1e-2:1", "--curve", "1e-2", "--csv", "-"],
        "a proved curve by shift-invert": ["sweep", *BED, "--epsilon", "1e-2:1", "--curve", "1e-2", "--solver",
                                           "shift-invert", "--csv", "-"],
        "a proved curve over eta": ["sweep", *BED, "--epsilon", "1e-2", "--eta", "1e-3:1e2", "--curve", "1e-1",
                                    "--solver", "shift-invert", "--csv", "-"],
        "a proved curve of schwarz": ["sweep", *BED, "--scheme", "schwarz", "--relaxation", "0.4", "--epsilon", "0.1:1",
                                      "--curve", "1e-1", "--csv", "-"],
        "by SLEPc": ["sweep", *BED, "--epsilon", "1e-3,1", "--eta", "inf,0.3", "--solver", "slepc", "--csv", "-"],
        "optimum": ["optimum", *BED, "--epsilon", "1e-3", "--contacts", "all", "--csv", "-"],
        "optimum of schwarz": ["optimum", *BED, "--scheme", "schwarz", "--epsilon", "1e-3", "--csv", "-"],
    }
    for name, arguments in work.items():
        code, expected, err = run(0, *["shift-invert" if word == "slepc" else word for word in arguments])
        check(code == 0, f"{name}: nscdd ends with {code}: {err}")
        for processes in with_one(2 if "disks12" in arguments else 4, always=name == "sweep"):
            code, met, err = run(processes, *arguments)
            where = f"{name}, {processes} process(es)"
            check(code == 0 and err == "", f"{where}: exit code {code}, {err}")
            loose = [dict(row, residual="1e-5") for row in rows(met)] if name == "optimum" else rows(met)
            compare(rows(expected), loose, where)


def coarse_spaces(_folder):
    """All rows are those of nscdd; BDDC of PETSc keeps the condition number to a factor."""
    line = ["coarse", *BED, "--epsilon", "1e-3W", "--csv", "-", "--preconditioner"]
    all_spaces = ["X,X_eta,lumped,dirichlet", "--scaling", "stiffness,deluxe", "--coarse-space", "none,rigid,geneo"]
    code, expected, err = run(0, *line, *all_spaces)
    check(code == 0 and len(rows(expected)) == 10, f"coarse: nscdd ends with {code}: {expected}, {err}")
    for processes in with_one(4):
        code, met, err = run(processes, *line, *all_spaces)
        check(code == 0 and err == "", f"coarse, {processes} process(es): exit code {code}, {err}")
        for one, other in zip(rows(expected), rows(met), strict=True):
            unknown = {name for name in one if processes > 1 and other[name] == "nan"}
            check(all(name.startswith("undivided_") or (name.startswith(("predicted", "interface_"))
                                                        and one["preconditioner"].startswith("X"))
                      or one[name] == "nan" for name in unknown), f"coarse: numbers expected, met {other}")
            compare([{name: cell for name, cell in one.items() if name not in unknown}],
                    [dict(other, residual="1e-6" if one["preconditioner"].startswith("X") else "1e-11")],
                    f"coarse, {processes} process(es)")
    code, met, err = run(6, *line, "bddc", "--scaling", "deluxe")
    check(code == 0 and err == "", f"coarse with bddc: exit code {code}, {err}")
    none, adaptive = rows(met)
    check(none["converged"] == adaptive["converged"] == "true" and none["certified"] == "false", f"bddc: {met}")
    check(int(none["modes"]) == 2 * int(none["cross_points"]) > 0, f"bddc: primal velocities of cross points: {none}")
    check(float(adaptive["kappa"]) <= 60 < float(none["kappa"]) and adaptive["threshold"] == "30", f"bddc: {met}")


def same_reports(folder):
    """inspect: the words of nscdd and its histogram, written once."""
    def inspected(processes, *arguments):
        path = os.path.join(folder, f"{processes}.csv")
        return run(processes, "inspect", *arguments, "--histogram", path, "--force"), read(path)

    for arguments, many in ((BED, with_one(4)), (["disks12"], (2,))):
        expected = inspected(0, *arguments)
        check(expected[0][0] == 0 and "rank W" in expected[0][1], f"inspect {arguments}: {expected[0]}")
        for processes in many:
            met = inspected(processes, *arguments)
            check(met == expected, f"inspect {arguments}, {processes} process(es): {expected} expected, met {met}")
    taken = ["inspect", "disks12", "--histogram", os.path.join(folder, "2.csv")]
    code, out, err = run(2, *taken)
    check(code == 2 and out == "" and err.count("exists already") == 1, f"{taken}: {code}, {out}, {err}")
    code, out, err = run(2, "inspect", "nosuch")
    check(code == 2 and out == "" and err.count("met no such file") == 1, f"inspect: {code}, {out}, {err}")


def same_counts(folder):
    """--counts: a row for each process, and sums that do not depend on how the work is dealt out."""
    def counted(processes, *arguments):
        path = os.path.join(folder, "counts.csv")
        code, _, err = run(processes, *arguments, "--counts", path, "--force")
        check(code == 0, f"{arguments} --counts, {processes} process(es): exit code {code}, {err}")
        table = rows(read(path))
        check([row["process"] for row in table] == [str(k) for k in range(max(1, processes))],
              f"counts of {processes} process(es): a row for each expected, met {table}")
        check(all(0 < float(row["seconds"]) < 100 and 1e6 < float(row["memory"]) < 1e10 for row in table),
              f"counts of {processes} process(es): seconds and memory expected, met {table}")
        return [{name: float(value) for name, value in row.items()} for row in table]

    radius = ["sweep", *BED, "--epsilon", "1", "--solver", "shift-invert", "--csv", "/dev/null"]
    alone = counted(0, *radius)[0]
    check(alone["flops"] == alone["path_flops"] > 0 and alone["messages"] == alone["sums"] == 0,
          f"counts of nscdd: {alone}")
    for processes in with_one(4):
        met = counted(processes, *radius)
        path = {row["path_flops"] for row in met}
        check(len(path) == 1 and max(row["flops"] for row in met) <= max(path) <= sum(row["flops"] for row in met),
              f"operations of {processes} process(es): {met}")
        check((processes == 1) == (sum(row["messages"] for row in met) == 0), f"messages: {met}")
    check(max(path) < alone["path_flops"], "operations of 4 processes one after the other: fewer than of one expected")

    def steps(iterations, *more):
        return ["simulate", "settle-1k", "--algorithm", "generic", "--criterion", "none", "--iterations",
                str(iterations), "--steps", "1", "--subdomains", "3x2", *more, "-o", os.path.join(folder, "run.h5")]
    per_iteration = {}
    for processes in (0, 2, 6):
        few, many = (counted(processes, *steps(iterations)) for iterations in (10, 30))
        per_iteration[processes] = [{name: (b[name] - a[name]) / 20 for name in a} for a, b in zip(few, many)]
    total = per_iteration[0][0]["contact_updates"]
    check(total > 1000, f"contact updates: {per_iteration}")
    for processes in (2, 6):
        met = per_iteration[processes]
        check(sum(row["contact_updates"] for row in met) == total, f"updates of {total} contacts expected, met {met}")
        # One message to each neighbour, and one sum of seven numbers of each of the six subdomains.
        check(all(row["sums"] == 1 and row["sum_bytes"] == 8 * 7 * 6 for row in met), f"sums: {met}")
        check(all(1 <= row["messages"] <= processes - 1 for row in met), f"messages: {met}")
        # Where the criterion is looked at less often, only neighbours wait for each other in between.
        seldom = ["--set", "solver.criterion_interval=10"]
        few, many = (counted(processes, *steps(iterations, *seldom)) for iterations in (10, 30))
        check(all(b["sums"] - a["sums"] == 2 for a, b in zip(few, many)), f"two looks expected, met {few} and {many}")
        check(all((b["messages"] - a["messages"]) / 20 == row["messages"] for a, b, row in zip(few, many, met)),
              f"the same messages expected, met {few} and {many}")
    for arguments in ([*radius[:-1], os.path.join(folder, "x.csv")], steps(1)):
        code, _, err = run(2, *arguments, "--counts", arguments[-1])
        check(code == 2 and "another name for each output" in err, f"one name for two: {code}, {err}")
    code, _, err = run(2, *radius, "--counts", os.path.join(folder, "counts.csv"))
    check(code == 2 and err.count("exists already") == 1, f"counts that exist already: {code}, {err}")


def nothing_to_share(folder):
    """A partition that cuts no piece of the packing: radius 0, and one process says why."""
    pieces = write(os.path.join(folder, "pieces.csv"), "x,y,radius\n0,0,0.5\n1,0,0.5\n10,0,0.5\n11,0,0.5\n")
    met = [run(processes, "sweep", pieces, "--subdomains", "2x1", "--epsilon", "1", "--csv", "-")
           for processes in (0, 2)]
    check(met[0] == met[1], f"an empty interface: {met[0]} expected, {met[1]} met")
    check(met[1][2].count("2 separate pieces") == 1, f"an empty interface: one explanation expected, met {met[1][2]!r}")


def refusals(folder):
    code, guide, err = run(1)
    check(code == 0 and "nscdd-mpi sweep disks4" in guide and "nscdd run" not in guide.replace("-mpi", ""),
          f"a guide to the verbs of nscdd-mpi: {code}, {guide}, {err}")
    taken = write(os.path.join(folder, "taken.csv"), "mine\n")
    new = os.path.join(folder, "new.csv")
    cases = {
        "expected a verb that several ranks can share": ["solve", "x.hdf5"],
        "met no such file": ["sweep", "nosuch", "--epsilon", "1", "--csv", new],
        "exists already": ["sweep", "disks12", "--epsilon", "1", "--csv", taken],
        "expected a number, met 'q'": ["sweep", "disks12", "--epsilon", "1,q", "--csv", new],
        "--gauss-seidel-sweeps: expected a single rank": ["sweep", "disks12", "--epsilon", "1",
                                                          "--gauss-seidel-sweeps", "inf,3", "--csv", new],
        "expected auto, dense or shift-invert with --certify or --eigenvalues, met slepc": [
            "sweep", "disks12", "--epsilon", "1", "--solver", "slepc", "--certify", "--csv", new],
        "--solver arpack: expected a single rank": ["sweep", *BED, "--epsilon", "1", "--eta", "0.3",
                                                    "--solver", "arpack", "--csv", new],
        "bddc: expected as many processes as subdomains, 6, met 2": ["coarse", *BED, "--preconditioner", "bddc",
                                                                     "--csv", new],
        "--preconditioner: expected one other than bddc with the coarse space rigid": [
            "coarse", *BED, "--preconditioner", "bddc", "--coarse-space", "rigid", "--csv", new],
        "--counts: expected a single rank": ["coarse", *BED, "--counts", "--csv", new],
    }
    for message, arguments in cases.items():
        check_refused(2, arguments, message)
    code, _, err = run(0, "sweep", "disks12", "--epsilon", "1", "--solver", "slepc", "--csv", new)
    check(code == 2 and "met slepc, which nscdd-mpi has" in err, f"slepc by nscdd: {code}, {err}")
    code, _, err = run(0, "coarse", "disks12", "--preconditioner", "bddc", "--csv", new)
    check(code == 2 and "--preconditioner: expected X, X_eta, X_eta_active, lumped or dirichlet" in err
          and "met bddc, which nscdd-mpi has" in err, f"bddc by nscdd: {code}, {err}")
    code, out, err = run(4, "sweep", "disks4", "--epsilon", "1", "--csv", new)
    check(code == 2 and "at most 2 (one per subdomain), met 4" in err, f"too many processes: {code}, {err}")
    check(sorted(os.listdir(folder)) == ["taken.csv"], f"refusals leave {os.listdir(folder)}")
    check(read(taken) == "mine\n", "a refusal changed a file")


def one_fails(folder):
    """A file that one process cannot read, and a disk that is full for the one that writes."""
    case = write(os.path.join(folder, "seen.toml"), read(os.path.join(SOURCE, "cases", "disks12.toml")))
    common = ["--epsilon", "1", "--csv", os.path.join(folder, "out.csv")]
    code, _, said = run_apart(["sweep", case, *common], ["sweep", os.path.join(folder, "unseen.toml"), *common])
    check(code == 2, f"one file missing: exit code 2 expected, {code} met: {said}")
    check(said.count("nscdd: error:") == 1 and "unseen.toml" in said, f"one file missing: {said!r}")
    check(os.listdir(folder) == ["seen.toml"], f"one file missing: leaves {os.listdir(folder)}")
    other = ["sweep", "disks12", "--epsilon", "1", "--csv", os.path.join(folder, "out.csv")]
    code, _, err = run_apart(other, [*other, "--density", "2"])
    check(code == 2 and "the same case and options" in err, f"two cases: {err!r}")
    for verb in (["optimum", "disks12"], ["inspect", "disks12"], ["sweep", "--help"], ["--version"]):
        code, out, err = run_apart(other, verb)
        check(code == 2 and err.count("nscdd: error:") == 1 and "command line: expected the same" in err and out == "",
              f"sweep and {verb}: {code}, {out!r}, {err!r}")
    began = time.monotonic()
    code, _, err = run(2, "sweep", *BED, "--epsilon", "1e-3:1:40", "--solver", "shift-invert", "--csv", "/dev/full")
    check(code != 0 and err.count("nscdd: error:") == 1 and "written" in err, f"full disk: {code}, {err!r}")
    check(time.monotonic() - began < 40, "full disk: the others went on")
    began = time.monotonic()
    trajectory = os.path.join(folder, "full.h5")
    code, _, err = run(2, *RUN, "--steps", "3", "-o", trajectory, "--convergence", "/dev/full", "--force")
    check(code != 0 and err.count("nscdd: error:") == 1 and "/dev/full" in err, f"full disk of a run: {code}, {err!r}")
    check(time.monotonic() - began < 40, "full disk of a run: the others went on")


def children(parent):
    found = []
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat") as file:
                after_name = file.read().rpartition(")")[2].split()
        except OSError:  # it has ended meanwhile
            continue
        if int(after_name[1]) == parent:
            found.append(int(name))
    return sorted(found)


# Spheres of a lattice that fall into a drum, which turns: they touch it after some sixty steps.
DRUM = """
[packing]
generator = "cubic"
columns = 3
rows = 3
layers = 3
disorder = 0.1
[masses]
density = 2500
[partition]
grid = [2, 2, 1]
[dynamics]
step = 0.005
[solver]
algorithm = "generic"
[[boundary]]
name = "drum"
shape = "cylinder"
from = [1, 0, 1]
to = [1, 1, 1]
radius = 2.2
centre = [1, 0, 1]
spin = [0, 2, 0]
"""

RUN = ["simulate", "settle-1k", "--algorithm", "generic", "--subdomains", "3x2", "--criterion", "natural_map",
       "--tolerance", "1e-3", "--iterations", "300", "--set", "solver.warm_start=true"]


def pictures(folder, trajectory):
    """All that a trajectory holds of grains and contacts, to the last bit."""
    target = trajectory + "-pictures"
    code, _, err = run(0, "export", trajectory, "--vtk", target, "--force")
    check(code == 0, f"{trajectory}: export ends with {code}: {err}")
    found = {}
    for name in os.listdir(target):
        with open(os.path.join(target, name), "rb") as file:
            found["collection" if name.endswith(".pvd") else name] = file.read()
    return found


def iterations(path):
    return [{key: value for key, value in row.items() if key != "seconds"} for row in rows(read(path))]


def same_runs(folder):
    """The bits of one process by any number of them, also where a run goes on with another number."""
    def files(name):
        return os.path.join(folder, name + ".h5"), os.path.join(folder, name + ".csv")

    def simulate(processes, name, steps, *more, start=RUN):
        trajectory, table = files(name)
        code, out, err = run(processes, *start, "--steps", steps, "-o", trajectory, "--convergence", table, *more)
        check(code == 0, f"{name}: exit code {code}, {err}")
        return out.split("time:")[0].splitlines()[1:]

    def check_same(one, other):
        check(iterations(files(other)[1]) == iterations(files(one)[1]), f"{other}: other bits")
        check(pictures(folder, files(other)[0]) == pictures(folder, files(one)[0]), f"{other}: another trajectory")

    said = simulate(0, "one", "6")
    expected, indicators = pictures(folder, files("one")[0]), iterations(files("one")[1])
    check(len(expected) > 6 and len(indicators) > 60, "one: steps and iterations expected")
    for processes in with_one(6):
        name = f"of-{processes}"
        check(simulate(processes, name, "6") == said, f"{name}: another report")
        check_same("one", name)
    simulate(2, "restarted", "2")
    simulate(4, "restarted", "4", "--restart")
    simulate(0, "restarted", "6", "--restart")
    check_same("one", "restarted")
    conjugate = ["--set", "solver.interface_method=conjugate_gradient", "--gauss-seidel-sweeps", "3"]
    simulate(0, "conjugate", "2", *conjugate)
    simulate(3, "conjugate-3", "2", *conjugate)
    check_same("conjugate", "conjugate-3")
    for name, more in {"lumped": ["two_stage_newton"],
                       "dirichlet": ["two_stage_admm", "--set", "solver.coarse_space=geneo"]}.items():
        local = ["simulate", "settle-1k", "--subdomains", "3x2", "--tolerance", "1e-6", "--set",
                 f"solver.interface_preconditioner={name}", "--algorithm", *more]
        simulate(0, name, "2", start=local)
        simulate(4, f"{name}-4", "2", start=local)
        check(len(iterations(files(name)[1])) > 2, f"{name}: steps of several iterations expected")
        check_same(name, f"{name}-4")
    # A partition that is kept for some steps, during which the run goes on with other processes: contacts come and go,
    # and every process must know which of them another one has.
    for name, more in {"kept": ["--subdomains", "4x2"], "metis": ["--subdomains", "metis:7"],
                       "cold": ["--subdomains", "3x3", "--set", "solver.warm_start=false"]}.items():
        kept = ["simulate", "shear-1k", "--algorithm", "generic", "--iterations", "40", "--set", "solver.redecompose=5",
                *more]
        simulate(0, name, "13", start=kept)
        simulate(3, f"{name}-3", "8", start=kept)
        simulate(5, f"{name}-3", "13", "--restart", start=kept)
        check(len(pictures(folder, files(name)[0])) > 13, f"{name}: steps expected")
        check_same(name, f"{name}-3")
    spheres = ["simulate", write(os.path.join(folder, "drum.toml"), DRUM)]
    simulate(0, "spheres", "80", start=spheres)
    check(len(iterations(files("spheres")[1])) > 200, "spheres: steps of several iterations expected")
    simulate(3, "spheres-3", "70", start=spheres)
    simulate(2, "spheres-3", "80", "--restart", start=spheres)
    check_same("spheres", "spheres-3")
    newton = ["simulate", "settle-1k", "--subdomains", "3x2", "--algorithm", "two_stage_newton", "--tolerance", "1e-11",
              "--iterations", "1000", "--preconditioner", "X", "--set", "interaction.law=coulomb",
              "--set", "interaction.friction=0.3"]
    simulate(0, "newton", "1", start=newton)
    for processes in (2, 3):
        name = f"newton-of-{processes}"
        simulate(processes, name, "1", start=newton)
        check_same("newton", name)
    check(int(iterations(files("newton")[1])[-1]["iteration"]) > 12, "newton: 500 sweeps were enough, none was cut")


def close_runs(folder):
    """Where a factor that processes share preconditions Stage 2: the same runs to the rounding of that factor."""
    def simulate(processes, name, steps, *more):
        trajectory, table = os.path.join(folder, name + ".h5"), os.path.join(folder, name + ".csv")
        code, _, err = run(processes, "simulate", "settle-1k", "--subdomains", "3x2", "--steps", steps, *more,
                           "-o", trajectory, "--convergence", table)
        check(code == 0, f"{name}: exit code {code}, {err}")
        return iterations(table)

    def check_close(expected, met, name):
        check(len(expected) == len(met) > 5, f"{name}: {len(expected)} iterations expected, {len(met)} met")
        for one, other in zip(expected, met):
            for column in set(one) - {"work", "status_changes"}:
                a, b = float(one[column]), float(other[column])
                check(a == b or abs(a - b) <= 1e-5 * abs(a) + 1e-13 or (a != a and b != b),
                      f"{name}, {column} of iteration {one['iteration']}: expected {a}, met {b}")

    zeta = ["--criterion", "zeta", "--tolerance", "1e-4", "--iterations", "100"]
    methods = {
        "enriched": ["--algorithm", "enriched", "--eta", "30W", *zeta],
        "best": ["--algorithm", "enriched", "--eta", "optimal", *zeta],
        "schwarz": ["--algorithm", "schwarz", "--set", "solver.interface_relaxation=0.5", *zeta],
        "active": ["--algorithm", "enriched", "--set", "solver.network=active", "--set",
                   "solver.interface_method=conjugate_gradient", *zeta],
        "once": ["--algorithm", "enriched", "--set", "solver.enrichment=semi_implicit", *zeta],
        "accelerated": ["--algorithm", "accelerated", "--tolerance", "1e-6", "--iterations", "1000"],
        "newton": ["--algorithm", "two_stage_newton", "--tolerance", "1e-10", "--iterations", "1000"],
        "newton-all": ["--algorithm", "two_stage_newton", "--tolerance", "1e-10", "--iterations", "1000",
                       "--preconditioner", "X_eta"],
        "admm": ["--algorithm", "two_stage_admm", "--tolerance", "1e-6"],
    }
    for name, more in methods.items():
        expected = simulate(0, name, "2", *more)
        for processes in with_one(2, 6, always=True) if name == "enriched" else with_one(3):
            met = simulate(processes, f"{name}-of-{processes}", "2", *more)
            check_close(expected, met, f"{name} of {processes}")
            check(processes > 1 or expected == met, f"{name} of 1: other bits than nscdd")
    simulate(2, "restarted", "1", *methods["enriched"])
    met = simulate(4, "restarted", "2", *methods["enriched"], "--restart")
    check_close(simulate(0, "whole", "2", *methods["enriched"]), met, "restarted")


def broken_runs(folder):
    """What breaks down does so in the words of one process, which names the contact and where it is."""
    cases = {"diverges": ["--algorithm", "enriched", "--eta", "0.01W"],
             "explodes": ["--algorithm", "generic", "--set", "solver.interface_relaxation=3"]}
    for name, more in cases.items():
        base = ["simulate", "settle-1k", "--subdomains", "3x2", "--steps", "3", "--iterations", "200", *more, "--force",
                "-o", os.path.join(folder, name + ".h5")]
        expected = run(0, *base)
        check(expected[0] == 1 and "contact of" in expected[2], f"{name}: a breakdown expected, met {expected}")
        met = run(5, *base)
        check(met[0] == 1 and met[2] == expected[2], f"{name} of 5: {expected[2]!r} expected, {met[2]!r}")


def refused_in_the_same_words(folder, distance, more_grains, more, words):
    """A square lattice of 100 grains that cannot move."""
    lattice = "".join(f"{k % 10 * distance},{k // 10 * distance},0.5\n" for k in range(100))
    write(os.path.join(folder, "grains.csv"), "x,y,radius\n" + lattice + more_grains)
    case = write(os.path.join(folder, "case.toml"), '[packing]\nfile = "grains.csv"\n[masses]\nmodel = "density"\n'
                 f"density = 1000\n[partition]\ngrid = [4, 4]\n[dynamics]\n{more}")
    base = ["simulate", case, "--algorithm", "generic", "--subdomains", "4x4", "-o", os.path.join(folder, "run.h5")]
    expected = run(0, *base)
    check(expected[0] == 2 and words in expected[2], f"{words}: {expected}")
    met = run(6, *base)
    check(met == expected, f"{words}, 6 processes: {expected} expected, {met} met")


def overlapping(folder):
    """Bodies that overlap too far are refused in the words of one process, whoever finds them."""
    refused_in_the_same_words(folder, 0.99, "3.2,5.1,0.5\n7.4,2.1,0.5\n", "", "expected an overlap of at most")


def too_long(folder):
    """A step in which a grain flies through another is refused in the words of one process, with the same safe step."""
    refused_in_the_same_words(folder, 1.2, "", "steps = 3\n[[prescribed]]\ngrain = 44\nvelocity = [400, 30]\n",
                              "dynamics.step: expected at most")


def shared_memory(folder):
    """What all processes have of a run is little beside what they share out; the first one also writes."""
    def memory(processes, case):
        path = os.path.join(folder, "counts.csv")
        code, _, err = run(processes, "simulate", case, "--algorithm", "generic", "--subdomains", "8x8", "--steps", "1",
                           "--iterations", "2", "-o", os.path.join(folder, "run.h5"), "--counts", path, "--force")
        check(code == 0, f"{case} of {processes} process(es): exit code {code}, {err}")
        return [float(row["memory"]) for row in rows(read(path))]

    program = min(memory(4, "settle-1k"))
    one = max(memory(1, "settle-100k")) - program
    check(one > 1e8, f"memory of 10^5 grains: 100 MB expected, met {one}")
    met = [size - program for size in memory(4, "settle-100k")]
    check(max(met[1:]) < 0.42 * one, f"memory of 4 processes: 0.42 of {one} expected, met {met}")
    check(met[0] < 0.85 * one, f"memory of the process that writes: 0.85 of {one} expected, met {met}")


def refused_runs(folder):
    new = os.path.join(folder, "new.h5")
    base = ["simulate", "settle-1k", "--steps", "2", "-o", new]
    cases = {
        "two_stage_admm on several ranks, met nlgs: run it with nscdd on a single rank": ["--algorithm", "nlgs"],
        "solver.switch linear: expected a single rank": ["--algorithm", "generic", "--set", "solver.switch=linear"],
        "such file": ["--algorithm", "generic", "--restart"],
        "expected an integer": ["--algorithm", "generic", "--iterations", "many"],
    }
    for message, arguments in cases.items():
        check_refused(2, [*base, *(["--subdomains", "3x2"] if "generic" in arguments else []), *arguments], message)
    base += ["--subdomains", "3x2"]
    code, _, err = run(7, *base, "--algorithm", "generic")
    check(code == 2 and "at most 6 (one per subdomain), met 7" in err, f"too many processes: {code}, {err}")
    one = [*base, "--algorithm", "generic"]
    table = ["--convergence", os.path.join(folder, "new.csv")]
    for first, second in ([[], ["--set", "masses.density=1234"]], [[], table],
                          [table, [*table, "--convergence-every", "5"]]):
        code, _, err = run_apart([*one, *first], [*one, *second])
        check(code == 2 and "the same case and options" in err, f"{first} and {second}: {code}, {err!r}")
    check(os.listdir(folder) == [], f"refused runs leave {os.listdir(folder)}")


def kill_one(arguments, ready):
    """Starts two processes, kills the second one as soon as `ready`, and sees the other one end."""
    process = start(2, arguments)
    for _ in range(600):
        time.sleep(0.1)
        if process.poll() is not None or ready():
            break
    check(process.poll() is None, f"{arguments[0]}: ended before it was killed")
    began = time.monotonic()
    os.kill(children(process.pid)[1], signal.SIGKILL)
    code, _, _ = end(process)
    check(code != 0, f"{arguments[0]}, killed: an exit code that is not 0 expected")
    check(time.monotonic() - began < 20, f"{arguments[0]}, killed: the others went on")


def killed_and_restarted(folder):
    trajectory, whole = os.path.join(folder, "run.h5"), os.path.join(folder, "whole.h5")
    began = time.monotonic()
    kill_one([*RUN, "--steps", "400", "-o", trajectory],
             lambda: os.path.exists(trajectory) and time.monotonic() - began > 2)
    kept = len(pictures(folder, trajectory)) - 2  # beside the start and the collection
    steps = str(kept + 10)
    code, out, err = run(3, *RUN, "--steps", steps, "-o", trajectory, "--restart")
    check(code == 0 and f"{steps} of {steps} in all" in out, f"restarted: exit code {code}, {out} {err}")
    code, _, err = run(0, *RUN, "--steps", steps, "-o", whole)
    check(code == 0, f"nscdd: exit code {code}, {err}")
    check(pictures(folder, trajectory) == pictures(folder, whole), "killed and restarted: another trajectory")


def killed_and_resumed(folder):
    table = os.path.join(folder, "curve.csv")
    partial = table + ".partial"
    arguments = ["sweep", *BED, "--epsilon", "1e-4:1:120", "--eta", "0.3", "--solver", "shift-invert", "--csv", table]

    def kept_rows():
        return read(partial).count("\n") - 1 if os.path.exists(partial) else 0

    kill_one(arguments, lambda: kept_rows() >= 10)
    check(not os.path.exists(table), "killed: a table that is not complete has its name")
    kept = kept_rows()
    check(10 <= kept < 120, f"killed: {kept} rows are left")
    code, _, err = run(4, *arguments, "--resume")
    check(code == 0, f"resumed: exit code {code}, {err}")
    met = rows(read(table))
    whole = os.path.join(folder, "whole.csv")
    code, _, err = run(0, *arguments[:-1], whole)
    check(code == 0, f"nscdd: exit code {code}, {err}")
    compare(rows(read(whole)), met, "resumed")
    check(sorted(os.listdir(folder)) == ["curve.csv", "whole.csv"], f"resumed: leaves {os.listdir(folder)}")


def in_own_folder(test):
    with tempfile.TemporaryDirectory() as folder:
        test(folder)


in_own_folder(coarse_spaces)  # alone: ranks of PETSc that wait for each other take the time of others
# Three at a time, the longest first: much of what processes do here is to begin, to wait and to end.
tests = (same_runs, same_tables, one_fails, refusals, close_runs, refused_runs, killed_and_resumed, same_counts,
         killed_and_restarted, same_reports, shared_memory, broken_runs, overlapping, too_long, nothing_to_share)
with ThreadPoolExecutor(3) as pool:
    for done in [pool.submit(in_own_folder, test) for test in tests]:
        done.result()
print(f"{checks} checks passed")
