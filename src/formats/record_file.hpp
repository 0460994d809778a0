// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/work_identity.hpp"
#include <nscdd/core/table.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd {

/// The file beside a growing table that tells what its rows come from: FILE.record, TOML.
struct RecordFile {
  WorkIdentity work;
  std::vector<std::string> types;  ///< of the columns: "integer", "number", "boolean" or "text"
  std::string finished;            ///< fingerprint of the whole table once it is complete, else empty
};

std::filesystem::path record_path(const std::filesystem::path& table);

std::string to_toml(const RecordFile& record);

/// Reads what `to_toml` wrote; throws Error "file:line: ..." for anything else.
RecordFile parse_record(std::string_view text, const std::string& file);

/// Name of the type of each cell of a row, and the cell of that type that a text reads back to, to the last
/// bit.
std::vector<std::string> cell_types(const Row& row);
Cell parse_cell(const std::string& text, const std::string& type, const std::string& where);

}  // namespace nscdd
