// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/mode_tables.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

using Velocity = std::array<double, 2>;

struct Copy {
  Index subdomain;
  Velocity velocity;
};

// Copies of every grain, subdomains ascending.
std::vector<std::vector<Copy>> copies_of_grains(const Decomposition& parts, const Mode& mode) {
  std::vector<std::vector<Copy>> copies(parts.multiplicity.size());
  for (Index e = 0; e < count(parts.subdomains); ++e) {
    const auto& grains = parts.subdomains[at(e)].grains;
    for (Index i = 0; i < count(grains); ++i)
      copies[at(grains[at(i)])].push_back(
          {e, {mode.velocities[at(e)][2 * i], mode.velocities[at(e)][2 * i + 1]}});
  }
  return copies;
}

double largest_jump(const Copy& copy, const std::vector<Copy>& all) {
  double largest = 0;
  for (const Copy& other : all)
    largest = std::max(
        largest, std::hypot(copy.velocity[0] - other.velocity[0], copy.velocity[1] - other.velocity[1]));
  return largest;
}

}  // namespace

std::vector<Column> mode_impulse_columns() {
  return {{"case", "", "name of the case"},
          {"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit"},
          {"eta", "1/kg", "flexibility of the network Stage 2 sees, inf for the generic algorithm"},
          {"end", "", "of the spectrum without unit eigenvalues: low or high"},
          {"eigenvalue", "1", "of the contraction operator, to which the mode belongs"},
          {"grain", "1", "number of the shared grain"},
          {"subdomain_first", "1", "subdomain of the copy that feels the opposite of the impulse"},
          {"subdomain_second", "1", "subdomain of the copy that feels the impulse"},
          {"x", "m", "centre"},
          {"y", "m", "centre"},
          {"impulse_x", "kg m/s", "interface impulse F of the mode, F^T P F = 1 J"},
          {"impulse_y", "kg m/s", "interface impulse F of the mode, F^T P F = 1 J"},
          {"jump_x", "m/s", "velocity of the first copy minus that of the second"},
          {"jump_y", "m/s", "velocity of the first copy minus that of the second"},
          {"share", "1", "of F^T P F; all shares add up to 1"}};
}

void mode_impulse_rows(const Model& model, const ModeParameters& parameters, const Mode& mode,
                       const RowSink& sink) {
  require_geometry(model, "mode");
  if (!mode.found()) return;
  const Packing& p = model.packing;
  for (Index k = 0; k < count(model.parts.gluing); ++k) {
    const Gluing& gluing = model.parts.gluing[at(k)];
    sink({model.name, parameters.epsilon, parameters.eta, std::string(to_string(mode.side)), mode.eigenvalue,
          std::int64_t{gluing.grain}, std::int64_t{gluing.first.subdomain},
          std::int64_t{gluing.second.subdomain}, p.x[at(gluing.grain)], p.y[at(gluing.grain)],
          mode.impulses[2 * k], mode.impulses[2 * k + 1], mode.jumps[2 * k], mode.jumps[2 * k + 1],
          mode.shares[at(k)]});
  }
}

std::vector<Column> mode_velocity_columns() {
  return {
      {"case", "", "name of the case"},
      {"grain", "1", "number of the grain"},
      {"subdomain", "1", "subdomain of this copy"},
      {"x", "m", "centre"},
      {"y", "m", "centre"},
      {"radius", "m", "radius"},
      {"multiplicity", "1", "subdomains that share the grain"},
      {"velocity_x", "m/s", "velocity of this copy that Stage 1 answers the impulses with"},
      {"velocity_y", "m/s", "velocity of this copy that Stage 1 answers the impulses with"},
      {"jump", "m/s", "largest distance to the velocity of another copy; 0 for a grain of one subdomain"}};
}

void mode_velocity_rows(const Model& model, const Mode& mode, const RowSink& sink) {
  require_geometry(model, "mode");
  if (!mode.found()) return;
  const Packing& p = model.packing;
  const auto grains = copies_of_grains(model.parts, mode);
  for (Index i = 0; i < count(grains); ++i)
    for (const Copy& copy : grains[at(i)])
      sink({model.name, std::int64_t{i}, std::int64_t{copy.subdomain}, p.x[at(i)], p.y[at(i)],
            p.radius[at(i)], std::int64_t{model.parts.multiplicity[at(i)]}, copy.velocity[0],
            copy.velocity[1], largest_jump(copy, grains[at(i)])});
}

}  // namespace nscdd
