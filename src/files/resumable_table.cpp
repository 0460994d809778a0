// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/resumable_table.hpp"

#include "files/strict_toml.hpp"

namespace nscdd {
namespace {

constexpr std::array<const char*, 4> type_names{"integer", "number", "boolean", "text"};  // as in Cell

struct WorkPart {
  const char *key, *what;
  std::string WorkIdentity::*text;
};
constexpr WorkPart work_parts[] = {{"version", "code version", &WorkIdentity::version},
                                   {"cases", "case", &WorkIdentity::cases},
                                   {"options", "choice of options", &WorkIdentity::options},
                                   {"effort", "choice of solver options", &WorkIdentity::effort}};

std::string record_path(const std::string& table) { return table + ".record"; }

// A multi-line TOML string. Every text ends with a line feed, so its quotes never touch the closing ones.
std::string lines(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || (c == '"' && escaped.ends_with("\"\""))) escaped += '\\';
    escaped += c;
  }
  return fmt::format("\"\"\"\n{}\"\"\"", escaped);
}

// The first different line of two texts.
std::string differing_line(std::string_view expected, std::string_view met) {
  TextLines a(expected), b(met);
  while (true) {
    const bool more_a = a.next(), more_b = b.next();
    if (!more_a && !more_b) return "expected other line ends";
    if (a.line() != b.line()) return fmt::format("expected '{}', met '{}'", a.line(), b.line());
  }
}

// Calls f(line, number from 1) for each complete line until it returns false; returns the bytes of the lines before.
std::size_t for_each_line(std::string_view text, auto&& f) {
  std::size_t start = 0;
  Index number = 0;
  for (auto end = text.find('\n'); end != std::string_view::npos; end = text.find('\n', start)) {
    if (!f(text.substr(start, end - start), ++number)) return start;
    start = end + 1;
  }
  return start;
}

Index line_count(std::string_view text) { return std::count(text.begin(), text.end(), '\n'); }

Row parse_row(std::string_view line, const std::vector<std::string>& types, const std::string& where) {
  const std::vector<std::string> values = csv_values(line, where);
  if (values.size() != types.size()) fail("{}: expected {} values, met {}", where, types.size(), values.size());
  Row row;
  for (std::size_t i = 0; i < values.size(); ++i) row.push_back(parse_cell(values[i], types[i], where));
  return row;
}

// The rows of `text` without a truncated last line: no line feed, or too few values.
KeptRows usable_rows(const std::string& text, const TableRecord& record, const TableWork& work,
                     const std::string& name) {
  KeptRows kept{"", record.types, 0, false};
  const Table layout{work.columns, {}};
  const std::string header = csv_header(layout.columns);
  const Index lines = line_count(text);
  const std::size_t bytes = for_each_line(text, [&](std::string_view line, Index number) {
    const std::string where = fmt::format("{}:{}", name, number);
    if (number == 1) {
      if (line != header) fail("{}: expected the columns {}, met {}", where, header, line);
      return true;
    }
    if (number == lines && csv_values(line, where).size() < layout.columns.size()) return false;
    if (work.rows && kept.rows >= *work.rows) fail("{}: expected {} rows at the most, met another", where, *work.rows);
    const Row row = parse_row(line, record.types, where);
    for (const auto& [column, expected] : work.known_cells(kept.rows++))
      if (const std::string met = to_text(row[layout.column(column)]); met != to_text(expected))
        fail("{}: {}: expected {}, met {}", where, column, to_text(expected), met);
    return true;
  });
  kept.text = text.substr(0, bytes);
  return kept;
}

// Throws Error unless the record is of the same work.
TableRecord matching_record(const std::string& path, const std::string& rows, const TableWork& work) {
  const std::string name = record_path(path);
  TableRecord record;
  try {
    record = parse_record(read_text(name), name);
  } catch (const Error& error) {
    fail("{}: cannot be resumed: {}; --force starts again", rows, error.what());
  }
  const std::string found = difference(record.work, work.identity);
  if (!found.empty()) fail("{}: cannot be resumed: {} (as recorded in {})", rows, found, name);
  return record;
}

KeptRows partial_rows(const std::string& path, const TableWork& work) {
  const std::string name = partial_path(path).string();
  const std::string text = read_text(name);
  if (line_count(text) < 2) return {};  // no row was finished
  if (!is_there(record_path(path)))
    fail("{}: cannot be resumed: no {} tells what its rows come from; --force starts again", name, record_path(path));
  const TableRecord record = matching_record(path, name, work);
  if (!work.rows) return {};
  return usable_rows(text, record, work, name);
}

// A finished table with a record belongs to work that was interrupted later.
KeptRows finished_rows(const std::string& path, const TableWork& work, bool force) {
  if (is_there(record_path(path))) {
    const TableRecord record = matching_record(path, path, work);
    const std::string text = read_text(path);
    if (record.finished == fingerprint(text)) {
      KeptRows kept = usable_rows(text, record, work, path);
      kept.finished = true;
      return kept;
    }
  }
  if (force) return {};
  fail(
      "{}: exists already, and nothing proves that it comes from this work; choose another name, or --force to replace "
      "it",
      path);
}

}  // namespace

std::string difference(const WorkIdentity& expected, const WorkIdentity& met) {
  for (const auto& [key, what, part] : work_parts)
    if (expected.*part != met.*part)
      return fmt::format("the {} differs: {}", what, differing_line(expected.*part, met.*part));
  return "";
}

std::string to_toml(const TableRecord& record) {
  std::vector<std::string> types;
  for (const std::string& type : record.types) types.push_back(field_text(type));
  std::string text =
      "# What the rows of the table beside this file come from; --resume goes on with equal work only.\n";
  for (const WorkPart& part : work_parts) text += fmt::format("{} = {}\n\n", part.key, lines(record.work.*part.text));
  return text + fmt::format("types = [{}]\nfinished = {}\n", fmt::join(types, ", "), field_text(record.finished));
}

TableRecord parse_record(std::string_view text, const std::string& file) {
  const toml::table document = parse_toml(text, file);
  StrictTable root(document, file, "");
  TableRecord record;
  root.require_keys({"version", "cases", "options", "effort", "types"});
  for (const WorkPart& part : work_parts) root.read(part.key, record.work.*part.text);
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
  if (type != "boolean") fail("{}: no such type of a cell: '{}'", where, type);
  bool flag = false;
  parse_value(text, flag, where);
  return flag;
}

bool is_complete(const std::string& path) {
  return !is_stream(path) && is_there(path) && !is_there(partial_path(path)) && !is_there(record_path(path));
}

void require_rows_of(const TableWork& work, const std::string& path) {
  constexpr std::string_view way_out = "--force replaces what is there";
  const Table layout{work.columns, {}};
  const std::string text = read_text(path), header = csv_header(layout.columns);
  if (const std::string met = text.substr(0, text.find('\n')); met != header)
    fail("{}:1: expected the columns {}, met {}; {}", path, header, met, way_out);
  if (!work.rows) return;
  CsvReader reader(text, path);
  Index number = 0;
  for (; number < *work.rows && reader.next(); ++number)
    for (const auto& [column, expected] : work.known_cells(number))
      if (const std::string met(reader.value(layout.column(column))); met != to_text(expected))
        fail("{}:{}: {}: expected {} of this work, met {}; {}", path, reader.line(), column, to_text(expected), met,
             way_out);
  if (number < *work.rows || reader.next())
    fail("{}: expected {} rows of this work, met another number; {}", path, *work.rows, way_out);
}

void remove_record(const std::string& path) {
  std::error_code ignored;
  if (!is_stream(path)) std::filesystem::remove(record_path(path), ignored);
}

KeptRows kept_rows(const std::string& path, const TableWork& work, Reopening how) {
  if (is_stream(path)) {
    if (how.resume) fail("--resume: expected a table in a file, met '{}', which keeps nothing", path);
    return {};
  }
  const bool partial = is_there(partial_path(path));
  if (how.resume) {
    if (!partial && is_there(path)) return finished_rows(path, work, how.force);
    require_writable(path, how.force, true);
    return partial ? partial_rows(path, work) : KeptRows{};
  }
  if (partial && !how.force && !is_there(path))
    fail("{}: holds {} row(s) of an interrupted run; --resume continues it, --force starts again",
         partial_path(path).string(), std::max<Index>(line_count(read_text(partial_path(path).string())) - 1, 0));
  require_writable(path, how.force);
  return {};
}

ResumableTable::ResumableTable(std::string path, TableWork work, Reopening how)
    : path_(std::move(path)), work_(std::move(work)), stream_(is_stream(path_)), found_(kept_rows(path_, work_, how)) {
  if (found_.finished) return;
  csv_.emplace(path_, how.force, work_.columns, how.resume ? std::optional(found_.text.size()) : std::nullopt);
  if (stream_ || found_.rows > 0) return;
  remove_record(path_);  // of removed rows
  record_is_ours_ = true;
}

// After an error, what was computed stays.
ResumableTable::~ResumableTable() {
  try {
    if (written_ > 0 && !stream_ && work_.rows) leave();
  } catch (const Error&) {  // nothing more can be written: the partial file goes, and with it the record
  }
  if (csv_ && record_is_ours_) remove_record(path_);
}

void ResumableTable::replay(const std::function<void(const Row&)>& sink) const {
  for_each_line(found_.text, [&](std::string_view line, Index number) {
    if (number > 1) sink(parse_row(line, found_.types, fmt::format("{}:{}", path_, number)));
    return true;
  });
}

void ResumableTable::write_record(const std::string& finished) const {
  write_file(record_path(path_), to_toml(TableRecord{work_.identity, found_.types, finished}), true);
}

void ResumableTable::write(const Row& row) {
  if (!stream_ && found_.types.empty()) {
    found_.types = cell_types(row);
    write_record("");
  }
  csv_->write(row);
  ++written_;
}

void ResumableTable::finish() {
  if (!csv_) return;
  csv_->flush();
  if (!stream_) write_record(fingerprint(read_text(partial_path(path_).string())));
  csv_->finish();
  csv_.reset();
}

void ResumableTable::leave() {
  if (!csv_) return;
  csv_->leave();
  csv_.reset();
}

}  // namespace nscdd
