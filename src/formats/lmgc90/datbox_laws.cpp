// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox.hpp"

#include <set>

namespace nscdd {
namespace {

struct Seen {
  bool grain = false, moves = false;    // one that is no wall; one that is not driven in all directions
  bool free = false, boundary = false;  // one of a free body; one of another body
  std::set<const DatboxBody*> bodies = {};
};

std::map<std::string, Seen> colours_of(const Datbox& datbox) {
  std::map<std::string, Seen> colours;
  for (const DatboxBody& body : datbox.bodies)
    for (const DatboxContactor& one : body.contactors) {
      Seen& seen = colours[colour_of(datbox, one)];
      const bool boundary = body.driven();  // a wall that nothing drives is a free body
      seen.grain = seen.grain || one.wall.empty();
      seen.moves = seen.moves || !body.fully_driven(datbox.dimension);
      seen.free = seen.free || !boundary;
      seen.boundary = seen.boundary || boundary;
      seen.bodies.insert(&body);
    }
  return colours;
}

// Pairs of colours that may meet, and how they see each other.
struct Meeting {
  std::string a, b;
  bool plain = false, boundary = false;  // of two free bodies, and with a boundary; colours may have both
  const DatboxSight* sight = nullptr;
};

std::vector<Meeting> meetings_of(const Datbox& datbox) {
  std::vector<Meeting> meetings;
  const auto colours = colours_of(datbox);
  for (auto a = colours.begin(); a != colours.end(); ++a)
    for (auto b = a; b != colours.end(); ++b) {
      const Seen &one = a->second, &other = b->second;
      if (!(one.grain || other.grain) || !(one.moves || other.moves)) continue;
      if (one.bodies.size() == 1 && one.bodies == other.bodies) continue;  // a body does not meet itself
      meetings.push_back({a->first, b->first, one.free && other.free, one.boundary || other.boundary,
                          sight_of(datbox, a->first, b->first)});
    }
  return meetings;
}

// The colours of grains, in runs of grains that follow each other.
std::vector<ColourSpec> runs_of_colours(const Datbox& datbox) {
  std::vector<ColourSpec> runs;
  Index number = 0;
  for (const DatboxBody& body : datbox.bodies)
    for (const DatboxContactor& one : body.contactors) {
      if (!one.wall.empty()) continue;
      const Index grain = number++;
      const std::string colour = colour_of(datbox, one);
      if (runs.empty() || runs.back().name != colour || runs.back().last != grain - 1)
        runs.push_back({colour, grain, grain});
      runs.back().last = grain;
    }
  return runs;
}

}  // namespace

const DatboxSight* sight_of(const Datbox& datbox, const std::string& a, const std::string& b) {
  for (const DatboxSight& one : datbox.sights)
    for (const std::size_t turned : {0U, 1U}) {
      const std::string candidate = one.of(0, turned), antagonist = one.of(1, 1 - turned);
      if ((candidate == a && antagonist == b) || (candidate == b && antagonist == a)) return &one;
    }
  return nullptr;
}

const DatboxLaw& law_named(const Datbox& datbox, const std::string& name, const DatboxPlace& place) {
  const auto found = datbox.laws.find(name);
  if (found == datbox.laws.end()) refuse(place, "expected a law that is described, met '{}'", name);
  const DatboxLaw& law = found->second;
  if (law.kind != "IQS_CLB" && law.kind != "GAP_SGR_CLB" && !law.on_velocity() && !law.wet() && !law.bond())
    refuse(law.place,
           "expected law IQS_CLB, GAP_SGR_CLB, VEL_SGR_CLB or RST_CLB, with _DS or without, IQS_WET_DS_CLB or "
           "COUPLED_DOF, met {}: others are not modelled",
           law.kind);
  if (law.tangential_cohesion != 0)
    refuse(law.place, "coht: expected 0, met {}: a cohesion along the surface is not modelled",
           law.tangential_cohesion);
  return law;
}

std::string colour_of(const Datbox& datbox, const DatboxContactor& contactor) {
  return fmt::format("{} {}", contactor.wall.empty() ? datbox.grain() : contactor.wall, contactor.colour);
}

double set_contact_laws(const Datbox& datbox, Dynamics& dynamics) {
  double alert = 0;
  const std::vector<Meeting> meetings = meetings_of(datbox);
  if (datbox.sights.empty() && !meetings.empty())
    fail("{}/TACT_BEHAV.DAT: expected contactors that see each other ($seety), met none", datbox.folder);
  const DatboxLaw *of_grains = nullptr, *of_boundaries = nullptr, none;
  for (const Meeting& one : meetings) {
    if (one.sight == nullptr) continue;
    const DatboxLaw& law = law_named(datbox, one.sight->law, one.sight->place);
    alert = std::max(alert, one.sight->alert);
    if (law.bond()) continue;
    const DatboxLaw*& first = one.plain ? of_grains : of_boundaries;
    if (first == nullptr) first = &law;
    const DatboxLaw& any = of_grains != nullptr ? *of_grains : *of_boundaries;
    if (any.on_velocity() != law.on_velocity() || (any.kind == "GAP_SGR_CLB") != (law.kind == "GAP_SGR_CLB"))
      refuse(one.sight->place, "expected one Signorini condition for all contacts, that of {} as before, met {}",
             any.kind, law.kind);
    if (any.cohesion != law.cohesion || any.range != law.range)
      refuse(one.sight->place,
             "expected one cohesion and range for all contacts, {} N and {} m as before, met {} and {}", any.cohesion,
             any.range, law.cohesion, law.range);
  }
  const DatboxLaw& law = of_grains != nullptr ? *of_grains : of_boundaries != nullptr ? *of_boundaries : none;
  const DatboxLaw& at_boundaries = of_boundaries != nullptr ? *of_boundaries : law;
  const auto frictions = [](const DatboxLaw& some) { return std::pair(some.friction, some.static_friction); };
  const bool same = frictions(at_boundaries) == frictions(law);
  const double static_at_boundaries = same ? law.static_friction : at_boundaries.friction;  // without a rule
  for (const Meeting& one : meetings) {
    PairRule rule;
    if (one.sight == nullptr) {
      rule.touch = false;
    } else if (const DatboxLaw& own = law_named(datbox, one.sight->law, one.sight->place); own.bond()) {
      rule.bond = true;
    } else {
      const auto set = [](std::optional<double>& value, double now, double otherwise) {
        if (now != otherwise) value = now;
      };
      if ((one.plain && frictions(own) != frictions(law)) ||
          (one.boundary && frictions(own) != std::pair(at_boundaries.friction, static_at_boundaries))) {
        rule.friction = own.friction;
        set(rule.static_friction, own.static_friction, own.friction);
      }
      set(rule.restitution, own.restitution, law.restitution);
      set(rule.tangential_restitution, own.tangential_restitution, law.tangential_restitution);
      if (!rule.friction && !rule.restitution && !rule.tangential_restitution) continue;
    }
    dynamics.pairs.push_back({{one.a, one.b}, rule});
  }
  if (!dynamics.pairs.empty()) dynamics.colours = runs_of_colours(datbox);
  Interaction& interaction = dynamics.interaction;
  interaction.friction = law.friction;
  if (!same) interaction.boundary_friction = at_boundaries.friction;
  if (law.static_friction != law.friction) interaction.static_friction = law.static_friction;
  if (law.on_velocity()) interaction.signorini = Signorini::velocity;
  if (law.wet() || std::ranges::any_of(dynamics.pairs, [](const PairSpec& pair) { return pair.rule.bond; })) {
    interaction.law = std::string(Cohesive::name);
    interaction.cohesion = law.cohesion;
    interaction.cohesion_range = law.range;
  }
  interaction.restitution = law.restitution;
  interaction.tangential_restitution = law.tangential_restitution;
  if (law.kind == "GAP_SGR_CLB")  // it removes an overlap in one step
    dynamics.time.maximum_push_speed = 1e100;
  else if (!law.on_velocity())
    dynamics.time.penetration_correction = 0;
  return alert;
}

}  // namespace nscdd
