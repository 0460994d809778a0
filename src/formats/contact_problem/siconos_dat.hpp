// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/formats/fclib.hpp>

/// Contact problems as text files of Siconos (https://github.com/siconos/siconos), written by its functions
/// frictionContact_printInFile and globalFrictionContact_printInFile. Words are separated by blanks and line ends.
namespace nscdd {

/// Reads a problem in the layouts of docs/formats.md and passes it to `check`. It is local if the numbers after the
/// first matrix are as many as those of q and mu, else global: the file does not say. Throws Error "name:line: expected
/// ..., met ..." for another text, for one that ends too early or late, and for what is not supported: rolling
/// friction, half of a symmetric matrix.
FclibFile siconos_from_text(std::string_view text, const std::string& name);

/// A text that Siconos reads, and that reads back to the problem bit for bit: matrices sparse by columns. It has no
/// solutions, guesses and texts. `program` replaces the version of CSparse.
std::string siconos_text(const FclibFile& file, const std::string& program);

/// Whether the name is that of a file of Siconos: it ends in .dat.
bool has_siconos_name(const std::string& path);

/// Reads a file of FCLIB, of Siconos or of LMGC90, by its name. Throws Error as the reader of its format.
FclibFile read_contact_problem(const std::string& path);

}  // namespace nscdd
