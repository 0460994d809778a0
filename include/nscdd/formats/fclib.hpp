// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/mechanics/friction_problem.hpp>

#include <variant>

namespace nscdd {

/// Impulses and velocities as a file of FCLIB keeps them.
struct FclibSolution {
  Vector v;  ///< velocities of the bodies, global problems only
  Vector u;  ///< relative velocities of the contacts, D c entries
  Vector r;  ///< impulses of the contacts, D c entries
};

/// Texts of a file, each present or not.
struct FclibInfo {
  std::optional<std::string> title, description, math_info;
};

/// A file of the Friction Contact Library (FCLIB, https://frictionalcontactlibrary.github.io), by which
/// Siconos, LMGC90 and others exchange frictional contact problems. The text files of Siconos (.dat) are read as one
/// that has the problem alone.
struct FclibFile {
  std::variant<LocalFrictionProblem, GlobalFrictionProblem> problem;
  FclibInfo info;
  std::optional<FclibSolution> solution;
  std::vector<FclibSolution> guesses;

  Index contacts() const;
  Index dimension() const;  ///< D: `spacedim` of FCLIB, 2 or 3
};

/// Whether these bytes of an HDF5 file hold a problem of FCLIB. Throws Error naming `name` for bytes of another kind.
bool holds_fclib(std::string_view bytes, const std::string& name);

/// Reads a problem in the plane or in space, local or global, with matrices by columns, by rows or as triplets.
/// Triplets are (row, column) = (p, i) as FCLIB documents them. If these do not fit the matrix but (i, p) do, they are
/// those of CSparse, which Siconos writes. Numbers are as in the file, and `check` has been passed. Throws
/// Error "name: group/dataset: expected ..., met ..." if the bytes are not a whole HDF5 file with exactly one problem,
/// if a member is missing, has a wrong length or an index out of range, and for what is not supported:
/// rolling friction, equality constraints G, couplings V and R.
FclibFile fclib_from_hdf5(std::string_view bytes, const std::string& name);

/// Reads a file of FCLIB, whatever its name. Throws Error as `fclib_from_hdf5` does.
FclibFile read_fclib(const std::string& path);

/// Reads a file that must hold a global problem: a text of Siconos where its name ends in .dat (docs/formats.md), else
/// HDF5 of FCLIB. Throws Error as `read_fclib` does, for a text "name:line: expected ..., met ...", and for a local
/// problem.
GlobalFrictionProblem read_global_problem(const std::string& path);

/// The bytes of a file that reads back to `file` bit for bit: matrices by columns, 32-bit integers, which
/// FCLIB and Siconos read. The provenance goes into the group of that name, which they leave alone.
std::string to_hdf5(const FclibFile& file, const Provenance& provenance = {});

}  // namespace nscdd
