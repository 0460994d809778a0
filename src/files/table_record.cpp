// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/table_record.hpp"

#include "files/strict_toml.hpp"

#include <array>

namespace nscdd {
namespace {

constexpr std::array<const char*, 4> type_names{"integer", "number", "boolean", "text"};  // as in Cell

// A text of several lines as TOML. Every text ends with a line feed, so that its quotes never touch the
// closing ones.
std::string lines(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || (c == '"' && escaped.ends_with("\"\""))) escaped += '\\';
    escaped += c;
  }
  return fmt::format("\"\"\"\n{}\"\"\"", escaped);
}

// The first line in which two texts differ.
std::string differing_line(std::string_view expected, std::string_view met) {
  const auto next = [](std::string_view& text) {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
  };
  while (!expected.empty() || !met.empty()) {
    const std::string a = next(expected), b = next(met);
    if (a != b) return fmt::format("expected '{}', met '{}'", a, b);
  }
  return "expected other line ends";
}

}  // namespace

std::string difference(const WorkIdentity& expected, const WorkIdentity& met) {
  const auto compared = [](const char* what, const std::string& a, const std::string& b) {
    return a == b ? "" : fmt::format("the {} differs: {}", what, differing_line(a, b));
  };
  for (const std::string& found :
       {compared("code version", expected.version, met.version), compared("case", expected.cases, met.cases),
        compared("choice of options", expected.options, met.options),
        compared("choice of solver options", expected.effort, met.effort)})
    if (!found.empty()) return found;
  return "";
}

std::filesystem::path record_path(const std::filesystem::path& table) { return table.string() + ".record"; }

std::string to_toml(const TableRecord& record) {
  std::string types;
  for (const std::string& type : record.types)
    types += fmt::format("{}{}", types.empty() ? "" : ", ", field_text(type));
  return fmt::format(
      "# What the rows of the table beside this file come from; --resume goes on with equal work only.\n"
      "version = {}\n\ncases = {}\n\noptions = {}\n\neffort = {}\n\ntypes = [{}]\nfinished = {}\n",
      lines(record.work.version), lines(record.work.cases), lines(record.work.options), lines(record.work.effort),
      types, field_text(record.finished));
}

TableRecord parse_record(std::string_view text, const std::string& file) {
  const toml::table document = parse_toml(text, file);
  StrictTable root(document, file, "");
  TableRecord record;
  for (const char* key : {"version", "cases", "options", "effort", "types"})
    if (!root.has(key)) root.fail(key, "a value", "none");
  root.read("version", record.work.version);
  root.read("cases", record.work.cases);
  root.read("options", record.work.options);
  root.read("effort", record.work.effort);
  root.read("finished", record.finished);
  const toml::node* types = root.node("types");
  if (!types->is_array()) root.fail("types", "an array", StrictTable::describe(*types));
  for (const toml::node& type : *types->as_array()) record.types.push_back(type.value_or<std::string>("none"));
  root.finish();
  return record;
}

std::vector<std::string> cell_types(const Row& row) {
  std::vector<std::string> types;
  for (const Cell& cell : row) types.emplace_back(type_names[cell.index()]);
  return types;
}

Cell parse_cell(const std::string& text, const std::string& type, const std::string& where) {
  if (type == "integer") return std::int64_t{parse_integer(text, where)};
  if (type == "number") return parse_number(text, where);
  if (type == "text") return text;
  if (type != "boolean") throw Error(fmt::format("{}: no such type of a cell: '{}'", where, type));
  bool flag = false;
  parse_value(text, flag, where);
  return flag;
}

}  // namespace nscdd
