// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>

namespace nscdd {

/// A table under the name of its group.
struct NamedTable {
  std::string name;
  Table table;
};

/// The bytes of an HDF5 file of tables. Each table is a group whose attribute `columns` has the order of the columns.
/// Each column is a dataset (double, int64, int8 0/1 or fixed-length UTF-8 text) with the attributes `unit` and
/// `description`. The group `provenance` holds texts. Without time stamps, equal content gives equal bytes. The file is
/// built in memory, because the HDF5 library cannot give up a file of its own on a full disk.
std::string to_hdf5(const Provenance& provenance, const std::vector<NamedTable>& tables);

/// To be called when a program begins: otherwise HDF5 writes again at exit what a full disk refused, and crashes.
void leave_hdf5_alone_at_exit();

}  // namespace nscdd
