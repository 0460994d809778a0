// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"
#include "files/resumable_table.hpp"

#include <optional>
#include <string>

namespace nscdd::app {

/// The option --resume, described alike for every verb that has it.
void declare_resume(Command& command, bool& resume);

/// Whether --resume meets a table that is complete, of which a note then tells the user. Throws Error if an
/// HDF5 file is still asked for, because nothing tells what work the table came from.
bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how);

/// The bytes that OutputFile keeps of an output that is written in one piece at the end: none, because what
/// an interrupted run left of it is empty.
std::optional<std::uintmax_t> leftover(bool resume);

/// Closes an interrupted table, tells the user how to go on, and returns the exit code.
int leave(ResumableTable& table, const std::string& path);

}  // namespace nscdd::app
