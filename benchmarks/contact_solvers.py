#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds of contact solvers, nscdd's and those of Siconos, one after the other on the same problems.

usage: PYTHONPATH=build/release/python taskset -c 0 /usr/bin/python3 benchmarks/contact_solvers.py
           [--solver auto] [--solver nlgs] [--siconos PROGRAM] [--seconds 40] [--csv TABLE.csv]
           [--program build/release/nscdd] [--steps shear-1k:2,10,40] [--steps ...] [PROBLEM or FOLDER ...]

PROBLEM        FCLIB's (.hdf5, .h5) or Siconos' (.dat); of a FOLDER all that can be read
--steps CASE:N,N,...
               contact problems of these steps of a case of the program, run by its own solver before; the default is
               shear-1k:2,10,40 where no problem is named
--solver NAME  one of nscdd; may be given again; the default is all of them
--siconos PROGRAM
               compiled benchmarks/peers/siconos_solve.c: its solvers take part in problems in space, and those in the
               plane are left out. A problem with bodies goes to Siconos' global solvers as it is, and to its local ones
               with the W that nscdd worked out, whose time is not counted. nscdd's time has it in
--seconds N    a solver ends there

All seconds are of the processor, on one thread, in the solver and its checks; the time to read is not counted. Short
runs are repeated until a tenth of a second is over, ten times at the most, and the shortest counts. Each run begins at
zero. The residual is the same for all and worked out here from their impulses: the norm of the natural maps with
rho = 1/W_nn over the larger of the norms of the impulses and of those that the contacts take one by one. As the solvers
of Siconos end by another measure, all are run to 10^-6, 10^-7 and so on to 10^-12 of their own, until the residual is
at most 10^-8 or the time over. seconds_1e-06 and seconds_1e-08 are those of the shortest run that met this residual, nan
if none did; `seconds`, `residual` and `tolerance` those of the last one.
"""
import argparse
import csv
import math
import os
import subprocess
import sys
import tempfile
import time

for library in ("OPENBLAS", "OMP", "MKL"):
    os.environ[f"{library}_NUM_THREADS"] = "1"

import numpy as np
import nscdd
import scipy.sparse

NSCDD = ("auto", "continuation", "newton", "nlgs", "admm", "accelerated")
LOCAL = ("fc3d_nsgs", "fc3d_nsn_ac")
GLOBAL = ("gfc3d_nsgs", "gfc3d_nsn_ac")
RESIDUALS = {"1e-06": 1e-6, "1e-08": 1e-8}
TOLERANCES = (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
FEWEST = 20  # contacts of a problem that is summed up: of smaller ones a time is mostly that of a call
NO_LIMIT = 10**9  # of sweeps and factorisations: the time ends a run
COLUMNS = ("problem", "contacts", "program", "solver", "status", "iterations", "tolerance", "seconds", "residual",
           *(f"seconds_{name}" for name in RESIDUALS))


class Measure:
    """The residual of impulses r: one for all programs."""

    def __init__(self, problem):
        self.w, self.q, self.mu, self.d = problem.W.tocsr(), problem.q, problem.mu, problem.dimension
        self.rho = 1 / self.w.diagonal()[::self.d]
        entries = self.w.tocoo()
        own = entries.row // self.d == entries.col // self.d
        blocks = scipy.sparse.csc_matrix((entries.data[own], (entries.row[own], entries.col[own])), self.w.shape)
        # Contacts that are not coupled are solved by one sweep.
        alone = nscdd.solve(blocks, self.q, self.mu, solver="nlgs", maximum_sweeps=1, threads=1).impulses
        self.alone = np.linalg.norm(alone)

    def residual(self, impulses):
        r = impulses.reshape(-1, self.d)
        with np.errstate(all="ignore"):  # a run that diverged
            u = (self.w @ impulses + self.q).reshape(-1, self.d)
            moved = r - self.rho[:, None] * u
            moved[:, 0] -= self.rho * self.mu * np.linalg.norm(u[:, 1:], axis=1)
            maps = np.linalg.norm(r - self.on_cone(moved))
            return 0.0 if maps == 0 else maps / max(np.linalg.norm(impulses), self.alone)

    def on_cone(self, x):
        """The nearest points of Coulomb's cones |x_t| <= mu x_n."""
        n, t = x[:, 0], x[:, 1:]
        size = np.linalg.norm(t, axis=1)
        edge = (n + self.mu * size) / (1 + self.mu**2)
        slope = np.divide(self.mu * edge, size, out=np.zeros_like(size), where=size > 0)
        found = np.column_stack([edge, slope[:, None] * t])
        inside, behind = size <= self.mu * n, self.mu * size <= -n
        found[behind] = 0
        found[inside] = x[inside]
        return found


def run_nscdd(path, solver, tolerance, limit):
    """How it ended, its impulses, iterations and seconds."""
    runs, total = [], 0
    while not runs or len(runs) < 10 and total < 0.1:
        problem = nscdd.read_contact_problem(path)  # again: it keeps what it was reduced to
        start = time.process_time()
        found = problem.solve(solver=solver, tolerance=tolerance, threads=1, maximum_sweeps=NO_LIMIT,
                              maximum_factorisations=NO_LIMIT,
                              callback=lambda _: time.process_time() - start < limit)
        runs.append(time.process_time() - start)
        total += runs[-1]
    status = "time_limit" if found.status == "stopped" else found.status
    return status, found.impulses, f"{found.sweeps} + {found.factorisations}", min(runs), found.residual


def run_siconos(program, path, solver, tolerance, limit):
    output = path + ".r"
    done = subprocess.run([program, path, solver, str(tolerance), str(limit), output], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(done.args)}: {done.stdout}")
    (seconds, info, iterations, _), impulses = np.split(np.fromfile(output), [4])
    status = {0: "converged", -1: "time_limit", -2: "diverged"}.get(int(info), "failed")
    return status, impulses, f"{int(iterations)}" if info >= 0 else "", seconds, None


def trial(run, measure):
    """A row of the table, without its first columns: RUN(tolerance) to one tolerance after the other."""
    row = {f"seconds_{name}": math.nan for name in RESIDUALS}
    for tolerance in TOLERANCES:
        status, impulses, iterations, seconds, own = run(tolerance)
        residual = measure.residual(impulses)
        # Below 1e-11 residuals are rounding.
        if own is not None and abs(residual - own) > 1e-3 * own + 1e-11:
            sys.exit(f"expected the residual that nscdd has, {own}, met {residual}")
        for name, wanted in RESIDUALS.items():
            if residual <= wanted:
                row[f"seconds_{name}"] = np.fmin(row[f"seconds_{name}"], seconds)
        row.update(status=status, iterations=iterations, tolerance=tolerance, seconds=seconds, residual=residual)
        if status != "converged" or residual <= min(RESIDUALS.values()):
            break
    return row


def trials(path, options, folder):
    """The rows of a problem."""
    problem = nscdd.read_contact_problem(path)
    if problem.contacts == 0 or options.siconos and problem.dimension != 3:
        return
    local = problem.reduced()
    measure = Measure(local)
    runs = [("nscdd", solver, lambda tolerance, s=solver: run_nscdd(path, s, tolerance, options.seconds))
            for solver in options.solver or NSCDD]
    if options.siconos:
        for solvers, given, name in ((LOCAL, local, "local.dat"), (GLOBAL, problem, "global.dat")):
            if solvers is GLOBAL and not problem.has_bodies:
                continue
            text = os.path.join(folder, name)
            nscdd.write_contact_problem(text, given, force=True)
            runs += [("siconos", solver, lambda tolerance, s=solver, t=text:
                      run_siconos(options.siconos, t, s, tolerance, options.seconds)) for solver in solvers]
    for program, solver, run in runs:
        yield {"problem": os.path.basename(path).split(".")[0], "contacts": problem.contacts, "program": program,
               "solver": solver, **trial(run, measure)}


def step_problems(program, asked, folder):
    case, steps = asked.split(":")
    steps = [int(step) for step in steps.split(",")]
    trajectory = os.path.join(folder, case + ".h5")
    calls = [["simulate", case, "--steps", str(max(steps)), "-o", trajectory]]
    problems = [os.path.join(folder, f"{case}-step-{step}.hdf5") for step in steps]
    calls += [["export", trajectory, "--fclib", str(step), "-o", name] for step, name in zip(steps, problems)]
    for call in calls:
        done = subprocess.run([program, *call], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if done.returncode not in (0, 1):
            sys.exit(f"{' '.join(done.args)}: {done.stderr}")
    return problems


def problems_of(path):
    if not os.path.isdir(path):
        return [path]
    problems = []
    for name in sorted(os.listdir(path)):
        if name.endswith((".hdf5", ".h5", ".dat")):
            try:
                nscdd.read_contact_problem(os.path.join(path, name))
                problems.append(os.path.join(path, name))
            except nscdd.Error as error:
                print(f"left out: {error}", file=sys.stderr)
    return problems


def sum_up(rows):
    """How many problems each solver solves, and times over those of the first one where both do."""
    rows = [row for row in rows if row["contacts"] >= FEWEST]
    if not rows:
        return
    print(f"\nof the problems with {FEWEST} contacts or more")
    solvers = list(dict.fromkeys(row["solver"] for row in rows))
    for name in RESIDUALS:
        found = {s: {r["problem"]: r[f"seconds_{name}"] for r in rows if r["solver"] == s} for s in solvers}
        first = found[solvers[0]]
        print(f"\nto {name:<11}{'solved':>12}  {solvers[0]} is so many times as fast: median, least, most")
        for solver, seconds in found.items():
            both = [seconds[p] / first[p] for p in seconds if seconds[p] > 0 and first[p] > 0]
            ratios = f"{np.median(both):.3g}, {min(both):.3g}, {max(both):.3g}" if both else ""
            print(f"{solver:<14}{np.sum(np.isfinite(list(seconds.values()))):>5} of {len(seconds):<3}  {ratios}")


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1])
    parser.add_argument("--program", default=os.path.join("build", "release", "nscdd"))
    parser.add_argument("--solver", action="append", choices=NSCDD)
    parser.add_argument("--siconos")
    parser.add_argument("--seconds", type=float, default=40)
    parser.add_argument("--csv")
    parser.add_argument("--steps", action="append", default=[])
    parser.add_argument("problems", nargs="*")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory(prefix="nscdd-solvers-") as folder, \
            open(options.csv or os.devnull, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        asked = options.steps or ([] if options.problems else ["shear-1k:2,10,40"])
        problems = [one for steps in asked for one in step_problems(options.program, steps, folder)]
        problems += [one for path in options.problems for one in problems_of(path)]
        print(f"{'problem':<42}{'contacts':>9}  {'solver':<14}{'status':<16}{'iterations':>14}{'tolerance':>10}"
              f"{'seconds':>9}{'residual':>10}{'to 1e-6':>9}{'to 1e-8':>9}")
        for problem in problems:
            for row in trials(problem, options, folder):
                rows.append(row)
                print("{problem:<42}{contacts:>9}  {solver:<14}{status:<16}{iterations:>14}{tolerance:>10.0e}"
                      "{seconds:>9.3g}{residual:>10.1e}{seconds_1e-06:>9.3g}{seconds_1e-08:>9.3g}".format(**row),
                      flush=True)
                # Four digits are more than times are good for.
                table.writerow({k: f"{value:.4g}" if isinstance(value, float) else value for k, value in row.items()})
                file.flush()
    sum_up(rows)


if __name__ == "__main__":
    main()
