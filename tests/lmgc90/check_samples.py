#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples of the paper's authors as cases, and LMGC90's criterion QM/16 on its runs, by studies/paper-samples.

$NSCDD_LMGC90 is LMGC90's tree, a folder of DATBOX folders or one of archives (studies/paper-samples/measure); the
default is ../shared/lmgc90, from the source tree. Without folders the test is skipped.

usage: check_samples.py PROGRAM SOURCE
Exit code 0: as expected; 1: not; 77: no folders."""
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

STEPS = 5
# Of the rough box with QM/16 at 1e-4, in 20 steps: iterations of nscdd over those of LMGC90, with the same partition.
ITERATIONS = {"1x1": (0.95, 1.05), "2x2": (0.9, 1.8)}
# Relative differences of velocities after steps 1, 10 and 20 from LMGC90's undivided run.
VELOCITIES = {"Ddm_exemple1": {1: 0.05, 10: 0.12, 20: 0.12}, "DDM_DDM_2d_rough_box": {1: 1e-5, 10: 3e-3, 20: 3e-3}}


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main(program, source):
    study = Path(source) / "studies" / "paper-samples"
    sys.path.insert(0, str(study))
    sys.dont_write_bytecode = True
    import lmgc90_files as files
    home = Path(os.environ.get("NSCDD_LMGC90") or Path(source).parent / "shared" / "lmgc90")
    failed = []

    def check(right, text):
        if not right:
            failed.append(text)
            print(text)

    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        try:
            for name in files.PLACES:
                files.datbox_of(home, name, work / "unpacked")
        except files.Missing as error:
            print(f"skipped: {error}")
            return 77

        def measure(*arguments):
            return subprocess.run([study / "measure", "--lmgc90", home, "--program", program, "--output", work,
                                   *arguments], capture_output=True, text=True)

        done = measure("--part", "cases", "--part", "sides")
        check(done.returncode == 0, f"measure: expected exit code 0, met {done.returncode}: {done.stderr}")
        if failed:
            return 1
        for case in ("paper-1k", "paper-10k"):
            steps = STEPS if case == "paper-1k" else 2
            done = subprocess.run([program, "simulate", work / "inputs/paper-samples" / f"{case}.toml", "--steps",
                                   str(steps), "-o", work / f"{case}.h5"], capture_output=True, text=True)
            check(f"steps: {steps} converged" in done.stdout,
                  f"{case}: expected {steps} steps that converge, met {done.stdout}{done.stderr}")
        distances = [row for row in rows_of(work / "paper-samples/distances.csv")
                     if row["program"] == "nscdd" and row["of"] == "velocities" and row["against"] == "seq"]
        for row in distances:
            most = VELOCITIES[row["sample"]][int(row["step"])]
            check(float(row["distance"]) <= most, f"{row}: expected at most {most}")
        totals = {}
        for row in rows_of(work / "paper-samples/iterations.csv"):
            key = row["sample"], row["program"], row["algorithm"], row["partition"]
            totals[key] = totals.get(key, 0) + int(row["iterations"])
        for (sample, program_name, algorithm, partition), met in totals.items():
            print(sample, program_name, algorithm, partition, met)
            other = sample, "LMGC90", {"generic": "nscdd"}.get(algorithm, algorithm), partition
            if program_name == "nscdd" and sample == "DDM_DDM_2d_rough_box" and other in totals:
                low, high = ITERATIONS[partition]
                check(low <= met / totals[other] <= high,
                      f"{sample} {partition}: expected about {totals[other]} iterations, met {met}")
        for arguments, words in ((("--lmgc90", work / "nowhere"), ["nowhere", "expected LMGC90's tree"]),):
            done = measure("--part", "cases", *arguments)
            check(done.returncode == 2 and all(word in done.stderr for word in words),
                  f"{arguments}: expected a refusal with {words}, met {done.returncode}: {done.stderr}")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
