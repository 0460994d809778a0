#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds of the contact solvers of nscdd solve, one after the other on the same problems.

usage: benchmarks/contact_solvers.py [--program build/release/nscdd] [--tolerance 1e-8] [--sweeps 100000]
                                     [--steps shear-1k:2,10,40] [--steps ...] [PROBLEM.hdf5 ...]

--steps CASE:N,N,...  contact problems of these steps of a case of the program, run by its own solver before; the default
                      is shear-1k:2,10,40 where no problem is named
One line per problem and solver: contacts, seconds of the solver, status, residual (natural map, rho = 1/W_nn, relative
to the impulses), sweeps (or iterations) and factorisations; for each problem the ratio nlgs / auto. Where nlgs does not
converge the ratio is a lower bound. A sweep or a factorisation runs on one core.
"""
import argparse
import os
import subprocess
import sys
import tempfile


def run(program, *arguments):
    done = subprocess.run([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode not in (0, 1) or not done.stdout:
        sys.exit(f"{' '.join(done.args)}: {done.stderr}")
    return done.stdout


def report_of(text):
    """The lines 'name   value ...' of a report."""
    names = ("contacts", "status", "residual", "sweeps", "factorisations", "seconds")
    found = {}
    for line in text.splitlines():
        words = line.split()
        if len(words) > 1 and words[0] in names and words[0] not in found and words[1] != "of":
            found[words[0]] = words[1]
    return found


def step_problems(program, asked, folder):
    case, steps = asked.split(":")
    steps = [int(step) for step in steps.split(",")]
    trajectory = os.path.join(folder, case + ".h5")
    run(program, "simulate", case, "--steps", str(max(steps)), "-o", trajectory)
    problems = []
    for step in steps:
        problems.append(os.path.join(folder, f"{case}-step-{step}.hdf5"))
        run(program, "export", trajectory, "--fclib", str(step), "-o", problems[-1])
    return problems


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1])
    parser.add_argument("--program", default=os.path.join("build", "release", "nscdd"))
    parser.add_argument("--tolerance", default="1e-8")
    parser.add_argument("--sweeps", default="100000")
    parser.add_argument("--steps", action="append", default=[])
    parser.add_argument("problems", nargs="*")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="nscdd-solvers-") as folder:
        asked = options.steps or ([] if options.problems else ["shear-1k:2,10,40"])
        problems = [one for steps in asked for one in step_problems(options.program, steps, folder)] + options.problems
        print(f"{'problem':<44}{'contacts':>9}  {'solver':<15}{'seconds':>9}  {'status':<16}{'residual':>10}"
              f"{'sweeps':>8}{'factorisations':>15}")
        for problem in problems:
            seconds = {}
            for solver in ("auto", "continuation", "newton", "nlgs", "admm", "apgd"):
                found = report_of(run(options.program, "solve", problem, "--solver", solver, "--tolerance",
                                      options.tolerance, "--maximum-sweeps", options.sweeps))
                seconds[solver] = float(found["seconds"])
                print(f"{os.path.basename(problem):<44}{found['contacts']:>9}  {solver:<15}{found['seconds']:>9}  "
                      f"{found['status']:<16}{found['residual']:>10}{found['sweeps']:>8}{found['factorisations']:>15}",
                      flush=True)
            print(f"{'':<44}{'':>9}  nlgs / auto: {seconds['nlgs'] / seconds['auto']:.2g}", flush=True)


if __name__ == "__main__":
    main()
