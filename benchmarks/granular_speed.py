#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Speed of the nonlinear Gauss-Seidel sweeps and of Algorithm 1 on frictional packings.

usage: benchmarks/granular_speed.py [--program build/release/nscdd] [--grains 1000,10000,100000] [--siconos PROGRAM]
       benchmarks/granular_speed.py --space [--program build/release/nscdd] [--grains 1000,10000,100000]
                                            [--siconos PROGRAM]
       benchmarks/granular_speed.py --against PROGRAM [--program build/release/nscdd] [--grains 1000,10000,100000]
                                            [--turns 5]

Four tables, with --space the first two of spheres:
  sweeps     ns per contact and sweep on one core, and the whole step of 100 sweeps (detection and set-up included)
  algorithm  ms per iteration of Algorithm 1 (n_GS = 1, generic) in two vertical strips, on one thread and on two
  memory     bytes per contact of a whole run: the difference of the peaks of the resident set at two sizes, over the
             difference of the contacts
  siconos    seconds of nscdd solve and of Siconos' fc2d_nsgs for the same contact problem, each in its own layout.
             Siconos stops where its cheap estimate says 1e-4. nscdd goes on to the residual that Siconos reached then,
             by Siconos' own measure. The argument is the path of benchmarks/peers/siconos_fc2d.c, compiled beforehand.
             With --space: ns per contact and sweep of nscdd simulate and of Siconos' fc3d_nsgs (Newton's steps for
             one contact) on lattices of up to 10 000 spheres, in the natural order; peers/siconos_fc3d.c. After as many
             sweeps both must have the same impulses. W is formed for Siconos alone.

With --against another build of nscdd does the same work, in turns: sweeps on one thread (natural order of disks,
interleaved order of disks and of fcc spheres) and Algorithm 1 on two. Ratios are those of each turn, of solving alone;
the impulses of both must agree to 1e-10.

Deposits come from the program's own generator (drop and roll; 100 000 grains have some 200 000 contacts), with friction
0.3; in space there are fcc lattices, too, as many layers as columns and rows, with six contacts per sphere. Times are
those the program measures of its own steps: the best and the median of some steps. Other work on the machine shows as a
spread. Sweeps in space are measured by the processor time of whole runs. The ratio of one thread to two is that of the
best times of some runs, which take turns.
"""
import argparse
import os
import statistics
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from scipy.sparse import csr_matrix, diags
from scipy.spatial import cKDTree

CASE = """
[packing]
generator = "deposit"
grains = {grains}
width = {width}
radius_min = 0.1
radius_max = 0.198
[masses]
density = 2500.0
[partition]
grid = [2, 1]
[interaction]
friction = 0.3
[dynamics]
step = 0.005
steps = {steps}
[solver]
algorithm = "{algorithm}"
criterion = "none"
warm_start = false
maximum_iterations = {iterations}
order = "{order}"
[[boundary]]
name = "floor"
shape = "wall"
from = [0.0, 0.0]
to = [1.0, 0.0]
[[boundary]]
name = "left"
shape = "wall"
from = [0.0, 1.0]
to = [0.0, 0.0]
[[boundary]]
name = "right"
shape = "wall"
from = [{width}, 0.0]
to = [{width}, 1.0]
"""


SPACE = """
[packing]
{packing}
[masses]
density = 2500.0
[partition]
grid = [2, 1, 1]
[interaction]
friction = 0.3
[dynamics]
step = 0.005
steps = {steps}
[solver]
algorithm = "{algorithm}"
criterion = "none"
warm_start = false
maximum_iterations = {iterations}
order = "{order}"
[[boundary]]
name = "floor"
shape = "wall"
point = [0, 0, {floor}]
normal = [0, 0, 1]
"""
SIDE = """[[boundary]]
name = "{name}"
shape = "wall"
point = {point}
normal = {normal}
"""


def plane_case(grains, **keys):
    return CASE.format(grains=grains, width=round(0.28 * grains**0.5, 3), **keys)


def lattice_case(grains, **keys):
    side = round(grains ** (1 / 3))
    return SPACE.format(packing=f'generator = "fcc"\ncolumns = {side}\nrows = {side}\nlayers = {side}\nradius = 0.15',
                        floor=-0.15, **keys)


def deposit_case(grains, **keys):
    width = round(0.3 * grains ** (1 / 3), 3)
    packing = (f'generator = "sphere_deposit"\ngrains = {grains}\nwidth = {width}\ndepth = {width}\n'
               "radius_min = 0.1\nradius_max = 0.198")
    sides = [("left", [0, 0, 0], [1, 0, 0]), ("right", [width, 0, 0], [-1, 0, 0]),
             ("front", [0, 0, 0], [0, 1, 0]), ("back", [0, width, 0], [0, -1, 0])]
    return (SPACE.format(packing=packing, floor=0, **keys) +
            "".join(SIDE.format(name=name, point=point, normal=normal) for name, point, normal in sides))


def simulate(program, folder, case_of, grains, algorithm, iterations, threads, order, steps=5):
    """Rows of the summary of some steps."""
    case, out = os.path.join(folder, "case.toml"), os.path.join(folder, "run.h5")
    with open(case, "w", encoding="ascii") as file:
        file.write(case_of(grains, steps=steps, algorithm=algorithm, iterations=iterations, order=order))
    process = subprocess.Popen([program, "simulate", case, "-o", out, "--force", "--save-every", str(steps + 1),
                                "--threads", str(threads)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit("simulate failed")
    with h5py.File(out) as run:
        rows = {name: np.array(data) for name, data in run["summary"].items()}
    return {**rows, "processor": usage.ru_utime + usage.ru_stime}


def sweeps(program, folder, sizes):
    print("sweeps: one thread, 100 sweeps per step")
    print(f"{'grains':>8} {'contacts':>9} {'order':>12} {'ns/contact/sweep best':>22} {'median':>7} {'step s':>8}")
    for grains in sizes:
        for order in ("natural", "interleaved", "coloured"):
            rows = simulate(program, folder, plane_case, grains, "nlgs", 100, 1, order)
            each = 1e9 * rows["solve_seconds"] / rows["contacts"] / rows["sweeps"]
            step = statistics.median(rows["setup_seconds"] + rows["solve_seconds"])
            print(f"{grains:>8} {int(rows['contacts'][0]):>9} {order:>12} {each.min():>22.2f} "
                  f"{statistics.median(each):>7.2f} {step:>8.3f}", flush=True)


def sweeps_in_space(program, folder, sizes, case_of):
    """Processor time of many sweeps less that of few: what else a run does is in both."""
    few, steps = 20, 2
    print("sweeps: one thread, processor time; a step is its set-up and 100 sweeps")
    print(f"{'spheres':>8} {'contacts':>9} {'order':>12} {'ns/contact/sweep':>17} {'step s':>8}")
    for grains in sizes:
        many = few + max(100, 2_000_000 // grains)
        for order in ("natural", "interleaved", "coloured"):
            each, setup = [], []
            for _ in range(2):
                runs = [simulate(program, folder, case_of, grains, "nlgs", n, 1, order, steps) for n in (few, many)]
                work = (many - few) * runs[1]["contacts"].sum()
                each.append((runs[1]["processor"] - runs[0]["processor"]) / work)
                setup += [run["setup_seconds"].min() for run in runs]
            contacts = int(runs[1]["contacts"][0])
            print(f"{grains:>8} {contacts:>9} {order:>12} {1e9 * min(each):>17.1f} "
                  f"{min(setup) + 100 * contacts * min(each):>8.3f}", flush=True)


def lattice_problem(path, grains):
    """The first step of lattice_case as siconos_fc3d reads it: u = W r + q, blocks of W by contacts."""
    side, radius, density, step = round(grains ** (1 / 3)), 0.15, 2500.0, 0.005
    z, y, x = (index.ravel() for index in np.meshgrid(*3 * [np.arange(side)], indexing="ij"))
    centres = radius * np.column_stack((2 * x + z % 2, 2 * y + z % 2, 2**0.5 * z))
    pairs = cKDTree(centres).query_pairs(2 * radius * (1 + 1e-9), output_type="ndarray")
    floor = np.flatnonzero(z == 0)
    a = np.concatenate((pairs[:, 0], floor))
    b = np.concatenate((pairs[:, 1], np.full(len(floor), -1)))
    order = np.lexsort((np.where(b < 0, len(centres), b), a))  # that of nscdd
    a, b = a[order], b[order]
    n = np.where(b[:, None] < 0, [0, 0, -1], centres[b] - centres[a])
    n = n / np.linalg.norm(n, axis=1)[:, None]
    across = np.where(np.abs(n[:, :1]) < 0.9, [1, 0, 0], [0, 1, 0])
    t1 = np.cross(n, across)
    t1 /= np.linalg.norm(t1, axis=1)[:, None]
    t2 = np.cross(n, t1)
    # Rows of H^T: n, t1 and t2 times V_b - V_a - (s_a + s_b) x n, with s the speed of the rim.
    turns = np.stack((np.zeros_like(n), -t2, t1), axis=1)
    directions = np.stack((n, t1, t2), axis=1)
    contacts = len(a)
    rows, columns, values = [], [], []
    for body, sign in ((a, -1.0), (b, 1.0)):
        own = np.flatnonzero(body >= 0)
        for part, first in ((sign * directions, 0), (turns, 3)):
            row, column = np.broadcast_arrays(3 * own[:, None, None] + np.arange(3)[:, None],
                                              6 * body[own][:, None, None] + first + np.arange(3))
            rows.append(row.ravel())
            columns.append(column.ravel())
            values.append(part[own].ravel())
    h = csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
                   shape=(3 * contacts, 6 * len(centres)))
    mass = density * 4 / 3 * np.pi * radius**3
    weights = diags(np.tile([1, 1, 1, 2.5, 2.5, 2.5], len(centres)) / mass)
    w = (h @ weights @ h.T).tobsr((3, 3))
    w.sort_indices()
    velocity = np.zeros((len(centres), 6))
    velocity[:, 2] = -9.81 * step
    with open(path, "wb") as out:
        np.array([contacts, len(w.indices)], np.int64).tofile(out)
        np.array([0.3]).tofile(out)
        w.indptr.astype(np.int64).tofile(out)
        w.indices.astype(np.int64).tofile(out)
        np.ascontiguousarray(w.data.transpose(0, 2, 1)).tofile(out)
        (h @ velocity.ravel()).tofile(out)
    return contacts


def siconos_in_space(program, folder, rival, sizes):
    print("siconos: fc3d_nsgs and nscdd simulate, lattices, natural order, processor time")
    for grains in sizes:
        path = os.path.join(folder, "problem.bin")
        contacts, iterations = lattice_problem(path, grains), max(10, 200_000 // grains)
        few, many = (simulate(program, folder, lattice_case, grains, "nlgs", n, 1, "natural", 1)
                     for n in (iterations, 20 * iterations))
        own = 1e9 * (many["processor"] - few["processor"]) / (19 * iterations) / contacts
        theirs = subprocess.run([rival, path, str(iterations)], check=True, capture_output=True, text=True,
                                env=dict(os.environ, OPENBLAS_NUM_THREADS="1")).stdout.splitlines()[-1]
        other, size = (float(word.split("=")[1]) for word in theirs.split())
        if abs(size - few["impulses"][0]) > 1e-9 * size:
            raise SystemExit(f"siconos: expected impulses of {few['impulses'][0]} N s after {iterations} sweeps, "
                             f"met {size}")
        print(f"{grains:>8} spheres, {contacts} contacts: nscdd {own:.1f}, Siconos {other:.1f} ns per contact and "
              f"sweep; {other / own:.1f} times the time", flush=True)


def algorithm(program, folder, grains, case_of=plane_case, iterations=200, turns=2, steps=3):
    print("algorithm 1: generic, two strips, n_GS = 1")
    times = {1: [], 2: []}
    for _ in range(turns):
        for threads, own in times.items():
            rows = simulate(program, folder, case_of, grains, "generic", iterations, threads, "interleaved", steps)
            own.extend(1e3 * rows["solve_seconds"] / rows["iterations"])
    for threads, own in times.items():
        print(f"{grains:>8} grains, {threads} thread(s): {min(own):.3f} ms per iteration (median "
              f"{statistics.median(own):.3f})", flush=True)
    print(f"{'':>8} ratio {min(times[1]) / min(times[2]):.2f}", flush=True)


def against(programs, folder, sizes, turns):
    """The time of the first program over that of the second, turn by turn."""
    print("against: time of each turn over that of the other build")
    print(f"{'grains':>8} {'work':>22} {'least':>7} {'median':>7} {'most':>7} {'ns/contact/sweep':>17} {'other':>7}")
    for grains in sizes:
        for work, case_of, name, iterations, threads, order in (
                ("sweeps, natural", plane_case, "nlgs", 100, 1, "natural"),
                ("sweeps, interleaved", plane_case, "nlgs", 100, 1, "interleaved"),
                ("sweeps of spheres", lattice_case, "nlgs", 60, 1, "interleaved"),
                ("algorithm 1", plane_case, "generic", 100, 2, "interleaved")):
            times = []
            for _ in range(turns):
                turned = 1 if len(times) % 2 == 0 else -1  # each program begins in every other turn
                runs = [simulate(program, folder, case_of, grains, name, iterations, threads, order, 3)
                        for program in programs[::turned]][::turned]
                if not np.abs(runs[0]["impulses"] / runs[1]["impulses"] - 1).max() <= 1e-10:
                    raise SystemExit(f"against: expected equal impulses, met {[run['impulses'] for run in runs]}")
                times.append([(1e9 * run["solve_seconds"] / run["contacts"] / run["sweeps"]).min() for run in runs])
            ratios = [own / other for own, other in times]
            own, other = map(statistics.median, zip(*times))
            print(f"{grains:>8} {work:>22} {min(ratios):>7.3f} {statistics.median(ratios):>7.3f} {max(ratios):>7.3f} "
                  f"{own:>17.2f} {other:>7.2f}", flush=True)


def memory(program, folder, sizes):
    print("memory: peak resident set of nscdd simulate, 3 steps, trajectory included")
    readings = []
    for grains in sizes:
        for name in ("nlgs", "generic"):
            case, out = os.path.join(folder, "case.toml"), os.path.join(folder, "run.h5")
            with open(case, "w", encoding="ascii") as file:
                file.write(plane_case(grains, steps=3, algorithm=name, iterations=10, order="interleaved"))
            process = subprocess.Popen([program, "simulate", case, "-o", out, "--force", "--threads", "1"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            if status != 0:
                raise SystemExit("simulate failed")
            with h5py.File(out) as run:
                contacts = int(run["summary/contacts"][0])
            readings.append((name, contacts, 1024 * usage.ru_maxrss))
            print(f"{grains:>8} grains, {contacts} contacts, {name}: {1024 * usage.ru_maxrss / 1e6:.0f} MB", flush=True)
    for name in ("nlgs", "generic"):
        own = [reading for reading in readings if reading[0] == name]
        (_, few, small), (_, many, large) = own[0], own[-1]
        if many > few:
            print(f"{'':>8} {name}: {(large - small) / (many - few):.0f} bytes per contact")


def problem(path, grains):
    """A contact problem of one step in the layout that siconos_fc2d reads, and in FCLIB's."""
    here = os.path.dirname(os.path.abspath(__file__))
    subprocess.run(["/usr/bin/python3", os.path.join(here, "peers", "gen_problem.py"), str(grains), path, "poly"],
                   check=True, stdout=subprocess.DEVNULL)
    with open(path, "rb") as f:
        bodies, contacts = np.fromfile(f, np.int64, 2)
        _, friction = np.fromfile(f, float, 2)
        mass, inertia, radius = (np.fromfile(f, float, bodies) for _ in range(3))
        free = np.fromfile(f, float, 3 * bodies)
        first, second = (np.fromfile(f, np.int64, contacts) for _ in range(2))
        nx, ny = (np.fromfile(f, float, contacts) for _ in range(2))
    inertias = np.ravel(np.c_[mass, mass, inertia])
    # Column 2 c: normal, 2 c + 1: tangent; body `first` gets +, `second` -, both turn by -radius.
    columns = []
    for c in range(contacts):
        normal, tangent = {}, {}
        for body, sign in ((first[c], 1.0), (second[c], -1.0)):
            if body < 0:
                continue
            normal.update({3 * body: sign * nx[c], 3 * body + 1: sign * ny[c]})
            tangent.update({3 * body: -sign * ny[c], 3 * body + 1: sign * nx[c], 3 * body + 2: -radius[body]})
        columns += [normal, tangent]
    starts = np.cumsum([0] + [len(c) for c in columns]).astype(np.int32)
    rows = np.concatenate([sorted(c) for c in columns]).astype(np.int32)
    values = np.concatenate([[c[k] for k in sorted(c)] for c in columns])
    with h5py.File(path + ".hdf5", "w") as out:
        group = out.create_group("fclib_global")
        group["spacedim"] = np.array([2], np.int32)
        diagonal = np.arange(len(inertias), dtype=np.int32)
        for name, p, i, x in (("M", np.arange(len(inertias) + 1, dtype=np.int32), diagonal, inertias),
                              ("H", starts, rows, values)):
            matrix = group.create_group(name)
            for key, value in (("nzmax", len(x)), ("m", len(inertias)), ("n", len(p) - 1), ("nz", -1)):
                matrix[key] = np.array([value], np.int32)
            matrix["p"], matrix["i"], matrix["x"] = p, i, x
        group["vectors/f"] = inertias * free
        group["vectors/w"] = np.zeros(2 * contacts)
        group["vectors/mu"] = np.full(contacts, friction)
    return contacts


def reading(text, label):
    """The number behind a label of `nscdd solve`."""
    return float(next(line[len(label):].split()[0] for line in text.splitlines() if line.startswith(label)))


def solve(program, path, tolerance):
    ours = subprocess.run([program, "solve", path + ".hdf5", "--solver", "nlgs", "--tolerance", repr(tolerance),
                           "--maximum-sweeps", "1000000"],
                          check=False, capture_output=True, text=True)
    if ours.returncode not in (0, 1):
        raise SystemExit(ours.stderr)
    return reading(ours.stdout, "sweeps"), reading(ours.stdout, "seconds"), reading(ours.stdout, "residual of Siconos")


def siconos(program, folder, rival, sizes):
    print("siconos: the same problem to the same natural map, in Siconos' definition, nscdd at or below what Siconos reached.")
    print("Both times leave reading the file and forming W out.")
    for grains in sizes:
        path = os.path.join(folder, f"problem-{grains}.bin")
        contacts = problem(path, grains)
        theirs = subprocess.run([rival, path, "2", "nsgs", "200000", "1", "1e-4"], check=True, capture_output=True,
                                text=True, env=dict(os.environ, OPENBLAS_NUM_THREADS="1")).stdout
        words = dict(word.split("=", 1) for word in theirs.split() if "=" in word)
        their_sweeps, their_seconds = float(words["iter"]), float(words["t_min"])
        goal = float(theirs.split("fc_error(natural map)=")[1].split()[0])
        tolerance = 1e-4
        for _ in range(6):  # the two definitions differ by a factor of the problem
            sweeps_done, seconds, residual = solve(program, path, tolerance)
            if 0.8 * goal <= residual <= goal:
                break
            tolerance *= 0.97 * goal / residual
        print(f"{grains} grains, {contacts} contacts, residual {residual:.3e} (Siconos: {goal:.3e})\n"
              f"  nscdd    {seconds:8.3f} s, {sweeps_done:8.0f} sweeps, {1e9 * seconds / sweeps_done / contacts:6.1f} ns per contact and sweep\n"
              f"  Siconos  {their_seconds:8.3f} s, {their_sweeps:8.0f} sweeps, {1e9 * their_seconds / their_sweeps / contacts:6.1f} ns per contact and sweep; "
              f"{their_seconds / seconds:.1f} times the time", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/nscdd")
    parser.add_argument("--grains", default="1000,10000,100000")
    parser.add_argument("--space", action="store_true", help="spheres instead of disks")
    parser.add_argument("--siconos", metavar="PROGRAM",
                        help="compiled benchmarks/peers/siconos_fc2d.c, with --space siconos_fc3d.c")
    parser.add_argument("--against", metavar="PROGRAM", help="another build of nscdd, before a change")
    parser.add_argument("--turns", type=int, default=5, help="of --against")
    options = parser.parse_args()
    sizes = [int(n) for n in options.grains.split(",")]
    with tempfile.TemporaryDirectory() as folder:
        if options.against and (options.space or options.siconos):
            parser.error("--against goes without --space and --siconos")
        if options.against:
            return against((options.program, options.against), folder, sizes, options.turns)
        if options.space:
            for name, case_of in (("fcc lattice", lattice_case), ("sphere_deposit", deposit_case)):
                print(name)
                sweeps_in_space(options.program, folder, sizes, case_of)
                algorithm(options.program, folder, sizes[-1], case_of, iterations=200, turns=3)
            if options.siconos:
                siconos_in_space(options.program, folder, options.siconos, [n for n in sizes if n <= 10_000])
            return
        sweeps(options.program, folder, sizes)
        algorithm(options.program, folder, sizes[-1])
        memory(options.program, folder, [sizes[0], sizes[-1]])
        if options.siconos:
            siconos(options.program, folder, options.siconos, sizes)


if __name__ == "__main__":
    sys.exit(main())
