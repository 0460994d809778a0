// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/report/page_json.hpp"

namespace nscdd::page {
namespace {

Json table_of(const std::vector<Series>& columns) {
  Json all = Json::array();
  for (const Series& column : columns) {
    Json values = Json::array();
    for (const double value : column.values) values.push_back(drawn(value));
    all.push_back({{"name", column.heading.name},
                   {"unit", column.heading.unit},
                   {"description", column.heading.description},
                   {"values", std::move(values)}});
  }
  return all;
}

Json contacts_of(const std::vector<DrawnContact>& contacts, Index dimension) {
  std::vector<std::uint32_t> a, b, subdomain;
  std::vector<float> normal, tangential, point;
  std::vector<std::uint8_t> status;
  for (const DrawnContact& c : contacts) {
    a.push_back(static_cast<std::uint32_t>(c.a));
    b.push_back(static_cast<std::uint32_t>(c.b));
    subdomain.push_back(static_cast<std::uint32_t>(c.subdomain));
    normal.push_back(static_cast<float>(c.normal));
    tangential.push_back(static_cast<float>(c.tangential));
    for (Index k = 0; k < dimension; ++k) point.push_back(static_cast<float>(c.point[at(k)]));
    status.push_back(static_cast<std::uint8_t>(c.status));
  }
  return {{"a", packed(a)},
          {"b", packed(b)},
          {"subdomain", packed(subdomain)},
          {"normal", packed(normal)},
          {"tangential", packed(tangential)},
          {"point", packed(point)},
          {"status", packed(status)}};
}

// A straight line by a point and its normal; a plane likewise, or a cylinder by its axis, with the radius behind.
Json wall_of(const Wall& wall, Index dimension) {
  Json json = Json::array();
  for (const auto& vector : {wall.point, wall.normal})
    for (Index k = 0; k < dimension; ++k) json.push_back(drawn(vector[at(k)]));
  if (dimension == 3) json.push_back(drawn(wall.radius));
  return json;
}

Json step_of(const DrawnStep& step, Index dimension) {
  Json walls = Json::array();
  for (const Wall& wall : step.walls) walls.push_back(wall_of(wall, dimension));
  Json json{{"step", step.step},
            {"time", drawn(step.time)},
            {"x", packed(converted<float>(step.x))},
            {"y", packed(converted<float>(step.y))},
            {"walls", std::move(walls)},
            {"contacts", contacts_of(step.contacts, dimension)}};
  if (dimension == 3) json["z"] = packed(converted<float>(step.z));
  return json;
}

}  // namespace

Json json_of(const RunReport& report) {
  const GranularSystem& system = report.header.system;
  Json steps = Json::array(), boundaries = Json::array(), provenance = Json::array();
  for (const DrawnStep& step : report.steps) steps.push_back(step_of(step, system.dimension));
  for (const Boundary& boundary : system.boundaries) boundaries.push_back(boundary.name);
  for (const auto& [key, text] : report.header.provenance)
    if (key != "cases") provenance.push_back(Json::array({key, text}));
  return {{"kind", "run"},
          {"dimension", system.dimension},
          {"ended", report.ended},
          {"provenance_of_run", std::move(provenance)},
          {"solver",
           {{"algorithm", std::string(to_string(report.solver.algorithm))},
            {"criterion", std::string(to_string(report.solver.criterion))},
            {"tolerance", report.solver.tolerance},
            {"gluing_tolerance", report.solver.gluing_tolerance},
            {"decomposes", decomposes(report.solver.algorithm)}}},
          {"subdomains", report.subdomains},
          {"disks",
           {{"radius", packed(converted<float>(system.radius))},
            {"mass", packed(converted<float>(system.mass))},
            {"driven_by", system.driven_by}}},
          {"boundaries", std::move(boundaries)},
          {"summary", table_of(report.summary)},
          {"status", report.status},
          {"iterations", table_of(report.iterations)},
          {"kept", report.kept},
          {"steps", std::move(steps)}};
}

}  // namespace nscdd::page
