// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/csv.hpp"

#include "core/fail.hpp"
#include <nscdd/core/fields.hpp>

#include <fstream>

namespace nscdd {
namespace {

bool same_value(const Cell& cell, const std::string& expected, double tolerance, bool relative) {
  if (to_text(cell) == expected) return true;
  const double* a = std::get_if<double>(&cell);
  const std::optional<double> b = number_of(trimmed(expected));
  if (a == nullptr || !b) return false;
  const double scale = relative ? std::abs(*b) : std::max(1.0, std::abs(*b));
  return std::isfinite(*a) && std::isfinite(*b) && std::abs(*a - *b) <= tolerance * scale;
}

// The values of one line. `quoted` owns the texts of quoted values.
void split_values(std::string_view line, std::vector<std::string_view>& values, std::deque<std::string>& quoted,
                  const auto& where) {
  values.clear();
  quoted.clear();
  for (std::size_t i = 0;; ++i) {
    const std::size_t start = std::min(line.find_first_not_of(" \t", i), line.size());
    const bool in_quotes = line.substr(start, 1) == "\"";
    if (in_quotes) {
      std::string& value = quoted.emplace_back();
      for (i = start + 1;; ++i) {
        if (i >= line.size()) fail("{}: expected a closing quote, met the end of the line", where());
        if (line[i] == '"') {
          if (i + 1 >= line.size() || line[i + 1] != '"') break;
          ++i;  // a doubled quote is one
        }
        value += line[i];
      }
      ++i;
    }
    const std::size_t comma = std::min(line.find(',', i), line.size());
    const std::string_view rest = line.substr(i, comma - i);
    if (in_quotes && !trimmed(rest).empty())
      fail("{}: expected a comma after a closing quote, met '{}'", where(), rest);
    values.push_back(in_quotes ? std::string_view(quoted.back()) : trimmed(rest));
    if (comma == line.size()) return;
    i = comma;
  }
}

}  // namespace

std::vector<std::string> csv_values(std::string_view line, const std::string& where) {
  std::vector<std::string_view> values;
  std::deque<std::string> quoted;
  split_values(line, values, quoted, [&] { return where; });
  return {values.begin(), values.end()};
}

std::string csv_line(const Row& row) {
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) line += ',';
    const std::string text = to_text(row[i]);
    // Rows that begin with # are comments, and blanks around a cell do not count.
    const bool quoted = text.find_first_of(",\"\n\r") != std::string::npos || text.starts_with('#') ||
                        trimmed(text).size() != text.size();
    if (quoted) line += '"';
    for (const char c : text) line.append(c == '"' ? 2 : 1, c);
    if (quoted) line += '"';
  }
  return line;
}

std::string csv_header(const std::vector<Column>& columns) {
  Row names;
  for (const Column& column : columns) names.emplace_back(column.name);
  return csv_line(names);
}

CsvWriter::CsvWriter(const std::string& path, bool force, const std::vector<Column>& columns,
                     std::optional<std::uintmax_t> kept_bytes)
    : file_(path, force, kept_bytes) {
  if (kept_bytes.value_or(0) == 0) header_ = csv_header(columns) + '\n';
}

void CsvWriter::flush() {
  file_.flush();
  if (!header_.empty()) file_.bytes(std::exchange(header_, {}));
}

void CsvWriter::finish() {
  flush();
  file_.finish();
}

void CsvWriter::write(const Row& row) { file_.line(std::exchange(header_, {}) + csv_line(row)); }

CsvReader::CsvReader(std::string_view text, std::string name) : lines_(text), name_(std::move(name)) {
  require_utf8(text, name_);
  if (!next_line()) fail("{}: expected a line of column names, met an empty file", name_);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (values_[i].empty()) fail("{}: expected a name for column {}, met none", where(), i + 1);
    if (std::ranges::find(columns_, values_[i]) != columns_.end())
      fail("{}: column '{}' is named twice", where(), values_[i]);
    columns_.emplace_back(values_[i]);
  }
}

bool CsvReader::next() {
  if (!next_line()) return false;
  if (values_.size() != columns_.size())
    fail("{}: expected {} values as in the first line, met {}", where(), columns_.size(), values_.size());
  return true;
}

bool CsvReader::next_line() {
  while (lines_.next()) {
    const std::string_view content = trimmed(lines_.line());
    if (content.empty() || content.front() == '#') continue;
    split_values(lines_.line(), values_, quoted_, [this] { return where(); });
    return true;
  }
  return false;
}

std::string CsvReader::where() const { return fmt::format("{}:{}", name_, lines_.number()); }

CsvText parse_csv(std::string_view text, const std::string& name) {
  CsvReader reader(text, name);
  CsvText csv{.columns = reader.columns()};
  while (reader.next()) {
    std::vector<std::string> row;
    for (std::size_t j = 0; j < csv.columns.size(); ++j) row.emplace_back(reader.value(j));
    csv.rows.push_back(std::move(row));
    csv.lines.push_back(reader.line());
  }
  return csv;
}

std::string read_text(const std::string& path) {
  if (!is_there(path)) fail("{}: no such file", path);
  if (!is_file(path)) fail("{}: expected a file, met a folder or a device", path);
  std::ifstream stream(path, std::ios::binary);
  std::string text, block(1 << 20, '\0');
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0)
    text.append(block, 0, static_cast<std::size_t>(stream.gcount()));
  if (!stream.is_open() || stream.bad()) fail("{}: cannot be read", path);
  return text;
}

Table untyped_table(const CsvText& csv) {
  Table table;
  for (const std::string& name : csv.columns) table.columns.push_back({name, "", ""});
  for (const auto& values : csv.rows) {
    Row& row = table.rows.emplace_back();
    for (const std::string& value : values) {
      const std::optional<double> number = number_of(trimmed(value));
      row.push_back(number ? Cell(*number) : Cell(value));
    }
  }
  return table;
}

std::string compare(const Table& table, const CsvText& expected, double tolerance,
                    const std::map<std::string, double>& column_tolerance, bool relative) {
  constexpr auto not_compared = std::to_array<std::string_view>(
      {"applications", "iterations", "first_iteration", "last_iteration", "spectra", "residual", "difference"});
  if (!std::ranges::equal(table.columns, expected.columns, {}, &Column::name)) return "the columns differ";
  if (table.rows.size() != expected.rows.size())
    return fmt::format("expected {} rows, met {}", expected.rows.size(), table.rows.size());
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    for (std::size_t j = 0; j < table.columns.size(); ++j) {
      const std::string& name = table.columns[j].name;
      if (std::ranges::find(not_compared, name) != not_compared.end()) continue;
      const auto own = column_tolerance.find(name);
      if (!same_value(table.rows[i][j], expected.rows[i][j], own == column_tolerance.end() ? tolerance : own->second,
                      relative))
        return fmt::format("row {}, column {}: expected {}, met {}", i + 1, name, expected.rows[i][j],
                           to_text(table.rows[i][j]));
    }
  return "";
}

}  // namespace nscdd
