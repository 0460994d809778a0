// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5.hpp"

#include "files/csv.hpp"
#include "files/hdf5_file.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

Table table_of(const hdf5::Group& group) {
  Table table;
  for (const std::string& name : csv_values(group.text_attribute("columns"), group.path())) {
    const std::vector<Cell> cells = group.cells(name);
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
  return hdf5::new_file_bytes([&](const hdf5::Group& root) {
    hdf5::put_provenance(root, provenance);
    for (const auto& [name, table] : tables) {
      const hdf5::Group group = root.make_group(name);
      group.put_attribute("columns", csv_header(table.columns));
      group.put_columns(table);
    }
  });
}

TablesFile tables_from_hdf5(std::string_view bytes, const std::string& name) {
  const hdf5::File file(bytes, name);
  const hdf5::Group root = file.root();
  TablesFile content{hdf5::provenance_of(root), {}};
  for (const std::string& table : root.members())
    if (table != "provenance") content.tables.push_back({table, table_of(root.group(table))});
  return content;
}

void leave_hdf5_alone_at_exit() { H5dont_atexit(); }

}  // namespace nscdd
