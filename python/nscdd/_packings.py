# SPDX-License-Identifier: GPL-3.0-or-later
"""Packings, their contacts and how they are cut."""
from __future__ import annotations

import os
from inspect import cleandoc

import numpy as np

from . import _arguments, _core
from ._core import ContactNetwork, Decomposition, Packing


def read_packing(path: str | os.PathLike[str]) -> Packing:
    """The packing of a file: CSV with columns x, y, radius and maybe z and mass, HDF5 (.h5, .hdf5) with datasets of
    these names in the group `packing`, a text with lines "x y radius", "x y z radius" or, of YADE, x_y_z_r_clumpId, or
    the free disks of a folder DATBOX of LMGC90. A packing with z is in space; in a text z must differ between grains.
    Raises Error naming file and line, or dataset, for bad input."""
    return _core.read_packing(_arguments.path(path))


def generate(generator: str, *, progress: _arguments.Progress = None, threads: int = 0,
             **parameters: object) -> Packing:
    """The packing of a generator. Equal parameters give equal bits. `progress` counts grains. Raises Error for an
    unknown generator or parameter, or a value out of bounds.

    The generators, their parameters and defaults:
    """
    return _core.generate(generator, _arguments.settings(parameters), _arguments.progress(progress), threads)


if generate.__doc__:  # not with python3 -OO
    generate.__doc__ = cleandoc(generate.__doc__) + "\n\n" + _core.generators_text


def contacts(packing: Packing, *, tolerance: float = 1e-7, overlap_tolerance: float = 1e-7) -> ContactNetwork:
    """The contacts: every pair of grains whose gap is at most `tolerance` times the smaller radius. If the coordinates
    are coarser than that (six decimals, float32, doubles far from the origin), the uncertainty of their digits replaces
    both tolerances, and a UserWarning reports contacts that depend on it. Raises Error naming both grains of a pair
    that overlaps by more than `overlap_tolerance` times the smaller radius, or shares a centre."""
    return _core.contacts(packing, tolerance, overlap_tolerance)


def decompose(packing: Packing, subdomains: _arguments.Subdomains = (1, 1), *, tolerance: float = 1e-7,
              overlap_tolerance: float = 1e-7, density: float | None = None,
              prescribed: _arguments.Prescribed | None = None, compression: tuple[float, ...] = (0.0, 0.0),
              shear: float = 0.0, name: str = "packing") -> Decomposition:
    """A packing cut into subdomains in the FETI way: contacts are distributed among them, a grain whose contacts belong
    to q subdomains becomes q copies, each with 1/q of its mass, and the interface holds the copies together.

    subdomains   (columns, rows) of a regular grid over the centres, in space (columns, rows, layers), "metis:N" for
                 the graph of contacts, or an array or list with the number of a subdomain for each contact, in the
                 order of `contacts(packing)`
    tolerance, overlap_tolerance   of the contacts, as in `contacts`
    density      masses = density x pi radius^2, kg/m^2, in space density x 4/3 pi radius^3, kg/m^3; else those of the
                 packing, or 1 kg each
    prescribed   arriving velocities of single grains, {grain: (vx, vy)}, in space {grain: (vx, vy, vz)}, m/s
    compression, shear   rates, 1/s, of a homogeneous deformation that all other grains arrive with: along x and y, in
                 space along z too; shear of x and y

    Velocities matter only for the choice of active contacts. Raises Error for bad input.
    """
    given = {"contacts.tolerance": tolerance, "contacts.overlap_tolerance": overlap_tolerance,
             "loads.compression": compression, "loads.shear": shear}
    if density is not None:
        given["masses.density"] = density
    return _core.decompose(packing, _arguments.subdomains(subdomains), _arguments.settings(given),
                           _arguments.prescribed(prescribed), name)


def read_case(path: str | os.PathLike[str], subdomains: _arguments.Subdomains | None = None, *,
              settings: dict[str, object] | None = None, progress: _arguments.Progress = None) -> Decomposition:
    """The decomposition of a case file (docs/cases.md): its packing or contact problem, cut as the file or `subdomains`
    says. The path may also be what stands for a case on the command line: a packing, a contact problem of FCLIB or
    Siconos, or a folder DATBOX of LMGC90, whose contacts are found to the digits of its numbers. `settings` overrides
    parameters of the case, {"packing.grains": 16}, as --set does. Raises Error naming file, line and key, and for a
    packing that a simulation would have to settle."""
    cut = None if subdomains is None else _arguments.subdomains(subdomains)
    return _core.read_case(_arguments.path(path), cut, _arguments.settings(settings or {}),
                           _arguments.progress(progress))


def chosen_contacts(parts: Decomposition, contacts: str = "active") -> np.ndarray:
    """Which contacts Stage 1 works with, one flag per contact: "all", "active" (in compression in the linear rigid
    problem), "unilateral" (carrying in the frictionless unilateral problem) or, of a contact problem with friction,
    "frozen" (in its solution: one flag per direction, both where a contact sticks, the normal where it slides). Raises
    Error if the choice depends on impulses and no grain has an arriving velocity, and if the impulses were not found to
    1e-8."""
    flags, _, rule, certain = _core.chosen_contacts(parts, contacts)
    if not certain:
        raise _core.Error(f"contacts: expected impulses to 1e-8 for {contacts}, met less ({rule})")
    return flags
