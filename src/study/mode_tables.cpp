// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/mode_tables.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

using Velocity = std::array<double, 2>;

Velocity velocity_of(const Mode& mode, const GrainCopy& copy) {
  const Vector& v = mode.velocities[at(copy.subdomain)];
  return {v[2 * copy.grain], v[2 * copy.grain + 1]};
}

double largest_jump(const Mode& mode, const Velocity& velocity, std::span<const GrainCopy> copies) {
  double largest = 0;
  for (const GrainCopy& copy : copies) {
    const Velocity other = velocity_of(mode, copy);
    largest = std::max(largest, std::hypot(velocity[0] - other[0], velocity[1] - other[1]));
  }
  return largest;
}

}  // namespace

const ResultColumns<ModeImpulse>& mode_impulse_columns() {
  using One = ModeImpulse;
  static const ResultColumns<ModeImpulse> columns{
      {"case", "", "name of the case", [](const One& r) { return r.model.name; }},
      {"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit",
       [](const One& r) { return r.parameters.epsilon; }},
      {"eta", "1/kg", "flexibility of the network Stage 2 sees, inf for the generic algorithm",
       [](const One& r) { return r.parameters.eta; }},
      {"end", "", "of the spectrum without unit eigenvalues: low or high", [](const One& r) { return r.mode.side; }},
      {"eigenvalue", "1", "of the contraction operator, to which the mode belongs",
       [](const One& r) { return r.mode.eigenvalue; }},
      {"grain", "1", "number of the shared grain", [](const One& r) { return r.gluing().grain; }},
      {"subdomain_first", "1", "subdomain of the copy that feels the opposite of the impulse",
       [](const One& r) { return r.gluing().first.subdomain; }},
      {"subdomain_second", "1", "subdomain of the copy that feels the impulse",
       [](const One& r) { return r.gluing().second.subdomain; }},
      {"x", "m", "centre", [](const One& r) { return r.model.packing.x[at(r.gluing().grain)]; }},
      {"y", "m", "centre", [](const One& r) { return r.model.packing.y[at(r.gluing().grain)]; }},
      {"impulse_x", "kg m/s", "interface impulse F of the mode, F^T P F = 1 J",
       [](const One& r) { return r.mode.impulses[2 * r.number]; }},
      {"impulse_y", "kg m/s", "interface impulse F of the mode, F^T P F = 1 J",
       [](const One& r) { return r.mode.impulses[2 * r.number + 1]; }},
      {"jump_x", "m/s", "velocity of the first copy minus that of the second",
       [](const One& r) { return r.mode.jumps[2 * r.number]; }},
      {"jump_y", "m/s", "velocity of the first copy minus that of the second",
       [](const One& r) { return r.mode.jumps[2 * r.number + 1]; }},
      {"share", "1", "of F^T P F; all shares add up to 1", [](const One& r) { return r.mode.shares[at(r.number)]; }}};
  return columns;
}

void mode_impulses(const Model& model, const ModeParameters& parameters, const Mode& mode,
                   const Sink<ModeImpulse>& sink) {
  require_geometry(model, "mode");
  if (!mode.found()) return;
  for (Index k = 0; k < count(model.parts.interface.gluing()); ++k) sink({model, parameters, mode, k});
}

const ResultColumns<ModeVelocity>& mode_velocity_columns() {
  using One = ModeVelocity;
  static const ResultColumns<ModeVelocity> columns{
      {"case", "", "name of the case", [](const One& r) { return r.model.name; }},
      {"grain", "1", "number of the grain", [](const One& r) { return r.grain; }},
      {"subdomain", "1", "subdomain of this copy", [](const One& r) { return r.subdomain; }},
      {"x", "m", "centre", [](const One& r) { return r.model.packing.x[at(r.grain)]; }},
      {"y", "m", "centre", [](const One& r) { return r.model.packing.y[at(r.grain)]; }},
      {"radius", "m", "radius", [](const One& r) { return r.model.packing.radius[at(r.grain)]; }},
      {"multiplicity", "1", "subdomains that share the grain",
       [](const One& r) { return r.model.parts.interface.multiplicity(r.grain); }},
      {"velocity_x", "m/s", "velocity of this copy that Stage 1 answers the impulses with",
       [](const One& r) { return r.velocity[0]; }},
      {"velocity_y", "m/s", "velocity of this copy that Stage 1 answers the impulses with",
       [](const One& r) { return r.velocity[1]; }},
      {"jump", "m/s", "largest distance to the velocity of another copy; 0 for a grain of one subdomain",
       [](const One& r) { return r.jump; }}};
  return columns;
}

void mode_velocities(const Model& model, const Mode& mode, const Sink<ModeVelocity>& sink) {
  require_geometry(model, "mode");
  if (!mode.found()) return;
  for (Index i = 0; i < model.parts.interface.grains(); ++i) {
    const auto copies = model.parts.interface.copies(i);
    for (const GrainCopy& copy : copies) {
      const Velocity v = velocity_of(mode, copy);
      sink({model, i, copy.subdomain, v, largest_jump(mode, v, copies)});
    }
  }
}

}  // namespace nscdd
