// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nscdd {

/// A table under the name of its group.
struct NamedTable {
  std::string name;
  Table table;
};

/// A column of numbers that lie elsewhere.
struct NumberColumn {
  Column heading;
  std::span<const double> values;
};

/// The bytes of an HDF5 file of tables. Each table is a group whose attribute `columns` has the order of the
/// columns. Each column is a dataset (double, int64, int8 0/1 or fixed-length UTF-8 text) with the attributes
/// `unit` and `description`. The group `provenance` holds texts. There are no time stamps, so that equal
/// content gives equal bytes. The file is put together in memory: writing its bytes then fails as for any
/// other file, whereas the HDF5 library cannot give up a file of its own on a full disk.
std::string to_hdf5(const Provenance& provenance, const std::vector<NamedTable>& tables);

/// The same for one group of numbers alone, without a cell for each of them.
std::string to_hdf5(const Provenance& provenance, const std::string& group, const std::vector<NumberColumn>& columns);

/// What an HDF5 file of tables holds.
struct TablesFile {
  Provenance provenance;           ///< in the order of the alphabet
  std::vector<NamedTable> tables;  ///< likewise; the columns in their own order
};

/// Reads the bytes that `to_hdf5` made of tables. Throws Error naming `name` (the file) for others.
TablesFile tables_from_hdf5(std::string_view bytes, const std::string& name);

/// The datasets of one group of an HDF5 file given by its bytes, by name. Throws Error naming `name` (the
/// file) for bytes that are no HDF5 file, for a missing group, and for a member of the group that is no
/// one-dimensional dataset of numbers or cannot be read.
std::map<std::string, std::vector<double>> numbers_from_hdf5(std::string_view bytes, const std::string& name,
                                                             const std::string& group);

/// A program calls this at its beginning. HDF5 then leaves files alone when the program ends. Otherwise it
/// would try again to write what a full disk did not take, and crash.
void leave_hdf5_alone_at_exit();

}  // namespace nscdd
