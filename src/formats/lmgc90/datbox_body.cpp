// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_body.hpp"

#include <Eigen/Eigenvalues>

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
  body.written_digit = half_digit(body.position, dimension);
}

void require_frame(const Matrix3& frame, const DatboxPlace& place) {
  const Matrix3 rest = frame.transpose() * frame - Matrix3::Identity();
  if (!(rest.cwiseAbs().maxCoeff() < 1e-5) || !(frame.determinant() > 0))
    refuse(place, "expected three axes of a body that are unit, orthogonal and right-handed, met others");
}

// "localframe" after a PLANx or CYLND: its axes, and the shift of its centre from the node.
void read_frame(FixedColumns& lines, DatboxContactor& contactor) {
  const DatboxPlace place = lines.place();
  Index k = 0;
  for (const char* name : {"alp{}", "bet{}", "gam{}"}) {
    lines.require_next("the axes of the frame");
    contactor.frame.col(k++) = lines.three_numbers(name);
  }
  require_frame(contactor.frame, place);
  lines.require_next("the shift of the frame");
  contactor.shift = lines.three_numbers("coo{}");
}

DatboxContactor read_contactor(FixedColumns& lines, bool space, DatboxBody& body) {
  const std::string kind(lines.text(2, 6));
  DatboxContactor contactor{.colour = std::string(lines.text(23, 27)), .place = lines.place()};
  const bool cluster = kind == (space ? "SPHEb" : "DISKb"), cylinder = kind == "DNLYC" || kind == "CYLND";
  if (space ? kind == "PLANx" || cylinder : kind == "JONCx" || kind == "xKSID") contactor.wall = kind;
  if (contactor.wall == "PLANx") {
    contactor.length = lines.positive_number(35, "axe1");
    contactor.width = lines.positive_number(56, "axe2");
    contactor.thickness = lines.positive_number(77, "axe3");
  } else if (contactor.wall == "JONCx") {
    contactor.length = lines.positive_number(35, "ax1");
    contactor.thickness = lines.positive_number(56, "ax2");
  } else if (space && cylinder) {
    contactor.length = lines.positive_number(35, "High");
    contactor.radius = lines.positive_number(56, "byrd");
  } else if (cluster || contactor.wall == "xKSID" || kind == (space ? "SPHER" : "DISKx")) {
    contactor.radius = lines.positive_number(35, "byrd");
  } else {
    if (body.unmodelled.empty())
      body.unmodelled = fmt::format(
          "{}:{}: expected contactors {}: other shapes are not modelled, met {}", contactor.place.file,
          contactor.place.line, space ? "SPHER, SPHEb, PLANx, DNLYC or CYLND" : "DISKx, DISKb, JONCx or xKSID", kind);
    if (kind == (space ? "POLYR" : "POLYG") && lines.text(30, 38) == "nb_vertex") read_solid(lines, space, contactor);
  }
  if (cluster) {
    lines.require_next(fmt::format("a line with the place of {}", kind));
    contactor.shift = {lines.number(35, "coo1"), lines.number(56, "coo2"), space ? lines.number(77, "coo3") : 0};
  }
  if (contactor.weight == 0) weigh(contactor, space);
  return contactor;
}

// The inertia of the contactors of a body about its centre, along its axes.
Matrix3 inertia_of(const DatboxBody& body) {
  Matrix3 inertia = Matrix3::Zero();
  for (const DatboxContactor& one : body.contactors)
    inertia += one.frame * one.inertia * one.frame.transpose() +
               one.weight * (one.shift.squaredNorm() * Matrix3::Identity() - one.shift * one.shift.transpose());
  return inertia;
}

// Sets moments of inertia, and turns the axes of a body along its principal ones.
void take_inertia(DatboxBody& body) {
  const Matrix3 inertia = inertia_of(body);
  body.inertia = inertia.diagonal();
  const Matrix3 coupling = inertia - Matrix3(body.inertia.asDiagonal());
  if (coupling.cwiseAbs().maxCoeff() <= 1e-12 * body.inertia.maxCoeff()) return;  // LMGC90 keeps their order
  body.own_axes = body.contactors.size() > 1;  // DOF.INI has those of a single contactor
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(inertia);
  Matrix3 axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) *= -1;
  body.inertia = principal.eigenvalues();
  body.frame *= axes;
  for (DatboxContactor& one : body.contactors) {
    one.shift = axes.transpose() * one.shift;
    one.frame = axes.transpose() * one.frame;
  }
}

// Reads a line of a section, or the lines of a frame. `met`: the number of lines of each section so far.
void read_line(FixedColumns& lines, const std::string& section, Index dimension, std::map<std::string, int>& met,
               DatboxBody& body) {
  const bool space = dimension == 3, again = ++met[section] > 1;
  if (section == "$blmty" && !again)
    read_bulk_element(lines, body, dimension);
  else if (section == "$blmty" && space && met[section] == 2 && lines.text(30, 31) == "I1")
    body.inertia = lines.three_numbers("I{}");
  else if (section == "$nodty" && !again)
    read_node(lines, body, dimension);
  else if (section == "$nodty" && space && met[section] == 2)
    return;  // coo4 to coo6, which LMGC90 sets to 0
  else if (section == "$tacty" && space && again && lines.text(30, 39) == "localframe" &&
           (body.contactors.back().wall == "PLANx" || body.contactors.back().wall == "CYLND"))
    read_frame(lines, body.contactors.back());
  else if (section == "$tacty" && lines.text(2, 6).empty() && !body.unmodelled.empty())
    return;  // more of a shape that is not modelled
  else if (section == "$tacty")
    body.contactors.push_back(read_contactor(lines, space, body));
  else
    lines.refuse(fmt::format("section {}: expected one line", section), "another");
}

}  // namespace

void weigh(DatboxContactor& one, bool space) {
  constexpr double pi = std::numbers::pi;
  const double a = one.length, b = one.width, c = one.thickness, square = one.radius * one.radius;
  if (one.wall == "JONCx") {  // not the exact inertia of its middle
    one.weight = 4 * a * c / pi + c * c;
    one.inertia(2, 2) = c * c * (a * a + c * c / 2) + 2 * a * c / pi * (a * a + c * c);
  } else if (one.wall == "PLANx") {
    one.weight = 8 * a * b * c;
    one.inertia.diagonal() = one.weight / 3 * Vector3(b * b + c * c, a * a + c * c, a * a + b * b);
  } else if (one.cylinder()) {
    one.weight = 2 * a * pi * square;
    const double across = one.weight * (square / 4 + a * a / 3);
    one.inertia.diagonal() << across, across, one.weight * square / 2;
  } else if (space) {
    one.weight = 4.0 / 3 * pi * square * one.radius;
    one.inertia.diagonal().setConstant(0.4 * square * one.weight);
  } else if (one.wall.empty()) {
    one.weight = square;
    one.inertia(2, 2) = square * square / 2;
  }
}

void complete(DatboxBody& body, Index dimension) {
  const bool single = body.contactors.size() == 1, space = dimension == 3;
  DatboxContactor& first = body.contactors[0];
  double weight = 0;
  Vector3 centre = Vector3::Zero();
  for (const DatboxContactor& one : body.contactors) {
    weight += one.weight;
    centre += one.weight * one.shift;
  }
  if (weight > 0) centre /= weight;
  if (single) centre = first.shift;
  const bool known = std::ranges::all_of(
      body.contactors, [](auto& one) { return one.weight > 0 || !one.wall.empty() || one.radius > 0; });
  // The node moves to the centre of a single disk or polygon; LMGC90 leaves out less than 1 mm.
  if (space || body.position.isZero(0) || (single && centre.squaredNorm() >= 1e-6)) {
    if (!single && !known) fail("{}", body.unmodelled);
    body.position += centre;
    for (DatboxContactor& one : body.contactors) one.shift -= centre;
  }
  if (single) first.shift.setZero();
  if (weight == 0 || !known) return;
  if (space && body.average_radius == 0) body.average_radius = std::cbrt(0.75 * weight / std::numbers::pi);
  if (space && single) body.frame = std::exchange(first.frame, Matrix3::Identity());
  if (space && (first.cylinder() || body.inertia.isZero(0))) take_inertia(body);
  if (!space && body.average_radius * body.gyration_radius == 0) {
    body.average_radius = std::sqrt(weight);
    body.gyration_radius = std::sqrt(inertia_of(body)(2, 2) / weight);
  }
}

double half_digit(const Eigen::Vector3d& place, Index dimension) {
  const double largest = place.head(dimension).cwiseAbs().maxCoeff();
  return largest == 0 ? 0 : 0.5 * std::pow(10.0, std::floor(std::log10(largest)) + 1 - 7);
}

const char* datbox_body_kind(Index dimension) { return dimension == 2 ? "RBDY2" : "RBDY3"; }

void set_axes(DatboxBody& body, const Eigen::Matrix3d& axes, const DatboxPlace& place) {
  body.read_axes = !axes.isIdentity(0);
  if (body.read_axes || !body.own_axes) body.frame = axes;  // LMGC90 writes principal axes, others x, y and z
  require_frame(body.frame, place);
}

DatboxBody read_datbox_body(FixedColumns& lines, Index& dimension, bool first) {
  lines.require_next("a body");
  DatboxBody body;
  body.place = lines.place();
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
  const auto require_that = [&](bool holds, const std::string& expected) {
    if (!holds) refuse(body.place, "expected {}", expected);
  };
  require_that(lines.key() == "$$$$$$", "a body that ends with $$$$$$, met one that does not");
  require_that(seen["$blmty"] > 0 && seen["$nodty"] > 0, "a body with a bulk element and a node, met one without");
  require_that(!body.contactors.empty(), "a body with a contactor, met one without");
  require_that(body.contactors.size() == 1 || std::ranges::none_of(body.contactors, &DatboxContactor::cylinder),
               "a cylinder alone in its body, met one with others");
  complete(body, dimension);
  return body;
}

}  // namespace nscdd
