// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>
#include <nscdd/io/csv.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace nscdd {
namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool same_value(const Cell& cell, const std::string& expected, double tolerance) {
  const std::string text = to_text(cell);
  if (text == expected) return true;
  if (!std::holds_alternative<double>(cell)) return false;
  const double a = std::get<double>(cell);
  double b = 0;
  try {
    b = parse_number(expected, "");
  } catch (const Error&) {
    return false;
  }
  return std::isfinite(a) && std::isfinite(b) && std::abs(a - b) <= tolerance * std::max(1.0, std::abs(b));
}

}  // namespace

std::vector<std::string> csv_values(std::string_view line, const std::string& where) {
  std::vector<std::string> values;
  std::size_t i = 0;
  while (true) {
    std::string value;
    std::size_t start = i;
    while (start < line.size() && (line[start] == ' ' || line[start] == '\t')) ++start;
    if (start < line.size() && line[start] == '"') {
      i = start + 1;
      while (true) {
        if (i >= line.size())
          throw Error(fmt::format("{}: expected a closing quote, met the end of the line", where));
        if (line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"') {
          value += '"';
          i += 2;
        } else if (line[i] == '"') {
          ++i;
          break;
        } else {
          value += line[i++];
        }
      }
      const std::size_t comma = std::min(line.find(',', i), line.size());
      if (!trimmed(line.substr(i, comma - i)).empty())
        throw Error(fmt::format("{}: expected a comma after a closing quote, met '{}'", where,
                                line.substr(i, comma - i)));
      i = comma;
    } else {
      const std::size_t comma = std::min(line.find(',', i), line.size());
      value = trimmed(line.substr(i, comma - i));
      i = comma;
    }
    values.push_back(std::move(value));
    if (i >= line.size()) return values;
    ++i;
  }
}

std::string csv_header(const std::vector<Column>& columns) {
  std::string header;
  for (const Column& column : columns) header += (header.empty() ? "" : ",") + quoted(column.name);
  return header;
}

CsvWriter::CsvWriter(const std::string& path, bool force, const std::vector<Column>& columns,
                     std::optional<std::uintmax_t> kept_bytes)
    : file_(path, force, kept_bytes) {
  if (kept_bytes.value_or(0) == 0) header_ = csv_header(columns);
}

void CsvWriter::write_header() {
  if (header_.empty()) return;
  file_.line(header_);
  header_.clear();
}

void CsvWriter::finish() {
  write_header();
  file_.finish();
}

void CsvWriter::leave() { file_.leave(); }

void CsvWriter::write(const Row& row) {
  write_header();
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) line += (i == 0 ? "" : ",") + quoted(to_text(row[i]));
  file_.line(line);
}

CsvText parse_csv(std::string_view text, const std::string& name) {
  CsvText csv;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  std::size_t number = 0;
  while (!text.empty()) {
    ++number;
    const auto end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    const std::string where = fmt::format("{}:{}", name, number);
    std::vector<std::string> values = csv_values(line, where);
    if (csv.columns.empty()) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i].empty())
          throw Error(fmt::format("{}: expected a name for column {}, met none", where, i + 1));
        if (std::find(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(i), values[i]) !=
            values.begin() + static_cast<std::ptrdiff_t>(i))
          throw Error(fmt::format("{}: column '{}' is named twice", where, values[i]));
      }
      csv.columns = std::move(values);
      csv.header_line = number;
      continue;
    }
    if (values.size() != csv.columns.size())
      throw Error(fmt::format("{}: expected {} values as in the first line, met {}", where,
                              csv.columns.size(), values.size()));
    csv.rows.push_back(std::move(values));
    csv.lines.push_back(number);
  }
  if (csv.columns.empty())
    throw Error(fmt::format("{}: expected a line of column names, met an empty file", name));
  return csv;
}

std::string read_text(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw Error(fmt::format("{}: no such file", path));
  if (!std::filesystem::is_regular_file(path, ignored))
    throw Error(fmt::format("{}: expected a file, met a folder or a device", path));
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad()) throw Error(fmt::format("{}: cannot be read", path));
  return text;
}

Table untyped_table(const CsvText& csv) {
  Table table;
  for (const std::string& name : csv.columns) table.columns.push_back({name, "", ""});
  for (const auto& values : csv.rows) {
    Row row;
    for (const std::string& value : values) {
      try {
        row.emplace_back(parse_number(value, ""));
      } catch (const Error&) {
        row.emplace_back(value);
      }
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string compare(const Table& table, const CsvText& expected, double tolerance) {
  constexpr std::array<std::string_view, 5> not_compared{"applications", "iterations", "spectra", "residual",
                                                         "difference"};
  std::vector<std::string> names;
  for (const Column& column : table.columns) names.push_back(column.name);
  if (names != expected.columns) return "the columns differ";
  if (table.rows.size() != expected.rows.size())
    return fmt::format("expected {} rows, met {}", expected.rows.size(), table.rows.size());
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (std::find(not_compared.begin(), not_compared.end(), names[j]) != not_compared.end()) continue;
      if (!same_value(table.rows[i][j], expected.rows[i][j], tolerance))
        return fmt::format("row {}, column {}: expected {}, met {}", i + 1, names[j], expected.rows[i][j],
                           to_text(table.rows[i][j]));
    }
  return "";
}

}  // namespace nscdd
