#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges `nscdd solve --verdict` by linear programs, which HiGHS solves (scipy.optimize.linprog).

usage: judge_verdicts.py PROGRAM
In the plane the largest margin is a linear program:  s -> max,  u_n - mu u_t >= s,  u_n + mu u_t >= s,  s <= max |q_c|,
for u = W y + q of random problems, and for u = H^T v' + q of steps of shear-1k.
"""
import re
import subprocess
import sys
import tempfile

import h5py
import numpy as np
import scipy.sparse
from scipy.optimize import linprog

program = sys.argv[1]


def run(*words, codes=(0,)):
    done = subprocess.run([program, *words], capture_output=True, text=True)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(words)}: exit code {done.returncode}: {done.stderr}")
    return done.stdout


def largest_margin(a, q, friction):
    """Of u = A v + q, with rows (n, t) of each contact."""
    normal, tangent = a[0::2], a[1::2]
    mu = scipy.sparse.diags(friction)
    rows = scipy.sparse.vstack([mu @ tangent - normal, -mu @ tangent - normal])
    right = np.concatenate([q[0::2] - friction * q[1::2], q[0::2] + friction * q[1::2]])
    program = scipy.sparse.hstack([rows, np.ones((len(right), 1))]).tocsr()
    program.data[abs(program.data) < 1e-12] = 0  # HiGHS refuses rounding
    program.eliminate_zeros()
    cost = np.append(np.zeros(a.shape[1]), -1)
    scale = np.hypot(q[0::2], q[1::2]).max()
    bounds = [(-1e6, 1e6)] * a.shape[1] + [(None, scale)]  # without bounds the presolver fails
    found = linprog(cost, program, right, bounds=bounds, method="highs")
    assert found.status == 0, found.message
    return found.x[-1], scale


def judge(name, file, a, q, friction):
    report = run("solve", file, "--verdict", "--solver", "nlgs", "--maximum-sweeps", "1", codes=(0, 1))
    verdict = re.search(r"verdict +(\w+)", report).group(1)
    margins = [float(text) for text in re.findall(r"(-?[\d.]+(?:e[-+]\d+)?) m/s", report.split("largest margin")[1])]
    best, scale = largest_margin(a, q, friction)
    near = 1e-5 * scale
    wrong = []
    if verdict == "exists" and best < -near or verdict != "exists" and best > near:
        wrong.append(f"the largest margin is {best}")
    if abs(min(margins[0], scale) - best) > near:
        wrong.append(f"the largest margin is {best}, not {margins[0]}")
    if verdict != "exists":
        normal, _ = largest_margin(a, q, 0 * friction)
        if abs(min(margins[1], scale) - normal) > near:
            wrong.append(f"without friction it is {normal}, not {margins[1]}")
        if (verdict == "impossible") != (normal < 0):
            wrong.append(f"without friction it is {normal}")
    if wrong:
        sys.exit(f"{name}: verdict {verdict}: {'; '.join(wrong)}")
    return verdict


def random_problem(random, file):
    contacts = int(random.integers(3, 20))
    h = random.normal(size=(int(random.integers(2, contacts + 3)), 2 * contacts))
    w = h.T @ h
    q = random.normal(size=2 * contacts)
    friction = np.where(random.random(contacts) < 0.3, 0, random.random(contacts))
    numbers = [" ".join(f"{value:.17g}" for value in values) for values in (w.T.ravel(), q, friction)]
    with open(file, "w") as text:
        text.write(f"2\n{contacts}\n0\n{len(q)}\n{len(q)}\n{len(q)}\t{len(q)}\n" + "\n".join(numbers) + "\n")
    return scipy.sparse.csr_matrix(w), q, friction


def step_problem(file):
    with h5py.File(file) as read:
        problem = read["fclib_global"]

        def matrix(name):
            of = problem[name]
            shape = of["m"][0], of["n"][0]
            return scipy.sparse.csc_matrix((of["x"][:], of["i"][:], of["p"][:]), shape=shape)

        h, mass = matrix("H"), matrix("M").diagonal()
        vectors = problem["vectors"]
        q = h.T @ (vectors["f"][:] / mass) + vectors["w"][:]
        return h.T.tocsr(), q, vectors["mu"][:]


with tempfile.TemporaryDirectory() as folder:
    counts = {}
    random = np.random.default_rng(1)
    for number in range(50):
        file = f"{folder}/{number}.dat"
        verdict = judge(f"random problem {number}", file, *random_problem(random, file))
        counts[verdict] = counts.get(verdict, 0) + 1
    run("simulate", "shear-1k", "--steps", "2", "-o", f"{folder}/shear.h5")
    for step in (1, 2):
        file = f"{folder}/step-{step}.hdf5"
        run("export", f"{folder}/shear.h5", "--fclib", str(step), "-o", file)
        judge(f"step {step}", file, *step_problem(file))
    print(counts)
    assert min(counts.get(kind, 0) for kind in ("exists", "impossible", "undecided")) >= 3, counts
