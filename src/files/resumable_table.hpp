// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/csv.hpp"

#include <filesystem>

namespace nscdd {

/// Everything that the rows of a table come from, as texts to be compared: equal texts give equal rows (on
/// one machine; from one processor to another the BLAS may round otherwise).
struct WorkIdentity {
  std::string version;  ///< of the program, its build and the libraries
  std::string cases;    ///< resolved, with the content of packing files: their paths do not count
  std::string options;  ///< which points: columns, values of the lists, contacts, seed
  std::string effort;   ///< how hard each point is worked on: solver, tolerances, limits
};

/// First difference as "the options differ: expected ..., met ...", or "" where there is none.
std::string difference(const WorkIdentity& expected, const WorkIdentity& met);

/// The file beside a growing table that tells what its rows come from: FILE.record, TOML.
struct TableRecord {
  WorkIdentity work;
  std::vector<std::string> types;  ///< of the columns: "integer", "number", "boolean" or "text"
  std::string finished;            ///< fingerprint of the whole table once it is complete, else empty
};

std::filesystem::path record_path(const std::filesystem::path& table);

std::string to_toml(const TableRecord& record);

/// Reads what `to_toml` wrote; throws Error "file:line: ..." for anything else.
TableRecord parse_record(std::string_view text, const std::string& file);

/// The name of the type of each cell, and the cell of a type that a text stands for, with every bit of a number.
std::vector<std::string> cell_types(const Row& row);
Cell parse_cell(const std::string& text, const std::string& type, const std::string& where);

/// What may be done with files that exist already.
struct Reopening {
  bool resume = false;  ///< go on with the rows of an interrupted run
  bool force = false;   ///< replace a finished table, and without `resume` a partial one, too
};

/// A table as far as it is known before its rows are computed.
struct TableWork {
  WorkIdentity identity;
  std::vector<Column> columns;
  std::optional<Index> rows;  ///< how many, if that is known
  /// Cells of a row, counted from 0, that are known beforehand, by column.
  std::function<std::vector<std::pair<std::string, Cell>>(Index row)> known_cells;
};

/// Rows that an earlier run of the same work left.
struct KeptRows {
  std::string text;                ///< the line of names and whole rows, as in the file
  std::vector<std::string> types;  ///< of the columns
  Index rows = 0;
  bool finished = false;  ///< the whole table, under its own name
};

/// What a run of `work` finds under `path`: nothing, or rows to go on with. Rows are kept only if the record
/// beside them equals that of `work` and every cell known beforehand is as expected. An incomplete last line
/// is left out. Tables whose rows are not known beforehand (links, grains) start again unless they are
/// finished. Throws Error and touches nothing if files may not be reopened that way or come from other work.
KeptRows kept_rows(const std::string& path, const TableWork& work, Reopening how);

/// Whether the table exists and is finished: neither a partial file nor a record is left beside it.
bool is_complete(const std::string& path);

/// Removes the record of a finished table: nothing is left to be resumed.
void remove_record(const std::string& path);

/// A CSV table that outlives its run. FILE.partial grows row by row beside FILE.record. Both stay if the run
/// is killed or left. When the table is complete, FILE.partial becomes FILE, and FILE.record proves what FILE
/// comes from until nothing waits for it any more. A run that fails by an exception removes what it wrote,
/// unless there were rows before it. Streams ("-", devices, pipes) have neither file and cannot be resumed.
class ResumableTable {
 public:
  ResumableTable(std::string path, TableWork work, Reopening how);
  ~ResumableTable();
  ResumableTable(const ResumableTable&) = delete;
  ResumableTable& operator=(const ResumableTable&) = delete;

  Index kept() const { return found_.rows; }  ///< rows that existed before this run
  Index rows() const { return found_.rows + written_; }
  std::optional<Index> total() const { return work_.rows; }
  void replay(const std::function<void(const Row&)>& sink) const;  ///< hands over the rows that existed before
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
  std::optional<CsvWriter> csv_;  ///< absent if the table was finished before
  bool record_is_ours_ = false;   ///< written for rows of this run alone, which go with them
};

}  // namespace nscdd
