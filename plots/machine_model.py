#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What processes do for a radius and for an iteration of Algorithm 1, as laws of grains, subdomains and processes.

usage: machine_model.py [RESULTS]

Prints the constants of the laws, how far they are off on rows that they were not fitted to, and the prediction for
10^7 grains on ARCHER2. RESULTS/machines/counts.csv is the table of studies/machines; without RESULTS its baseline.

A law is a sum of known functions with constants that are not negative. They minimise the sum of squares of relative
errors, on rows of at most 20 000 grains for the check and on all rows for the prediction.

The functions of a radius come from the nested bisection of a square of N grains into P parts. After l bisections the
set that holds the middle part is a rectangle of sides w and h, in units of the square. The next bisection cuts it
along its shorter side, s = min(w, h). b is the length of its sides inside the square. A length x has 2 x sqrt(N)
interface rows, and a front of r rows that eliminates p of them takes (r^3 - (r - p)^3)/3 operations.
"""
import itertools
import os
import sys

import numpy as np
import style

HERE = os.path.dirname(os.path.abspath(__file__))
BASELINE = os.path.join(os.path.dirname(HERE), "studies", "machines", "baseline.csv")
TABLE = "machines/counts.csv"
NUMBERS = ("grains processes threads interface_unknowns iterations memory memory_all messages message_bytes sums "
           "sum_bytes flops flops_all path_flops contact_updates contact_updates_all seconds seconds_least "
           "seconds_most work_seconds")
LARGEST_FITTED = 20_000  # grains; rows of more are held out
# A search in smaller subdomains goes another way, with two to three times as many iterations and factorisations.
SMALLEST_SUBDOMAIN = 150  # grains

# ARCHER2, an HPE Cray EX. Processor, memory and network: https://docs.archer2.ac.uk/user-guide/hardware/
# Sums over all processes: measured by its operators with the OSU benchmarks, 128 processes a node, OpenFabrics,
# https://github.com/ARCHER2-HPC/performance_ofi-ucx, OSU-MPI/OFI/osu_allreduce_*.dat of March 2022.
ARCHER2 = {
    "cores": 128, "memory": 256e9,  # B, of a node
    "operations": 16 * 2.25e9,  # 1/s of a core at its nominal clock, AVX2
    "memory_bandwidth": 2 * 204.8e9 / 128,  # B/s, the share of a core where all are at work
    "cache": 16 * 2**20 / 4,  # B, the share of a core in the third level
    "network": 2 * 100e9 / 8,  # B/s of a node, its two ports
    # s of a message: a sum of 8 B takes 3.9, 7.0 and 13.1 us on 128, 256 and 1 024 processes, and each doubling of
    # their number adds a message to its way, inside a node or between two.
    "latency_inside": 3.9e-6 / 7,
    "latency": (13.1e-6 - 7.0e-6) / 2,
    "sum_bandwidth": 1048576 / 2.12e-3,  # B/s, of a sum of 1 MiB on 1 024 processes
}
# The machine of docs/performance.md, on which seconds were measured: a core at its nominal clock.
MEASURED_OPERATIONS = 16 * 2.596e9
CONTACT_UPDATE = 7.9e-9  # s, of a sweep whose contacts lie in the cache (docs/performance.md), at that clock
CONTACT_BYTES = 64  # read and written for a contact in a sweep: 48 read, 16 of them written
LARGE, PROCESSES = 1e7, [64, 128, 256, 512, 1024]


def parts(row):
    columns, rows = map(int, row["subdomains"].split("x"))
    return columns, rows


def levels(processes):
    """(b, s) of the sets of processes, from all of them to a single one."""
    found = []
    for level in range(int(np.log2(processes)) + 1):
        columns, rows = blocks(level)
        found.append((min(2, columns - 1) / rows + min(2, rows - 1) / columns, 1 / max(columns, rows)))
    return found


def blocks(level):
    """Columns and rows into which a square is cut by so many bisections."""
    return 2 ** (level // 2), 2 ** (level - level // 2)


def operations(b, s):
    """Of a front of b + s rows that eliminates s of them."""
    return ((b + s)**3 - b**3) / 3


def rows_cubed(row):
    return (2 * np.sqrt(row["grains"]))**3


def shared_fronts(row):
    """Operations of one factorisation in the fronts of several processes, one above the other."""
    return rows_cubed(row) * sum(operations(b, s) for b, s in levels(row["processes"])[:-1])


def own_fronts(row, first, last):
    """Operations of one factorisation in the fronts of one process, of the bisections FIRST to LAST - 1."""
    outer, own = blocks(int(np.log2(row["processes"]))), 0
    for level in range(first, last):
        # The rectangles inside the share of a process touch others on two sides, but for those on the edge.
        inner = blocks(level)
        columns, rows = (many // few for many, few in zip(inner, outer))
        sides = [(2 * k - 2 + min(2, few - 1)) / k for k, few in zip((columns, rows), outer)]
        own += columns * rows * operations(sides[0] / inner[1] + sides[1] / inner[0], 1 / max(inner))
    return rows_cubed(row) * own


def fronts_of_cuts(row):
    """Those along the cuts between the subdomains of a process."""
    return own_fronts(row, int(np.log2(row["processes"])), int(np.log2(np.prod(parts(row)))))


def fronts_inside(row):
    """Those inside its subdomains."""
    return own_fronts(row, int(np.log2(np.prod(parts(row)))), int(np.log2(row["grains"])))


def handed_on(row):
    """Bytes of the Schur complements that a process hands on in one factorisation: its own, and one of several."""
    boundaries = [b for b, _ in levels(row["processes"])]
    several = max(boundaries[1:-1], default=0)
    return 8 / 2 * (2 * np.sqrt(row["grains"]))**2 * (boundaries[-1]**2 + several**2)


def share(row):
    return row["grains"] / row["processes"]


def cuts(row):
    """Interface unknowns of a lattice in a grid of subdomains: two for each grain along a cut."""
    columns, rows = parts(row)
    return 2 * np.sqrt(row["grains"]) * (columns + rows - 2)


def edge(row):
    """Grains along the cuts around the share of a process in the middle."""
    return levels(row["processes"])[-1][0] * np.sqrt(row["grains"])


def several(row):
    return float(row["processes"] > 1)


# Of each work: quantity -> functions whose weighted sum it is. A process needs most memory before the packing is cut,
# when it has all of it, or later, when it has its share: the larger of two laws counts.
LAWS = {
    "radius": {
        "memory, all": {"1": lambda row: 1.0, "N": lambda row: row["grains"]},
        "memory, share": {"1": lambda row: 1.0, "N": lambda row: row["grains"], "N/P": share},
        "path_flops": {"of several": shared_fronts, "along cuts": fronts_of_cuts, "inside": fronts_inside,
                       "N/P log2(N/P)": lambda row: share(row) * np.log2(share(row))},
        "message_bytes": {"fronts": handed_on},
        "messages": {"2 processes": lambda row: float(row["processes"] == 2),
                     "4 processes": lambda row: float(row["processes"] == 4),
                     "more": lambda row: float(row["processes"] > 4)},
        "sums": {"1": several},
        "sum_bytes": {"interface": lambda row: several(row) * cuts(row)},
        "iterations": {"1": lambda row: 1.0},
    },
    "iteration": {
        "memory": {"1": lambda row: 1.0, "N": lambda row: row["grains"], "N/P": share},
        "memory_others": {"1": lambda row: 1.0, "N": lambda row: row["grains"], "N/P": share},
        "contact_updates": {"N/P": share},
        "message_bytes": {"1": several, "edge": edge},
        "messages": {"2 processes": lambda row: float(row["processes"] == 2),
                     "4 processes": lambda row: float(row["processes"] == 4),
                     "more": lambda row: float(row["processes"] > 4)},
        "sums": {"1": several},
        "sum_bytes": {"subdomains": lambda row: several(row) * np.prod(parts(row))},
    },
}


MANY = 16  # processes from which on the memory of a radius no longer falls


def those_with(rows, quantity):
    """Rows of which a quantity speaks: one process sends nothing, and its few sums are those of the beginning."""
    alone = quantity in ("messages", "message_bytes", "sums", "sum_bytes", "memory_others")
    return [row for row in rows if row["processes"] > 1 or not alone]


def those_of_law(rows, law):
    if law == "memory, share":
        return [row for row in rows if row["processes"] < MANY]
    if law == "memory, all":
        return [row for row in rows if row["processes"] >= MANY]
    return those_with(rows, law)


def weights(functions, rows, law):
    """The non-negative weights that minimise the sum of squares of relative errors."""
    rows, quantity = those_of_law(rows, law), law.split(",")[0]
    terms = np.array([[f(row) / row[quantity] for f in functions.values()] for row in rows])
    best, least = None, np.inf
    for size in range(1, terms.shape[1] + 1):
        for some in map(list, itertools.combinations(range(terms.shape[1]), size)):
            found = np.linalg.lstsq(terms[:, some], np.ones(len(rows)), rcond=None)[0]
            error = np.sum((terms[:, some] @ found - 1)**2)
            if np.all(found >= 0) and error < least:
                least, best = error, np.zeros(terms.shape[1])
                best[some] = found
    return dict(zip(functions, best))


class Model:
    """The laws of a kind of work with constants from some rows."""

    def __init__(self, work, rows):
        self.work = work
        self.constants = {law: weights(functions, rows, law) for law, functions in LAWS[work].items()}
        self.quantities = list(dict.fromkeys(law.split(",")[0] for law in LAWS[work]))

    def value(self, quantity, row):
        laws = LAWS[self.work]
        return max(sum(self.constants[law][name] * f(row) for name, f in laws[law].items())
                   for law in laws if law.split(",")[0] == quantity)

    def ratios(self, quantity, rows):
        """Predicted over measured."""
        return np.array([self.value(quantity, row) / row[quantity] for row in those_with(rows, quantity)])


def read(results, name=TABLE):
    """The table, and beside its columns the memory of the processes that do not write, on average."""
    rows = style.read_table(results, name, numbers=NUMBERS, texts="series work program subdomains oversubscribed")
    for row in rows:
        row["memory_others"] = (row["memory_all"] - row["memory"]) / max(1, row["processes"] - 1)
    return rows


def rows_of(rows, work):
    """Those that the laws are about: of nscdd-mpi."""
    found = style.where(rows, work=work, program="nscdd-mpi")
    return [row for row in found if work != "radius" or row["grains"] / np.prod(parts(row)) >= SMALLEST_SUBDOMAIN]


def fitted_and_held_out(rows, work):
    own = rows_of(rows, work)
    return tuple([row for row in own if (row["grains"] > LARGEST_FITTED) == held_out] for held_out in (False, True))


def large(processes):
    """10^7 grains, a subdomain for each process, at least 8 x 8."""
    subdomains = max(64, processes)
    columns = 2 ** int(np.ceil(np.log2(subdomains) / 2))
    return {"grains": LARGE, "processes": processes, "subdomains": f"{columns}x{subdomains // columns}"}


def per_node(memory, machine):
    """The power of two of processes that fit on a node, by cores and by memory (a tenth is left to the system)."""
    return 2 ** int(np.floor(np.log2(min(machine["cores"], 0.9 * machine["memory"] / memory))))


def sum_seconds(processes, size, on_node, machine):
    """Of one sum over all processes, ON_NODE of them on a node, of so many bytes."""
    return (np.log2(on_node) * machine["latency_inside"] + np.log2(processes / on_node) * machine["latency"]
            + size / machine["sum_bandwidth"])


def measured_speeds(rows):
    """Of one process on the largest lattice that was timed: operations per second, and seconds per grain that every
    process spends on the whole packing. None where no seconds were measured."""
    timed = [row for row in rows_of(rows, "radius") if row["processes"] == 1 and np.isfinite(row["seconds"])]
    if not timed:
        return None
    row = max(timed, key=lambda one: one["grains"])
    return {"operations": row["path_flops"] / row["work_seconds"],
            "whole": (row["seconds"] - row["work_seconds"]) / row["grains"]}


def predict_radius(model, processes, machine, speeds):
    """Counts of one radius of 10^7 grains, and what they come to in seconds; a prediction. Without SPEEDS it is the
    least: operations at the nominal speed of a core, and nothing for the whole packing."""
    row = large(processes)
    found = {quantity: model.value(quantity, row) for quantity in model.quantities}
    found["per_node"] = per_node(found["memory"], machine)
    slower = MEASURED_OPERATIONS / machine["operations"]
    speeds = speeds or {"operations": MEASURED_OPERATIONS, "whole": 0}
    ascents = model.constants["messages"]["2 processes"]
    seconds = {
        "whole packing": slower * speeds["whole"] * LARGE,
        "operations": slower * found["path_flops"] / speeds["operations"],
        "messages": 2 * ascents * np.log2(processes) * machine["latency"]
                    + found["message_bytes"] * found["per_node"] / machine["network"],
        "sums": found["sums"] * sum_seconds(processes, found["sum_bytes"] / found["sums"], found["per_node"],
                                              machine),
    }
    return {**found, "parts": seconds, "seconds": sum(seconds.values())}


def predict_iteration(model, processes, machine):
    """The same of an iteration of Algorithm 1 on a bed of 10^7 grains."""
    row = large(processes)
    found = {quantity: model.value(quantity, row) for quantity in model.quantities}
    found["per_node"] = per_node(found["memory_others"], machine)
    update = CONTACT_UPDATE * MEASURED_OPERATIONS / machine["operations"]
    if found["contact_updates"] * CONTACT_BYTES > machine["cache"] * machine["cores"] / found["per_node"]:
        bandwidth = machine["memory_bandwidth"] * machine["cores"] / found["per_node"]
        update = max(update, CONTACT_BYTES / bandwidth)
    seconds = {
        "sweeps": found["contact_updates"] * update,
        "messages": found["messages"] * machine["latency"]
                    + found["message_bytes"] * found["per_node"] / machine["network"],
        "sums": sum_seconds(processes, found["sum_bytes"], found["per_node"], machine),
    }
    return {**found, "parts": seconds, "seconds": sum(seconds.values())}


def report(rows):
    for work in LAWS:

        fitted, held_out = fitted_and_held_out(rows, work)
        model = Model(work, fitted)
        print(f"{work}: constants from {len(fitted)} rows of at most {LARGEST_FITTED} grains")
        for law, constants in model.constants.items():
            print(f"  {law} = " + " + ".join(f"{value:.4g} [{name}]" for name, value in constants.items()))
        for quantity in model.quantities:
            for name, some in (("fitted", fitted), ("held out", held_out)):
                ratios = model.ratios(quantity, some)
                if len(ratios):
                    print(f"  {quantity}, {name}: predicted/measured {ratios.min():.2f} to {ratios.max():.2f}, median "
                          f"{np.median(ratios):.2f} of {len(ratios)} rows")
    speeds = measured_speeds(rows)
    print("prediction for 10^7 grains on ARCHER2; constants from all rows")
    radius, iteration = (Model(work, rows_of(rows, work)) for work in LAWS)
    for processes in PROCESSES:
        for one in (predict_radius(radius, processes, ARCHER2, speeds),
                    predict_iteration(iteration, processes, ARCHER2)):
            name = "radius" if "path_flops" in one else "iteration"
            least = "at least " if name == "radius" and speeds is None else ""
            each = one.get("memory_others", one["memory"])
            print(f"  {name}, {processes} processes: {each / 1e9:.2f} GB each, {one['per_node']} a node"
                  + ("" if name == "radius" else f", the one that writes {one['memory'] / 1e9:.2f} GB")
                  + (f", {one['path_flops']:.3g} operations, {one['message_bytes']:.3g} B" if name == "radius" else "")
                  + f", {least}{one['seconds']:.4g} s predicted: "
                  + ", ".join(f"{part} {value:.3g}" for part, value in one["parts"].items()))


def main():
    if len(sys.argv) > 2:
        sys.exit("usage: machine_model.py [RESULTS]")
    try:
        report(read(sys.argv[1]) if len(sys.argv) == 2 else read(*os.path.split(BASELINE)))
    except style.DataError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
