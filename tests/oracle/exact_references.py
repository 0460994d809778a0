#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact reference spectra of the contraction matrices: three triangular strips, four packings of spheres.

The paper's formulas (P. Alart, D. Iceta, D. Dureisseix, "A nonlinear Domain Decomposition
formulation with application to granular dynamics", 2012; [ADI12] below) are evaluated as
printed, misprints corrected, in exact arithmetic over the field Q(sqrt 3), where all the
coordinates of the strips live.  The characteristic polynomial is exact too; its roots are
isolated by Sturm sequences and bisected with exact signs, so that every printed digit is
certified and no floating-point number takes part.

Example "disksN": N disks of unit diameter and unit mass, grain i at (i/2, (i mod 2) sqrt(3)/2),
2N - 3 contacts, two subdomains cut by the vertical line through the middle of the bounding box
of the centres; the contact whose midpoint is on the line belongs to the left.  The active
contacts are those in compression, r > 0, in W r = -H^T V^-, the last grain arriving at (-1, 0).

Spheres of unit diameter and unit mass, cut by a grid over the bounding box of the centres, a contact
on a line belonging to the lower cell:
  tetrahedra   two tetrahedra that share a face, one sphere below and the last above: 9 contacts
  octahedron   6 spheres, a horizontal square with one below and the last above: 12 contacts
  cube         8 spheres at the corners of a cube: 12 contacts, hypostatic; 2 x 2 x 1 subdomains
  fcc13        a sphere and its 12 neighbours in the face-centred cubic lattice: 36 contacts,
               three more than 13 spheres can balance
The first, second and fourth are cut in two by a horizontal plane.  In the first two the last sphere
arrives at (0, 0, -1).  Their coordinates lie in other fields than Q(sqrt 3), axis by axis: x, y, z
in multiples of 1, sqrt 3, sqrt 6 (tetrahedra) or of 1, 1, sqrt 2 (octahedron, fcc13).  With these
roots in the diagonal matrix Q, of one block per grain, all formulas are evaluated for Q^-1 H and
Q^-1 M Q^-1, which are rational.  A commutes with Q, so that every interface operator becomes
Q X Q, and the eigenvalues of a pencil stay.

Usage:
  exact_references.py                             CSV of the references on standard output
  exact_references.py --schwarz                   CSV of those of the scheme schwarz: block Jacobi
                                                  J = I - (D + epsilon)^-1 (W + epsilon)
  exact_references.py --self-test                 closed forms and identities, exactly
  exact_references.py --check PROGRAM --cases DIR compare "PROGRAM sweep DIR/disksN.toml ..." and
                                                  sweeps of packing files of the spheres with the
                                                  references, to 1e-12

Columns: case, contact_set (all | active), epsilon (0: rigid), eta (inf: generic algorithm),
spectral_radius, eigenvalue_min, eigenvalue_max: of B, 30 significant digits.

Exit code: 0 done, 1 a check failed, 2 wrong usage.  Standard library only (Python 3.11).
"""

import argparse
import csv
import io
import math
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from decimal import Context, Decimal, InvalidOperation
from fractions import Fraction
from functools import reduce
from pathlib import Path

GRAIN_COUNTS = {"disks4": 4, "disks8": 8, "disks12": 12}
PRINTED_DIGITS = 30
ROOT_DIGITS = 40
TOLERANCE = Decimal("1e-12")
COLUMNS = ("case", "contact_set", "epsilon", "eta",
           "spectral_radius", "eigenvalue_min", "eigenvalue_max")
COMPARED = ("spectral_radius", "eigenvalue_min", "eigenvalue_max")


# The field Q(sqrt 3)

class Surd:
    """(rational + irrational * sqrt 3) / denominator, three integers in lowest terms."""

    __slots__ = ("rational", "irrational", "denominator")

    def __init__(self, rational, irrational=0, denominator=1):
        common = math.gcd(rational, irrational, denominator)
        if denominator < 0:
            common = -common
        self.rational = rational // common
        self.irrational = irrational // common
        self.denominator = denominator // common

    @staticmethod
    def of(value):
        if isinstance(value, Surd):
            return value
        fraction = Fraction(value)
        return Surd(fraction.numerator, 0, fraction.denominator)

    def __add__(self, other):
        other = Surd.of(other)
        return Surd(self.rational * other.denominator + other.rational * self.denominator,
                    self.irrational * other.denominator + other.irrational * self.denominator,
                    self.denominator * other.denominator)

    def __neg__(self):
        return Surd(-self.rational, -self.irrational, self.denominator)

    def __sub__(self, other):
        return self + (-Surd.of(other))

    def __mul__(self, other):
        other = Surd.of(other)
        return Surd(self.rational * other.rational + 3 * self.irrational * other.irrational,
                    self.rational * other.irrational + self.irrational * other.rational,
                    self.denominator * other.denominator)

    __rmul__ = __mul__

    def inverse(self):
        # The norm p^2 - 3 q^2 vanishes for p = q = 0 only, sqrt 3 being irrational.
        norm = self.rational ** 2 - 3 * self.irrational ** 2
        if norm == 0:
            raise ZeroDivisionError("division by zero in Q(sqrt 3)")
        return Surd(self.denominator * self.rational, -self.denominator * self.irrational, norm)

    def __truediv__(self, other):
        return self * Surd.of(other).inverse()

    def __bool__(self):
        return self.rational != 0 or self.irrational != 0

    def __eq__(self, other):
        return not self - other

    __hash__ = None

    def sign(self):
        return sign_of_surd(self.rational, self.irrational)


def sign_of_surd(rational, irrational):
    """Sign of rational + irrational * sqrt 3 (integers), without approximation."""
    rational_sign = (rational > 0) - (rational < 0)
    irrational_sign = (irrational > 0) - (irrational < 0)
    if rational_sign * irrational_sign >= 0:
        return rational_sign or irrational_sign
    return rational_sign if rational ** 2 > 3 * irrational ** 2 else irrational_sign


ZERO = Surd(0)
ONE = Surd(1)


# Dense matrices over the field: lists of rows

def zeros(rows, columns):
    return [[ZERO] * columns for _ in range(rows)]


def identity(size):
    return [[ONE if i == j else ZERO for j in range(size)] for i in range(size)]


def transpose(matrix):
    return [list(column) for column in zip(*matrix)]


def add(left, right):
    return [[a + b for a, b in zip(*rows)] for rows in zip(left, right)]


def scale(factor, matrix):
    factor = Surd.of(factor)
    return [[factor * entry if entry else ZERO for entry in row] for row in matrix]


def subtract(left, right):
    return add(left, scale(-1, right))


def product(first, *others):
    """Product from left to right: thin left factors keep the exact integers few and short."""
    result = first
    for factor in others:
        columns = len(factor[0])
        rows = []
        for row in result:
            total = [ZERO] * columns
            for entry, factor_row in zip(row, factor):
                if entry:
                    total = [t + entry * f if f else t for t, f in zip(total, factor_row)]
            rows.append(total)
        result = rows
    return result


def inverse(matrix):
    """Gauss-Jordan elimination; any non-zero pivot will do, the arithmetic being exact."""
    size = len(matrix)
    work = [list(row) + unit for row, unit in zip(matrix, identity(size))]
    for column in range(size):
        pivot = next((row for row in range(column, size) if work[row][column]), None)
        if pivot is None:
            raise ZeroDivisionError("singular matrix")
        work[column], work[pivot] = work[pivot], work[column]
        factor = work[column][column].inverse()
        work[column] = [factor * entry if entry else ZERO for entry in work[column]]
        for row in range(size):
            multiplier = work[row][column]
            if row != column and multiplier:
                work[row] = [entry - multiplier * pivot_entry if pivot_entry else entry
                             for entry, pivot_entry in zip(work[row], work[column])]
    return [row[size:] for row in work]


def equal(left, right):
    return all(a == b for rows in zip(left, right) for a, b in zip(*rows))


# The packings: M_E, H_E, A_E and the active contacts

@dataclass
class Shape:
    """Touching grains of unit diameter and unit mass, how they are cut and what arrives."""
    centres: list             # one tuple of Surd per grain, in multiples of the roots of `squares`
    squares: tuple            # of the unit of each axis
    grid: tuple               # cells along each axis
    arrival: tuple | None     # velocity of the last grain, in the same units; None: no active set

    @property
    def dimension(self):
        return len(self.squares)


@dataclass
class Subdomain:
    """Split inertia M_E, kinematics H_E (v_E = H_E^T V_E) and signed boolean gluing A_E."""
    M: list         # d n_E x d n_E, diagonal
    H: list         # d n_E x c_E
    A: list         # n_Gamma x d n_E
    contacts: list  # global numbers of the c_E contacts


@dataclass
class Strip:
    """A packing with its subdomains."""
    contacts: list    # (i, j), i < j
    active: list      # one truth value per contact, all true without an arrival
    subdomains: list


def strip_shape(grain_count):
    centres = [(Surd(i, 0, 2), Surd(0, i % 2, 2)) for i in range(grain_count)]
    return Shape(centres, (1, 1), (2, 1), (-1, 0))


def rational_centres(*places):
    return [tuple(Surd.of(Fraction(word)) for word in place.split()) for place in places]


def sphere_shapes():
    third, sixth = Fraction(1, 3), Fraction(1, 6)
    corners = [f"{x} {y} {z}" for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    hollows = {level: [f"{x} {y} {level}" for y in ("-1/2", "1/2") for x in ("-1/2", "1/2")]
               for level in ("-1/2", "1/2")}
    return {
        "tetrahedra": Shape(
            rational_centres(f"1/2 {sixth} {-third}", "0 0 0", "1 0 0", "1/2 1/2 0",
                             f"1/2 {sixth} {third}"),
            (1, 3, 6), (1, 1, 2), (0, 0, -1)),
        "octahedron": Shape(
            rational_centres("1/2 1/2 -1/2", "0 0 0", "1 0 0", "0 1 0", "1 1 0", "1/2 1/2 1/2"),
            (1, 1, 2), (1, 1, 2), (0, 0, -1)),
        "cube": Shape(rational_centres(*corners), (1, 1, 1), (2, 2, 1), None),
        "fcc13": Shape(
            rational_centres(*hollows["-1/2"], "0 -1 0", "-1 0 0", "0 0 0", "1 0 0", "0 1 0",
                             *hollows["1/2"]),
            (1, 1, 2), (1, 1, 2), None),
    }


def all_shapes():
    return {**{case: strip_shape(n) for case, n in GRAIN_COUNTS.items()}, **sphere_shapes()}


def kinematics(shape, contacts, grains):
    """H: the unit normal from i to j on the rows of j, its opposite on those of i.

    v = H^T V is then the opening velocity and r > 0 pushes the two grains apart."""
    dimension = shape.dimension
    row_of = {grain: dimension * position for position, grain in enumerate(grains)}
    H = zeros(dimension * len(grains), len(contacts))
    for column, (i, j) in enumerate(contacts):
        for axis in range(dimension):
            # The centres are at unit distance: their difference is the unit normal.
            normal = shape.centres[j][axis] - shape.centres[i][axis]
            H[row_of[j] + axis][column] = normal
            H[row_of[i] + axis][column] = -normal
    return H


def diagonal_mass(shape, masses):
    diagonal = [Surd.of(Fraction(mass) / square) for mass in masses for square in shape.squares]
    return [[entry if i == j else ZERO for j in range(len(diagonal))]
            for i, entry in enumerate(diagonal)]


def impact_impulses(shape, contacts):
    """Solution r of W r = -H^T V^-, undivided packing, up to a positive factor."""
    grain_count = len(shape.centres)
    H = kinematics(shape, contacts, range(grain_count))
    M = diagonal_mass(shape, [1] * grain_count)
    arrival = zeros(shape.dimension * (grain_count - 1), 1) + [[Surd(v)] for v in shape.arrival]
    delassus = product(transpose(H), inverse(M), H)
    return product(inverse(delassus), scale(-1, product(transpose(H), arrival)))


def cell_of_midpoint(shape, i, j):
    """Cell along each axis; a midpoint on a line belongs to the lower one."""
    cell = []
    for axis, cells in enumerate(shape.grid):
        places = [centre[axis] for centre in shape.centres]
        lower = upper = places[0]
        for place in places:
            lower = place if (place - lower).sign() < 0 else lower
            upper = place if (place - upper).sign() > 0 else upper
        doubled = places[i] + places[j] - lower - lower
        cell.append(sum((doubled - 2 * Fraction(line, cells) * (upper - lower)).sign() > 0
                        for line in range(1, cells)))
    return tuple(reversed(cell))


def build_packing(shape):
    centres, dimension = shape.centres, shape.dimension
    grain_count = len(centres)
    contacts = []
    for i in range(grain_count):
        for j in range(i + 1, grain_count):
            difference = [centres[j][axis] - centres[i][axis] for axis in range(dimension)]
            distance_squared = sum((square * (d * d)
                                    for square, d in zip(map(Surd.of, shape.squares), difference)), ZERO)
            if distance_squared == ONE:
                contacts.append((i, j))

    active = [True] * len(contacts)
    if shape.arrival is not None:
        active = [impulse[0].sign() > 0 for impulse in impact_impulses(shape, contacts)]

    cell_of = [cell_of_midpoint(shape, i, j) for i, j in contacts]
    cells = sorted(set(cell_of))
    grains_of = {cell: sorted({grain for contact, owner in zip(contacts, cell_of)
                               if owner == cell for grain in contact}) for cell in cells}
    sharing = [[cell for cell in cells if grain in grains_of[cell]]
               for grain in range(grain_count)]
    interface_size = dimension * sum(len(owners) - 1 for owners in sharing)

    subdomains = []
    for cell in cells:
        numbers = [k for k, owner in enumerate(cell_of) if owner == cell]
        grains = grains_of[cell]
        M = diagonal_mass(shape, [Fraction(1, len(sharing[grain])) for grain in grains])
        H = kinematics(shape, [contacts[k] for k in numbers], grains)
        subdomains.append(Subdomain(M, H, zeros(interface_size, dimension * len(grains)), numbers))

    # Chain: V of the k-th owner of a grain minus V of its (k+1)-th owner, (6).
    row = 0
    for grain, owners in enumerate(sharing):
        for upper, lower in zip(owners, owners[1:]):
            for axis in range(dimension):
                for cell, sign in ((upper, 1), (lower, -1)):
                    column = dimension * grains_of[cell].index(grain) + axis
                    subdomains[cells.index(cell)].A[row][column] = Surd(sign)
                row += 1
    return Strip(contacts, active, subdomains)


def independent(H):
    """The columns of H that those before do not span: the rigid limit depends on their span alone."""
    kept, reduced = [], []  # reduced: (pivot row, column without the pivots before)
    for number, column in enumerate(transpose(H)):
        for pivot, other in reduced:
            if column[pivot]:
                factor = column[pivot] / other[pivot]
                column = [a - factor * b if b else a for a, b in zip(column, other)]
        pivot = next((row for row, entry in enumerate(column) if entry), None)
        if pivot is not None:
            reduced.append((pivot, column))
            kept.append(number)
    return kept


def selection(strip, subdomain, contact_set):
    """C_E, c_E x (number of active contacts): G_E = H_E C_E, (28)."""
    kept = [local for local, number in enumerate(subdomain.contacts)
            if contact_set == "all" or strip.active[number]]
    return [[ONE if local == other else ZERO for other in kept]
            for local in range(len(subdomain.contacts))]


# The paper's matrices.  A contraction matrix is P^-1 Y, the pair (P, Y) is returned.

def enriched_mass(subdomain, flexibility):
    """M_E + K_E / flexibility, (23)-(24)."""
    K = product(subdomain.H, transpose(subdomain.H))
    return add(subdomain.M, scale(Fraction(1) / flexibility, K))


def interface_operator(strip, eta):
    """X_eta = sum A_E M_E,eta^-1 A_E^T, (21); eta None: X, with M_E."""
    return reduce(add, (product(s.A, inverse(s.M if eta is None else enriched_mass(s, eta)), transpose(s.A))
                        for s in strip.subdomains))


def carrying(subdomain, epsilon):
    """H_E, without dependent columns in the rigid limit, where W_E would be singular."""
    if epsilon:
        return subdomain.H
    kept = independent(subdomain.H)
    return [[row[k] for k in kept] for row in subdomain.H]


def smooth_generic(strip, epsilon):
    """(10)-(11); epsilon = 0 is (25)."""
    def term(s):
        mass_inverse = inverse(s.M)
        H = carrying(s, epsilon)
        A_hat = product(s.A, mass_inverse, H)
        W = product(transpose(H), mass_inverse, H)
        W_epsilon = add(W, scale(epsilon, identity(len(W))))
        return product(A_hat, inverse(W_epsilon), transpose(A_hat))
    return interface_operator(strip, None), reduce(add, map(term, strip.subdomains))


def smooth_enriched(strip, epsilon, eta):
    """(20)-(24)."""
    def term(s):
        mass_inverse = inverse(s.M)
        H = carrying(s, epsilon)
        A_hat = product(s.A, mass_inverse, H)
        W = product(transpose(H), mass_inverse, H)
        W_epsilon = add(W, scale(epsilon, identity(len(W))))
        left = product(s.A, inverse(enriched_mass(s, eta)), H)
        return scale(1 - epsilon / eta, product(left, inverse(W_epsilon), transpose(A_hat)))
    return interface_operator(strip, eta), reduce(add, map(term, strip.subdomains))


def nonsmooth_generic(strip, contact_set, epsilon):
    """(31), the active contacts having the flexibility epsilon (0 in print)."""
    def term(s):
        mass_inverse = inverse(s.M)
        G = product(s.H, selection(strip, s, contact_set))
        A_bar = product(s.A, mass_inverse, G)
        W_bar = product(transpose(G), mass_inverse, G)
        W_bar = add(W_bar, scale(epsilon, identity(len(W_bar))))
        return product(A_bar, inverse(W_bar), transpose(A_bar))
    return interface_operator(strip, None), reduce(add, map(term, strip.subdomains))


def nonsmooth_enriched(strip, contact_set, epsilon, eta):
    """(34)-(36), the active contacts having the flexibility epsilon (0 in print).

    As printed, the last G_E of (36) has no transpose; here G_E^T, which the shapes require.
    With epsilon > 0 the derivation of (33) is unchanged: Stage 1 gives
    r_E = (Wbar_E + epsilon I)^-1 G_E^T M_E^-1 A_E^T F up to a constant."""
    def term(s):
        mass_inverse = inverse(s.M)
        C = selection(strip, s, contact_set)
        G = product(s.H, C)
        W_bar = product(transpose(G), mass_inverse, G)
        W_bar = add(W_bar, scale(epsilon, identity(len(W_bar))))
        impulses = product(inverse(W_bar), transpose(G), mass_inverse)
        kinematic = subtract(product(transpose(s.H), mass_inverse, G, impulses),
                             product(transpose(s.H), mass_inverse))
        Z = add(product(C, impulses), scale(Fraction(1) / eta, kinematic))
        return product(s.A, inverse(enriched_mass(s, eta)), s.H, Z, transpose(s.A))
    return interface_operator(strip, eta), reduce(add, map(term, strip.subdomains))


def contraction_pencil(strip, contact_set, epsilon, eta):
    if contact_set == "all":
        return smooth_generic(strip, epsilon) if eta is None else smooth_enriched(strip, epsilon, eta)
    if eta is None:
        return nonsmooth_generic(strip, contact_set, epsilon)
    return nonsmooth_enriched(strip, contact_set, epsilon, eta)


def schwarz_pencil(shape, strip, epsilon):
    """(D + epsilon, D - W) with whole masses: J = (D + epsilon)^-1 (D - W) of all contacts."""
    owners, numbers = [], []
    for owner, s in enumerate(strip.subdomains):
        kept = range(len(s.contacts)) if epsilon else independent(s.H)
        owners += [owner] * len(kept)
        numbers += [s.contacts[k] for k in kept]
    grains = range(len(shape.centres))
    H = kinematics(shape, [strip.contacts[k] for k in numbers], grains)
    W = product(transpose(H), inverse(diagonal_mass(shape, [1 for _ in grains])), H)
    D = [[entry if owners[i] == owners[j] else ZERO for j, entry in enumerate(row)]
         for i, row in enumerate(W)]
    return add(D, scale(epsilon, identity(len(D)))), subtract(D, W)


# Polynomials over the field: coefficients from the constant term upwards

def trimmed(polynomial):
    last = len(polynomial)
    while last and not polynomial[last - 1]:
        last -= 1
    return polynomial[:last]


def monic(polynomial):
    factor = polynomial[-1].inverse()
    return [factor * coefficient for coefficient in polynomial]


def multiply_polynomials(left, right):
    result = [ZERO] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            result[i + j] = result[i + j] + a * b
    return result


def derivative(polynomial):
    return [coefficient * power for power, coefficient in enumerate(polynomial)][1:]


def divide(dividend, divisor):
    """Quotient and remainder."""
    remainder = list(dividend)
    quotient = [ZERO] * max(len(dividend) - len(divisor) + 1, 0)
    for shift in reversed(range(len(quotient))):
        factor = remainder[shift + len(divisor) - 1] / divisor[-1]
        quotient[shift] = factor
        for power, coefficient in enumerate(divisor):
            remainder[shift + power] = remainder[shift + power] - factor * coefficient
    return quotient, trimmed(remainder)


def greatest_common_divisor(left, right):
    while right:
        left, right = right, divide(left, right)[1]
        if right:
            right = monic(right)
    return monic(left)


def characteristic_polynomial(P, Y):
    """det(z I - P^-1 Y), monic, by Faddeev-LeVerrier: exact division by 1, 2, ... only."""
    B = product(inverse(P), Y)
    size = len(B)
    coefficients = [ZERO] * size + [ONE]
    auxiliary = zeros(size, size)
    for step in range(1, size + 1):
        auxiliary = add(product(B, auxiliary), scale(coefficients[size - step + 1], identity(size)))
        trace = sum((row[i] for i, row in enumerate(product(B, auxiliary))), ZERO)
        coefficients[size - step] = -trace / step
    return coefficients


def square_free_factors(polynomial):
    """Yun: [(factor, multiplicity)], the factors square-free and pairwise prime."""
    factors = []
    slope = derivative(polynomial)
    common = greatest_common_divisor(polynomial, slope)
    remaining = divide(polynomial, common)[0]
    reduced_slope = divide(slope, common)[0]
    multiplicity = 1
    while len(remaining) > 1:
        difference = trimmed([(reduced_slope[k] if k < len(reduced_slope) else ZERO) - coefficient
                              for k, coefficient in enumerate(derivative(remaining))])
        factor = greatest_common_divisor(remaining, difference)
        if len(factor) > 1:
            factors.append((factor, multiplicity))
        remaining = divide(remaining, factor)[0]
        reduced_slope = divide(difference, factor)[0] if difference else []
        multiplicity += 1
    return factors


def integer_coefficients(polynomial):
    """A positive multiple with integer coefficients, as pairs (rational, irrational)."""
    common = math.lcm(*(coefficient.denominator for coefficient in polynomial))
    return [(c.rational * (common // c.denominator), c.irrational * (common // c.denominator))
            for c in polynomial]


def sign_at(pairs, point):
    """Sign of the polynomial at a rational point, in integer arithmetic."""
    numerator, denominator = point.numerator, point.denominator
    rational = irrational = 0
    power = 1
    for p, q in reversed(pairs):
        rational = rational * numerator + p * power
        irrational = irrational * numerator + q * power
        power *= denominator
    return sign_of_surd(rational, irrational)


def sturm_chain(polynomial):
    chain = [polynomial, derivative(polynomial)]
    while len(chain[-1]) > 1:
        remainder = divide(chain[-2], chain[-1])[1]
        if not remainder:
            break
        # A positive factor is allowed, and keeps the integers short.
        size = remainder[-1] if remainder[-1].sign() > 0 else -remainder[-1]
        chain.append([-coefficient / size for coefficient in remainder])
    return [integer_coefficients(member) for member in chain]


def sign_changes(chain, point):
    signs = [sign for sign in (sign_at(member, point) for member in chain) if sign]
    return sum(a != b for a, b in zip(signs, signs[1:]))


def roots_in(chain, lower, upper):
    """Number of distinct real roots in (lower, upper]."""
    return sign_changes(chain, lower) - sign_changes(chain, upper)


def root_bound(polynomial):
    """A power of two above all absolute values of the roots (Cauchy)."""
    pairs = integer_coefficients(monic(polynomial))
    leading = abs(pairs[-1][0])  # monic: the last pair is (common denominator, 0)
    return Fraction(2 ** (2 + max((abs(p) + 2 * abs(q)) // leading + 1
                                  for p, q in pairs).bit_length()))


def square_free_roots(polynomial):
    """All roots of a square-free polynomial, which must be real, to ROOT_DIGITS digits.

    Returns rational numbers; exact ones where the bisection meets the root."""
    if not polynomial[0]:
        # Zero is met exactly, and the relative precision of the others makes sense.
        return [Fraction(0)] + square_free_roots(polynomial[1:])
    if len(polynomial) == 1:
        return []
    chain = sturm_chain(polynomial)
    bound = root_bound(polynomial)
    if roots_in(chain, -bound, bound) != len(polynomial) - 1:
        raise ArithmeticError("a contraction matrix has complex eigenvalues")

    isolated = []
    pending = [(-bound, Fraction(0)), (Fraction(0), bound)]
    while pending:
        lower, upper = pending.pop()
        count = roots_in(chain, lower, upper)
        if count == 1:
            isolated.append((lower, upper))
        elif count > 1:
            middle = (lower + upper) / 2
            pending += [(lower, middle), (middle, upper)]
    return [bisect(chain[0], lower, upper) for lower, upper in isolated]


def bisect(pairs, lower, upper):
    """The only root in (lower, upper], an interval on one side of zero."""
    upper_sign = sign_at(pairs, upper)
    if upper_sign == 0:
        return upper
    relative_width = Fraction(1, 10 ** (ROOT_DIGITS + 2))
    while upper - lower > relative_width * min(abs(lower), abs(upper)):
        middle = (lower + upper) / 2
        middle_sign = sign_at(pairs, middle)
        if middle_sign == 0:
            return middle
        if middle_sign == upper_sign:
            upper = middle
        else:
            lower = middle
    return (lower + upper) / 2


def real_roots(polynomial):
    """All roots with their multiplicity, in increasing order."""
    roots = []
    for factor, multiplicity in square_free_factors(polynomial):
        roots += multiplicity * square_free_roots(factor)
    return sorted(roots)


# The table of references

TENS = [Fraction(1, 1000), Fraction(1, 100), Fraction(1, 10),
        Fraction(1), Fraction(10), Fraction(100)]


def requested_points(shape):
    """(contact_set, epsilon, eta) of the table; eta None is the generic algorithm."""
    if shape.dimension == 3:
        points = [("all", Fraction(epsilon), None) for epsilon in (0, Fraction(1, 10), 1)]
        points += [("all", Fraction(epsilon), Fraction(1, 10)) for epsilon in (0, 1)]
        if shape.arrival is not None:
            points += [("active", Fraction(0), eta) for eta in (None, Fraction(10))]
        return points
    points = [("all", epsilon, None) for epsilon in [Fraction(0), *TENS, Fraction(1000)]]
    points += [("all", Fraction(epsilon), eta) for epsilon in (0, 1) for eta in TENS]
    points += [("active", Fraction(0), eta) for eta in [None, *TENS]]
    points += [("active", Fraction(1), eta) for eta in (None, Fraction(1, 10), Fraction(10))]
    return points


def plain_decimal(number, digits=PRINTED_DIGITS):
    """Fraction rounded to significant digits, without an exponent; None is infinity."""
    if number is None:
        return "inf"
    context = Context(prec=digits)
    quotient = context.divide(Decimal(number.numerator), Decimal(number.denominator))
    return format(quotient, "f")


def reference_row(case, strip, contact_set, epsilon, eta):
    return row_of_roots(case, contact_set, epsilon, eta, contraction_pencil(strip, contact_set, epsilon, eta))


def row_of_roots(case, contact_set, epsilon, eta, pencil):
    roots = real_roots(characteristic_polynomial(*pencil))
    radius = max(abs(roots[0]), abs(roots[-1]))
    return {"case": case, "contact_set": contact_set,
            "epsilon": plain_decimal(epsilon), "eta": plain_decimal(eta),
            "spectral_radius": plain_decimal(radius),
            "eigenvalue_min": plain_decimal(roots[0]),
            "eigenvalue_max": plain_decimal(roots[-1])}


def reference_table():
    rows = []
    for case, shape in all_shapes().items():
        strip = build_packing(shape)
        rows += [reference_row(case, strip, *point) for point in requested_points(shape)]
    return rows


def schwarz_table():
    rows = []
    for case, shape in all_shapes().items():
        strip = build_packing(shape)
        for epsilon in (Fraction(0), Fraction(1, 100), Fraction(1)):
            rows.append(row_of_roots(case, "all", epsilon, None, schwarz_pencil(shape, strip, epsilon)))
    return rows


def write_table(rows, stream):
    writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)


# Comparison with a program

def real_number(surd):
    return (surd.rational + surd.irrational * math.sqrt(3)) / surd.denominator


def write_packing(shape, path):
    """The spheres as a packing file, and the options that cut it."""
    roots = [math.sqrt(square) for square in shape.squares]
    with open(path, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(("x", "y", "z", "radius"))
        for centre in shape.centres:
            writer.writerow([repr(root * real_number(c)) for root, c in zip(roots, centre)] + ["0.5"])
    return ["--subdomains", "x".join(map(str, shape.grid))]


def run_sweep(program, case_file, contact_set, rows, options=()):
    """One sweep over the product of the requested epsilon and eta: a superset of the rows."""
    def values(column):
        return ",".join(dict.fromkeys(row[column] for row in rows))
    command = [program, "sweep", case_file, *options, "--epsilon", values("epsilon"),
               "--eta", values("eta"), "--contacts", contact_set, "--csv", "-"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        return None, f"cannot run {' '.join(command)}: {error}"
    if done.returncode != 0:
        return None, (f"{' '.join(command)}\n  exit code {done.returncode}: "
                      f"{done.stderr.strip()}")
    return list(csv.DictReader(io.StringIO(done.stdout))), None


def point_key(row):
    return (row["case"], row["contact_set"], float(row["epsilon"]), float(row["eta"]))


def compare_row(reference, met):
    """List of (difference or None, message or None), one entry per compared value."""
    results = []
    for column in COMPARED:
        place = (f"{reference['case']} contacts={reference['contact_set']} "
                 f"epsilon={reference['epsilon']} eta={reference['eta']} {column}")
        try:
            difference = abs(Decimal(met[column]) - Decimal(reference[column]))
        except (InvalidOperation, TypeError, KeyError):
            results.append((None, f"{place}: expected a number, met {met.get(column)!r}"))
            continue
        if not difference.is_finite():
            results.append((None, f"{place}: expected {reference[column]}, met {met[column]}"))
        elif difference > TOLERANCE:
            results.append((difference, f"{place}: expected {reference[column]}, "
                                        f"met {met[column]}, difference {difference:.3e}"))
        else:
            results.append((difference, None))
    return results


def check_program(program, cases_directory):
    with tempfile.TemporaryDirectory() as folder:
        return check_program_in(folder, program, cases_directory)


def check_program_in(folder, program, cases_directory):
    references = reference_table()
    messages = []
    differences = []
    for case, shape in all_shapes().items():
        case_file = os.path.join(cases_directory, case + ".toml")
        options = ()
        if shape.dimension == 3:
            case_file = os.path.join(folder, case + ".csv")
            options = write_packing(shape, case_file)
        # What arrives is in the case files of the strips; the active sets of the spheres are
        # compared by known_radii_test.cpp.
        for contact_set in ("all", "active") if shape.dimension == 2 else ("all",):
            wanted = [row for row in references
                      if row["case"] == case and row["contact_set"] == contact_set]
            table, failure = run_sweep(program, case_file, contact_set, wanted, options)
            if failure:
                messages.append(failure)
                continue
            try:
                met = {point_key(row): row for row in table}
            except (KeyError, TypeError, ValueError) as error:
                messages.append(f"{case_file} contacts={contact_set}: the table cannot be read "
                                f"(columns case, contact_set, epsilon, eta expected): {error!r}")
                continue
            for reference in wanted:
                key = point_key(reference)
                if key not in met:
                    messages.append(f"{case_file}: no row for case={key[0]} contact_set={key[1]} "
                                    f"epsilon={key[2]} eta={key[3]}")
                    continue
                for difference, message in compare_row(reference, met[key]):
                    if difference is not None:
                        differences.append(difference)
                    if message:
                        messages.append(message)
    for message in messages:
        print(message, file=sys.stderr)
    if not differences:
        print("nothing was compared", file=sys.stderr)
        return 1
    print(f"{len(differences)} values compared, "
          f"largest difference {max(differences):.3e}, tolerance {TOLERANCE}")
    return 1 if messages else 0


# Self-test

def closed_form_disks4(epsilon):
    """det(z I - B_epsilon) for 4 disks, monic: two rational eigenvalues and a quadratic."""
    e = epsilon
    quadratic = [15 * e + 42,
                 -(16 * e ** 2 + 108 * e + 174),
                 4 * e ** 3 + 44 * e ** 2 + 153 * e + 168]
    result = monic([Surd.of(c) for c in quadratic])
    for root in (3 / (5 + 2 * e), 1 / (5 + 2 * e)):
        result = multiply_polynomials(result, [Surd.of(-root), ONE])
    return result


def same_polynomial(left, right):
    return len(left) == len(right) and all(a == b for a, b in zip(left, right))


def largest_root_is(polynomial, value):
    """Exactly: value is a root and no root has a larger absolute value (all roots real)."""
    at_value = sign_at(integer_coefficients(polynomial), value) == 0
    distinct = divide(polynomial, greatest_common_divisor(polynomial, derivative(polynomial)))[0]
    chain = sturm_chain(distinct)
    return at_value and roots_in(chain, -value, value) == len(distinct) - 1


def closed_form_checks(strip):
    for epsilon in [Fraction(0), *TENS, Fraction(1000), Fraction(22, 7)]:
        polynomial = characteristic_polynomial(*smooth_generic(strip, epsilon))
        yield (f"disks4: characteristic polynomial of B_epsilon, epsilon = {epsilon}",
               same_polynomial(polynomial, closed_form_disks4(epsilon)))

    # rho(B_0) = (29 + sqrt 57)/56 is the upper root of 28 z^2 - 29 z + 7, hence a root of the
    # polynomial just verified: the rounded root must agree in all its digits.
    rigid = characteristic_polynomial(*smooth_generic(strip, Fraction(0)))
    remainder = divide(rigid, [Surd(7), Surd(-29), Surd(28)])[1]
    context = Context(prec=ROOT_DIGITS + 10)
    expected = context.divide(context.add(29, context.sqrt(Decimal(57))), Decimal(56))
    met = Decimal(plain_decimal(real_roots(rigid)[-1], ROOT_DIGITS))
    yield ("disks4: rho(B_0) = (29 + sqrt 57)/56",
           not remainder and abs(context.subtract(met, expected)) < Decimal(10) ** -(ROOT_DIGITS - 1))

    yield "disks4: four active contacts", sum(strip.active) == 4
    nonsmooth = characteristic_polynomial(*nonsmooth_generic(strip, "active", Fraction(0)))
    yield "disks4: rho(Bbar) = 3/5", largest_root_is(nonsmooth, Fraction(3, 5))


def flexible_operator(strip, contact_set, epsilon):
    """sum A_E (M_E + G_E G_E^T / epsilon)^-1 A_E^T, epsilon > 0: no Delassus operator in it."""
    def term(s):
        G = product(s.H, selection(strip, s, contact_set))
        mass = add(s.M, scale(Fraction(1) / epsilon, product(G, transpose(G))))
        return product(s.A, inverse(mass), transpose(s.A))
    return reduce(add, map(term, strip.subdomains))


def identity_checks(case, strip):
    """The six matrices are P - Y = one operator, independent of eta; exactly."""
    epsilon, eta = Fraction(3, 7), Fraction(2, 5)
    yield f"{case}: isostatic, 2n - 3 contacts", len(strip.contacts) == 2 * GRAIN_COUNTS[case] - 3
    yield f"{case}: B = 0 for epsilon = eta", not any(
        entry for row in smooth_enriched(strip, eta, eta)[1] for entry in row)
    P, Y = nonsmooth_enriched(strip, "all", epsilon, eta)
    yield (f"{case}: (34)-(36) with G_E = H_E is (20)-(22)",
           all(map(equal, (P, Y), smooth_enriched(strip, epsilon, eta))))
    for contact_set in ("all", "active"):
        for flexibility in (epsilon, Fraction(0)):
            P, Y = contraction_pencil(strip, contact_set, flexibility, None)
            P_eta, Y_eta = contraction_pencil(strip, contact_set, flexibility, eta)
            yield (f"{case}: X - Y = X_eta - Y_eta, contacts {contact_set}, epsilon {flexibility}",
                   equal(subtract(P, Y), subtract(P_eta, Y_eta)))
            if flexibility:
                yield (f"{case}: X - Y = sum A (M + G G^T/epsilon)^-1 A^T, contacts {contact_set}",
                       equal(subtract(P, Y), flexible_operator(strip, contact_set, flexibility)))


def sphere_checks(case, strip, contacts, ranks):
    """Counts of contacts and ranks of the subdomains, and the identities of the plane."""
    yield f"{case}: {contacts} contacts", len(strip.contacts) == contacts
    yield f"{case}: ranks {ranks}", [len(independent(s.H)) for s in strip.subdomains] == ranks
    epsilon, eta = Fraction(3, 7), Fraction(2, 5)
    for flexibility in (epsilon, Fraction(0)):
        P, Y = smooth_generic(strip, flexibility)
        P_eta, Y_eta = smooth_enriched(strip, flexibility, eta)
        yield (f"{case}: X - Y = X_eta - Y_eta, epsilon {flexibility}",
               equal(subtract(P, Y), subtract(P_eta, Y_eta)))
    yield (f"{case}: X - Y = sum A (M + H H^T/epsilon)^-1 A^T",
           equal(subtract(*smooth_generic(strip, epsilon)), flexible_operator(strip, "all", epsilon)))


def self_test():
    packings = {case: build_packing(shape) for case, shape in all_shapes().items()}
    results = list(closed_form_checks(packings["disks4"]))
    for case in GRAIN_COUNTS:
        results += identity_checks(case, packings[case])
    for case, contacts, ranks in (("tetrahedra", 9, [6, 3]), ("octahedron", 12, [8, 4]),
                                  ("cube", 12, [5, 3, 3, 1]), ("fcc13", 36, [20, 16])):
        results += sphere_checks(case, packings[case], contacts, ranks)
    kept = (Path(__file__).parent / "exact_schwarz.csv").read_text(encoding="utf-8")
    made = io.StringIO()
    write_table(schwarz_table(), made)
    results.append(("exact_schwarz.csv is what this program writes", made.getvalue() == kept))
    for name, holds in results:
        print(f"{'ok    ' if holds else 'FAILED'}  {name}")
    failures = sum(not holds for _, holds in results)
    print(f"{len(results)} checks, {failures} failed")
    return 1 if failures or not results else 0


def main():
    parser = argparse.ArgumentParser(
        description="Exact reference spectra for the three triangular strips.")
    parser.add_argument("--self-test", action="store_true",
                        help="verify the closed forms and identities exactly")
    parser.add_argument("--check", metavar="PROGRAM", help="compare PROGRAM's sweeps")
    parser.add_argument("--cases", metavar="DIR", help="folder of disks4.toml, ... (with --check)")
    parser.add_argument("--schwarz", action="store_true", help="the references of the scheme schwarz")
    options = parser.parse_args()
    if (options.check is None) != (options.cases is None):
        parser.error("--check PROGRAM and --cases DIR go together")
    if options.check and options.self_test:
        parser.error("--check and --self-test exclude each other")
    if options.self_test:
        return self_test()
    if options.check:
        return check_program(options.check, options.cases)
    write_table(schwarz_table() if options.schwarz else reference_table(), sys.stdout)
    return 0


if __name__ == "__main__":
    sys.exit(main())
