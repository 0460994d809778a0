// SPDX-License-Identifier: GPL-3.0-or-later
// Boundaries of a DATBOX: all bodies but free grains.
#include "formats/lmgc90/datbox.hpp"

#include <numbers>

namespace nscdd {
namespace {

using Vector3 = Eigen::Vector3d;

// A hollow one has no ends here. LMGC90 has contacts at wrong distances beyond the ends of a DNLYC.
void set_cylinder(const DatboxBody& body, BoundarySpec& cylinder) {
  const DatboxContactor& shape = body.contactors[0];
  cylinder.shape = BoundaryShape::cylinder;
  cylinder.radius = shape.radius;
  cylinder.ends = shape.wall == "CYLND";
  cylinder.side = cylinder.ends ? CylinderSide::outside : CylinderSide::inside;
  const bool space = shape.wall != "xKSID";
  const Vector3 middle(body.position[0], body.position[1], space ? body.position[2] : 0);
  Vector3::Map(cylinder.from.data()) = middle - shape.length * body.frame.col(2);
  Vector3::Map(cylinder.to.data()) = middle + shape.length * body.frame.col(2);
}

void set_wall(const Datbox& datbox, const DatboxBody& body, BoundarySpec& plank) {
  const DatboxContactor& shape = body.contactors[0];
  if (shape.radius > 0) return set_cylinder(body, plank);
  plank.shape = BoundaryShape::plank;
  plank.radius = shape.thickness;
  if (datbox.space()) {
    Vector3::Map(plank.point.data()) = body.position;
    Vector3::Map(plank.axis.data()) = body.frame.col(0);
    Vector3::Map(plank.normal.data()) = body.frame.col(2);
    plank.length = 2 * shape.length;
    plank.width = 2 * shape.width;
    return;
  }
  const double angle = body.position[2], x = shape.length * std::cos(angle), y = shape.length * std::sin(angle);
  plank.from = {body.position[0] - x, body.position[1] - y, 0};
  plank.to = {body.position[0] + x, body.position[1] + y, 0};
}

void require_one_drive(const DatboxBody& body) {
  for (std::size_t k = 0; k < body.drives.size(); ++k)
    if (body.drives[k] && body.forces[k])
      refuse(body.forces[k]->place, "expected a velocity or a force of degree of freedom {}, met both", k + 1);
}

// What moves a body along the degrees of freedom that are not driven.
FreeBody free_body(const Datbox& datbox, const DatboxBody& body) {
  const bool space = datbox.space();
  FreeBody result;
  const double density = density_of(datbox, body), radius = body.average_radius, gyration = body.gyration_radius;
  result.mass = density * std::numbers::pi * (space ? 4.0 / 3 * radius : 1) * radius * radius;
  result.inertia = {density * body.inertia[0], density * body.inertia[1], density * body.inertia[2]};
  if (!space) result.inertia[2] = result.mass * gyration * gyration;
  bool turns = false;
  for (std::size_t k = 0; k < (space ? 6 : 3); ++k) {
    if (body.drives[k]) continue;
    const bool spin = k >= at(datbox.dimension);
    turns = turns || spin;
    result.directions[space ? k : spin ? 5 : k] = true;
    if (space && spin && body.forces[k] && !body.forces[k]->none())
      refuse(body.forces[k]->place,
             "expected forces along x, y and z of a body in space, met a moment: LMGC90 takes it along an axis of the "
             "body, which turns with it; not modelled");
  }
  const bool inertia = std::ranges::all_of(space ? std::span(result.inertia) : std::span(result.inertia).last(1),
                                           [](double one) { return one > 0; });
  if (!(result.mass > 0) || (turns && !inertia))
    refuse(body.place,
           "avrd and {}: expected numbers above 0 of a body that is not driven, met 0, which only disks, spheres "
           "and cylinders in space replace",
           space ? "I1 to I3" : "gyrd");
  if (space && turns) result.axes = Eigen::Quaterniond(body.frame).normalized();
  result.load = datbox_load(body, datbox.start, datbox.dimension);
  return result;
}

// The boundary from which free grains come one by one, that of body `first` on.
void add_source(const Datbox& datbox, std::vector<BoundarySpec>& boundaries) {
  const DatboxSource& source = *datbox.command.source;
  Index grains = 0, first = -1;
  for (Index k = 0; k < count(datbox.bodies); ++k) {
    const DatboxBody& body = datbox.bodies[at(k)];
    if (k + 1 >= source.first && !is_free_grain(body, datbox.space()))
      refuse(body.place, "expected a free {} as the source point of {}:{} releases, met another body",
             shape_of_grains(datbox.dimension), source.place.file, source.place.line);
    if (k + 1 == source.first) first = grains;
    if (body.wall().empty()) grains += count(body.contactors);
  }
  if (first < 0)
    refuse(source.place, "expected a source point of one of the {} bodies, met body {}", datbox.bodies.size(),
           source.first);
  BoundarySpec& boundary = boundaries.emplace_back();
  boundary.name = "source";
  boundary.dimension = datbox.dimension;
  boundary.shape = BoundaryShape::grains;
  boundary.first = first;
  boundary.last = grains - 1;
  boundary.source = source.at;
}

}  // namespace

std::vector<BoundarySpec> boundaries_of_datbox(const Datbox& datbox, bool coloured) {
  std::vector<BoundarySpec> boundaries;
  Index grains = 0;
  for (std::size_t k = 0; k < datbox.bodies.size(); ++k) {
    const DatboxBody& body = datbox.bodies[k];
    const Index own = !body.wall().empty() ? 0 : count(body.contactors), first = std::exchange(grains, grains + own);
    if (is_free_grain(body, datbox.space())) continue;
    BoundarySpec& boundary = boundaries.emplace_back();
    boundary.name = fmt::format("body {}", k + 1);
    boundary.dimension = datbox.dimension;
    boundary.colour = coloured ? colour_of(datbox, body.contactors[0]) : "";
    boundary.motion = datbox_motion(body, datbox.start, datbox.dimension);
    require_one_drive(body);
    if (!body.fully_driven(datbox.dimension)) boundary.body = free_body(datbox, body);
    if (!body.wall().empty()) {
      set_wall(datbox, body, boundary);
    } else {
      boundary.shape = BoundaryShape::grains;
      boundary.first = first;
      boundary.last = grains - 1;
    }
  }
  if (datbox.command.source) add_source(datbox, boundaries);
  return boundaries;
}

}  // namespace nscdd
