#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""studies/machines/measure at its smallest sizes: its rows, what --resume measures again, and what it refuses.

usage: check_machines.py MPIEXEC NSCDD NSCDD_MPI SOURCE
"""
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

MPIEXEC, SERIAL, SHARED, SOURCE = sys.argv[1:5]
SMALL = "work=radius,grains=1024,processes=1,processes=2"
KEYS = "series work program grains subdomains processes threads".split()
SECONDS = "seconds seconds_least seconds_most work_seconds".split()


def check(condition, what):
    if not condition:
        sys.exit(f"check_machines: {what}")


def measure(output, *arguments, program=SERIAL):
    done = subprocess.run([os.path.join(SOURCE, "studies", "machines", "measure"), "--program", program,
                           "--mpi-program", SHARED, "--mpirun", MPIEXEC, "--output", output, *arguments], text=True,
                          capture_output=True, timeout=120)
    return done.returncode, done.stdout + done.stderr


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def counts(folder):
    path = os.path.join(folder, "new", "counts.csv")
    code, said = measure(path, "--counts-only", "--only", SMALL)
    check(code == 0, f"counts: exit code {code}: {said}")
    found = rows(path)
    baseline = rows(os.path.join(SOURCE, "studies", "machines", "baseline.csv"))
    check(list(found[0]) == list(baseline[0]), f"columns of the baseline expected, met {list(found[0])}")
    check([(row["program"], row["processes"], row["threads"]) for row in found]
          == [("nscdd", "1", "1"), ("nscdd", "1", "2"), ("nscdd-mpi", "1", "1"), ("nscdd-mpi", "2", "1")],
          f"four rows expected, met {found}")
    check(all(row[name] == "nan" for row in found for name in SECONDS), f"no seconds expected, met {found}")
    alone, two = found[2], found[3]
    check(float(two["path_flops"]) < float(alone["path_flops"]) and alone["messages"] == "0" != two["messages"],
          f"less work one after the other on two processes, and messages: met {alone} and {two}")
    check(float(two["memory"]) < float(two["memory_all"]) <= 2 * float(two["memory"]), f"memory: {two}")
    for row in found:  # what the program counts is what it counted for the baseline, wherever it runs
        same = next(one for one in baseline if all(one[key] == row[key] for key in KEYS))
        for name in ("interface_unknowns", "messages", "sums"):
            check(abs(float(row[name]) - float(same[name])) <= 0.1 * float(same[name]), f"{name}: {row} and {same}")
    return path


def resumed(path):
    """A killed measurement goes on: what is there stays as it is, and what is missing is measured."""
    lines = Path(path).read_text(encoding="utf-8").splitlines(keepends=True)
    Path(path).write_text("".join(lines[:1] + lines[2:]), encoding="utf-8")
    code, said = measure(path, "--only", SMALL, "--resume", "--beside-others", "--repeat", "2")
    check(code == 0 and said.count("counts and seconds in") == 1 and said.count(": seconds in") == 3,
          f"--resume: exit code {code}: {said}")
    found = rows(path)
    for row, line in zip(found, lines[1:]):
        before = dict(zip(found[0], line.strip().split(",")))
        check(all(row[key] == before[key] for key in KEYS), f"the order of rows: {row}, {before}")
        check(row is found[0] or row["memory"] == before["memory"], f"a row that was there changed: {row}, {before}")
        check(0 < float(row["seconds_least"]) <= float(row["seconds"]) <= float(row["seconds_most"]) < 60
              and 0 < float(row["work_seconds"]) < float(row["seconds"]), f"seconds: {row}")
    code, said = measure(path, "--only", SMALL, "--resume")
    check(code == 0 and said == "" and rows(path) == found, f"nothing left to do: {code}, {said}")


def iterations(folder):
    path = os.path.join(folder, "iterations.csv")
    bed = "series=strong,work=iteration,grains=780,subdomains=8x8"
    code, said = measure(path, "--counts-only", "--only", f"{bed},program=nscdd-mpi,processes=1,processes=2")
    check(code == 0, f"iterations: exit code {code}: {said}")
    alone, two = rows(path)
    check(alone["contact_updates"] == alone["contact_updates_all"] == two["contact_updates_all"]
          and 0.5 <= float(two["contact_updates"]) / float(alone["contact_updates"]) < 0.6,
          f"half the contacts, and all of them together: met {alone} and {two}")
    check((two["messages"], two["sums"], two["sum_bytes"]) == ("1", "1", str(8 * 7 * 64)),
          f"one message and one sum of seven numbers for each subdomain: met {two}")


def refusals(folder, path):
    before = Path(path).read_text(encoding="utf-8")
    new = os.path.join(folder, "refused.csv")
    other = os.path.join(folder, "other.csv")
    Path(other).write_text("x,y\n1,2\n", encoding="utf-8")
    for expected, arguments, program in (
            ("exists already", [path, "--only", SMALL], SERIAL),
            ("expected the columns", [other, "--only", SMALL, "--resume"], SERIAL),
            ("expected COLUMN=VALUE", [new, "--only", "radius"], SERIAL),
            ("which no row has", [new, "--only", "grains=7"], SERIAL),
            ("expected counts of every row", [new, "--seconds-only", "--only", SMALL], SERIAL),
            ("expected a number of at least 1, met '0'", [new, "--repeat", "0"], SERIAL),
            ("nosuch: No such file", [new, "--only", SMALL], os.path.join(folder, "nosuch")),
            ("not allowed with", [new, "--resume", "--force"], SERIAL)):
        code, said = measure(*arguments, program=program)
        check(code == 2 and expected in said, f"{arguments}: expected '{expected}' and exit code 2, met {code}: {said}")
    check(not os.path.exists(new), "a refusal left a table")
    check(Path(path).read_text(encoding="utf-8") == before, "a refusal changed a table")


def main():
    with tempfile.TemporaryDirectory() as folder:
        path = counts(folder)
        resumed(path)
        iterations(folder)
        refusals(folder, path)


if __name__ == "__main__":
    main()
