// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "files/strict_toml.hpp"
#include "formats/case/case_file.hpp"

namespace nscdd {
namespace {

ColourSpec read_colour(StrictTable section) {
  ColourSpec spec;
  section.require_keys({"name", "first", "last"});
  section.read("name", spec.name);
  section.read("first", spec.first);
  section.read("last", spec.last);
  section.finish();
  return spec;
}

PairSpec read_pair(StrictTable section, const Dynamics& dynamics, bool effects_wanted) {
  PairSpec spec;
  section.require_keys({"colours"});
  const toml::node* found = section.node("colours");
  const toml::array* names = found->as_array();
  for (std::size_t k = 0; k < 2; ++k) {
    const auto name = names != nullptr && names->size() == 2 ? (*names)[k].value<std::string>() : std::nullopt;
    if (!name) section.fail(found, "colours", "an array of two texts", StrictTable::describe(*found));
    spec.colours[k] = *name;
  }
  section.read("touch", spec.rule.touch);
  section.read("bond", spec.rule.bond);
  const auto read = [&](const char* key, std::optional<double>& value, double most) {
    if (section.has(key)) section.read(key, value.emplace(), Field{.minimum = 0, .maximum = most});
  };
  read("friction", spec.rule.friction, 100);
  read("static_friction", spec.rule.static_friction, 100);
  read("restitution", spec.rule.restitution, 1);
  read("tangential_restitution", spec.rule.tangential_restitution, 1);
  if (spec.rule.restitution && !dynamics.interaction.on_velocity())
    section.fail("restitution", "interaction.signorini = \"velocity\" with it", "\"gap\"");
  bool given = spec.rule.bond || !spec.rule.touch;
  for (const char* key : {"friction", "static_friction", "restitution", "tangential_restitution"}) {
    if (!section.has(key)) continue;
    given = true;
    if (spec.rule.bond) section.fail(key, "none with bond = true", "one");
    if (!spec.rule.touch && effects_wanted) section.fail(key, "none with touch = false", "one");
    if (effects_wanted && std::string_view(key) != "restitution")
      require_effect(dynamics, fmt::format("interaction.{}", key), section.where(key), false);
  }
  if (spec.rule.bond && !spec.rule.touch) section.fail("bond", "touch = true with it", "false");
  if (!given && effects_wanted)
    section.fail("touch", "a friction, a restitution, touch = false or bond = true", "a pair without a rule");
  section.finish();
  return spec;
}

}  // namespace

void read_pairs(StrictTable& root, Dynamics& dynamics, bool effects_wanted) {
  for (const StrictTable& colour : root.tables("colour")) dynamics.colours.push_back(read_colour(colour));
  for (const StrictTable& pair : root.tables("pair"))
    dynamics.pairs.push_back(read_pair(pair, dynamics, effects_wanted));
  if (effects_wanted && dynamics.pairs.empty() && !dynamics.colours.empty())
    root.fail("colour", "a section [[pair]] with it", "none");
}

}  // namespace nscdd
