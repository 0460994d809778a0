// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/text_packing.hpp"

#include "core/fail.hpp"
#include "core/text.hpp"
#include "formats/packing_columns.hpp"

#include <charconv>

namespace nscdd {
namespace {

// The lines of a text that say something, one at a time.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (rest_.starts_with(byte_order_mark)) rest_.remove_prefix(byte_order_mark.size());
  }
  bool next() {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++number_;
      if (line_.ends_with('\r')) line_.remove_suffix(1);
      line_ = trimmed(line_);
      if (!line_.empty() && line_.front() != '#') return true;
    }
    return false;
  }
  std::size_t number() const { return number_; }
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
  std::string_view rest_, line_;
  std::size_t number_ = 0;
};

bool is_number(std::string_view text) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size();
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
  return words.size() > 1 && std::ranges::all_of(words, is_number);
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
        fail("{}:{}: expected lines 'x y radius' or 'x y z radius', met {} numbers", name, first_line, words.size());
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
