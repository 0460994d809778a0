// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/packing/text_packing.hpp"

#include "core/fail.hpp"
#include "core/text.hpp"
#include "formats/packing/packing_columns.hpp"

namespace nscdd {
namespace {

// The lines of a text that say something, one at a time.
class Lines {
 public:
  explicit Lines(std::string_view text) : lines_(text) {}
  bool next() {
    while (lines_.next()) {
      line_ = trimmed(lines_.line());
      if (!line_.empty() && line_.front() != '#') return true;
      if (line_.starts_with(format_mark)) format_ = trimmed(line_.substr(format_mark.size()));
    }
    return false;
  }
  std::size_t number() const { return lines_.number(); }
  bool has_commas() const { return line_.find_first_of(",;") != line_.npos; }
  std::string_view format() const { return format_; }  // that YADE names in a remark; empty for none
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
  std::string_view line_, format_;
};

bool is_number(std::string_view text) { return number_of(text).has_value(); }

// Of the first line of a packing, which has other columns than "x y radius" and "x y z radius".
[[noreturn]] void refuse_columns(const std::string& name, const Lines& lines, std::size_t numbers) {
  const std::string where = fmt::format("{}:{}: expected lines 'x y radius' or 'x y z radius'", name, lines.number());
  const bool clumps = lines.format().empty() ? numbers == 5 : lines.format().find("clumpId") != std::string_view::npos;
  if (clumps)
    fail(
        "{}, met {} numbers{}: clumps of YADE (x_y_z_r_clumpId) are not supported yet: they come with bodies of "
        "several "
        "contactors; without the fifth column their members are read as free grains",
        where, numbers, lines.format().empty() ? ", the fifth one as of a clump" : "");
  if (!lines.format().empty()) fail("{}, met {} numbers, the format '{}' of YADE", where, numbers, lines.format());
  fail("{}, met {} numbers", where, numbers);
}

// Of a line "x y radius" and of one "x y z radius".
constexpr std::array plane_columns{packing_column("x"), packing_column("y"), packing_column("radius")};
constexpr std::array space_columns{packing_column("x"), packing_column("y"), packing_column("z"),
                                   packing_column("radius")};

}  // namespace

bool is_text_packing(std::string_view text) {
  Lines lines(text);
  if (!lines.next()) return false;
  const std::vector<std::string_view> words = lines.words();
  return words.size() > 1 && !lines.has_commas() && std::ranges::any_of(words, is_number);
}

Packing parse_text_packing(std::string_view text, const std::string& name) {
  Packing packing;
  Lines lines(text);
  std::span<const PackingColumn> columns;
  std::size_t first_line = 0;
  while (lines.next()) {
    const std::vector<std::string_view> words = lines.words();
    if (columns.empty()) {
      first_line = lines.number();
      if (words.size() != plane_columns.size() && words.size() != space_columns.size())
        refuse_columns(name, lines, words.size());
      columns = words.size() == plane_columns.size() ? std::span<const PackingColumn>(plane_columns) : space_columns;
    }
    if (words.size() != columns.size())
      fail("{}:{}: expected {} numbers as in line {}, met {}", name, lines.number(), columns.size(), first_line,
           words.size());
    for (std::size_t k = 0; k < columns.size(); ++k)
      (packing.*(columns[k].values)).push_back(packing_value(words[k], columns[k], name, lines.number()));
  }
  if (packing.size() == 0) fail("{}: expected at least one grain, met none", name);
  // One z for all is how plane packings are exchanged.
  if (std::ranges::all_of(packing.z, [&](double z) { return z == packing.z.front(); })) packing.z.clear();
  return packing;
}

}  // namespace nscdd
