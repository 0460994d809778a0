// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/csv.hpp"

namespace nscdd {

/// Everything that determines the rows of a table, as texts: equal texts give equal rows on one machine.
struct WorkIdentity {
  std::string version;  ///< of the program, its build and the libraries
  std::string cases;    ///< resolved, with the content of packing files, not their paths
  std::string options;  ///< which points: columns, values of the lists, contacts, seed
  std::string effort;   ///< per point: solver, tolerances, limits
};

/// First difference as "the options differ: expected ..., met ...", or "".
std::string difference(const WorkIdentity& expected, const WorkIdentity& met);

/// Record of a growing table, FILE.record in TOML: the origin of its rows.
struct TableRecord {
  WorkIdentity work;
  std::vector<std::string> types;  ///< of the columns: "integer", "number", "boolean" or "text"
  std::string finished;            ///< fingerprint of the complete table, else empty
};

std::string to_toml(const TableRecord& record);

/// Reads what `to_toml` wrote; throws Error "file:line: ..." for anything else.
TableRecord parse_record(std::string_view text, const std::string& file);

std::vector<std::string> cell_types(const Row& row);
/// The cell of a type from its text, exact to the last bit.
Cell parse_cell(const std::string& text, const std::string& type, const std::string& where);

/// How to treat existing files.
struct Reopening {
  bool resume = false;  ///< continue the rows of an interrupted run
  bool force = false;   ///< replace a finished table and, without `resume`, a partial one
};

/// A table before its rows are computed.
struct TableWork {
  WorkIdentity identity;
  std::vector<Column> columns;
  std::optional<Index> rows;  ///< their number, if known
  /// Cells of a row, from 0, known beforehand, by column.
  std::function<std::vector<std::pair<std::string, Cell>>(Index row)> known_cells;
};

/// Rows of an earlier run of the same work.
struct KeptRows {
  std::string text;                ///< header and complete rows, as in the file
  std::vector<std::string> types;  ///< of the columns
  Index rows = 0;
  bool finished = false;  ///< the whole table, under its own name
};

/// The rows of an earlier run of `work` under `path`, without an incomplete last line. Unfinished tables with an
/// unknown number of rows start again. Throws Error if `how` forbids it, if the record differs from that of `work`, or
/// if a row differs in a cell that is known beforehand. Changes nothing.
KeptRows kept_rows(const std::string& path, const TableWork& work, Reopening how);

/// Whether the table exists and is finished, without a partial file or a record.
bool is_complete(const std::string& path);

/// Throws Error unless a finished table has the columns, the number of rows and the known cells of `work`.
void require_rows_of(const TableWork& work, const std::string& path);

void remove_record(const std::string& path);

/// Resumable CSV table. FILE.partial grows row by row, with FILE.record. Both stay if the run is killed or stopped. A
/// complete FILE.partial becomes FILE, and FILE.record proves its origin until `remove_record`. An exception removes
/// both, unless earlier rows exist. Streams ("-", devices, pipes) have neither file and cannot be resumed.
class ResumableTable {
 public:
  ResumableTable(std::string path, TableWork work, Reopening how);
  ~ResumableTable();  ///< without finish: leaves the rows as `leave` does, where the table can be resumed
  ResumableTable(const ResumableTable&) = delete;
  ResumableTable& operator=(const ResumableTable&) = delete;

  Index kept() const { return found_.rows; }  ///< rows of earlier runs
  Index rows() const { return found_.rows + written_; }
  std::optional<Index> total() const { return work_.rows; }
  void replay(const std::function<void(const Row&)>& sink) const;  ///< passes the rows of earlier runs
  bool finished() const { return found_.finished; }                ///< before this run
  bool resumable() const { return !stream_; }

  void write(const Row& row);
  void finish();  ///< FILE is complete; its record stays until `remove_record`
  void leave();   ///< stopped: FILE.partial and FILE.record stay

 private:
  void write_record(const std::string& finished) const;
  std::string path_;
  TableWork work_;
  bool stream_;
  KeptRows found_;
  Index written_ = 0;
  std::optional<CsvWriter> csv_;  ///< absent for a finished table
  bool record_is_ours_ = false;   ///< has rows of this run only, and is removed with them
};

}  // namespace nscdd
