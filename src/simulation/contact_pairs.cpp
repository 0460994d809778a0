// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/contact_pairs.hpp"

#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

namespace nscdd {

void set_pairs(GranularSystem& system, const std::vector<ColourSpec>& colours, const std::vector<PairSpec>& pairs,
               const std::vector<std::string>& of_boundaries, Index grains) {
  system.pairs = {};
  std::map<std::string, Index> number{{"", 0}};
  const auto number_of = [&](const std::string& name) { return number.try_emplace(name, count(number)).first->second; };
  std::vector<Index>& colour = system.pairs.colour;
  for (const Index k : system.driven_by) colour.push_back(k < 0 ? 0 : number_of(of_boundaries[at(k)]));
  for (const Wall& wall : system.walls) colour.push_back(number_of(of_boundaries[at(wall.boundary)]));
  for (std::size_t c = 0; c < colours.size(); ++c) {
    const ColourSpec& one = colours[c];
    const Index first = one.first < 0 ? one.first + grains : one.first,
                last = one.last < 0 ? one.last + grains : one.last;
    if (first < 0 || last >= grains || first > last)
      throw Error(fmt::format("colour[{}].first", c),
                  fmt::format("expected grains first <= last in 0..{} (or negative, from the end), met {} and {}",
                              grains - 1, one.first, one.last));
    const Index own = number_of(one.name);
    std::fill(colour.begin() + first, colour.begin() + last + 1, own);
  }
  if (pairs.empty()) return void(system.pairs = {});
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    std::array<Index, 2> pair{};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto found = number.find(pairs[p].colours[k]);
      if (found == number.end())
        throw Error(fmt::format("pair[{}].colours", p),
                    fmt::format("expected colours of grains ([[colour]]) or boundaries, met \"{}\", which nothing has",
                                pairs[p].colours[k]));
      pair[k] = found->second;
    }
    if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
    if (!system.pairs.rules.emplace(pair, pairs[p].rule).second)
      throw Error(fmt::format("pair[{}].colours", p),
                  fmt::format("expected each pair once, met \"{}\" and \"{}\" again", pairs[p].colours[0],
                              pairs[p].colours[1]));
  }
}

std::string to_toml(const ColourSpec& spec) {
  return fmt::format("name = {}\nfirst = {}\nlast = {}\n", field_text(spec.name), spec.first, spec.last);
}

std::string to_toml(const PairSpec& spec) {
  std::string text = fmt::format("colours = [{}, {}]\n", field_text(spec.colours[0]), field_text(spec.colours[1]));
  if (!spec.rule.touch) text += "touch = false\n";
  if (spec.rule.bond) text += "bond = true\n";
  const auto add = [&](const char* key, const std::optional<double>& value) {
    if (value) text += fmt::format("{} = {}\n", key, field_text(*value));
  };
  add("friction", spec.rule.friction);
  add("static_friction", spec.rule.static_friction);
  add("restitution", spec.rule.restitution);
  add("tangential_restitution", spec.rule.tangential_restitution);
  return text;
}

}  // namespace nscdd
