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

void require_frame(const DatboxBody& body, const DatboxPlace& place) {
  const Eigen::Matrix3d rest = body.frame.transpose() * body.frame - Eigen::Matrix3d::Identity();
  if (!(rest.cwiseAbs().maxCoeff() < 1e-5) || !(body.frame.determinant() > 0))
    refuse(place, "expected three axes of a body that are unit, orthogonal and right-handed, met others");
}

// "localframe" after a PLANx or CYLND: its axes, and the shift of its centre from the node.
void read_frame(FixedColumns& lines, DatboxBody& body) {
  const DatboxPlace place = lines.place();
  Index k = 0;
  for (const char* name : {"alp{}", "bet{}", "gam{}"}) {
    lines.require_next("the axes of the frame");
    body.frame.col(k++) = lines.three_numbers(name);
  }
  require_frame(body, place);
  lines.require_next("the shift of the frame");
  body.position += lines.three_numbers("coo{}");
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
    if (kind == (space ? "POLYR" : "POLYG") && lines.text(30, 38) == "nb_vertex")
      contactor.solid = read_solid(lines, space);
  }
  if (cluster) {
    lines.require_next(fmt::format("a line with the place of {}", kind));
    contactor.shift = {lines.number(35, "coo1"), lines.number(56, "coo2"), space ? lines.number(77, "coo3") : 0};
  }
  return contactor;
}

// The centre of disks or spheres, weighted by area or volume; 0 if there are none.
Eigen::Vector3d centre_of_grains(const DatboxBody& body, Index dimension) {
  double weights = 0;
  Eigen::Vector3d centre(0, 0, 0);
  for (const DatboxContactor& one : body.contactors) {
    const double weight = one.radius * one.radius * (dimension == 3 ? one.radius : 1);
    weights += weight;
    centre += weight * one.shift;
  }
  return weights > 0 ? Eigen::Vector3d(centre / weights) : centre;
}

// The mean radius and inertia of spheres about their centre, each counted whole, and the axes of a cluster along its
// principal ones, as LMGC90 has them.
void complete_cluster(DatboxBody& body) {
  double volume = 0;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (const DatboxContactor& one : body.contactors) {
    const double own = 4.0 / 3 * std::numbers::pi * one.radius * one.radius * one.radius;
    volume += own;
    inertia += own * (0.4 * one.radius * one.radius + one.shift.squaredNorm()) * Eigen::Matrix3d::Identity() -
               own * one.shift * one.shift.transpose();
  }
  if (body.average_radius == 0) body.average_radius = std::cbrt(0.75 * volume / std::numbers::pi);
  if (!body.inertia.isZero(0)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
  body.inertia = principal.eigenvalues();
  body.frame = principal.eigenvectors();
  if (body.frame.determinant() < 0) body.frame.col(2) *= -1;
  for (DatboxContactor& one : body.contactors) one.shift = body.frame.transpose() * one.shift;
  body.own_axes = true;
}

// Radii of a cluster of disks about its node, each disk counted whole, as LMGC90 has them.
void complete_cluster_in_plane(DatboxBody& body) {
  double square = 0, moment = 0;  // of the area and its moment, over pi
  for (const DatboxContactor& one : body.contactors) {
    const double own = one.radius * one.radius;
    square += own;
    moment += own * (own / 2 + one.shift.squaredNorm());
  }
  body.average_radius = std::sqrt(square);
  body.gyration_radius = std::sqrt(moment / square);
}

// Computes, as LMGC90 does, the centre of a body (in the plane only if its node is at 0), the inertia of a cylinder,
// and radii and inertia that are 0 in BODIES.DAT. (Those of planks and hollow disks stay 0: refused in free bodies.)
void complete(DatboxBody& body, Index dimension) {
  if (body.contactors.size() == 1 && body.contactors[0].solid) return complete_solid(body, dimension);
  const bool single = body.contactors.size() == 1;
  if (single && dimension == 2) {  // the node moves to an eccentric disk; LMGC90 leaves out less than 1 mm
    const Eigen::Vector3d shift = std::exchange(body.contactors[0].shift, Eigen::Vector3d::Zero());
    if (body.position.isZero(0) || shift.squaredNorm() >= 1e-6) body.position += shift;
  }
  if (dimension == 3 || (!single && body.position.isZero(0))) {
    if (dimension == 2 && !body.unmodelled.empty()) fail("{}", body.unmodelled);  // only disks have weights here
    const Eigen::Vector3d centre = centre_of_grains(body, dimension);
    body.position += centre;
    for (DatboxContactor& one : body.contactors) one.shift -= centre;
  }
  if (!single && dimension == 3 && body.unmodelled.empty()) complete_cluster(body);
  if (!single && dimension == 2 && body.unmodelled.empty() && body.average_radius * body.gyration_radius == 0)
    complete_cluster_in_plane(body);
  if (!single || body.wall() == "xKSID") return;
  const double radius = body.contactors[0].radius;
  if (dimension == 3 && radius > 0 && !body.wall().empty()) {
    const double half = body.contactors[0].length, square = radius * radius,
                 volume = 2 * half * std::numbers::pi * square;
    if (body.average_radius == 0) body.average_radius = std::cbrt(0.75 * volume / std::numbers::pi);
    const double across = volume * (square / 4 + half * half / 3);
    body.inertia = {across, across, volume * square / 2};
  } else if (dimension == 3) {
    if (body.average_radius == 0) body.average_radius = radius;
    if (body.inertia.isZero(0))
      body.inertia.setConstant(0.4 * radius * radius * (4.0 / 3 * std::numbers::pi * radius * radius * radius));
  } else if (body.average_radius == 0 || body.gyration_radius == 0) {
    body.average_radius = radius;
    body.gyration_radius = radius / std::numbers::sqrt2;
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
           (body.wall() == "PLANx" || body.wall() == "CYLND"))
    read_frame(lines, body);
  else if (section == "$tacty" && lines.text(2, 6).empty() && !body.unmodelled.empty())
    return;  // more of a shape that is not modelled
  else if (section == "$tacty")
    body.contactors.push_back(read_contactor(lines, space, body));
  else
    lines.refuse(fmt::format("section {}: expected one line", section), "another");
}

}  // namespace

double half_digit(const Eigen::Vector3d& place, Index dimension) {
  const double largest = place.head(dimension).cwiseAbs().maxCoeff();
  return largest == 0 ? 0 : 0.5 * std::pow(10.0, std::floor(std::log10(largest)) + 1 - 7);
}

const char* datbox_body_kind(Index dimension) { return dimension == 2 ? "RBDY2" : "RBDY3"; }

void set_axes(DatboxBody& body, const Eigen::Matrix3d& axes, const DatboxPlace& place) {
  body.read_axes = !axes.isIdentity(0);
  if (body.read_axes || !body.own_axes) body.frame = axes;  // LMGC90 writes principal axes, others x, y and z
  require_frame(body, place);
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
  const std::size_t contactors = body.contactors.size();
  require_that(lines.key() == "$$$$$$", "a body that ends with $$$$$$, met one that does not");
  require_that(seen["$blmty"] > 0 && seen["$nodty"] > 0, "a body with a bulk element and a node, met one without");
  require_that(contactors > 0, "a body with a contactor, met one without");
  for (const DatboxContactor& one : body.contactors)
    require_that(contactors == 1 || one.wall.empty(),
                 fmt::format("a contactor {} alone in its body, met one with others", one.wall));
  complete(body, dimension);
  return body;
}

}  // namespace nscdd
