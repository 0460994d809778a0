#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Headline numbers of the figures, read from the tables, and the files they are drawn in. Tables that are not there are
left out."""
import argparse
import os
import sys

import numpy as np
import style

NETWORKS = {"disks4": "figure-2", "disks8": "figure-3", "disks12": "figure-4"}


def rho(rows, **values):
    """The radius at a point of a sweep, NaN where the sweep lacks it."""
    found = style.where(rows, **values)
    return found[0]["spectral_radius"] if found else np.nan


def nearest(rows, eta):
    return min(style.finite(rows, "eta"), key=lambda row: abs(np.log(row["eta"] / eta)))


def at_eta(row):
    return f"{row['spectral_radius']:.6f} at eta {row['eta']:.4g}"


def networks(results):
    links = style.read_table(results, "figures-2-3-4/links.csv", texts="case", numbers="impulse")
    for case, name in NETWORKS.items():
        own = style.where(links, case=case)
        pressed = sum(k["impulse"] > 0 for k in own)
        yield name, case, f"{len(own)} links: {pressed} compressive, {len(own) - pressed} tensile"


def figure_5(results):
    for _, own in style.by_case(style.read_radii(results, "figure-5/radius.csv", "epsilon")[0]):
        yield ("figure-5", own[0]["case"],
               f"rho(B_0) {rho(own, epsilon=0):.6f}, rho(B_1) {rho(own, epsilon=1):.6f}")


def figure_6(results):
    for _, own in style.by_case(style.read_radii(results, "figure-6/radius.csv", "eta", "epsilon")[0]):
        for epsilon in (1, 0):
            some = style.where(own, epsilon=epsilon)
            if some:
                points = ", ".join(at_eta(nearest(some, eta)) for eta in (1e-4, 0.1, 1))
                yield ("figure-6", own[0]["case"],
                       f"epsilon {epsilon}: generic {rho(some, eta=np.inf):.6f}; enriched {points}")


def figure_7(results):
    for _, own in style.by_case(style.read_radii(results, "figure-7/radius.csv", "eta")[0]):
        curve = style.finite(own, "eta")
        best = min(curve, key=lambda row: row["spectral_radius"])
        yield ("figure-7", own[0]["case"],
               f"generic {rho(own, eta=np.inf):.6f}; enriched, smallest {at_eta(best)}; {at_eta(curve[0])}")


def optimal_eta(results):
    numbers = ("grains generic_radius best_eta best_radius "
               "generic_relaxed_radius relaxed_best_eta relaxed_best_radius")
    for row in style.read_table(results, "optimal-eta/optimum.csv", numbers=numbers):
        yield ("optimal-eta", f"{row['grains']:g} disks",
               f"generic {row['generic_radius']:.6f}, "
               f"enriched {row['best_radius']:.6f} at eta {row['best_eta']:.4g}; "
               f"relaxed: generic {row['generic_relaxed_radius']:.6f}, "
               f"enriched {row['relaxed_best_radius']:.6f} at eta {row['relaxed_best_eta']:.4g}")


def relaxation(results):
    for _, own in style.by_case(style.read_radii(results, "relaxation/radius.csv", "eta", "relaxation")[0]):
        largest, relaxed = (max(r["spectral_radius"] for r in some) for some in (own[0::2], own[1::2]))
        best = min(own[1::2], key=lambda row: row["spectral_radius"])
        yield ("relaxation", own[0]["case"],
               f"largest: {largest:.6f} without, {relaxed:.6f} with relaxation; smallest with {at_eta(best)}")


def inexact_stage_one(results):
    rows, _ = style.read_radii(results, "inexact-stage-one/radius.csv", "gauss_seidel_sweeps", "epsilon eta")
    for _, own in style.by_case(rows):
        for epsilon, eta in dict.fromkeys((r["epsilon"], r["eta"]) for r in own):
            some = style.where(own, epsilon=epsilon, eta=eta)
            sweeps = [f"{rho(some, gauss_seidel_sweeps=n):.6f} ({n:g})" for n in (1, 2, 10, np.inf)]
            yield ("inexact-stage-one", own[0]["case"],
                   f"epsilon {epsilon:g}, eta {eta:g}: rho (n_GS) {', '.join(sweeps)}")


def observed_rate(results):
    rows = style.read_table(results, "observed-rate/rate.csv", texts="case", flags="agree",
                            numbers="grains difference")
    for _, own in style.by_case(rows):
        largest = np.max(np.abs(style.column(own, "difference")))
        yield ("observed-rate", own[0]["case"], f"largest |observed - predicted| {largest:.1e}; "
               f"{sum(r['agree'] for r in own)} of {len(own)} agree")


def exponent(rows, x, **values):
    """Fitted exponent of 1 - rho (unit eigenvalues left out) against the column X."""
    some = style.where(rows, **values)
    return style.slope(style.column(some, x), 1 - style.column(some, "subdominant_radius"))


def size(results):
    for packing in ("lattice", "deposit"):
        rows = style.read_table(results, f"size/rigid-{packing}.csv",
                                numbers="grains epsilon eta subdominant_radius")
        yield ("size", packing, f"rigid: 1 - rho ~ N^{exponent(rows, 'grains', eta=np.inf):.2f} generic, "
               f"N^{exponent(rows, 'grains', eta=0.1):.2f} enriched (eta 0.1)")


def scalability(results):
    for table, epsilon in (("lattice-strips", 0), ("lattice-grids", 0), ("deposit-grids", 1e-6),
                           ("lattice-strips", 1e-2), ("deposit-grids", 1e-2)):
        rows = style.read_table(results, f"scalability/{table}.csv",
                                numbers="subdomains epsilon eta subdominant_radius")
        powers = [exponent(rows, "subdomains", epsilon=epsilon, eta=eta) for eta in (np.inf, 0.1)]
        yield ("scalability", table, f"epsilon {epsilon:g}: 1 - rho ~ n^{powers[0]:.2f} generic, "
               f"n^{powers[1]:.2f} enriched (eta 0.1)")


def disorder(results):
    for table in ("vacancies", "deposit"):
        rows = style.read_table(results, f"disorder/{table}.csv", numbers="epsilon eta subdominant_radius")
        gaps = [1 - style.column(style.where(rows, epsilon=0, eta=eta), "subdominant_radius")
                for eta in (np.inf, 0.1)]
        yield ("disorder", table, "rigid: 1 - rho " + ", ".join(
            f"{gap.min():.2g} to {gap.max():.2g} {text}" for gap, text in zip(gaps, ("generic", "enriched (eta 0.1)"))))


def figure_9(results):
    rows = style.read_table(results, "figure-9/indicators.csv", texts="case",
                            numbers="iteration zeta interface_change natural_map")
    for when in (100, 1000, max(r["iteration"] for r in rows)):
        row = min(rows, key=lambda r: abs(r["iteration"] - when))
        yield ("figure-9", row["case"], f"iteration {row['iteration']:.0f}: zeta {row['zeta']:.2e}, "
               f"Z {row['interface_change']:.2e}, error of the contact law {row['natural_map']:.2e}")


def figure_10(results):
    rows = style.read_table(results, "figure-10/runs.csv", texts="case algorithm",
                            numbers="gauss_seidel_sweeps steps converged_steps iterations natural_map distance_mean")
    for row in rows:
        yield ("figure-10", row["case"], f"{row['algorithm']}, n_GS {row['gauss_seidel_sweeps']:.0f}: "
               f"{row['converged_steps']:.0f} of {row['steps']:.0f} steps converged in "
               f"{row['iterations']:.0f} iterations, "
               f"{row['distance_mean']:.2g} m from Gauss-Seidel")


def figure_11(results):
    numbers = "iteration gauss_seidel_sweeps eta interface_change"
    rows = style.read_table(results, "figure-11/generic.csv", texts="case", numbers=numbers)
    rows += style.read_table(results, "figure-11/enriched.csv", texts="case", numbers=numbers)
    for sweeps, eta in dict.fromkeys((r["gauss_seidel_sweeps"], r["eta"]) for r in rows):
        last = max(style.where(rows, gauss_seidel_sweeps=sweeps, eta=eta), key=lambda r: r["iteration"])
        yield ("figure-11", f"n_GS {sweeps:.0f}", f"eta {eta:g}: Z {last['interface_change']:.2e} after "
               f"{last['iteration']:.0f} iterations")


def predicted_observed(results):
    for table, where in (("rate", ""), ("solution", " next to the solution")):
        yield from gaps_of_rates(results, table, where)


def gaps_of_rates(results, table, where):
    rows = style.read_table(results, f"predicted-observed/{table}.csv", texts="case algorithm",
                            numbers="grains gauss_seidel_sweeps predicted observed")
    for grains in sorted({r["grains"] for r in rows}):
        own = [r for r in style.where(rows, grains=grains)
               if np.isfinite(r["observed"]) and np.isfinite(r["predicted"])]
        if own:
            gap = [abs(r["observed"] - r["predicted"]) / (1 - r["predicted"]) for r in own]
            yield ("predicted-observed", f"{grains:.0f} grains",
                   f"{len(own)} runs{where}: |observed - predicted| / (1 - predicted) at most {max(gap):.2g}, "
                   f"median {np.median(gap):.2g}")


def partition(results):
    for packing in ("lattice", "deposit"):
        for cut in ("grid", "metis"):
            rows = style.read_table(results, f"partition/{packing}-{cut}.csv",
                                    numbers="subdomains interface_dofs epsilon eta subdominant_radius")
            gap = 1 - style.column(style.where(rows, epsilon=1e-2, eta=np.inf), "subdominant_radius")
            yield ("partition", f"{packing}, {cut}",
                   f"epsilon 0.01, generic: 1 - rho {gap.min():.2g} to {gap.max():.2g}")


SECTIONS = [networks, figure_5, figure_6, figure_7, figure_9, figure_10, figure_11, optimal_eta, relaxation,
            inexact_stage_one, observed_rate, size, scalability, disorder, partition, predicted_observed]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", metavar="RESULTS", help="folder of the tables")
    parser.add_argument("figures", metavar="FIGURES", help="folder of the figures")
    options = parser.parse_args()
    lines, status = [("figure", "case", "headline (radii; eta, epsilon in 1/kg)", "file")], 0
    for section in SECTIONS:
        try:
            for name, case, headline in section(options.results):
                files = [os.path.join(options.figures, f"{name}.{kind}") for kind in style.FORMATS]
                drawn = [f for f in files if os.path.exists(f)]
                lines.append((name, case, headline, drawn[0] if drawn else "not drawn"))
        except style.NoTable:
            continue  # a study that was not run
        except style.DataError as error:
            print(f"error: {error}", file=sys.stderr)
            status = 2
    if len(lines) == 1 and status == 0:
        print(f"error: {options.results}: expected the results of a study, met none", file=sys.stderr)
        return 2
    widths = [max(map(len, cells)) for cells in zip(*lines)]
    for cells in lines:
        print("  ".join(cell.ljust(width) for cell, width in zip(cells, widths)).rstrip())
    return status


if __name__ == "__main__":
    sys.exit(main())
