// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "core/text.hpp"
#include "files/csv.hpp"
#include "files/hdf5_file.hpp"
#include "formats/lmgc90/datbox.hpp"
#include <nscdd/core/fields.hpp>
#include <nscdd/formats/packing_file.hpp>

#include <filesystem>
#include <map>

namespace nscdd {
namespace {

// A column of a packing file of any format.
struct PackingColumn {
  std::vector<double> Packing::*values;
  bool required;
  std::string_view name;
  Field field;
};

constexpr Field packing_place{.description = "centre of the grain", .unit = "m", .minimum = -1e100, .maximum = 1e100};
constexpr Field packing_positive(std::string_view name, std::string_view unit) {
  return {.description = name, .unit = unit, .above = 0, .maximum = 1e100};
}

constexpr PackingColumn packing_columns[] = {{&Packing::x, true, "x", packing_place},
                                             {&Packing::y, true, "y", packing_place},
                                             {&Packing::z, false, "z", packing_place},  // in space only
                                             {&Packing::radius, true, "radius", packing_positive("radius", "m")},
                                             {&Packing::mass, false, "mass", packing_positive("mass", "kg")}};

const PackingColumn* find_column(std::string_view name) {
  const auto found = std::ranges::find(packing_columns, name, &PackingColumn::name);
  return found == std::end(packing_columns) ? nullptr : found;
}

// Throws Error unless `met` has all required columns.
void require_columns(const std::vector<const PackingColumn*>& met, std::string_view where, std::string_view kind) {
  for (const PackingColumn& known : packing_columns)
    if (known.required && std::find(met.begin(), met.end(), &known) == met.end())
      fail("{}: expected a {} '{}', met none", where, kind, known.name);
}

// Throws Error for clumps.
std::vector<const PackingColumn*> columns_of(const Packing& packing) {
  if (!packing.clump.empty())
    fail(
        "expected free grains, met clumps, which have no column in CSV and HDF5: nscdd simulate takes them from a text "
        "of YADE");
  std::vector<const PackingColumn*> columns;
  for (const PackingColumn& column : packing_columns)
    if (column.required || !(packing.*(column.values)).empty()) columns.push_back(&column);
  return columns;
}

std::string header_of(const std::vector<const PackingColumn*>& columns) {
  Row names;
  for (const PackingColumn* column : columns) names.emplace_back(std::string(column->name));
  return csv_line(names);
}

// Remarks of CSV: every line begins with '#'.
std::string remarks(const Provenance& provenance) {
  std::string text;
  for (const auto& [name, content] : provenance) {
    text += fmt::format("# {}:{}", name, content.find('\n') == std::string::npos ? " " : "\n#   ");
    for (const char c : content.substr(0, content.find_last_not_of('\n') + 1))
      text += c == '\n' ? std::string("\n#   ") : std::string(1, c);
    text += '\n';
  }
  return text;
}

// Formats the place of a number only for errors, because most numbers are valid.
double packing_value(std::string_view text, const PackingColumn& column, const std::string& name, std::size_t line) {
  const std::optional<double> found = number_of(text);
  if (found && in_bounds(*found, column.field)) return *found;
  const std::string where = fmt::format("{}:{}: {}", name, line, column.name);
  const double value = found ? *found : parse_number(text, where);
  check_bounds(value, column.field, where);
  return value;
}

// The lines of a text that are neither blank nor remarks, one at a time.
class Lines {
 public:
  explicit Lines(std::string_view text) : lines_(text) {}
  bool next() {
    while (lines_.next()) {
      line_ = trimmed(lines_.line());
      if (!line_.empty() && line_.front() != '#') return true;
      if (line_.starts_with(format_mark) && line_.find_first_of(" \t") == format_mark.size())
        format_ = trimmed(line_.substr(format_mark.size()));
      if (line_.starts_with("##PERIODIC::")) cell_ = line_;
    }
    return false;
  }
  std::size_t number() const { return lines_.number(); }
  bool has_commas() const { return line_.find_first_of(",;") != line_.npos; }
  std::string_view format() const { return format_; }  // from a remark of YADE, or empty
  std::string_view cell() const { return cell_; }      // likewise
  std::vector<std::string_view> words() const {
    std::vector<std::string_view> all;
    for (std::string_view rest = line_; !rest.empty();) {
      const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
      all.push_back(rest.substr(0, end));
      rest = trimmed(rest.substr(end));
    }
    return all;
  }

 private:
  static constexpr std::string_view format_mark = "#format";
  TextLines lines_;
  std::string_view line_, format_, cell_;
};

constexpr std::string_view clump_format = "x_y_z_r_clumpId";

// Throws Error for a first line other than "x y radius", "x y z radius" and, with that format, "x y z radius clump".
[[noreturn]] void refuse_columns(const std::string& name, const Lines& lines, std::size_t numbers) {
  const std::string where = fmt::format("{}:{}: expected lines 'x y radius' or 'x y z radius'", name, lines.number());
  if (lines.format().empty() && numbers == 5)
    fail("{}, met {} numbers; a fifth one is that of a clump if a line '#format {}' is before it", where, numbers,
         clump_format);
  if (!lines.format().empty()) fail("{}, met {} numbers, the format '{}' of YADE", where, numbers, lines.format());
  fail("{}, met {} numbers", where, numbers);
}

// A grain that is alone in its clump moves as a free grain.
void free_single_grains(std::vector<Index>& clump) {
  std::map<Index, Index> members;
  for (const Index number : clump) ++members[number];
  for (Index& number : clump)
    if (members[number] == 1) number = -1;
  if (std::ranges::count(clump, -1) == count(clump)) clump.clear();
}

Packing parse_text_packing(std::string_view text, const std::string& name) {
  Packing packing;
  Lines lines(text);
  std::vector<const PackingColumn*> columns;
  std::size_t first_line = 0, numbers = 0;
  while (lines.next()) {
    const std::vector<std::string_view> words = lines.words();
    if (columns.empty()) {
      first_line = lines.number();
      numbers = words.size();
      const std::string_view format = lines.format();
      const bool fits = format.empty()           ? numbers == 3 || numbers == 4
                        : format == "x_y_r"      ? numbers == 3
                        : format == "x_y_z_r"    ? numbers == 4
                        : format == clump_format ? numbers == 5
                                                 : false;
      if (!fits) refuse_columns(name, lines, numbers);
      columns = {find_column("x"), find_column("y"), find_column("z"), find_column("radius")};
      if (numbers == 3) columns.erase(columns.begin() + 2);
    }
    if (words.size() != numbers)
      fail("{}:{}: expected {} numbers as in line {}, met {}", name, lines.number(), numbers, first_line, words.size());
    for (std::size_t k = 0; k < columns.size(); ++k)
      (packing.*(columns[k]->values)).push_back(packing_value(words[k], *columns[k], name, lines.number()));
    if (numbers < 5) continue;
    const std::string where = fmt::format("{}:{}: clumpId", name, lines.number());
    packing.clump.push_back(parse_integer(words[4], where));
    check_bounds(packing.clump.back(), Field{.minimum = -1}, where);
  }
  if (!lines.cell().empty())
    fail("{}: expected no periodic cell, met '{}'; without this line, contacts.period_x and period_y state it", name,
         lines.cell());
  if (packing.size() == 0) fail("{}: expected at least one grain, met none", name);
  free_single_grains(packing.clump);
  // Plane packings are exchanged with one z for all grains.
  if (std::ranges::all_of(packing.z, [&](double z) { return z == packing.z.front(); })) packing.z.clear();
  return packing;
}

}  // namespace

std::optional<PackingFormat> packing_format(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".csv") return PackingFormat::csv;
  if (extension == ".h5" || extension == ".hdf5") return PackingFormat::hdf5;
  return std::nullopt;
}

bool is_text_packing(std::string_view text) {
  Lines lines(text);
  if (!lines.next()) return false;
  const std::vector<std::string_view> words = lines.words();
  return words.size() > 1 && !lines.has_commas() &&
         std::ranges::any_of(words, [](std::string_view word) { return number_of(word).has_value(); });
}

Packing parse_packing(std::string_view text, const std::string& name) {
  require_utf8(text, name);
  if (is_text_packing(text)) return parse_text_packing(text, name);
  CsvReader reader = [&] {
    try {
      return CsvReader(text, name);
    } catch (const Error& error) {
      fail("{}; expected columns x, y, radius and optionally z and mass, named in line 1", error.what());
    }
  }();
  const std::string header = fmt::format("{}:{}", name, reader.line());
  std::vector<const PackingColumn*> meaning;
  for (const std::string& column : reader.columns()) {
    meaning.push_back(find_column(column));
    if (meaning.back() == nullptr)
      fail("{}: expected columns x, y, radius and optionally z and mass, met '{}'{}", header, column,
           column == "clumpId" ? fmt::format(": clumps are read from lines of numbers below '#format {}'", clump_format)
                               : "");
  }
  require_columns(meaning, header, "column");
  Packing packing;
  while (reader.next())
    for (std::size_t j = 0; j < meaning.size(); ++j)
      (packing.*(meaning[j]->values)).push_back(packing_value(reader.value(j), *meaning[j], name, reader.line()));
  if (packing.size() == 0) fail("{}: expected at least one grain, met none", name);
  return packing;
}

Packing packing_from_hdf5(std::string_view bytes, const std::string& name) {
  Packing packing;
  std::vector<const PackingColumn*> met;
  const hdf5::File file(bytes, name);
  const hdf5::Group group = file.root().group("packing");
  for (const std::string& dataset : group.members()) {
    std::vector<double> values = group.numbers<double>(dataset);
    const std::string where = group.of(dataset);
    met.push_back(find_column(dataset));
    if (met.back() == nullptr)
      fail("{}: expected datasets x, y, radius and optionally z and mass, met '{}'", where, dataset);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!in_bounds(values[i], met.back()->field))
        check_bounds(values[i], met.back()->field, fmt::format("{}: grain {}", where, i));
    packing.*(met.back()->values) = std::move(values);
  }
  require_columns(met, name + ": packing", "dataset");
  for (const PackingColumn* column : met)
    if (count(packing.*(column->values)) != packing.size())
      fail("{}: packing/{}: expected {} numbers as in x, met {}", name, column->name, packing.size(),
           count(packing.*(column->values)));
  if (packing.size() == 0) fail("{}: expected at least one grain, met none", name);
  return packing;
}

Packing read_packing(const std::string& path) {
  if (holds_datbox(path)) return datbox_packing(read_datbox(path), DatboxGrains::free);
  const std::string content = read_text(path);
  return packing_format(path) == PackingFormat::hdf5 ? packing_from_hdf5(content, path) : parse_packing(content, path);
}

std::string packing_csv(const Packing& packing) {
  const auto columns = columns_of(packing);
  std::string text = header_of(columns) + '\n';
  Row row(columns.size());
  for (std::size_t i = 0; i < packing.x.size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) row[j] = (packing.*(columns[j]->values))[i];
    text += csv_line(row) + '\n';
  }
  return text;
}

std::string packing_bytes(PackingFormat format, const Packing& packing, const Provenance& provenance) {
  if (format == PackingFormat::csv) return remarks(provenance) + packing_csv(packing);
  const auto columns = columns_of(packing);
  return hdf5::new_file_bytes([&](const hdf5::Group& root) {
    hdf5::put_provenance(root, provenance);
    const hdf5::Group group = root.make_group("packing");
    group.put_attribute("columns", header_of(columns));
    for (const PackingColumn* column : columns)
      group.put<double>(std::string(column->name), packing.*(column->values),
                        {.attributes = {{"unit", column->field.unit}, {"description", column->field.description}}});
  });
}

}  // namespace nscdd
