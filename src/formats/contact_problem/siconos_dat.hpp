// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/formats/fclib.hpp>

/// Contact problems as the text files of Siconos (https://github.com/siconos/siconos), which its functions
/// frictionContact_printInFile and globalFrictionContact_printInFile write. Words are separated by blanks and line
/// ends.
namespace nscdd {

/// Reads a problem in the plane or in space, with the layouts that docs/formats.md describes. It is local where as many
/// numbers follow the first matrix as q and mu have, and global otherwise: nothing in the file says so. `check` has
/// been passed. Throws Error "name:line: expected ..., met ..." for another text, for one that ends too early or late,
/// and for what is not supported: rolling friction, half of a symmetric matrix.
FclibFile siconos_from_text(std::string_view text, const std::string& name);

/// A text that reads back to the problem bit for bit, and that Siconos reads: matrices sparse by columns. It has no
/// place for solutions, guesses and texts. `program` stands where CSparse tells its version.
std::string siconos_text(const FclibFile& file, const std::string& program);

/// Whether a file of that name is one of Siconos: its name ends in .dat.
bool has_siconos_name(const std::string& path);

/// Reads a contact problem of FCLIB or of Siconos, by the name of the file. Throws Error as `fclib_from_hdf5` and
/// `siconos_from_text` do.
FclibFile read_contact_problem(const std::string& path);

}  // namespace nscdd
