// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>

#include <string>
#include <utility>
#include <vector>

namespace nscdd {

/// What a result file says of its origin: name and text, in order, such as ("command_line", "nscdd run ...").
using Provenance = std::vector<std::pair<std::string, std::string>>;

/// A table under the name of its group.
struct NamedTable {
  std::string name;
  Table table;
};

/// Writes tables as HDF5: one group per table, one dataset per column (double, int64, int8 0/1 or
/// fixed-length UTF-8 text) with attributes `unit` and `description`, the order of the columns in the group's
/// attribute `columns`, provenance as texts in the group `provenance`. No time stamps: equal content gives
/// equal bytes. The file grows as `path.partial` and is renamed when complete. Throws Error where the file
/// exists and `force` is false, or where HDF5 cannot write it (no room left, no permission).
void write_hdf5(const std::string& path, bool force, const Provenance& provenance,
                const std::vector<NamedTable>& tables);

}  // namespace nscdd
