// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/report/report_page.hpp"

#include <nlohmann/json.hpp>

#include <bit>

namespace nscdd {
namespace page {
namespace parts {  // the files of page/, embedded by cmake/EmbedPage.cmake
extern const std::string_view page, style;
extern const std::span<const std::string_view> program;  // in the order of the page
}  // namespace parts
namespace {

using Json = nlohmann::ordered_json;

// An array as {"type": "float32", "data": "..."}: little-endian numbers in base 64, a half to a third of the size of
// text. Types are those of the arrays of a browser.
Json packed_bytes(const char* type, std::span<const std::byte> bytes) {
  static constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t there = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (k < there ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= there ? letters[three >> (18 - 6 * k) & 63U] : '=';
  }
  return {{"type", type}, {"data", std::move(text)}};
}

// `get` of each value, as an array of `To`.
template <class To, class Values, class Get = std::identity>
Json packed(const Values& values, Get get = {}) {
  static_assert(std::endian::native == std::endian::little, "bytes are written as they lie in memory");
  constexpr const char* type = std::is_same_v<To, float>          ? "float32"
                               : std::is_same_v<To, std::int16_t> ? "int16"
                               : std::is_same_v<To, std::uint8_t> ? "uint8"
                                                                  : "uint32";
  std::vector<To> numbers;
  for (const auto& value : values) numbers.push_back(static_cast<To>(std::invoke(get, value)));
  return packed_bytes(type, std::as_bytes(std::span(numbers)));
}

// A number with the seven digits that a picture needs.
Json drawn(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::stod(fmt::format("{:.7g}", value));
}

// What `get` makes of each item.
template <class Items, class Get>
Json list_of(const Items& items, Get get) {
  Json all = Json::array();
  for (const auto& item : items) all.push_back(get(item));
  return all;
}

Json grains_of(const Model& model) {
  const Packing& packing = model.packing;
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

Json table_of(const std::vector<Series>& columns) {
  return list_of(columns, [](const Series& column) {
    return Json{{"name", column.heading.name},
                {"unit", column.heading.unit},
                {"description", column.heading.description},
                {"values", list_of(column.values, drawn)}};
  });
}

// Tangential impulses have their sign in the plane, and their size in space.
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

Json json_of(const Model& model, const PackingReport& report) {
  const Inspection& found = report.inspection;
  Json shared = Json::array();
  for (const auto& [multiplicity, grains] : found.interface_grains)
    shared.push_back({{"multiplicity", multiplicity}, {"grains", grains}});
  // JSON has no infinity.
  const auto eta_of = [](double value) { return std::isinf(value) ? Json("inf") : Json(value); };
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
          {"period", {model.network.period.x, model.network.period.y}},
          {"epsilon", report.epsilon},
          {"eta", list_of(report.eta, eta_of)},
          {"grids", list_of(report.grids, grid_of)}};
}

Json json_of(const RunReport& report) {
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

std::string packing_page(const Model& model, const PackingReport& report, const PageOrigin& origin) {
  return page::filled(origin, page::json_of(model, report), ": nscdd report");
}

std::string run_page(const RunReport& report, const PageOrigin& origin) {
  return page::filled(origin, page::json_of(report), ": nscdd report of a run");
}

}  // namespace nscdd
