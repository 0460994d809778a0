#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's contraction matrices, literal and dense, for any packing of disks or spheres.

The formulas of P. Alart, D. Iceta, D. Dureisseix, "A nonlinear Domain Decomposition formulation
with application to granular dynamics", 2012 ([ADI12] below) are evaluated as printed, misprints
corrected: explicit inverses of W_E + epsilon I and of M_E + K_E/eta, explicit interface sums, and
the nonsymmetric eigenvalue problem of X^-1 Y.  Slow and memory-hungry on purpose: it shares no
algebra with a program that works with sparse interface operators, and serves as its oracle.

Usage:
  literal_formulas.py PACKING.csv --subdomains 2x1 --epsilon 0,0.1,1 --eta inf,0.1 [options]
  literal_formulas.py PACKING.csv ... --check PROGRAM
  literal_formulas.py --random SEED --grains N [--space] [--lattice] --write PACKING.csv

PACKING.csv has columns x, y, radius and optionally z and mass (unit masses without it).
  --subdomains NXxNY      regular grid over the bounding box of the grain centres, NXxNYxNZ where
                          they have a z; a contact goes to the cell of the midpoint of its two
                          centres, on a line to the lower
  --epsilon LIST          flexibilities of the linear law; 0 is the rigid limit
  --eta LIST              flexibilities of the enriched Stage 2; inf is the generic algorithm
  --contacts all|active   network of Stage 1; active: in compression in the linear rigid impact
  --prescribed G:VX:VY    velocity V^- of grain G (0-based) before the impact, G:VX:VY:VZ in space;
                          may be repeated
  --tolerance T           a contact is a gap <= T times the smaller radius (default 1e-7)
  --check PROGRAM         run "PROGRAM sweep PACKING.csv ..." and compare to 1e-9
  --random SEED           write a test packing: exact tangencies, random masses; with --lattice
                          a piece of hexagonal or face-centred cubic lattice with vacancies (mostly
                          hyperstatic), without it random radii, every new grain tangent to two
                          earlier ones, or to three in space (isostatic)

Output, CSV: contact_set, epsilon, eta, spectral_radius, eigenvalue_min, eigenvalue_max of B, then
grains, contacts, subdomains, interface_dofs.  A summary with the number of cross points (grains
shared by three subdomains or more) goes to standard error.

Accuracy: (22) and (36) cancel, a factor of order 1/eta multiplying terms of order eta, and the
largest |eigenvalue| grows as 1/eta where X_0 is singular (hyperstatic subdomains).  On packings of
tens of grains the absolute error is below 1e-10 for eta >= 1e-2 and epsilon = 0 or >= 1e-3; for
eta = 1e-3 it is below 1e-12 of the largest |eigenvalue|, which may be in the thousands: keep
eta >= 1e-2 where 1e-9 is asked for.

Exit code: 0 done, 1 a comparison failed, 2 wrong usage or input.  Needs numpy.
"""

import argparse
import csv
import io
import math
import subprocess
import sys
from dataclasses import dataclass

import numpy as np

TOLERANCE = 1e-9
# Singular values of W_E and relative impulses below this are rounding: those of small packings
# are far above or, being zero in exact arithmetic, near 1e-16.
RANK_TOLERANCE = 1e-10
ON_LINE = 1e-9
COMPARED = ("spectral_radius", "eigenvalue_min", "eigenvalue_max")
COLUMNS = ("contact_set", "epsilon", "eta", *COMPARED,
           "grains", "contacts", "subdomains", "interface_dofs")


class InputError(Exception):
    """Input that cannot be used; the message says what was expected and what was met."""


# Packing, contacts, partition

@dataclass
class Packing:
    centres: np.ndarray  # n x 2, or n x 3 in space
    radii: np.ndarray    # n
    masses: np.ndarray   # n

    @property
    def dimension(self):
        return self.centres.shape[1]


@dataclass
class Subdomain:
    """Split inertia, kinematics v_E = H_E^T V_E, signed boolean gluing sum A_E V_E = 0."""
    M: np.ndarray         # d n_E x d n_E, diagonal
    H: np.ndarray         # d n_E x c_E
    A: np.ndarray         # n_Gamma x d n_E
    contacts: np.ndarray  # global numbers of the c_E contacts


def read_packing(path):
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        axes = ("x", "y", "z") if rows and "z" in rows[0] else ("x", "y")
        centres = np.array([[float(row[axis]) for axis in axes] for row in rows])
        radii = np.array([float(row["radius"]) for row in rows])
        masses = np.array([float(row.get("mass", 1.0)) for row in rows])
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: columns of numbers x, y[, z], radius[, mass] expected, "
                         f"met {error!r}") from error
    if len(rows) == 0:
        raise InputError(f"{path}: at least one grain expected, met none")
    return Packing(centres, radii, masses)


def find_contacts(packing, tolerance):
    contacts = []
    for i in range(len(packing.radii)):
        for j in range(i + 1, len(packing.radii)):
            gap = (np.linalg.norm(packing.centres[j] - packing.centres[i])
                   - packing.radii[i] - packing.radii[j])
            if gap <= tolerance * min(packing.radii[i], packing.radii[j]):
                contacts.append((i, j))
    return contacts


def cell_of_midpoint(midpoint, lower, upper, grid):
    """Column, row (and layer) of the cell, the lower one for a midpoint on a line."""
    cell = []
    for axis in range(len(grid)):
        size = upper[axis] - lower[axis]
        position = (midpoint[axis] - lower[axis]) / size if size > 0 else 0.0
        index = 0
        # Lines at 1/N, ..., (N-1)/N of the box: count those strictly behind the midpoint.
        while index < grid[axis] - 1 and position > (index + 1) / grid[axis] + ON_LINE:
            index += 1
        cell.append(index)
    return tuple(cell)


def kinematics(packing, contacts, grains):
    """H: unit normal from i to j on the rows of j, its opposite on those of i.

    v = H^T V is then the opening velocity and r > 0 is compression."""
    d = packing.dimension
    row_of = {grain: d * position for position, grain in enumerate(grains)}
    H = np.zeros((d * len(grains), len(contacts)))
    for column, (i, j) in enumerate(contacts):
        difference = packing.centres[j] - packing.centres[i]
        normal = difference / np.linalg.norm(difference)
        H[row_of[j]:row_of[j] + d, column] = normal
        H[row_of[i]:row_of[i] + d, column] = -normal
    return H


def decompose(packing, contacts, grid):
    """Subdomains that own contacts, and the number of their owners for every grain."""
    d = packing.dimension
    if len(grid) != d:
        raise InputError(f"--subdomains: {d} numbers of cells expected, met {len(grid)}")
    lower, upper = packing.centres.min(axis=0), packing.centres.max(axis=0)
    owner = [cell_of_midpoint((packing.centres[i] + packing.centres[j]) / 2, lower, upper, grid)
             for i, j in contacts]
    cells = sorted(set(owner))
    numbers = [[k for k, cell in enumerate(owner) if cell == own] for own in cells]
    grains = [sorted({grain for k in own for grain in contacts[k]}) for own in numbers]
    sharing = [[E for E in range(len(cells)) if grain in grains[E]]
               for grain in range(len(packing.radii))]
    interface_size = d * sum(len(owners) - 1 for owners in sharing if owners)

    subdomains = []
    for E in range(len(cells)):
        # Mass split equally among the subdomains of the grain.
        split = [packing.masses[grain] / len(sharing[grain]) for grain in grains[E]]
        subdomains.append(Subdomain(
            M=np.diag(np.repeat(split, d)),
            H=kinematics(packing, [contacts[k] for k in numbers[E]], grains[E]),
            A=np.zeros((interface_size, d * len(grains[E]))),
            contacts=np.array(numbers[E], dtype=int)))

    # Chain gluing: q - 1 pairs of rows for a grain of q subdomains, cross points included.
    row = 0
    for grain, owners in enumerate(sharing):
        for first, second in zip(owners, owners[1:]):
            for axis in range(d):
                for E, sign in ((first, 1.0), (second, -1.0)):
                    subdomains[E].A[row, d * grains[E].index(grain) + axis] = sign
                row += 1
    return subdomains, [len(owners) for owners in sharing]


def active_contacts(packing, contacts, prescribed):
    """r > 0 in the least-norm solution of W r = -H^T V^-, undivided packing."""
    if not prescribed:
        raise InputError("--contacts active: at least one --prescribed GRAIN:VX:VY expected")
    grain_count, d = len(packing.radii), packing.dimension
    arrival = np.zeros(d * grain_count)
    for grain, velocity in prescribed:
        if not 0 <= grain < grain_count:
            raise InputError(f"--prescribed: a grain of 0..{grain_count - 1} expected, met {grain}")
        if len(velocity) != d:
            raise InputError(f"--prescribed: {d} components expected, met {len(velocity)}")
        arrival[d * grain:d * grain + d] = velocity
    H = kinematics(packing, contacts, range(grain_count))
    W = H.T @ np.linalg.inv(np.diag(np.repeat(packing.masses, d))) @ H
    r = np.linalg.pinv(W, rcond=RANK_TOLERANCE, hermitian=True) @ (-H.T @ arrival)
    return r > RANK_TOLERANCE * np.abs(r).max()


# The paper's matrices.  A contraction matrix is P^-1 Y.

def delassus_inverse(W, epsilon):
    """(W_E + epsilon I)^-1; the pseudo-inverse in the rigid limit, W_E being singular when the
    network is hyperstatic."""
    if W.shape[0] == 0:
        return W
    if epsilon == 0:
        return np.linalg.pinv(W, rcond=RANK_TOLERANCE, hermitian=True)
    return np.linalg.inv(W + epsilon * np.eye(W.shape[0]))


def enriched_mass_inverse(subdomain, eta):
    """M_E,eta^-1 = (M_E + K_E/eta)^-1, (23)-(24); M_E^-1 for eta = inf."""
    if math.isinf(eta):
        return np.linalg.inv(subdomain.M)
    return np.linalg.inv(subdomain.M + subdomain.H @ subdomain.H.T / eta)


def interface_operator(subdomains, eta):
    """X_eta, (21); X for eta = inf."""
    return sum(s.A @ enriched_mass_inverse(s, eta) @ s.A.T for s in subdomains)


def smooth_generic(s, epsilon):
    """Term of Y_epsilon, (11) and (25)."""
    M_inverse = np.linalg.inv(s.M)
    A_hat = s.A @ M_inverse @ s.H
    return A_hat @ delassus_inverse(s.H.T @ M_inverse @ s.H, epsilon) @ A_hat.T


def smooth_enriched(s, epsilon, eta):
    """Term of Y_epsilon,eta, (22)."""
    M_inverse = np.linalg.inv(s.M)
    A_hat = s.A @ M_inverse @ s.H
    W_inverse = delassus_inverse(s.H.T @ M_inverse @ s.H, epsilon)
    return s.A @ enriched_mass_inverse(s, eta) @ s.H @ ((1 - epsilon / eta) * W_inverse) @ A_hat.T


def nonsmooth_generic(s, active, epsilon):
    """Term of Ybar, (31), the active contacts having the flexibility epsilon (0 in print)."""
    M_inverse = np.linalg.inv(s.M)
    G = s.H[:, active[s.contacts]]
    A_bar = s.A @ M_inverse @ G
    return A_bar @ delassus_inverse(G.T @ M_inverse @ G, epsilon) @ A_bar.T


def nonsmooth_enriched(s, active, epsilon, eta):
    """Term of Ybar_eta, (35)-(36), the active contacts having the flexibility epsilon (0 in print).

    As printed, the last G_E of (36) has no transpose; here G_E^T, which the shapes require."""
    M_inverse = np.linalg.inv(s.M)
    C = np.eye(s.H.shape[1])[:, active[s.contacts]]
    G = s.H @ C
    W_inverse = delassus_inverse(G.T @ M_inverse @ G, epsilon)
    Z = (C @ W_inverse @ G.T @ M_inverse
         + (s.H.T @ M_inverse @ G @ W_inverse @ G.T @ M_inverse - s.H.T @ M_inverse) / eta)
    return s.A @ enriched_mass_inverse(s, eta) @ s.H @ Z @ s.A.T


def contraction_matrix(subdomains, active, epsilon, eta):
    """B = P^-1 Y; active None: the whole network in both stages."""
    if active is None and math.isinf(eta):
        Y = sum(smooth_generic(s, epsilon) for s in subdomains)
    elif active is None:
        Y = sum(smooth_enriched(s, epsilon, eta) for s in subdomains)
    elif math.isinf(eta):
        Y = sum(nonsmooth_generic(s, active, epsilon) for s in subdomains)
    else:
        Y = sum(nonsmooth_enriched(s, active, epsilon, eta) for s in subdomains)
    return np.linalg.inv(interface_operator(subdomains, eta)) @ Y


def real_spectrum(B):
    """Eigenvalues in increasing order; imaginary parts must be rounding, the pencil being
    symmetric in exact arithmetic."""
    eigenvalues = np.linalg.eigvals(B)
    scale = max(1.0, np.abs(eigenvalues).max())
    if np.abs(eigenvalues.imag).max() > 1e-7 * scale:
        raise ArithmeticError(f"complex eigenvalues: {eigenvalues[np.abs(eigenvalues.imag) > 0]}")
    return np.sort(eigenvalues.real)


def evaluate(packing, options):
    """Rows of the table, one per (epsilon, eta)."""
    contacts = find_contacts(packing, options.tolerance)
    if not contacts:
        raise InputError("the packing has no contact")
    active = (active_contacts(packing, contacts, options.prescribed)
              if options.contacts == "active" else None)
    subdomains, owner_counts = decompose(packing, contacts, options.subdomains)
    interface_dofs = subdomains[0].A.shape[0]
    if interface_dofs == 0:
        raise InputError("the interface is empty: no grain belongs to two subdomains")
    print(f"{len(packing.radii)} grains, {len(contacts)} contacts"
          + (f", {int(active.sum())} of them active" if active is not None else "")
          + f", {len(subdomains)} subdomains, {sum(q > 1 for q in owner_counts)} interface grains, "
          f"{sum(q > 2 for q in owner_counts)} cross points", file=sys.stderr)

    rows = []
    for epsilon in options.epsilon:
        for eta in options.eta:
            spectrum = real_spectrum(contraction_matrix(subdomains, active, epsilon, eta))
            rows.append({"contact_set": options.contacts, "epsilon": epsilon, "eta": eta,
                         "spectral_radius": float(np.abs(spectrum).max()),
                         "eigenvalue_min": float(spectrum[0]),
                         "eigenvalue_max": float(spectrum[-1]),
                         "grains": len(packing.radii), "contacts": len(contacts),
                         "subdomains": len(subdomains), "interface_dofs": interface_dofs})
    return rows


def write_table(rows, stream):
    writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: repr(value) if isinstance(value, float) else value
                      for name, value in row.items()} for row in rows)


# Comparison with a program

def sweep_command(options):
    def join(values):
        return ",".join(repr(value) for value in values)
    command = [options.check, "sweep", options.packing,
               "--subdomains", "x".join(map(str, options.subdomains)),
               "--epsilon", join(options.epsilon), "--eta", join(options.eta),
               "--contacts", options.contacts]
    for grain, velocity in options.prescribed:
        command += ["--prescribed", ":".join([str(grain), *map(repr, velocity)])]
    return command + ["--csv", "-"]


def run_program(command):
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        return None, f"cannot run {' '.join(command)}: {error}"
    if done.returncode != 0:
        return None, f"{' '.join(command)}\n  exit code {done.returncode}: {done.stderr.strip()}"
    try:
        return {(row["contact_set"], float(row["epsilon"]), float(row["eta"])): row
                for row in csv.DictReader(io.StringIO(done.stdout))}, None
    except (KeyError, TypeError, ValueError) as error:
        return None, (f"{' '.join(command)}\n  the table cannot be read (columns contact_set, "
                      f"epsilon, eta expected): {error!r}")


def expected_values(row, met):
    """Values to compare, by column.

    Where the program announces unit eigenvalues (rigid limit, interface forces that hyperstatic
    networks carry either way), the largest eigenvalue is 1 exactly and so is the radius, unless
    an active set and a small eta push the other end below -1.  That it is 1 must hold here too."""
    if float(met.get("unit_multiplicity") or 0) <= 0:
        return {name: row[name] for name in COMPARED}
    if not abs(row["eigenvalue_max"] - 1.0) <= TOLERANCE:
        raise ValueError(f"unit_multiplicity {met['unit_multiplicity']} where the largest "
                         f"eigenvalue is {row['eigenvalue_max']!r}")
    return {"spectral_radius": max(1.0, abs(row["eigenvalue_min"])), "eigenvalue_max": 1.0}


def check_program(rows, options):
    table, failure = run_program(sweep_command(options))
    messages = [failure] if failure else []
    differences = []
    for row in rows if table is not None else []:
        key = (row["contact_set"], row["epsilon"], row["eta"])
        place = f"contacts={key[0]} epsilon={key[1]!r} eta={key[2]!r}"
        if key not in table:
            messages.append(f"{place}: no such row in the program's table")
            continue
        met = table[key]
        try:
            pairs = {name: (value, float(met[name]))
                     for name, value in expected_values(row, met).items()}
        except (KeyError, TypeError, ValueError) as error:
            messages.append(f"{place}: row cannot be compared: {error!r}")
            continue
        for name, (value, value_met) in pairs.items():
            difference = abs(value_met - value)
            if math.isfinite(difference):
                differences.append(difference)
            if not difference <= TOLERANCE:
                messages.append(f"{place} {name}: expected {value!r}, met {value_met!r}, "
                                f"difference {difference:.3e}")
    for message in messages:
        print(message, file=sys.stderr)
    if not differences:
        print("nothing was compared", file=sys.stderr)
        return 1
    print(f"{len(differences)} values in {len(rows)} rows compared, "
          f"largest difference {max(differences):.3e}, tolerance {TOLERANCE:.0e}")
    return 1 if messages else 0


# Random test packings

def random_hexagonal(generator, grain_count):
    """A nearly square piece of the hexagonal lattice, unit diameters, one site in six vacant."""
    site_count = math.ceil(1.2 * grain_count)
    columns = max(1, round(math.sqrt(site_count * math.sqrt(3) / 2)))
    sites = [(k % columns + 0.5 * (k // columns % 2), k // columns * math.sqrt(3) / 2)
             for k in range(site_count)]
    kept = np.sort(generator.choice(site_count, grain_count, replace=False))
    return np.array(sites)[kept], np.full(grain_count, 0.5)


def random_fcc(generator, grain_count):
    """A piece of face-centred cubic lattice as wide as high, unit diameters, one site in six
    vacant.  Its (001) layers lie one in the hollows of the other."""
    site_count = math.ceil(1.2 * grain_count)
    side = max(2, round(site_count ** (1 / 3)))
    sites = [(k % side + 0.5 * (k // side**2 % 2), k // side % side + 0.5 * (k // side**2 % 2),
              k // side**2 * math.sqrt(0.5)) for k in range(site_count)]
    kept = np.sort(generator.choice(site_count, grain_count, replace=False))
    return np.array(sites)[kept], np.full(grain_count, 0.5)


def tangent_centre(centres, radii, i, j, radius, side):
    """Centre of the disk tangent to disks i and j, on the given side of the line through them."""
    a, b = radii[i] + radius, radii[j] + radius
    difference = centres[j] - centres[i]
    distance = np.linalg.norm(difference)
    along = (a * a - b * b + distance * distance) / (2 * distance)
    height_squared = a * a - along * along
    if height_squared <= 0:
        return None
    tangent = difference / distance
    normal = np.array([-tangent[1], tangent[0]])
    return centres[i] + along * tangent + side * math.sqrt(height_squared) * normal


def random_growth(generator, grain_count):
    """Random radii; every disk from the third on touches exactly two earlier ones: 2n - 3
    contacts and an isostatic network.  The free place nearest to the origin is taken."""
    radii = generator.uniform(0.3, 0.7, grain_count)
    centres = np.zeros((grain_count, 2))
    if grain_count > 1:
        centres[1] = (radii[0] + radii[1], 0.0)
    for new in range(2, grain_count):
        best = None
        for i in range(new):
            for j in range(i + 1, new):
                for side in (-1, 1):
                    centre = tangent_centre(centres, radii, i, j, radii[new], side)
                    if centre is None or (best is not None
                                          and np.linalg.norm(centre) >= np.linalg.norm(best)):
                        continue
                    gaps = (np.linalg.norm(centres[:new] - centre, axis=1)
                            - radii[:new] - radii[new])
                    gaps[[i, j]] = np.inf
                    # Far from touching the others: no doubt about the contact list.
                    if gaps.min() > 1e-3:
                        best = centre
        if best is None:
            raise InputError(f"--random: no free place for grain {new}; take another seed")
        centres[new] = best
    return centres, radii


def tangent_centres(centres, radii, earlier, radius):
    """Both centres of the sphere tangent to three earlier ones; none, where there are no such
    places.  Differences of the squared distances are linear in the centre."""
    base = centres[earlier[0]]
    edges = centres[earlier[1:]] - base
    reach = radii[earlier] + radius
    right = (reach[0] ** 2 - reach[1:] ** 2 + (edges ** 2).sum(axis=1)) / 2
    along = np.linalg.lstsq(edges, right, rcond=None)[0]
    normal = np.cross(edges[0], edges[1])
    height_squared = reach[0] ** 2 - along @ along
    if height_squared <= 0 or np.linalg.norm(normal) < 1e-6:
        return []
    step = math.sqrt(height_squared) * normal / np.linalg.norm(normal)
    return [base + along - step, base + along + step]


def random_growth_in_space(generator, grain_count):
    """Random radii; the first three spheres touch each other, every later one touches exactly
    three earlier ones: 3n - 6 contacts.  Of 200 triples of neighbours drawn at random the free place
    nearest to the origin is taken."""
    radii = generator.uniform(0.3, 0.7, grain_count)
    centres = np.zeros((grain_count, 3))
    if grain_count < 3:
        raise InputError("--space: three grains expected at least")
    first, second, third = radii[:3]
    centres[1, 0] = first + second
    x = ((first + third) ** 2 - (second + third) ** 2 + centres[1, 0] ** 2) / (2 * centres[1, 0])
    centres[2, :2] = x, math.sqrt((first + third) ** 2 - x * x)
    for new in range(3, grain_count):
        best = None
        for _ in range(200):
            about = centres[generator.integers(new)]
            near = np.argsort(np.linalg.norm(centres[:new] - about, axis=1))[:8]
            earlier = np.sort(generator.choice(near, 3, replace=False))
            for centre in tangent_centres(centres, radii, earlier, radii[new]):
                gaps = np.linalg.norm(centres[:new] - centre, axis=1) - radii[:new] - radii[new]
                gaps[earlier] = np.inf
                nearer = best is None or np.linalg.norm(centre) < np.linalg.norm(best)
                # Far from touching the others: no doubt about the contact list.
                if nearer and gaps.min() > 1e-3:
                    best = centre
        if best is None:
            raise InputError(f"--random: no free place for grain {new}; take another seed")
        centres[new] = best
    return centres, radii


def write_random_packing(options):
    generator = np.random.default_rng(options.random)
    if options.space:
        make = random_fcc if options.lattice else random_growth_in_space
    else:
        make = random_hexagonal if options.lattice else random_growth
    centres, radii = make(generator, options.grains)
    masses = generator.uniform(0.5, 2.0, options.grains)
    with open(options.write, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow((*("x", "y", "z")[:centres.shape[1]], "radius", "mass"))
        for centre, radius, mass in zip(centres, radii, masses):
            writer.writerow([repr(float(value)) for value in (*centre, radius, mass)])


# Command line

def number_list(text):
    values = [float(word) for word in text.split(",")]
    if any(math.isnan(value) or value < 0 for value in values):
        raise ValueError(text)
    return values


def flexibility_list(text):
    values = number_list(text)
    if any(math.isinf(value) for value in values):
        raise ValueError(text)
    return values


def positive_list(text):
    values = number_list(text)
    if not all(values):
        raise ValueError(text)
    return values


def grid_size(text):
    cells = tuple(int(word) for word in text.split("x"))
    if len(cells) not in (2, 3) or min(cells) < 1:
        raise ValueError(text)
    return cells


def prescribed_velocity(text):
    grain, *velocity = text.split(":")
    return int(grain), tuple(map(float, velocity))


def parse_options():
    parser = argparse.ArgumentParser(
        description="The paper's contraction matrices, literal and dense.")
    parser.add_argument("packing", nargs="?", metavar="PACKING.csv")
    parser.add_argument("--subdomains", type=grid_size, default=(2, 1), metavar="NXxNY")
    parser.add_argument("--epsilon", type=flexibility_list, default=[0.0], metavar="LIST")
    parser.add_argument("--eta", type=positive_list, default=[math.inf], metavar="LIST")
    parser.add_argument("--contacts", choices=("all", "active"), default="all")
    parser.add_argument("--prescribed", type=prescribed_velocity, action="append", default=[],
                        metavar="GRAIN:VX:VY")
    parser.add_argument("--tolerance", type=float, default=1e-7)
    parser.add_argument("--check", metavar="PROGRAM")
    parser.add_argument("--random", type=int, metavar="SEED")
    parser.add_argument("--grains", type=int, metavar="N")
    parser.add_argument("--space", action="store_true")
    parser.add_argument("--lattice", action="store_true")
    parser.add_argument("--write", metavar="FILE")
    options = parser.parse_args()
    if options.random is not None:
        if options.packing or not options.write or not options.grains or options.grains < 1:
            parser.error("--random SEED goes with --grains N (at least 1) and --write FILE, "
                         "without a packing to read")
    elif not options.packing:
        parser.error("PACKING.csv or --random expected")
    return options


def main():
    options = parse_options()
    try:
        if options.random is not None:
            write_random_packing(options)
            return 0
        rows = evaluate(read_packing(options.packing), options)
    except (InputError, OSError, ArithmeticError, np.linalg.LinAlgError) as error:
        print(error, file=sys.stderr)
        return 2
    if options.check:
        return check_program(rows, options)
    write_table(rows, sys.stdout)
    return 0


if __name__ == "__main__":
    sys.exit(main())
