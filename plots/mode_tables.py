# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of `nscdd modes`, and what its figures in the plane and in space share: colours, scales and words."""
import os

import numpy as np
import style
from matplotlib.colors import ListedColormap

# Light to dark, in grey as well, but not so dark that the arrows are lost.
MAP = ListedColormap(style.plt.get_cmap("YlOrBr")(np.linspace(0, 0.8, 256)))
ARROW = "#1f5f99"
SHORTEST = 0.04                # of the arrows, as a part of the longest
SLOWEST = 0.15                 # of the mean velocities shown, as a part of the fastest


def read(prefix):
    try:
        return read_tables(prefix)
    except style.NoRows:
        raise style.DataError(f"{prefix}: no mode in its tables (no interface, or no mode was found, as nscdd modes "
                              "says): nothing to draw") from None


def read_tables(prefix):
    """(rows, copies): both have a z in space."""
    folder, name = os.path.split(prefix)
    rows = style.read_table(folder, f"{name}-impulses.csv", texts="case end",
                            numbers="epsilon eta eigenvalue grain subdomain_first subdomain_second "
                                    "impulse_x impulse_y", if_there="impulse_z")
    copies = style.read_table(folder, f"{name}-velocities.csv", texts="case",
                              numbers="grain subdomain x y radius multiplicity velocity_x velocity_y",
                              if_there="z velocity_z")
    met = {("impulse_z" in rows[0], "z" in copies[0], "velocity_z" in copies[0])}
    if met not in ({(True, True, True)}, {(False, False, False)}):
        raise style.DataError(f"{prefix}: expected two tables of one packing, in space with impulse_z, z and "
                              "velocity_z, met some of these columns alone")
    if any(np.isnan(row["x"]) for row in copies):
        raise style.DataError(f"{prefix}: expected places of grains, met a contact problem, which has none to draw")
    return rows, copies


def vectors(rows, name, axes):
    """The columns NAME and each of AXES side by side, as name="velocity_", axes="xyz"."""
    return np.column_stack([style.column(rows, name + axis) for axis in axes])


def pulls_of(rows, axes):
    """Impulses that the copies of shared grains feel, {(grain, subdomain): impulse}: those of the rows, which tie two
    copies each, with opposite signs. However the copies of a grain are tied, these are the same."""
    pulls = {}
    for row, impulse in zip(rows, vectors(rows, "impulse_", axes)):
        for end, sign in (("first", -1), ("second", 1)):
            copy = row["grain"], row[f"subdomain_{end}"]
            pulls[copy] = pulls.get(copy, 0) + sign * impulse
    return pulls


def power_of_ten(largest):
    return int(np.floor(np.log10(largest))) if largest > 0 else 0


def scaled(name, exponent):
    return name if exponent == 0 else rf"$10^{{{exponent}}}$ {name}"


def number(value):
    """As a label has it: powers of ten as such, infinity by its sign."""
    if value == 0 or np.isinf(value):
        return "0" if value == 0 else r"\infty"
    exponent = power_of_ten(abs(value))
    if -2 <= exponent <= 3:
        return f"{value:.3g}"
    mantissa = f"{value / 10.0**exponent:.3g}"
    return (rf"{mantissa}\times " if mantissa != "1" else "") + rf"10^{{{exponent}}}"


def heading(row):
    return (rf"{row['case']}: $\varepsilon = {number(row['epsilon'])}$ 1/kg, $\eta = {number(row['eta'])}$ 1/kg, "
            rf"{row['end']} end, $\mu = {row['eigenvalue']:.6g}$; $F^T\!P F = 1$ J")
