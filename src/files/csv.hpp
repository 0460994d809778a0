// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/text.hpp"
#include "files/output_file.hpp"
#include <nscdd/core/table.hpp>

#include <deque>
#include <map>

namespace nscdd {

/// Writes a table to an OutputFile as CSV (RFC 4180 with line feeds): a line of column names, then one per row.
class CsvWriter {
 public:
  /// With `kept_bytes` > 0, continues the partial file of an earlier run after these bytes, which include the header.
  CsvWriter(const std::string& path, bool force, const std::vector<Column>& columns,
            std::optional<std::uintmax_t> kept_bytes = std::nullopt);
  void write(const Row& row);
  void flush();  ///< writes the gathered rows, or the header if there is no row yet
  void finish();
  void leave() { file_.leave(); }  ///< closes the partial file and keeps it

 private:
  OutputFile file_;
  std::string header_;  ///< waits for the first row: a run that fails before it prints nothing
};

/// One line of CSV without its line feed; values with a comma, a quote or a line feed are quoted.
std::string csv_line(const Row& row);
std::string csv_header(const std::vector<Column>& columns);

/// Values of one line of CSV, quoted as in RFC 4180. Throws Error "where: ..." for a quote that is not closed.
std::vector<std::string> csv_values(std::string_view line, const std::string& where);

/// Reads CSV text (RFC 4180) row by row. The first line holds the names. Blank lines and lines that begin with '#' are
/// skipped; for line ends and a byte order mark see TextLines. The text must outlive the reader. Throws Error
/// "name:line: ..." for a row with too few or too many values, a quote that is not closed, an empty or repeated column
/// name, text without a line of names, or UTF-16.
class CsvReader {
 public:
  CsvReader(std::string_view text, std::string name);
  const std::vector<std::string>& columns() const { return columns_; }
  bool next();  ///< advances to the next row; false after the last one
  std::string_view value(std::size_t column) const { return values_[column]; }
  std::size_t line() const { return lines_.number(); }  ///< of the row, initially of the header; from 1

 private:
  bool next_line();
  std::string where() const;
  TextLines lines_;
  std::string name_;
  std::vector<std::string> columns_;
  std::vector<std::string_view> values_;
  std::deque<std::string> quoted_;  ///< quoted values, without quotes
};

struct CsvText {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows{};
  std::vector<std::size_t> lines{};  ///< line number of each row, from 1
};

/// All rows of CsvReader.
CsvText parse_csv(std::string_view text, const std::string& name);

/// The whole content of a regular file. Throws Error if it cannot be read.
std::string read_text(const std::string& path);

/// The table without units. A cell is a number if it reads as one, else a text.
Table untyped_table(const CsvText& csv);

/// The first difference between a table and the CSV text of another, or "" if they agree: equal columns, numbers of
/// rows and texts, and numbers that differ by at most `tolerance` x max(1, |number|), or x |number| if `relative`. A
/// column may have its own tolerance. Not compared: effort (applications, iterations, spectra), residual, difference.
std::string compare(const Table& table, const CsvText& expected, double tolerance,
                    const std::map<std::string, double>& column_tolerance = {}, bool relative = false);

}  // namespace nscdd
