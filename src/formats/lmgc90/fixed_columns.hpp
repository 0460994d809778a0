// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/text.hpp"
#include "formats/lmgc90/datbox.hpp"

#include <charconv>

namespace nscdd {

/// The lines of a text with words and numbers in fixed columns, counted from 1, as Fortran writes them. Skips empty
/// lines and those that begin with ! or #. Errors name file and line.
class FixedColumns {
 public:
  FixedColumns(std::string_view text, std::string name) : lines_(text), name_(std::move(name)) {
    require_utf8(text, name_);
  }

  /// Advances to the next line; at the end, false and an empty line.
  bool next() {
    while (lines_.next()) {
      line_ = lines_.line();
      line_ = line_.substr(0, line_.find_last_not_of("\r \t") + 1);
      if (!line_.empty() && line_[0] != '!' && line_[0] != '#') return true;
    }
    line_ = {};
    return false;
  }
  /// Advances to the next line with that keyword, such as "$bdyty"; false if there is none.
  bool find(std::string_view keyword) {
    while (next())
      if (key() == keyword) return true;
    return false;
  }
  void require_next(std::string_view what) {
    if (!next()) fail("{}:{}: expected {}, met the end of the file", name_, lines_.number(), what);
  }

  std::string_view text(std::size_t first, std::size_t last) const {
    if (line_.size() < first) return {};
    return trimmed(line_.substr(first - 1, last - first + 1));
  }
  std::string_view line() const { return trimmed(line_); }
  std::string_view key() const { return text(1, 6); }
  bool section() const { return line_.empty() || line_[0] == '$'; }

  /// A number in the 14 columns from `first` on, with D or E for the exponent. `blank`: blanks are 0. LMGC90 reads no
  /// more: a number that begins before or goes on must have the same value with what it would cut off. Its format D14.7
  /// puts the point of a number without one before the last seven digits: such numbers are refused.
  double number(std::size_t first, std::string_view what, bool blank = false) const {
    const std::string_view field = text(first, first + 13);
    if (field.empty() && blank) return 0;
    const std::size_t end = std::max(std::min(line_.find_first_of(" \t", first + 12), line_.size()), first - 1);
    std::size_t begin = first - 1;
    if (!field.empty() && line_[begin] == field[0]) begin = line_.find_last_not_of("+-.0123456789DdEe", begin - 1) + 1;
    const std::string_view whole = field.empty() ? field : trimmed(line_.substr(begin, end - begin));
    const std::optional<double> value = fortran_number(field);
    if (!value || value != fortran_number(whole))
      refuse(fmt::format("{}: expected a number in columns {} to {}", what, first, first + 13),
             fmt::format("'{}'{}", field, whole == field ? "" : fmt::format(" of '{}'", whole)));
    if (*value != 0 && field.find('.') == std::string_view::npos)
      refuse(fmt::format("{}: expected a number with a decimal point, without which LMGC90 reads another one", what),
             fmt::format("'{}'", field));
    return *value;
  }
  /// A number from 0 to `most`.
  double number_within(std::size_t first, std::string_view what, double most) const {
    const double value = number(first, what);
    if (!(value >= 0 && value <= most))
      refuse(fmt::format("{}: expected a number from 0 to {}", what, most), fmt::format("{}", value));
    return value;
  }
  double positive_number(std::size_t first, std::string_view what) const {
    const double value = number(first, what);
    if (!(value > 0)) refuse(fmt::format("{}: expected a number above 0", what), fmt::format("{}", value));
    return value;
  }
  /// Three numbers with names such as "coo{}".
  Eigen::Vector3d three_numbers(const char* name) const {
    const auto one = [&](std::size_t first, int k) { return number(first, fmt::format(fmt::runtime(name), k)); };
    return {one(35, 1), one(56, 2), one(77, 3)};
  }
  /// A word as a number, in any column.
  double number_in(std::string_view word, std::string_view what) const {
    const std::optional<double> value = fortran_number(word);
    if (!value) refuse(fmt::format("expected {}", what), fmt::format("'{}'", word));
    return *value;
  }
  Index integer(std::size_t first, std::size_t last, std::string_view what) const {
    const std::string_view field = text(first, last);
    Index value = 0;
    const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (field.empty() || status != std::errc() || end != field.data() + field.size())
      refuse(fmt::format("{}: expected a whole number in columns {} to {}", what, first, last),
             fmt::format("'{}'", field));
    return value;
  }

  DatboxPlace place() const { return {name_, static_cast<Index>(lines_.number())}; }
  [[noreturn]] void refuse(std::string_view expected, std::string_view met) const {
    nscdd::refuse(place(), "{}, met {}", expected, met);
  }

 private:
  // A number with D, E or (exponents of three digits) nothing before the exponent; none if it is above 1e100.
  static std::optional<double> fortran_number(std::string_view field) {
    std::string copy(field);
    for (char& c : copy)
      if (c == 'D' || c == 'd') c = 'E';
    const auto sign = copy.find_last_of("+-");
    if (sign != std::string::npos && sign > 0 && copy[sign - 1] >= '.' && copy[sign - 1] <= '9')
      copy.insert(sign, 1, 'E');
    const char* begin = copy.data() + (!copy.empty() && copy[0] == '+' ? 1 : 0);
    double value = 0;
    const auto [end, status] = std::from_chars(begin, copy.data() + copy.size(), value);
    constexpr double largest = 1e100;
    if (copy.empty() || end != copy.data() + copy.size()) return std::nullopt;
    if (status == std::errc::result_out_of_range && copy.find("E-") != std::string::npos) return 0;  // underflow
    if (status != std::errc() || !(std::abs(value) <= largest)) return std::nullopt;
    return value;
  }

  TextLines lines_;
  std::string_view line_;
  std::string name_;
};

}  // namespace nscdd
