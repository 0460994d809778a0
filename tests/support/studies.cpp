// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies.hpp"

#include "files/csv.hpp"
#include "formats/case/case_file.hpp"

#include <filesystem>

namespace nscdd::testing {

Study read_study(const std::string& name) {
  const std::string folder = source_folder().string() + "/studies/" + name, file = folder + "/study.toml";
  return parse_study(read_text(file), file, [&](const std::string& one) {
    const std::string own = folder + "/" + one;
    return read_case(std::filesystem::exists(own) ? own : source_folder().string() + "/cases/" + one + ".toml");
  });
}

std::string baseline_path(const Study& study, std::size_t number) {
  const std::string suffix = number == 0 ? "" : "-" + study.tables[number].name;
  return source_folder().string() + "/studies/" + study.name + "/baseline" + suffix + ".csv";
}

Table run(StudyTable definition) {
  for (Case& one : definition.cases)  // those of files
    if (!std::holds_alternative<SettledFrom>(one.spec.packing)) one = resolve(one.spec);
  Table table{study_columns(definition), {}};
  run_table(definition, [&](const Row& row) { table.rows.push_back(row); });
  return table;
}

}  // namespace nscdd::testing
