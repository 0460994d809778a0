// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters, choices and cells as texts.
#include "core/text.hpp"

#include "core/fail.hpp"
#include <nscdd/core/fields.hpp>
#include <nscdd/core/table.hpp>

#include <charconv>

namespace nscdd {
namespace {

// Reads a whole text as a number, also with a plus sign.
template <class Number>
std::errc read_all(std::string_view text, Number& value) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end != text.data() + text.size() ? std::errc::invalid_argument : status;
}

template <class Number>
Number parse_all(std::string_view text, std::string_view what, std::string_view expected) {
  text = trimmed(text);
  Number value{};
  const std::errc status = read_all(text, value);
  if (status == std::errc()) return value;
  fail("{}: expected {}, met '{}'{}", what, expected, text,
       status == std::errc::result_out_of_range ? ", which is out of range" : "");
}

// Edit distance (Damerau, Levenshtein): insertions, deletions, changes and swaps of neighbours, none within a swap.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

// Bytes of the first character of a UTF-8 text; 0 if invalid, or a control character beyond ASCII (U+0080 to U+009F).
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xC0) != 0x80) return 0;
  const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool beyond = (first == 0xED && byte(1) > 0x9F) || (first == 0xF4 && byte(1) > 0x8F);
  return overlong || beyond || (first == 0xC2 && byte(1) < 0xA0) ? 0 : length;
}

std::string_view without_brackets(std::string_view text) {
  text = trimmed(text);
  return text.size() >= 2 && text.front() == '[' && text.back() == ']' ? text.substr(1, text.size() - 2) : text;
}

}  // namespace

Error::Error(const std::string& message) : std::runtime_error(printable(message)) {}

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const char first = text.front();
    const bool control = (first >= 0 && first < 0x20 && first != '\n' && first != '\t') || first == 0x7f;
    const std::size_t length = control ? 0 : utf8_length(text);
    if (length == 0)
      shown += fmt::format("\\x{:02X}", static_cast<unsigned char>(first));
    else
      shown += text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return shown;
}

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  if (read_all(text, value) == std::errc()) return value;
  std::string plain(text);
  for (char& c : plain)
    if (c == 'D' || c == 'd') c = 'e';
  // Otherwise "nand" would be tried as "nane".
  if (plain.empty() || plain.find_first_not_of("0123456789+-.eE") != plain.npos) return std::nullopt;
  return read_all(plain, value) == std::errc() ? std::optional(value) : std::nullopt;
}

void require_utf8(std::string_view text, std::string_view name) {
  using namespace std::string_view_literals;
  const std::string_view begin = text.substr(0, 4);
  const bool utf32 = begin == "\xFF\xFE\0\0"sv || begin == "\0\0\xFE\xFF"sv ||
                     (begin.size() == 4 && (begin.substr(1) == "\0\0\0"sv || begin.substr(0, 3) == "\0\0\0"sv));
  const bool utf16 =
      begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF") || begin.substr(0, 2).find('\0') != begin.npos;
  if (utf32 || utf16) fail("{}: expected UTF-8, met {}; save the text as UTF-8", name, utf32 ? "UTF-32" : "UTF-16");
}

char line_end_of(std::string_view text) { return text.find('\n') == text.npos ? '\r' : '\n'; }

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

TextLines::TextLines(std::string_view text) : rest_(without_byte_order_mark(text)), end_(line_end_of(text)) {}

bool TextLines::next() {
  line_ = {};
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find(end_), rest_.size());
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  ++number_;
  return true;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto next = text.find(separator);
    parts.push_back(trimmed(text.substr(0, next)));
    if (next == std::string_view::npos) return parts;
    text.remove_prefix(next + 1);
  }
}

double parse_number(std::string_view text, std::string_view what) {
  const std::optional<double> number = number_of(trimmed(text));
  return number ? *number : parse_all<double>(text, what, "a number");  // throws
}

Index parse_integer(std::string_view text, std::string_view what) { return parse_all<Index>(text, what, "an integer"); }

void parse_value(std::string_view text, bool& value, std::string_view key) {
  if (text != "true" && text != "false") fail("{}: expected true or false, met '{}'", key, text);
  value = text == "true";
}

std::vector<std::string_view> components_of(std::string_view text, std::string_view key) {
  const std::vector<std::string_view> parts = split(without_brackets(text), ',');
  if (parts.size() < 2 || parts.size() > 3)
    fail("{}: expected two numbers 'a,b', or three 'a,b,c' in space, met '{}'", key, text);
  return parts;
}

std::string field_text(double value) {
  const std::string text = fmt::format("{}", value);
  return text == "-0" ? "-0.0" : text;  // an integer has no -0
}
std::string field_text(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    const auto code = static_cast<unsigned char>(c);
    text += code < 0x20 || code == 0x7f ? fmt::format("\\u{:04X}", code) : std::string(1, c);  // TOML requires escapes
  }
  return text + "\"";
}

bool in_bounds(double value, const Field& field) {
  return std::isfinite(value) && value >= field.minimum && value > field.above && value <= field.maximum;
}
void check_bounds(double value, const Field& field, std::string_view key) {
  if (in_bounds(value, field) || value == field.also) return;
  std::string expected = "a finite number";
  const double low = std::max(field.minimum, field.above);
  if (low > -infinity) expected += fmt::format(" {} {}", low == field.above ? ">" : ">=", low);
  if (field.maximum < infinity) expected += fmt::format("{} <= {}", low > -infinity ? " and" : "", field.maximum);
  if (!std::isnan(field.also)) expected += fmt::format(", or {}", field.also);
  fail("{}: expected {}, met {}", key, expected, value);
}

std::string suggestion(std::string_view met, std::span<const std::string> known, std::string_view prefix) {
  constexpr std::size_t beginning = 5;
  if (met.size() > 64) return "";  // no slip of the finger
  for (const std::string& name : known)
    if (met.size() >= beginning && name.starts_with(met)) return fmt::format("; did you mean {}{}?", prefix, name);
  // A third of the letters may be wrong, and one of a short name.
  std::size_t nearest = std::max<std::size_t>(1, met.size() / 3) + 1;
  std::string_view found;
  for (const std::string& name : known)
    if (const std::size_t distance = edit_distance(met, name); distance < nearest && distance < name.size()) {
      nearest = distance;
      found = name;
    }
  return found.empty() ? "" : fmt::format("; did you mean {}{}?", prefix, found);
}

std::size_t position_of(std::string_view name, std::span<const std::string_view> names, std::string_view what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  fail("{}: expected one of \"{}\", met {}{}", what, fmt::join(names, "\", \""), field_text(std::string(name)),
       suggestion(name, std::vector<std::string>(names.begin(), names.end())));
}

std::size_t Table::column(const std::string& name) const {
  const auto found = std::ranges::find(columns, name, &Column::name);
  if (found != columns.end()) return static_cast<std::size_t>(found - columns.begin());
  std::vector<std::string> known;
  for (const Column& column : columns) known.push_back(column.name);
  fail("expected a column '{}', met only: {}", name, fmt::join(known, ", "));
}

std::string to_text(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell); number != nullptr && std::isnan(*number))
    return "nan";  // whatever its sign bit
  return std::visit([](const auto& value) { return fmt::format("{}", value); }, cell);
}

std::string fingerprint(std::string_view bytes) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return fmt::format("{:016x}", hash);
}

std::string fingerprint(std::span<const double> numbers) {
  return fingerprint(std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
}

}  // namespace nscdd
