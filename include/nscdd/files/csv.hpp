// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/files/output_file.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nscdd {

/// Writes a table row by row as CSV (RFC 4180 with line feeds): a line of column names, then one line per
/// row, as OutputFile writes lines. Equal tables give equal bytes.
class CsvWriter {
 public:
  /// With `kept_bytes` > 0, continues the partial file of a run before behind that many bytes, which hold the
  /// line of names.
  CsvWriter(const std::string& path, bool force, const std::vector<Column>& columns,
            std::optional<std::uintmax_t> kept_bytes = std::nullopt);
  void write(const Row& row);
  void flush();  ///< writes the names, where no row has, and the rows gathered
  void finish();
  void leave() { file_.leave(); }  ///< closes the partial file and keeps it

 private:
  OutputFile file_;
  std::string header_;  ///< until it is written, with the first row: a run that fails before prints nothing
};

/// One line of CSV without its line feed: a value that holds a comma, a quote or a line feed stands in
/// quotes.
std::string csv_line(const std::vector<std::string>& values);
std::string csv_line(const Row& row);

/// The line of names of a table.
std::string csv_header(const std::vector<Column>& columns);

/// Values of one line of CSV, quotes as in RFC 4180. Throws Error beginning with `where` for an open quote.
std::vector<std::string> csv_values(std::string_view line, const std::string& where);

/// Reads CSV text row by row: first line of names, quotes as in RFC 4180, blank lines and lines that begin
/// with '#' left out, CRLF and a byte order mark accepted. The text must outlive the reader.
/// Throws Error "name:line: ..." for a row with too few or too many values, an open quote, an empty or
/// repeated column name, or text without a line of names.
class CsvReader {
 public:
  CsvReader(std::string_view text, std::string name);
  const std::vector<std::string>& columns() const { return columns_; }
  bool next();  ///< to the next row; false after the last
  std::string_view value(std::size_t column) const { return values_[column]; }
  std::size_t line() const { return line_; }  ///< line number of the row (at first of the names), from 1

 private:
  bool next_line();
  void split(std::string_view line);
  std::string where() const;
  std::string_view rest_;
  std::string name_;
  std::size_t line_ = 0;
  std::vector<std::string> columns_;
  std::vector<std::string_view> values_;
  std::vector<std::pair<std::size_t, std::string>>
      quoted_;  ///< values that are not as they stand in the text
};

/// A CSV file as texts.
struct CsvText {
  std::vector<std::string> columns;
  std::size_t header_line = 0;  ///< line number of the names, from 1
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> lines;  ///< line number of each row, from 1
};

/// The whole of a CSV text, as CsvReader reads it.
CsvText parse_csv(std::string_view text, const std::string& name);

/// Whole content of a regular file. Throws Error where it cannot be read.
std::string read_text(const std::string& path);

/// The table with a number where a value reads as one, else a text: its columns have no units.
Table untyped_table(const CsvText& csv);

/// First difference between a table and the CSV text of another, or "" where there is none: same columns,
/// same number of rows, texts equal, numbers within `tolerance` x max(1, |number|), or the tolerance given
/// for their column (`relative`: x |number| alone, so that small numbers count as much as large ones).
/// Columns that tell the effort of a solver (applications, iterations, spectra) or its rounding (residual,
/// difference) are not compared.
std::string compare(const Table& table, const CsvText& expected, double tolerance,
                    const std::map<std::string, double>& column_tolerance = {}, bool relative = false);

}  // namespace nscdd
