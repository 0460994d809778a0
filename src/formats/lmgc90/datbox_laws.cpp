// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox.hpp"

#include <set>

namespace nscdd {
namespace {

using Colour = std::pair<std::string, std::string>;  // DISKx, JONCx, SPHER or PLANx, and its colour
struct Colours {
  std::map<Colour, Index> free;  // and their numbers of grains
  std::set<Colour> driven;
};

Colours colours_of(const Datbox& datbox) {
  Colours colours;
  for (const DatboxBody& body : datbox.bodies)
    for (const DatboxContactor& one : body.contactors) {
      const Colour colour{one.plank ? datbox.plank() : datbox.grain(), one.colour};
      if (body.driven())
        colours.driven.insert(colour);
      else
        ++colours.free[colour];
    }
  return colours;
}

const DatboxSight& sight_of(const Datbox& datbox, const Colour& a, const Colour& b) {
  for (const DatboxSight& sight : datbox.sights) {
    const Colour candidate{sight.contactors[0], sight.colours[0]}, antagonist{sight.contactors[1], sight.colours[1]};
    if ((candidate == a && antagonist == b) || (candidate == b && antagonist == a)) return sight;
  }
  fail(
      "{}/TACT_BEHAV.DAT: expected a $seety for {} {} and {} {}, met none: all free {}s touch each other and what is "
      "driven here",
      datbox.folder, a.first, a.second, b.first, b.second, shape_of_grains(datbox.dimension));
}

const DatboxLaw& law_of(const Datbox& datbox, const DatboxSight& sight) {
  return law_named(datbox, sight.law, sight.place);
}

}  // namespace

const DatboxLaw& law_named(const Datbox& datbox, const std::string& name, const DatboxPlace& place) {
  const auto found = datbox.laws.find(name);
  if (found == datbox.laws.end()) refuse(place, "expected a law that is described, met '{}'", name);
  const DatboxLaw& law = found->second;
  if (law.kind != "IQS_CLB" && law.kind != "GAP_SGR_CLB" && !law.on_velocity())
    refuse(law.place, "expected law IQS_CLB, GAP_SGR_CLB, VEL_SGR_CLB or RST_CLB, met {}: others are not modelled",
           law.kind);
  return law;
}

DatboxContacts contact_law_of(const Datbox& datbox) {
  const DatboxLaw *of_free = nullptr, *of_driven = nullptr, none;
  double alert = 0;
  const auto add = [&](const Colour& a, const Colour& b, bool driven) {
    const DatboxSight& sight = sight_of(datbox, a, b);
    const DatboxLaw& law = law_of(datbox, sight);
    const DatboxLaw*& same = driven ? of_driven : of_free;
    if (same == nullptr) same = &law;
    if (same->friction != law.friction)
      refuse(sight.place, "expected one friction between free {}s{}, {} as before, met {}",
             shape_of_grains(datbox.dimension), driven ? " and driven bodies" : "", same->friction, law.friction);
    const DatboxLaw& any = of_free != nullptr ? *of_free : *of_driven;
    if (any.on_velocity() != law.on_velocity() || (any.kind == "GAP_SGR_CLB") != (law.kind == "GAP_SGR_CLB"))
      refuse(sight.place, "expected one Signorini condition for all contacts, that of {} as before, met {}", any.kind,
             law.kind);
    if (any.restitution != law.restitution || any.tangential_restitution != law.tangential_restitution)
      refuse(sight.place, "expected one restitution for all contacts, {} and {} as before, met {} and {}",
             any.restitution, any.tangential_restitution, law.restitution, law.tangential_restitution);
    alert = std::max(alert, sight.alert);
  };
  const Colours colours = colours_of(datbox);
  for (auto a = colours.free.begin(); a != colours.free.end(); ++a) {
    for (auto b = a; b != colours.free.end(); ++b)
      if (a != b || a->second > 1) add(a->first, b->first, false);
    for (const Colour& driven : colours.driven) add(a->first, driven, true);
  }
  const DatboxLaw& law = of_free != nullptr ? *of_free : of_driven != nullptr ? *of_driven : none;
  Interaction interaction;
  interaction.friction = law.friction;
  if (of_driven != nullptr && of_driven->friction != law.friction) interaction.boundary_friction = of_driven->friction;
  if (law.on_velocity()) interaction.signorini = Signorini::velocity;
  interaction.restitution = law.restitution;
  interaction.tangential_restitution = law.tangential_restitution;
  return {interaction, alert, law.kind == "GAP_SGR_CLB"};
}

}  // namespace nscdd
