// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd {

/// Everything that the rows of a table come from, as texts to be compared: equal texts give equal rows (on
/// one machine; from one processor to another the BLAS may round otherwise).
struct WorkIdentity {
  std::string version;  ///< of the program, its build and the libraries
  std::string cases;    ///< resolved, with the content of packing files: their paths do not count
  std::string options;  ///< which points: columns, values of the lists, contacts, seed
  std::string effort;   ///< how hard each point is worked on: solver, tolerances, limits
};

/// First difference as "the options differ: expected ..., met ...", or "" where there is none.
std::string difference(const WorkIdentity& expected, const WorkIdentity& met);

/// The file beside a growing table that tells what its rows come from: FILE.record, TOML.
struct TableRecord {
  WorkIdentity work;
  std::vector<std::string> types;  ///< of the columns: "integer", "number", "boolean" or "text"
  std::string finished;            ///< fingerprint of the whole table once it is complete, else empty
};

std::filesystem::path record_path(const std::filesystem::path& table);

std::string to_toml(const TableRecord& record);

/// Reads what `to_toml` wrote; throws Error "file:line: ..." for anything else.
TableRecord parse_record(std::string_view text, const std::string& file);

/// The name of the type of each cell of a row, and the cell of that type that a text stands for. Numbers read
/// back to the last bit.
std::vector<std::string> cell_types(const Row& row);
Cell parse_cell(const std::string& text, const std::string& type, const std::string& where);

}  // namespace nscdd
