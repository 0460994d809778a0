// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/report/report_page.hpp"

#include "formats/report/page_json.hpp"

namespace nscdd {
namespace page {
namespace parts {  // the files of page/, embedded by cmake/EmbedPage.cmake
extern const std::string_view page, style;
extern const std::span<const std::string_view> program;  // in the order of the page
}  // namespace parts
namespace {

Json table_of(const std::vector<Series>& columns) {
  return list_of(columns, [](const Series& column) {
    return Json{{"name", column.heading.name},
                {"unit", column.heading.unit},
                {"description", column.heading.description},
                {"values", list_of(column.values, drawn)}};
  });
}

// Tangential impulses: signed in the plane, magnitudes in space.
Json contacts_of(const std::vector<TrajectoryContact>& contacts, Index dimension) {
  std::vector<double> point;
  for (const TrajectoryContact& c : contacts)
    point.insert(point.end(), c.geometry.point.begin(), c.geometry.point.begin() + dimension);
  return {{"a", packed<std::uint32_t>(contacts, [](const auto& c) { return c.geometry.a; })},
          {"b", packed<std::uint32_t>(contacts, [](const auto& c) { return c.geometry.b; })},
          {"subdomain", packed<std::uint32_t>(contacts, &TrajectoryContact::subdomain)},
          {"normal", packed<float>(contacts, [](const auto& c) { return c.impulse.n; })},
          {"tangential",
           packed<float>(contacts, [&](const auto& c) { return dimension == 2 ? c.impulse.t : c.tangential(); })},
          {"point", packed<float>(point)},
          {"stress", packed<float>(contacts, &TrajectoryContact::self_stress)},
          {"status", packed<std::uint8_t>(contacts, &TrajectoryContact::status)}};
}

// A point and the normal or axis; of circles, of planks and in space the radius; of planks in space the axis; half the
// length of planks and of cylinders with ends; of planks in space half the width.
Json wall_of(const Wall& wall, Index dimension) {
  Json json = Json::array();
  const auto add = [&](const std::array<double, 3>& vector) {
    for (Index k = 0; k < dimension; ++k) json.push_back(drawn(vector[at(k)]));
  };
  add(wall.point);
  add(wall.normal);
  if (dimension == 3 || wall.radius != 0) json.push_back(drawn(wall.radius));
  if (wall.half_length == 0) return json;
  const bool plate = dimension == 3 && wall.plank();
  if (plate) add(wall.axis);
  json.push_back(drawn(wall.half_length));
  if (plate) json.push_back(drawn(wall.half_width));
  return json;
}

Json step_of(const DrawnStep& step, Index dimension) {
  Json json{{"step", step.step},
            {"time", drawn(step.time)},
            {"x", packed<float>(step.x)},
            {"y", packed<float>(step.y)},
            {"walls", list_of(step.walls, [&](const Wall& wall) { return wall_of(wall, dimension); })},
            {"contacts", contacts_of(step.contacts, dimension)}};
  if (dimension == 3) json["z"] = packed<float>(step.z);
  return json;
}

Json json_of_run(const RunReport& report) {
  const GranularSystem& system = report.header.system;
  Json provenance = Json::array();
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
           {{"radius", packed<float>(system.radius)},
            {"mass", packed<float>(system.mass)},
            {"driven_by", system.driven_by}}},
          {"period", {system.period.x, system.period.y}},
          {"boundaries", list_of(system.boundaries, [](const Boundary& one) { return one.name; })},
          {"free", list_of(system.boundaries,
                           [](const Boundary& one) { return Json(one.body.value_or(FreeBody()).directions); })},
          {"summary", table_of(report.summary)},
          {"status", report.status},
          {"iterations", table_of(report.iterations)},
          {"kept", report.kept},
          {"steps", list_of(report.steps, [&](const DrawnStep& step) { return step_of(step, system.dimension); })}};
}

// Text between tags.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return result;
}

// JSON between the tags of a script. "<", which occurs only in texts, is escaped: "</script>" would end the script.
std::string within_script(const Json& json) {
  std::string result;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
    result += c == '<' ? "\\u003c" : std::string(1, c);
  return result;
}

std::string filled(const PageOrigin& origin, const Json& data, const char* title) {
  Json all{{"origin",
            {{"program", "nscdd " + version()},
             {"name", origin.name},
             {"command_line", origin.command_line},
             {"case", origin.case_text},
             {"libraries", origin.libraries}}}};
  all.update(data);
  const auto text_of = [&](std::string_view name) {
    if (name == "title") return escaped(origin.name + title);
    if (name == "style") return std::string(parts::style);
    if (name == "data") return within_script(all);
    std::string program;
    for (const std::string_view part : parts::program) program += part;
    return program;
  };
  // Placeholders are searched only in the page, not in what replaces them.
  std::string result;
  std::string_view rest = parts::page;
  for (std::size_t open = rest.find("{{"); open != std::string_view::npos; open = rest.find("{{")) {
    const std::size_t close = rest.find("}}", open);
    result += rest.substr(0, open);
    result += text_of(rest.substr(open + 2, close - open - 2));
    rest.remove_prefix(close + 2);
  }
  return result += rest;
}

}  // namespace

}  // namespace page

std::string packing_page(const Model& model, const PackingReport& report, const ProblemReport* problem,
                         const PageOrigin& origin) {
  page::Json json = page::json_of(model, report, problem);
  if (report.scheme != DecompositionScheme::nscdd) json["scheme"] = std::string(to_string(report.scheme));
  return page::filled(origin, json, ": nscdd report");
}

std::string run_page(const RunReport& report, const PageOrigin& origin) {
  return page::filled(origin, page::json_of_run(report), ": nscdd report of a run");
}

}  // namespace nscdd
