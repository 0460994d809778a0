// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/dynamics.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// A parameter that has an effect only if another one has one of these values.
struct Effect {
  std::string_view path, with, values;
};
constexpr std::string_view criteria = "zeta interface_change gluing natural_map quad_dv mean_dv_over_r";
constexpr Effect effects[] = {
    {"interaction.friction", "interaction.law", "coulomb cohesive"},
    {"interaction.boundary_friction", "interaction.law", "coulomb cohesive"},
    {"interaction.cohesion", "interaction.law", "cohesive"},
    {"interaction.epsilon", "interaction.law", "linear_viscous"},
    {"interaction.tangential_restitution", "interaction.law", "coulomb cohesive linear_viscous"},
    {"dynamics.penetration_correction", "interaction.restitution", "0"},
    {"dynamics.maximum_push_speed", "interaction.restitution", "0"},
    {"solver.tolerance", "solver.criterion", criteria},
    {"solver.gluing_tolerance", "solver.algorithm", "generic enriched"},
    {"solver.gluing_tolerance", "solver.criterion", criteria},
    {"solver.seed", "solver.order", "random"},
    {"solver.eta", "solver.algorithm", "enriched"},
    {"solver.network", "solver.algorithm", "enriched"},
    {"solver.network", "solver.enrichment", "every_iteration first_iteration"},
    {"solver.enrichment", "solver.algorithm", "enriched"},
    {"solver.interface_method", "solver.algorithm", "generic enriched"},
    {"solver.interface_relaxation", "solver.algorithm", "generic enriched"},
    {"solver.interface_relaxation", "solver.interface_method", "richardson"},
    {"solver.redecompose", "solver.algorithm", "generic enriched"},
};

// The value of a parameter as a text without quotes.
template <class Parameters>
std::string text_of(const Parameters& parameters, std::string_view key) {
  std::string text;
  for (const FieldDescription& field : describe_fields(parameters))
    if (field.key == key) text = field.value;
  std::erase(text, '"');
  return text == "-0.0" ? "0" : text;
}

std::string value_of(const Dynamics& dynamics, std::string_view path) {
  const auto dot = path.find('.');
  const std::string_view key = path.substr(dot + 1);
  return path.substr(0, dot) == "solver" ? text_of(dynamics.solver, key) : text_of(dynamics.interaction, key);
}

bool is_among(std::string_view word, std::string_view words) {
  for (std::string_view rest = words; !rest.empty();) {
    const std::string_view first = rest.substr(0, rest.find(' '));
    if (first == word) return true;
    rest.remove_prefix(std::min(first.size() + 1, rest.size()));
  }
  return false;
}

// "a, b or c".
std::string any_of(std::string_view words) {
  std::string text;
  for (const char letter : words) text += letter == ' ' ? ", " : std::string(1, letter);
  if (const auto last = text.rfind(", "); last != std::string::npos) text.replace(last, 2, " or ");
  return text;
}

// The first entry of the list that keeps the parameter from having an effect; none if it has one.
const Effect* missing_for(const Dynamics& dynamics, std::string_view path) {
  for (const Effect& effect : effects)
    if (effect.path == path && !is_among(value_of(dynamics, effect.with), effect.values)) return &effect;
  return nullptr;
}

}  // namespace

bool has_effect(const Dynamics& dynamics, std::string_view path) { return missing_for(dynamics, path) == nullptr; }

void require_effect(const Dynamics& dynamics, std::string_view path, std::string_view where) {
  const Effect* missing = missing_for(dynamics, path);
  if (missing == nullptr) return;
  throw Error(fmt::format("{}: expected {} {} with it, met {}", where, missing->with, any_of(missing->values),
                          value_of(dynamics, missing->with)));
}

void check(const BoundarySpec& spec) {
  if (spec.shape == BoundaryShape::grains) return;
  const double length = std::hypot(spec.to[0] - spec.from[0], spec.to[1] - spec.from[1]);
  if (!(length > 0) || !std::isfinite(length))
    throw Error(fmt::format("boundary '{}': from, to: expected distinct ends, met ({}, {}) and ({}, {})", spec.name,
                            spec.from[0], spec.from[1], spec.to[0], spec.to[1]));
  if (spec.shape == BoundaryShape::wall) return;
  if (!(spec.radius > 0))
    throw Error(fmt::format("boundary '{}': radius: expected one > 0 of its disks, met {}", spec.name, spec.radius));
  constexpr double most = 1e7;
  if (!(length / spec.distance() < most))
    throw Error(fmt::format("boundary '{}': spacing: expected at most {} disks, met {} m in steps of {} m", spec.name,
                            most, length, spec.distance()));
}

}  // namespace nscdd
