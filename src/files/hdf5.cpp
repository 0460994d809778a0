// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5.hpp"

#include "files/csv.hpp"
#include "files/hdf5_file.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

namespace nscdd {
namespace {

using hdf5::Group;

void put_table_head(const Group& group, const std::vector<Column>& columns) {
  std::string order;
  for (const Column& column : columns) order += (order.empty() ? "" : ",") + column.name;
  group.put_attribute("columns", order);
}

template <class Value>
void put_column(const Group& group, const Column& column, std::span<const Value> values) {
  group.put(column.name, values, {{"unit", column.unit}, {"description", column.description}});
}

template <class Value>
std::vector<Value> gather(const Table& table, std::size_t j) {
  std::vector<Value> values;
  for (const Row& row : table.rows) values.push_back(std::get<Value>(row[j]));
  return values;
}

void put_column(const Group& group, const Table& table, std::size_t j) {
  const Column& column = table.columns[j];
  if (table.rows.empty() || std::holds_alternative<double>(table.rows[0][j])) {
    put_column<double>(group, column, gather<double>(table, j));
  } else if (std::holds_alternative<std::int64_t>(table.rows[0][j])) {
    put_column<std::int64_t>(group, column, gather<std::int64_t>(table, j));
  } else if (std::holds_alternative<bool>(table.rows[0][j])) {
    const std::vector<bool> flags = gather<bool>(table, j);
    put_column<std::int8_t>(group, column, std::vector<std::int8_t>(flags.begin(), flags.end()));
  } else {
    group.put_texts(column.name, gather<std::string>(table, j),
                    {{"unit", column.unit}, {"description", column.description}});
  }
}

std::vector<Cell> column_cells(const Group& group, const std::string& name) {
  const auto cells = [](const auto& values) { return std::vector<Cell>(values.begin(), values.end()); };
  if (group.kind(name) == H5T_STRING) return cells(group.texts(name));
  if (group.kind(name) == H5T_FLOAT) return cells(group.numbers<double>(name));
  if (group.element_size(name) > 1) return cells(group.numbers<std::int64_t>(name));
  std::vector<Cell> flags;
  for (const std::int8_t flag : group.numbers<std::int8_t>(name)) flags.emplace_back(flag != 0);
  return flags;
}

Table table_of(const Group& group) {
  Table table;
  for (const std::string& name : csv_values(group.text_attribute("columns"), group.path())) {
    const std::vector<Cell> cells = column_cells(group, name);
    if (table.columns.empty()) table.rows.resize(cells.size());
    if (cells.size() != table.rows.size())
      throw Error(fmt::format("{}: expected {} values as in the first column, met {}", group.of(name),
                              table.rows.size(), cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) table.rows[i].push_back(cells[i]);
    table.columns.push_back({name, group.text_attribute("unit", name), group.text_attribute("description", name)});
  }
  return table;
}

}  // namespace

std::string to_hdf5(const Provenance& provenance, const std::vector<NamedTable>& tables) {
  return hdf5::new_file_bytes([&](const Group& root) {
    hdf5::put_provenance(root, provenance);
    for (const NamedTable& named : tables) {
      const Group group = root.make_group(named.name);
      put_table_head(group, named.table.columns);
      for (std::size_t j = 0; j < named.table.columns.size(); ++j) put_column(group, named.table, j);
    }
  });
}

std::string to_hdf5(const Provenance& provenance, const std::string& name, const std::vector<NumberColumn>& columns) {
  return hdf5::new_file_bytes([&](const Group& root) {
    hdf5::put_provenance(root, provenance);
    const Group group = root.make_group(name);
    std::vector<Column> headings;
    for (const NumberColumn& column : columns) headings.push_back(column.heading);
    put_table_head(group, headings);
    for (const NumberColumn& column : columns) put_column(group, column.heading, column.values);
  });
}

TablesFile tables_from_hdf5(std::string_view bytes, const std::string& name) {
  const hdf5::File file(bytes, name);
  const Group root = file.root();
  TablesFile content{hdf5::provenance_of(root), {}};
  for (const std::string& table : root.members())
    if (table != "provenance") content.tables.push_back({table, table_of(root.group(table))});
  return content;
}

void leave_hdf5_alone_at_exit() { H5dont_atexit(); }

std::map<std::string, std::vector<double>> numbers_from_hdf5(std::string_view bytes, const std::string& name,
                                                             const std::string& group_name) {
  const hdf5::File file(bytes, name);
  const Group group = file.root().group(group_name);
  std::map<std::string, std::vector<double>> columns;
  for (const std::string& member : group.members()) columns[member] = group.numbers<double>(member);
  return columns;
}

}  // namespace nscdd
