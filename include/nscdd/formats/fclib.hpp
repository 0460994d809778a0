// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/mechanics/friction_problem.hpp>

#include <variant>

namespace nscdd {

/// Impulses and velocities in a file of FCLIB.
struct FclibSolution {
  Vector v;  ///< velocities of the bodies, global problems only
  Vector u;  ///< relative velocities of the contacts, D c entries
  Vector r;  ///< impulses of the contacts, D c entries
};

/// Texts of a file.
struct FclibInfo {
  std::optional<std::string> title, description, math_info;
};

/// A file of the Friction Contact Library (FCLIB, https://frictionalcontactlibrary.github.io), with which Siconos,
/// LMGC90 and others exchange frictional contact problems. A text file of Siconos (.dat) fills only `problem`,
/// one of LMGC90 has a guess and the points of its contacts.
struct FclibFile {
  std::variant<LocalFrictionProblem, GlobalFrictionProblem> problem;
  FclibInfo info;
  std::optional<FclibSolution> solution;
  std::vector<FclibSolution> guesses;
  Matrix points = {};  ///< of the contacts, D x contacts, m; only from Vloc_Rloc of LMGC90, else empty

  Index contacts() const;
  Index dimension() const;  ///< D: `spacedim` of FCLIB, 2 or 3
};

/// Whether the bytes of an HDF5 file hold a problem of FCLIB. Throws Error naming `name` for bytes of another kind.
bool holds_fclib(std::string_view bytes, const std::string& name);

/// Reads a problem in the plane or in space, local or global, with matrices by columns, by rows or as triplets, and
/// passes it to `check`. Triplets are (row, column) = (p, i) as FCLIB documents them, or (i, p) as CSparse and Siconos
/// write them, if only these fit the matrix. Throws Error "name: group/dataset: expected ..., met ..." if the bytes are
/// not a whole HDF5 file with exactly one problem, if a member is missing, has a wrong length or an index out of range,
/// and for what is not supported: rolling friction, equality constraints G, couplings V and R.
FclibFile fclib_from_hdf5(std::string_view bytes, const std::string& name);

/// Reads a file of FCLIB with any name. Throws Error as `fclib_from_hdf5`.
FclibFile read_fclib(const std::string& path);

/// Reads a global problem: a text of Siconos if the name ends in .dat, of LMGC90 if it begins with Vloc_Rloc or is a
/// folder DATBOX (docs/formats.md), else HDF5 of FCLIB. `points`: receives those of the file. Throws Error as
/// `read_fclib`, "name:line: expected ..., met ..." for a text, and for a local problem.
GlobalFrictionProblem read_global_problem(const std::string& path, Matrix* points = nullptr);

/// The bytes of a file that FCLIB and Siconos read, and that reads back to `file` bit for bit: matrices by columns,
/// 32-bit integers. The group `provenance` is ours.
std::string to_hdf5(const FclibFile& file, const Provenance& provenance = {});

}  // namespace nscdd
