// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/choice.hpp>
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace nscdd {
namespace {

// Fewest insertions, deletions, changes and swaps of neighbours that make one word the other (Damerau's
// distance without edits within a swap).
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

constexpr std::size_t longest_name = 64;  // longer ones are no slips of the finger

}  // namespace

std::string suggestion(std::string_view met, std::span<const std::string> known) {
  if (met.size() > longest_name) return "";
  // A third of the letters may be wrong, and one of a short name.
  std::size_t nearest = std::max<std::size_t>(1, met.size() / 3) + 1;
  std::string_view found;
  for (const std::string& name : known)
    if (const std::size_t distance = edit_distance(met, name); distance < nearest && distance < name.size()) {
      nearest = distance;
      found = name;
    }
  return found.empty() ? "" : fmt::format("; did you mean {}?", found);
}

std::size_t position_of(std::string_view name, std::span<const std::string_view> names, std::string_view what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::string known;
  for (const std::string_view each : names) known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", each);
  throw Error(fmt::format("{}: expected one of {}, met {}{}", what, known, field_text(std::string(name)),
                          suggestion(name, std::vector<std::string>(names.begin(), names.end()))));
}

}  // namespace nscdd
