// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/report/page_json.hpp"

namespace nscdd::page {
namespace {

Json grains_of(const Model& model) {
  const Packing& packing = model.packing;
  Json json{{"x", packed(converted<float>(packing.x))},
            {"y", packed(converted<float>(packing.y))},
            {"radius", packed(converted<float>(packing.radius))},
            {"mass", packed(converted<float>(packing.mass))}};
  if (packing.dimension() == 3) json["z"] = packed(converted<float>(packing.z));
  return json;
}

// The copies of grain i are those from start[i] up to start[i + 1].
Json copies_of(const Model& model) {
  const Interface& interface = model.parts.interface;
  std::vector<std::uint32_t> start{0}, subdomain;
  for (Index i = 0; i < interface.grains(); ++i) {
    for (const GrainCopy& copy : interface.copies(i)) subdomain.push_back(static_cast<std::uint32_t>(copy.subdomain));
    start.push_back(static_cast<std::uint32_t>(subdomain.size()));
  }
  return {{"start", packed(start)}, {"subdomain", packed(subdomain)}};
}

Json contacts_of(const Model& model, const Vector& impulses) {
  std::vector<std::uint32_t> a, b;
  for (const Contact& contact : model.network.contacts) {
    a.push_back(static_cast<std::uint32_t>(contact.a));
    b.push_back(static_cast<std::uint32_t>(contact.b));
  }
  return {{"a", packed(a)},
          {"b", packed(b)},
          {"subdomain", packed(converted<std::uint32_t>(model.partition.subdomain_of_contact))},
          {"impulse", impulses.size() > 0 ? packed(converted<float>(impulses)) : Json(nullptr)}};
}

Json point_of(const SweepResult& point) {
  const SpectralRadius& r = point.radius;
  Json json{{"radius", r.value},           {"subdominant", r.subdominant},
            {"unit", r.unit_multiplicity}, {"low", r.subdominant_min},
            {"high", r.subdominant_max},   {"residual", r.residual},
            {"converged", r.converged},    {"solver", r.solver}};
  if (!r.converged) json["failure"] = r.failure;
  if (r.certified) json["certified"] = {{"low", r.interval_min}, {"high", r.interval_max}};
  return json;
}

Json best_of(const OptimumResult& result) {
  const Optimum& best = result.best;
  return {{"status", std::string(to_string(best.status))},
          {"eta", best.eta},
          {"radius", best.radius},
          {"generic_radius", best.generic_radius},
          {"convergent_from", best.convergent_from},
          {"better_from", best.better_from},
          {"residual", best.residual}};
}

// Velocities are within 1; the largest whole number stands for it.
Json mode_of(const KeptMode& mode) {
  constexpr float full = 32767;
  std::vector<std::int16_t> velocities;
  for (const float v : mode.velocities) velocities.push_back(static_cast<std::int16_t>(std::lround(full * v)));
  return {{"epsilon", mode.epsilon},
          {"eta", mode.eta},
          {"side", std::string(to_string(mode.side))},
          {"eigenvalue", mode.eigenvalue},
          {"velocities", packed(velocities)}};
}

Json grid_of(const RadiusGrid& grid) {
  Json points = Json::array(), best = Json::array(), modes = Json::array();
  for (const SweepResult& point : grid.points) points.push_back(point_of(point));
  for (const OptimumResult& one : grid.best) best.push_back(best_of(one));
  for (const KeptMode& mode : grid.modes) modes.push_back(mode_of(mode));
  return {{"contacts", std::string(to_string(grid.contacts))},
          {"rule", grid.choice.rule},
          {"certain", grid.choice.certain},
          {"active", packed(converted<std::uint8_t>(grid.choice.active))},
          {"points", std::move(points)},
          {"best", std::move(best)},
          {"modes_asked", grid.modes_asked},
          {"modes", std::move(modes)}};
}

}  // namespace

Json json_of(const Model& model, const PackingReport& report) {
  const Inspection& found = report.inspection;
  Json shared = Json::array();
  for (const auto& [multiplicity, grains] : found.interface_grains)
    shared.push_back({{"multiplicity", multiplicity}, {"grains", grains}});
  Json eta = Json::array();  // JSON has no infinity
  for (const double value : report.eta) eta.push_back(std::isinf(value) ? Json("inf") : Json(value));
  Json grids = Json::array();
  for (const RadiusGrid& grid : report.grids) grids.push_back(grid_of(grid));
  return {{"kind", "packing"},
          {"dimension", model.packing.dimension()},
          {"subdomains", model.partition.subdomains},
          {"counts",
           {{"grains", model.grains()},
            {"contacts", model.contacts()},
            {"interface", found.interface_dofs},
            {"why_empty", why_empty(model)},
            {"shared", std::move(shared)},
            {"isolated", found.isolated_grains},
            {"rattlers", found.rattlers},
            {"coordination", found.coordination_number},
            {"solid_fraction", found.solid_fraction.box}}},
          {"scale", report.scale},
          {"grains", grains_of(model)},
          {"copies", copies_of(model)},
          {"contacts", contacts_of(model, report.impulses)},
          {"epsilon", report.epsilon},
          {"eta", std::move(eta)},
          {"grids", std::move(grids)}};
}

}  // namespace nscdd::page
