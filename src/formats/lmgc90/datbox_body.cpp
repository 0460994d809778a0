// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_body.hpp"

#include <numbers>

namespace nscdd {
namespace {

void read_bulk_element(FixedColumns& lines, DatboxBody& body, Index dimension) {
  if (lines.text(2, 6) != "PLAIN") lines.refuse("expected the bulk element PLAIN", lines.text(2, 6));
  body.bulk = lines.text(23, 27);
  body.average_radius = lines.number(35, "avrd", true);
  if (dimension == 2) body.gyration_radius = lines.number(56, "gyrd", true);
}

void read_node(FixedColumns& lines, DatboxBody& body, Index dimension) {
  const char* kind = dimension == 2 ? "NO3xx" : "NO6xx";
  if (lines.text(2, 6) != kind)
    lines.refuse(fmt::format("expected the node {} of a rigid body", kind), lines.text(2, 6));
  body.position = {lines.number(35, "coo1"), lines.number(56, "coo2"), lines.number(77, "coo3", dimension == 2)};
  body.written_digit = std::max(half_digit(body.position[0]), half_digit(body.position[1]));
  if (dimension == 3) body.written_digit = std::max(body.written_digit, half_digit(body.position[2]));
}

// "localframe" behind a PLANx: its axes, and how far its centre is from the node.
void read_frame(FixedColumns& lines, DatboxBody& body) {
  const DatboxPlace place = lines.place();
  Index k = 0;
  for (const char* name : {"alp", "bet", "gam"}) {
    lines.require_next("the axes of the frame");
    body.frame.col(k++) = three_numbers(lines, name);
  }
  require_frame(body, place);
  lines.require_next("the shift of the frame");
  Eigen::Map<Eigen::Vector3d>(body.position.data()) += three_numbers(lines, "coo");
}

DatboxContactor read_contactor_in_space(FixedColumns& lines) {
  const std::string kind(lines.text(2, 6));
  DatboxContactor contactor{.colour = std::string(lines.text(23, 27)), .place = lines.place()};
  if (kind == "PLANx") {
    contactor.plank = true;
    contactor.length = positive_number(lines, 35, "axe1");
    contactor.width = positive_number(lines, 56, "axe2");
    contactor.thickness = positive_number(lines, 77, "axe3");
  } else if (kind == "SPHER") {
    contactor.radius = positive_number(lines, 35, "byrd");
  } else {
    lines.refuse("expected contactors SPHER or PLANx: other shapes are not modelled", kind);
  }
  return contactor;
}

DatboxContactor read_contactor(FixedColumns& lines) {
  const std::string kind(lines.text(2, 6));
  DatboxContactor contactor{.colour = std::string(lines.text(23, 27)), .place = lines.place()};
  if (kind == "JONCx") {
    contactor.plank = true;
    contactor.length = positive_number(lines, 35, "ax1");
    contactor.thickness = positive_number(lines, 56, "ax2");
  } else if (kind == "DISKx" || kind == "DISKb") {
    contactor.radius = positive_number(lines, 35, "byrd");
    if (kind == "DISKb") {
      lines.require_next("a line with the place of the disk DISKb");
      contactor.shift = {lines.number(35, "coo1"), lines.number(56, "coo2")};
    }
  } else {
    lines.refuse("expected contactors DISKx, DISKb or JONCx: other shapes are not modelled", kind);
  }
  return contactor;
}

// LMGC90 works out what BODIES.DAT leaves at 0: the centre of a body of several contactors, weighted by their areas,
// and its radii. A plank is never free here, so that its own radii have no effect.
void complete(DatboxBody& body, Index dimension) {
  if (dimension == 3) {
    const double radius = body.contactors[0].radius, volume = 4.0 / 3 * std::numbers::pi * radius * radius * radius;
    if (body.average_radius == 0) body.average_radius = radius;
    if (body.inertia == std::array<double, 3>{}) body.inertia.fill(0.4 * radius * radius * volume);
    return;
  }
  if (body.contactors.size() > 1 && body.position == std::array<double, 3>{}) {
    double area = 0;
    std::array<double, 2> centre{};
    for (const DatboxContactor& one : body.contactors) {
      area += one.radius * one.radius;
      for (std::size_t k = 0; k < 2; ++k) centre[k] += one.radius * one.radius * one.shift[k];
    }
    for (std::size_t k = 0; k < 2; ++k) body.position[k] = centre[k] / area;
    for (DatboxContactor& one : body.contactors)
      for (std::size_t k = 0; k < 2; ++k) one.shift[k] -= body.position[k];
  }
  if (body.contactors.size() == 1 && (body.average_radius == 0 || body.gyration_radius == 0)) {
    body.average_radius = body.contactors[0].radius;
    body.gyration_radius = body.contactors[0].radius / std::numbers::sqrt2;
  }
}

// What stands on one line, but for the inertia of a body in space, the rest of its node and the frame of a plank.
void read_line(FixedColumns& lines, const std::string& section, Index dimension, std::map<std::string, int>& met,
               DatboxBody& body) {
  const bool space = dimension == 3, again = ++met[section] > 1;
  if (section == "$blmty" && !again)
    read_bulk_element(lines, body, dimension);
  else if (section == "$blmty" && space && met[section] == 2 && lines.text(30, 31) == "I1")
    Eigen::Map<Eigen::Vector3d>(body.inertia.data()) = three_numbers(lines, "I");
  else if (section == "$nodty" && !again)
    read_node(lines, body, dimension);
  else if (section == "$nodty" && space && met[section] == 2)
    return;  // coo4 to coo6, which LMGC90 sets to 0
  else if (section == "$tacty" && space && again && lines.text(30, 39) == "localframe" && body.plank())
    read_frame(lines, body);
  else if (section == "$tacty")
    body.contactors.push_back(space ? read_contactor_in_space(lines) : read_contactor(lines));
  else
    lines.refuse(fmt::format("section {}: expected one line", section), "another");
}

}  // namespace

double half_digit(double value) {
  return value == 0 ? 0 : 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - 7);
}

double positive_number(const FixedColumns& lines, std::size_t first, std::string_view what) {
  const double value = lines.number(first, what);
  if (!(value > 0)) lines.refuse(fmt::format("{}: expected a number above 0", what), fmt::format("{}", value));
  return value;
}

const char* datbox_body_kind(Index dimension) { return dimension == 2 ? "RBDY2" : "RBDY3"; }

Eigen::Vector3d three_numbers(const FixedColumns& lines, const char* name, bool blank) {
  const auto one = [&](std::size_t column, int number) {
    return lines.number(column, fmt::format("{}{}", name, number), blank);
  };
  return {one(35, 1), one(56, 2), one(77, 3)};
}

void require_frame(const DatboxBody& body, const DatboxPlace& place) {
  const Eigen::Matrix3d rest = body.frame.transpose() * body.frame - Eigen::Matrix3d::Identity();
  if (!(rest.cwiseAbs().maxCoeff() < 1e-5) || !(body.frame.determinant() > 0))
    fail("{}:{}: expected three axes of a body that are unit, orthogonal and right-handed, met others", place.file,
         place.line);
}

DatboxBody read_datbox_body(FixedColumns& lines, Index& dimension, bool first) {
  lines.require_next("a body");
  DatboxBody body;
  body.place = body.velocity_place = lines.place();
  if (first && lines.text(2, 6) == "RBDY3") dimension = 3;
  if (lines.text(2, 6) != datbox_body_kind(dimension))
    lines.refuse(first ? "expected rigid bodies (RBDY2 in the plane, RBDY3 in space)"
                       : fmt::format("expected {} as the bodies before", datbox_body_kind(dimension)),
                 lines.text(2, 6));
  std::map<std::string, int> seen;  // lines of each section
  lines.next();
  while (lines.section() && !lines.key().empty() && lines.key() != "$$$$$$" && lines.key() != "$bdyty") {
    const std::string section(lines.key());
    while (lines.next() && !lines.section()) read_line(lines, section, dimension, seen, body);
  }
  const auto refuse = [&](std::string_view expected, std::string_view met) {
    fail("{}:{}: {}, met {}", body.place.file, body.place.line, expected, met);
  };
  if (lines.key() != "$$$$$$") refuse("expected a body that ends with $$$$$$", "one that does not");
  if (seen["$blmty"] == 0 || seen["$nodty"] == 0)
    refuse("expected a body with a bulk element and a node", "one without");
  if (body.contactors.empty()) refuse("expected a body with a contactor", "one without");
  if (dimension == 3 && body.contactors.size() > 1)
    refuse("expected a body in space with one contactor",
           fmt::format("one with {}: not modelled", body.contactors.size()));
  if (body.contactors.size() > 1)
    for (const DatboxContactor& one : body.contactors)
      if (one.plank) refuse("expected a plank JONCx alone in its body", "one with other contactors");
  complete(body, dimension);
  return body;
}

}  // namespace nscdd
