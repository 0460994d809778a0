#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the study machines found, on its baseline, and that the laws of its model hold where they were not fitted.

usage: machine_statements.py SOURCE
"""
import os
import sys

import numpy as np

SOURCE = sys.argv[1]
sys.path.insert(0, os.path.join(SOURCE, "plots"))
import machine_model as model
import style


def check(condition, what):
    if not condition:
        sys.exit(f"machine_statements: {what}")


def by_processes(rows, quantity, **values):
    """Values of nscdd-mpi by the number of processes."""
    some = style.need("", "baseline.csv", rows, program="nscdd-mpi", **values)
    return {int(row["processes"]): row[quantity] for row in some}


def radius(rows):
    million = {"series": "strong", "work": "radius", "grains": 1e6, "subdomains": "8x8"}
    memory = by_processes(rows, "memory", **million)
    check(memory[4] <= 0.40 * memory[1], f"at most 40 % of the memory on 4 processes, the target: met {memory}")
    check(all(memory[2 * p] < memory[p] for p in (1, 2, 4, 8)), f"less memory with more processes: met {memory}")
    path = by_processes(rows, "path_flops", **million)
    check(all(path[2 * p] < path[p] for p in (1, 2, 4, 8)), f"less work one after the other up to 16: met {path}")
    # One rank eliminates each shared front, so that shared fronts bound the critical path.
    path = by_processes(rows, "path_flops", **{**million, "grains": 99_856})
    check(path[64] > 0.8 * path[32] and path[64] > path[1] / 8, f"no gain from 32 to 64 processes: met {path}")
    check(path[16] > path[8], f"a longer way on 16 processes than on 8: met {path}")
    # From 16 ranks on replicated data dominates the memory.
    memory = by_processes(rows, "memory", **{**million, "grains": 250_000})
    check(memory[64] > 0.95 * memory[16], f"no less memory on 64 processes than on 16: met {memory}")
    for row in style.where(rows, work="radius", program="nscdd-mpi"):
        check(row["flops"] <= row["path_flops"] <= row["flops_all"] * (1 + 1e-9), f"operations: met {row}")


def iteration(rows):
    for grains in (780, 10_000, 100_000):
        for subdomains in ("8x8", "16x16"):
            bed = {"series": "strong", "work": "iteration", "grains": grains, "subdomains": subdomains}
            own = by_processes(rows, "contact_updates", **bed)
            everything = by_processes(rows, "contact_updates_all", **bed)
            check(len(set(everything.values())) == 1, f"the same contacts on any number: met {everything}")
            check(all(updates <= 1.5 * everything[1] / p for p, updates in own.items()), f"evenly dealt out: met {own}")
            messages = by_processes(rows, "messages", **bed)
            check(all(messages[p] <= min(p - 1, 8) for p in messages), f"one message to each neighbour: met {messages}")
            check(by_processes(rows, "sums", **bed) == {p: float(p > 1) for p in own}, "one sum in an iteration")
    # Memory is distributed except replicated data, less than a tenth. Rank 0 writes and needs more.
    bed = {"series": "strong", "work": "iteration", "grains": 100_000, "subdomains": "8x8"}
    first, others = by_processes(rows, "memory", **bed), by_processes(rows, "memory_others", **bed)
    program = by_processes(rows, "memory_others", **{**bed, "grains": 780})[4]
    check(all(others[2 * p] < others[p] for p in (2, 4, 8, 16, 32)), f"less memory with more processes: met {others}")
    check(all(first[p] > others[p] for p in others if p > 1), f"more memory where it is written: met {first}")
    all_have = 2 * others[64] - others[32] - program  # doubling the ranks halves the distributed part
    check(0 < all_have < 0.1 * (first[1] - program), f"a tenth of {first[1] - program} B at most: met {all_have}")


def seconds(rows):
    """The targets of time, as soon as the baseline has seconds."""
    if not any(np.isfinite(row["seconds"]) for row in rows):
        return
    for work, grains, target in (("radius", 1e6, 1.5), ("iteration", 100_000, 1.3)):
        own = style.where(rows, series="strong", work=work, grains=grains, subdomains="8x8")
        threads = style.need("", "baseline.csv", own, program="nscdd", threads=2)[0]["seconds"]
        processes = style.need("", "baseline.csv", own, program="nscdd-mpi", processes=2)[0]["seconds"]
        check(0 < processes <= target * threads, f"{work}: {processes} s on two processes, {threads} s on two threads")


def laws(rows):
    """Predicted over measured on rows that the constants were not fitted to."""
    bounds = {"radius": {"memory": (0.8, 1.2), "path_flops": (0.7, 1.45), "message_bytes": (0.5, 1.75),
                         "messages": (0.9, 1.1), "sums": (0.9, 1.1), "sum_bytes": (0.9, 1.15),
                         "iterations": (0.9, 1.1)},
              "iteration": {"memory": (0.8, 1.15), "memory_others": (0.95, 1.2), "contact_updates": (0.7, 1.1), "message_bytes": (0.7, 1.35),
                            "messages": (0.6, 1.6), "sums": (1, 1), "sum_bytes": (1, 1)}}
    for work, quantities in bounds.items():
        fitted, held_out = model.fitted_and_held_out(rows, work)
        check(max(row["grains"] for row in fitted) <= 20_000 < min(row["grains"] for row in held_out),
              "what is held out")
        check(len(fitted) >= 15 and len(held_out) >= 15, f"{work}: {len(fitted)} rows fitted, {len(held_out)} held out")
        law = model.Model(work, fitted)
        check(set(quantities) == set(law.quantities), f"{work}: a bound for each law")
        for quantity, (low, high) in quantities.items():
            ratios = law.ratios(quantity, held_out)
            check(len(ratios) >= 14 and low - 1e-9 <= ratios.min() and ratios.max() <= high + 1e-9,
                  f"{work}, {quantity}: {low} to {high} expected, met {ratios.min():.3f} to {ratios.max():.3f}")


def geometry():
    """The bisection of a square, against fronts counted by hand."""
    check(model.levels(1) == [(0, 1.0)] and model.levels(2) == [(0, 1.0), (1.0, 0.5)], f"two halves: {model.levels(2)}")
    check(model.levels(16)[-1] == (1.0, 0.25), "a part of 4 x 4 touches others on four sides")
    row = {"grains": 10_000.0, "processes": 2, "subdomains": "2x1"}
    check(np.isclose(model.shared_fronts(row), 200**3 / 3), "two rows for each of 100 grains along the cut")
    two = 200**3 / 3 + (300**3 - 200**3) / 3  # a half touches the other along 100 grains and is cut along 50
    check(np.isclose(model.shared_fronts({**row, "processes": 4}), two), "of four processes: two fronts in a row")
    check(np.isclose(model.handed_on(row), 8 * 200**2 / 2), "half the square of these rows is handed on")
    alone = {**row, "processes": 1}
    check(np.isclose(model.fronts_of_cuts(alone), 200**3 / 3), "the same front, of one process")
    check(model.own_fronts(alone, 0, 3) > model.own_fronts(alone, 0, 2) > 0, "more bisections have more fronts")


def prediction(rows):
    """More ranks never lengthen the critical path, and 10^7 grains leave cores of a node idle for lack of memory."""
    law = model.Model("radius", model.rows_of(rows, "radius"))
    found = [model.predict_radius(law, processes, model.ARCHER2, None) for processes in model.PROCESSES]
    check(all(a["path_flops"] >= 0.95 * b["path_flops"] for a, b in zip(found[1:], found)), "fronts are what is left")
    check(all(4e9 < one["memory"] < 20e9 and 8 <= one["per_node"] <= 32 for one in found), f"memory: met {found}")


def main():
    rows = model.read(os.path.join(SOURCE, "studies", "machines"), "baseline.csv")
    radius(rows)
    iteration(rows)
    seconds(rows)
    laws(rows)
    geometry()
    prediction(rows)


if __name__ == "__main__":
    main()
