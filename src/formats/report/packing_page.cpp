// SPDX-License-Identifier: GPL-3.0-or-later
// The data of the page of a packing or contact problem.
#include "formats/report/page_json.hpp"

namespace nscdd::page {
namespace {

Json grains_of(const Packing& packing) {
  Json json{{"x", packed<float>(packing.x)},
            {"y", packed<float>(packing.y)},
            {"radius", packed<float>(packing.radius)},
            {"mass", packed<float>(packing.mass)}};
  if (packing.dimension() == 3) json["z"] = packed<float>(packing.z);
  return json;
}

// The copies of grain i are those from start[i] up to start[i + 1].
Json copies_of(const Model& model) {
  const Interface& interface = model.parts.interface;
  std::vector<Index> start{0}, subdomain;
  for (Index i = 0; i < interface.grains(); ++i) {
    for (const GrainCopy& copy : interface.copies(i)) subdomain.push_back(copy.subdomain);
    start.push_back(count(subdomain));
  }
  return {{"start", packed<std::uint32_t>(start)}, {"subdomain", packed<std::uint32_t>(subdomain)}};
}

Json contacts_of(const Model& model, const Vector& impulses) {
  const std::vector<Contact>& contacts = model.network.contacts;
  return {{"a", packed<std::uint32_t>(contacts, &Contact::a)},
          {"b", packed<std::uint32_t>(contacts, &Contact::b)},
          {"subdomain", packed<std::uint32_t>(model.partition.subdomain_of_contact)},
          {"impulse", impulses.size() > 0 ? packed<float>(impulses) : Json(nullptr)}};
}

// With the point of each contact; the second body of a support is 2^32 - 1.
Json contacts_of(const Model& model, const ProblemReport& problem) {
  std::vector<Index> subdomain;
  for (Index c = 0; c < model.contacts(); ++c)
    subdomain.push_back(model.partition.subdomain_of_contact[at(model.problem.columns_per_contact * c)]);
  return {{"a", packed<std::uint32_t>(problem.a)},
          {"b", packed<std::uint32_t>(problem.b)},
          {"subdomain", packed<std::uint32_t>(subdomain)},
          {"point", packed<float>(problem.points.reshaped())},
          {"impulse", problem.normal_impulses.size() > 0 ? packed<float>(problem.normal_impulses) : Json(nullptr)}};
}

Json numbers_of(const Model& model, const Inspection& found, const ProblemReport& problem) {
  const NetworkDegrees& whole = found.whole;
  return {{"title", problem.title},
          {"velocities", model.problem.inertia.size()},
          {"links", model.problem.contacts()},
          {"friction", problem.friction},
          {"normal_delassus", problem.normal_delassus},
          {"entries", problem.entries},
          {"pieces", found.components},
          {"ranks", found.ranks ? Json{{"rank", whole.rank},
                                       {"rigid_modes", whole.rigid_modes},
                                       {"hyperstaticity", whole.hyperstaticity},
                                       {"unit", found.unit_multiplicity}}
                                : Json(nullptr)},
          {"impulses", list_of(problem.impulses, [](const auto& one) {
             const FrictionState& state = one.second;
             return Json{{"name", one.first},
                         {"residual", drawn(state.residual)},
                         {"open", state.open},
                         {"stick", state.stick},
                         {"slide", state.slide}};
           })}};
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

// Velocities are within [-1, 1], scaled to 16-bit integers.
Json mode_of(const KeptMode& mode) {
  constexpr float full = 32767;
  return {{"epsilon", mode.epsilon},
          {"eta", mode.eta},
          {"side", std::string(to_string(mode.side))},
          {"eigenvalue", mode.eigenvalue},
          {"velocities", packed<std::int16_t>(mode.velocities, [](float v) { return std::lround(full * v); })}};
}

Json grid_of(const RadiusGrid& grid) {
  return {{"contacts", std::string(to_string(grid.contacts))},
          {"rule", grid.choice.rule},
          {"certain", grid.choice.certain},
          {"active", packed<std::uint8_t>(grid.choice.active)},
          {"points", list_of(grid.points, point_of)},
          {"best", list_of(grid.best, best_of)},
          {"modes_asked", grid.modes_asked},
          {"modes", list_of(grid.modes, mode_of)}};
}

}  // namespace

Json json_of(const Model& model, const PackingReport& report, const ProblemReport* problem) {
  const Inspection& found = report.inspection;
  Json shared = Json::array();
  for (const auto& [multiplicity, grains] : found.interface_grains)
    shared.push_back({{"multiplicity", multiplicity}, {"grains", grains}});
  // JSON has no infinity.
  const auto eta_of = [](double value) { return std::isinf(value) ? Json("inf") : Json(value); };
  return {{"kind", "packing"},
          {"dimension", model.problem.dimension},
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
          {"problem", problem != nullptr ? numbers_of(model, found, *problem) : Json(nullptr)},
          {"grains", grains_of(problem != nullptr ? problem->bodies : model.packing)},
          {"copies", copies_of(model)},
          {"contacts", problem != nullptr ? contacts_of(model, *problem) : contacts_of(model, report.impulses)},
          {"period", {model.network.period.x, model.network.period.y}},
          {"epsilon", report.epsilon},
          {"eta", list_of(report.eta, eta_of)},
          {"grids", list_of(report.grids, grid_of)}};
}

}  // namespace nscdd::page
