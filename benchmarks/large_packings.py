#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Radii of B_epsilon on triangular lattices in vertical strips: nscdd against SciPy and Octave, one run of each.

The peers (benchmarks/peers/) are the best straightforward method found in either language: local factorisations, a
dense interface matrix, its largest eigenvalue. They are timed by their own clocks, without their set-up, over a few
values of epsilon. nscdd is timed as a whole process, packing file read and contacts found, over 20 values of epsilon
from 1e-4 to 1e2, at a tolerance of 1e-8, for both ends of the spectrum. Seconds and ratios are averages over these
values, or those of the peer. Radii must agree to 2e-8 wherever both have them.

usage: large_packings.py [--program PATH] [--grains N] [--strips 2,16] [--peers octave,scipy] [--peer-epsilons 2]
       large_packings.py --scaling [--sizes 10000,100000,1000000]     cost of one point against N, 16 strips
       large_packings.py --deposits [--sizes 100000,1000000]          deposits of equal to very unequal grains
       large_packings.py --space [--sizes 1000,10000,100000] [--peers octave,scipy] [--peers-up-to 10000]
           one radius of spheres in 2 x 2 x 2 blocks: growth, and the peers that read the exported operators
"""
import argparse
import csv
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
EPSILONS = 20
OPERATOR_PEERS = {
    "octave": ["octave-cli", "--no-gui", "-q", os.path.join(HERE, "peers", "spectral_operators_octave.m")],
    "scipy": ["/usr/bin/python3", os.path.join(HERE, "peers", "spectral_operators_scipy.py")],
}


def machine():
    """Processor and cores at hand."""
    with open("/proc/cpuinfo", encoding="ascii") as file:
        models = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{(models or ['unknown processor'])[0]}, {len(os.sched_getaffinity(0))} cores"


def lattice(path, grains):
    """The lattice of the peers: round(sqrt(sqrt(3) N)) columns, last row possibly short, unit diameter and mass."""
    columns = max(2, round(math.sqrt(math.sqrt(3) * grains)))
    with open(path, "w", encoding="ascii") as file:
        file.write("x,y,radius,mass\n")
        for k in range(grains):
            row, column = divmod(k, columns)
            file.write(f"{column + 0.5 * (row % 2)!r},{row * math.sqrt(3) / 2!r},0.5,1\n")


def timed(command):
    """Standard output, wall seconds, peak resident bytes of one process."""
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1")
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(command)}: ended with status {status}")
    return output, time.perf_counter() - start, usage.ru_maxrss * 1024


def nscdd(program, packing, subdomains, epsilons, more=()):
    output, seconds, memory = timed([program, "sweep", packing, "--subdomains", subdomains, "--epsilon", epsilons,
                                     "--csv", "-", *more])
    rows = list(csv.DictReader(output.splitlines()))
    unproved = sum(row["converged"] != "true" for row in rows)
    radii = {float(row["epsilon"]): float(row["spectral_radius"]) for row in rows}
    return {"radii": radii, "seconds": seconds / len(rows), "memory": memory, "unproved": unproved,
            "unknowns": rows[0]["interface_dofs"], "solver": rows[0]["solver"]}


def peer(name, grains, strips, count):
    if name == "octave":
        command = ["octave-cli", "--no-gui", "-q", os.path.join(HERE, "peers", "spectral_octave.m"), str(grains),
                   str(strips), str(count), "dense"]
    else:
        command = ["/usr/bin/python3", os.path.join(HERE, "peers", "spectral_scipy.py"), str(grains), str(strips),
                   str(count), "1e-8", "1e9", "dense"]
    output, _, memory = timed(command)
    # Of one value, Octave's logspace gives the last and NumPy's the first.
    values = {1e-4: "first", 1e2: "last"} if count > 1 else {1e2 if name == "octave" else 1e-4: "first"}
    radii = {epsilon: float(re.search(rf"rho\({which}\)=([0-9.e+-]+)", output).group(1))
             for epsilon, which in values.items()}
    return {"radii": radii,
            "seconds": float(re.search(r"total=([0-9.]+)s", output).group(1)) / count, "memory": memory}


def compare(options, folder):
    packing = os.path.join(folder, "lattice.csv")
    lattice(packing, options.grains)
    print(f"{options.grains} disks; seconds per epsilon, the average of {EPSILONS} values ({options.peer_epsilons} of a "
          f"peer), and their ratio; peak memory in MiB")
    print("strips  unknowns  solver        program  s/epsilon  ratio  memory  ratio  largest difference")
    for strips in options.strips:
        own = nscdd(options.program, packing, f"{strips}x1", f"1e-4:1e2:{EPSILONS}")
        print(f"{strips:6}  {own['unknowns']:>8}  {own['solver']:12}  nscdd    {own['seconds']:9.3f}         "
              f"{own['memory'] / 2**20:6.0f}         {own['unproved']} of {EPSILONS} not proved", flush=True)
        for name in options.peers:
            other = peer(name, options.grains, strips, options.peer_epsilons)
            difference = max(abs(other["radii"][e] - own["radii"][e]) for e in other["radii"])
            print(f"{strips:6}  {own['unknowns']:>8}  {'dense':12}  {name:7}  {other['seconds']:9.3f}  "
                  f"{other['seconds'] / own['seconds']:5.1f}  {other['memory'] / 2**20:6.0f}  "
                  f"{other['memory'] / own['memory']:5.2f}  {difference:.1e}", flush=True)
            if difference > 2e-8:
                sys.exit(f"{name} and nscdd disagree")


def scale(options, folder):
    print("one point, epsilon = 1, 16 strips, whole process; N log N relative to the first row")
    first = None
    for grains in options.sizes or [10_000, 100_000, 1_000_000]:
        packing = os.path.join(folder, f"lattice-{grains}.csv")
        lattice(packing, grains)
        own = nscdd(options.program, packing, "16x1", "1")
        law = grains * math.log(grains)
        first = first or (own["seconds"], law)
        print(f"{grains:9}  {own['seconds']:9.3f} s  {own['memory'] / 2**20:6.0f} MiB  cost x {own['seconds'] / first[0]:7.1f}"
              f"  N log N x {law / first[1]:7.1f}  {own['unproved']} not proved", flush=True)


def deposits(options, folder):
    """Deposits of four ranges of sizes: the bed is made, then read again and its contacts found.

    From 10^5 grains on: below, `inspect` computes ranks as well, which takes most of its time.
    """
    kinds = {"equal": {"radius_max": 0.1}, "1 : 2": {"radius_max": 0.2},
             "1 : 100, equal area of every size": {"radius_max": 10, "distribution": "uniform_volume"},
             "1 : 100, one large in 1000": {"radius_max": 10, "distribution": "two_sizes", "fraction_large": 0.001}}
    print("   grains  generate  inspect  radii")
    for grains in options.sizes or [100_000, 1_000_000]:
        for kind, sizes in kinds.items():
            packing = os.path.join(folder, "deposit.h5")
            keys = {"grains": grains, "radius_min": 0.1, **sizes}
            settings = [part for key, value in keys.items() for part in ("--set", f"packing.{key}={value}")]
            made = timed([options.program, "generate", "deposit", *settings, "--force", "-o", packing])[1]
            read = timed([options.program, "inspect", packing])[1]
            print(f"{grains:9}  {made:7.3f}s {read:7.3f}s  {kind}", flush=True)


def spheres(options, folder):
    """Face-centred cubic lattices and deposits of spheres: rigid, and with epsilon > 0."""
    print("one radius, 2 x 2 x 2 blocks, eta infinite; whole process, packing read; peers without their set-up")
    print("packing  spheres  unknowns  epsilon  program  seconds  memory, MiB  radius")
    blocks = "2x2x2"
    for grains in options.sizes or [1000, 10_000, 100_000]:
        side = round(grains**(1 / 3))
        kinds = {"fcc": [f"packing.{key}={side}" for key in ("columns", "rows", "layers")],
                 "sphere_deposit": [f"packing.grains={grains}", "packing.radius_min=0.1", "packing.radius_max=0.2"]}
        for kind, settings in kinds.items():
            packing = os.path.join(folder, f"{kind}.h5")
            timed([options.program, "generate", kind, *(part for one in settings for part in ("--set", one)), "--force",
                   "-o", packing])
            for epsilon in ("0", "1e-4", "1e-2", "1"):
                own = nscdd(options.program, packing, blocks, epsilon)
                radius = own["radii"][float(epsilon)]
                print(f"{kind:14}  {grains:7}  {own['unknowns']:>6}  {epsilon:>5}  nscdd  {own['seconds']:8.2f}  "
                      f"{own['memory'] / 2**20:6.0f}  {radius:.10f}{'  not proved' if own['unproved'] else ''}",
                      flush=True)
                if epsilon == "0" or grains > options.peers_up_to:
                    continue
                operators = os.path.join(folder, "operators")
                shutil.rmtree(operators, ignore_errors=True)
                timed([options.program, "export", packing, "--subdomains", blocks, "--operators", operators,
                       "--sparse-only"])
                for peer in options.peers:
                    output, _, memory = timed([*OPERATOR_PEERS[peer], operators, epsilon])
                    cells = (part.split("=") for part in output.split())
                    other = {key: float(value.rstrip("s")) for key, value in cells}
                    print(f"{kind:14}  {grains:7}  {own['unknowns']:>6}  {epsilon:>5}  {peer}  {other['total']:8.2f}  "
                          f"{memory / 2**20:6.0f}  {other['rho']:.10f}  ratio {other['total'] / own['seconds']:.1f}",
                          flush=True)
                    if abs(other["rho"] - radius) > 2e-8:
                        sys.exit(f"{peer} and nscdd disagree")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    numbers = lambda text: [int(float(part)) for part in text.split(",")]
    parser.add_argument("--program", default=os.path.join(HERE, "..", "build", "release", "nscdd"))
    parser.add_argument("--grains", type=lambda text: int(float(text)), default=100_000)
    parser.add_argument("--strips", type=numbers, default=[2, 16])
    parser.add_argument("--peers", type=lambda text: [part for part in text.split(",") if part],
                        default=["octave", "scipy"])
    parser.add_argument("--peer-epsilons", type=int, default=2)
    parser.add_argument("--scaling", action="store_true")
    parser.add_argument("--deposits", action="store_true")
    parser.add_argument("--space", action="store_true")
    parser.add_argument("--peers-up-to", type=lambda text: int(float(text)), default=10_000)
    parser.add_argument("--sizes", type=numbers)
    options = parser.parse_args()
    print(machine())
    with tempfile.TemporaryDirectory() as folder:
        modes = {"scaling": scale, "deposits": deposits, "space": spheres}
        chosen = [run for name, run in modes.items() if getattr(options, name)] or [compare]
        chosen[0](options, folder)


if __name__ == "__main__":
    main()
