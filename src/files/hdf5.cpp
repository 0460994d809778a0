// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_handles.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/files/hdf5.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace nscdd {
namespace {

using hdf5::Handle;

// One column; `type` is that of the data and of the file.
void write_column(hid_t group, const Column& column, hid_t type, std::size_t rows, const void* data) {
  const Handle dataset = hdf5::write_dataset(group, column.name, type, rows, data);
  hdf5::write_attribute(dataset, "unit", column.unit);
  hdf5::write_attribute(dataset, "description", column.description);
}

template <class Value>
std::vector<Value> gather(const Table& table, std::size_t j) {
  std::vector<Value> values;
  for (const Row& row : table.rows) values.push_back(std::get<Value>(row[j]));
  return values;
}

void write_column(hid_t group, const Table& table, std::size_t j) {
  const Column& column = table.columns[j];
  const std::size_t rows = table.rows.size();
  if (rows == 0 || std::holds_alternative<double>(table.rows[0][j])) {
    write_column(group, column, H5T_IEEE_F64LE, rows, gather<double>(table, j).data());
  } else if (std::holds_alternative<std::int64_t>(table.rows[0][j])) {
    write_column(group, column, H5T_STD_I64LE, rows, gather<std::int64_t>(table, j).data());
  } else if (std::holds_alternative<bool>(table.rows[0][j])) {
    std::vector<signed char> flags;
    for (const bool flag : gather<bool>(table, j)) flags.push_back(flag ? 1 : 0);
    write_column(group, column, H5T_STD_I8LE, rows, flags.data());
  } else {
    const auto texts = gather<std::string>(table, j);
    std::size_t length = 1;
    for (const std::string& text : texts) length = std::max(length, text.size());
    std::string bytes;
    for (const std::string& text : texts) {
      bytes += text;
      bytes.append(length - text.size(), '\0');
    }
    write_column(group, column, hdf5::text_type(length), rows, bytes.data());
  }
}

std::string joined_names(const std::vector<Column>& columns) {
  std::string order;
  for (const Column& column : columns) order += (order.empty() ? "" : ",") + column.name;
  return order;
}

// The bytes of a file with its provenance that `fill` writes its groups into.
template <class Fill>
std::string write_all(const Provenance& provenance, Fill&& fill) {
  return hdf5::file_bytes([&](hid_t file) {
    const Handle origin = hdf5::new_group(file, "provenance");
    for (const auto& [name, text] : provenance) hdf5::write_text(origin, name, text);
    fill(file);
  });
}

}  // namespace

std::string to_hdf5(const Provenance& provenance, const std::vector<NamedTable>& tables) {
  return write_all(provenance, [&](hid_t file) {
    for (const NamedTable& named : tables) {
      const std::vector<Column>& columns = named.table.columns;
      const Handle group = hdf5::new_group(file, named.name);
      hdf5::write_attribute(group, "columns", joined_names(columns));
      for (std::size_t j = 0; j < columns.size(); ++j) write_column(group, named.table, j);
    }
  });
}

std::string to_hdf5(const Provenance& provenance, const std::string& name,
                    const std::vector<NumberColumn>& columns) {
  return write_all(provenance, [&](hid_t file) {
    const Handle group = hdf5::new_group(file, name);
    std::vector<Column> headings;
    for (const NumberColumn& column : columns) headings.push_back(column.heading);
    hdf5::write_attribute(group, "columns", joined_names(headings));
    for (const NumberColumn& column : columns)
      write_column(group, column.heading, H5T_IEEE_F64LE, column.values.size(), column.values.data());
  });
}

std::map<std::string, std::vector<double>> numbers_from_hdf5(std::string_view bytes, const std::string& name,
                                                             const std::string& group_name) {
  const Handle file = hdf5::open_bytes(bytes, name);
  const Handle group(H5Gopen2(file, group_name.c_str(), H5P_DEFAULT), H5Gclose,
                     fmt::format("{}: expected a group '{}', met none", name, group_name));
  std::map<std::string, std::vector<double>> columns;
  for (const std::string& member : hdf5::members(group, name))
    columns[member] = hdf5::read_numbers(group, member, fmt::format("{}: {}/{}", name, group_name, member));
  return columns;
}

}  // namespace nscdd
