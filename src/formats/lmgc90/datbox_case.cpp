// SPDX-License-Identifier: GPL-3.0-or-later
// Packing and case of a DATBOX.
#include "formats/lmgc90/vloc_rloc.hpp"

#include <filesystem>
#include <numbers>

namespace nscdd {
namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

// The radius of gyration of a full disk is R / sqrt(2). Some files have three digits of it.
void require_full_disk(const DatboxBody& body) {
  constexpr double tolerance = 1e-3;
  const double radius = body.contactors[0].radius, expected = radius / std::numbers::sqrt2;
  if (body.contactors.size() > 1)
    refuse(body.place, "expected free bodies of one disk, met one of {}: free clusters are not modelled",
           body.contactors.size());
  if (std::abs(body.gyration_radius - expected) > tolerance * expected)
    refuse(body.place, "gyrd: expected that of a full disk, {}, met {}: other inertias are not modelled", expected,
           body.gyration_radius);
}

// The moments of inertia of a full sphere are 2/5 m R^2.
void require_full_sphere(const DatboxBody& body) {
  constexpr double tolerance = 1e-3;
  if (body.contactors.size() > 1)
    refuse(body.place, "expected free bodies of one sphere, met one of {}: free clusters are not modelled",
           body.contactors.size());
  const double radius = body.contactors[0].radius, average = body.average_radius;
  const double expected = 0.4 * radius * radius * 4.0 / 3 * std::numbers::pi * average * average * average;
  for (const double inertia : body.inertia)
    if (!(std::abs(inertia - expected) <= tolerance * expected))
      refuse(body.place, "I1 to I3: expected those of a full sphere, {}, met {}: other inertias are not modelled",
             expected, inertia);
}

Vector3 place_of(const DatboxBody& body, const DatboxContactor& grain, bool space) {
  if (space) return body.position + body.frame * grain.shift;
  const double c = std::cos(body.position[2]), s = std::sin(body.position[2]);
  return {body.position[0] + c * grain.shift[0] - s * grain.shift[1],
          body.position[1] + s * grain.shift[0] + c * grain.shift[1], 0};
}

// Calls `visit(body, disk, number)` for every grain of the packing.
template <class Visit>
void for_each_grain(const Datbox& datbox, DatboxGrains which, Visit visit) {
  Index number = 0;
  for (const DatboxBody& body : datbox.bodies)
    for (const DatboxContactor& contactor : body.contactors)
      if (!contactor.plank && (which == DatboxGrains::all || !body.driven())) visit(body, contactor, number++);
}

// The axes of a plank, as columns: along it, across it, and normal to it.
Matrix3 axes_of(const DatboxBody& plank, bool space) {
  if (space) return plank.frame;
  const double c = std::cos(plank.position[2]), s = std::sin(plank.position[2]);
  return Matrix3{{c, 0, -s}, {s, 0, c}, {0, 1, 0}};
}

// The face of a plank that all free grains are in front of: 1 for that of the normal, else -1. Throws Error if there is
// none, or if a grain lies beyond the edges.
double side_of_grains(const Datbox& datbox, const DatboxBody& body, const Matrix3& axes) {
  const DatboxContactor& plank = body.contactors[0];
  const bool space = datbox.space();
  const char* edges = space ? "edges" : "ends";
  const std::string_view grain = shape_of_grains(datbox.dimension);
  Index above = 0, below = 0;
  for_each_grain(datbox, DatboxGrains::free, [&](const DatboxBody& other, const DatboxContactor&, Index number) {
    const Vector3 from_middle = axes.transpose() * (other.position - body.position);
    const double along = std::abs(from_middle[0]), across = space ? std::abs(from_middle[1]) : 0;
    ++(from_middle[2] > 0 ? above : below);
    if (along > plank.length || across > plank.width)
      refuse(body.place,
             "expected a plank {0} with all free {1}s between its {2}, met {1} {3} at {4} from its middle, and {5}: "
             "walls have no {2} here, and would hold what the plank does not",
             datbox.plank(), grain, edges, number,
             space ? fmt::format("{} m and {} m", along, across) : fmt::format("{} m", along),
             space ? fmt::format("axe1 = {}, axe2 = {}", plank.length, plank.width)
                   : fmt::format("ax1 = {}", plank.length));
  });
  if (above > 0 && below > 0)
    refuse(body.place,
           "expected a plank {} with all free {}s on one side, met {} above and {} below it: walls are {} without {} "
           "here",
           datbox.plank(), grain, above, below, space ? "planes" : "straight lines", edges);
  return below > 0 ? -1 : 1;
}

// The line or plane of that face.
void set_wall(const Datbox& datbox, const DatboxBody& body, BoundarySpec& wall) {
  const bool space = datbox.space();
  const DatboxContactor& plank = body.contactors[0];
  const Matrix3 axes = axes_of(body, space);
  const double side = side_of_grains(datbox, body, axes);
  const Vector3 normal = side * (space ? axes.col(2).normalized() : Vector3(axes.col(2)));
  const Vector3 foot = body.position + plank.thickness * normal, half = side * plank.length * axes.col(0);
  if (space) {
    wall.dimension = 3;
    Vector3::Map(wall.point.data()) = foot;
    Vector3::Map(wall.normal.data()) = normal;
    return;
  }
  wall.from = {foot[0] - half[0], foot[1] - half[1]};
  wall.to = {foot[0] + half[0], foot[1] + half[1]};
}

std::vector<BoundarySpec> boundaries_of(const Datbox& datbox) {
  std::vector<BoundarySpec> boundaries;
  Index grains = 0;
  for (std::size_t k = 0; k < datbox.bodies.size(); ++k) {
    const DatboxBody& body = datbox.bodies[k];
    if (body.force)
      refuse(*body.force, "expected velocities (vlocy), met a force: bodies driven by forces are not modelled");
    if (body.plank() && !body.driven())
      refuse(body.place, "expected a plank {} that is driven, met a free one: planks are walls here", datbox.plank());
    if (body.driven()) {
      BoundarySpec boundary;
      boundary.name = fmt::format("body {}", k + 1);
      boundary.dimension = datbox.dimension;
      boundary.motion = datbox_motion(body, datbox.start, datbox.dimension);
      if (body.plank()) {
        set_wall(datbox, body, boundary);
      } else {
        boundary.shape = BoundaryShape::grains;
        boundary.first = grains;
        boundary.last = grains + count(body.contactors) - 1;
      }
      boundaries.push_back(std::move(boundary));
    }
    if (!body.plank()) grains += count(body.contactors);
  }
  return boundaries;
}

// The initial velocities of grains, by their numbers in the packing.
std::vector<PrescribedVelocity> moving_grains(const Datbox& datbox, DatboxGrains which) {
  std::vector<PrescribedVelocity> moving;
  for_each_grain(datbox, which, [&](const DatboxBody& body, const DatboxContactor&, Index number) {
    if (body.driven()) return;
    const bool space = datbox.space();
    const Vector3& v = body.velocity;
    Vector3 spin = Vector3::Zero();
    if (which == DatboxGrains::all) spin = space ? Vector3(body.frame * body.spin) : Vector3(0, 0, v[2]);
    if (v.head(datbox.dimension).isZero(0) && spin.isZero(0)) return;
    moving.push_back({number,
                      space ? Components<double>{v[0], v[1], v[2]} : Components<double>{v[0], v[1]},
                      {spin[0], spin[1], spin[2]}});
  });
  return moving;
}

// Without trailing slashes.
std::string trimmed(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

}  // namespace

double density_of(const Datbox& datbox, const DatboxBody& body) {
  const auto found = datbox.density.find(body.bulk);
  if (found == datbox.density.end())
    refuse(body.place, "bulk law '{}': expected a law RIGID of that name in BULK_BEHAV.DAT, met none", body.bulk);
  return found->second;
}

Packing datbox_packing(const Datbox& datbox, DatboxGrains which) {
  Packing packing;
  for_each_grain(datbox, which, [&](const DatboxBody& body, const DatboxContactor& disk, Index) {
    packing.radius.push_back(disk.radius);
    packing.half_digit = std::max(packing.half_digit, body.written_digit);
    const double size = body.driven() ? disk.radius : body.average_radius;  // a driven mass has no effect
    const bool space = datbox.space();
    if (!body.driven()) space ? require_full_sphere(body) : require_full_disk(body);
    const Vector3 place = place_of(body, disk, space);
    packing.x.push_back(place[0]);
    packing.y.push_back(place[1]);
    if (space) packing.z.push_back(place[2]);
    const double density = density_of(datbox, body);
    packing.mass.push_back(space ? density * 4.0 / 3 * std::numbers::pi * size * size * size
                                 : density * std::numbers::pi * size * size);
  });
  if (packing.size() == 0)
    fail("{}/BODIES.DAT: expected at least one {}, met none", datbox.folder, shape_of_grains(datbox.dimension));
  check(packing);
  return packing;
}

Dynamics datbox_dynamics(const Datbox& datbox) {
  const Packing packing = datbox_packing(datbox, DatboxGrains::all);
  Dynamics dynamics;
  dynamics.boundaries = boundaries_of(datbox);
  const auto [interaction, alert, removes_overlaps] = contact_law_of(datbox);
  dynamics.interaction = interaction;
  if (!datbox.gravity) fail("{}/BULK_BEHAV.DAT: expected a section $gravy, met none", datbox.folder);
  const auto [x, y, z] = *datbox.gravity;
  dynamics.time.gravity = datbox.space() ? Components<double>{x, y, z} : Components<double>{x, y};
  dynamics.time.alert = std::min(10.0, alert / *std::ranges::min_element(packing.radius));
  dynamics.time.boundary_instant = BoundaryInstant::end;
  if (removes_overlaps)
    dynamics.time.maximum_push_speed = 1e100;
  else if (!interaction.on_velocity())
    dynamics.time.penetration_correction = 0;
  return dynamics;
}

CaseSpec case_of_datbox(const std::string& path, bool moving) {
  const Datbox datbox = read_datbox(path, DatboxShapes::any);
  CaseSpec spec;
  spec.name = datbox_name(trimmed(path));
  const auto unmodelled = std::ranges::find_if(datbox.bodies, [](const auto& one) { return !one.unmodelled.empty(); });
  if (unmodelled != datbox.bodies.end()) {
    const std::string network = vloc_rloc_of_datbox(path);
    if (network.empty()) fail("{}", unmodelled->unmodelled);
    if (moving) fail("{}; sweep, inspect and solve take its contacts from {}", unmodelled->unmodelled, network);
    spec.packing = ContactProblemFile{network};
    return spec;
  }
  spec.packing = PackingFile{trimmed(path)};
  spec.prescribed = moving_grains(datbox, moving ? DatboxGrains::all : DatboxGrains::free);
  if (moving) spec.dynamics = datbox_dynamics(datbox);
  return spec;
}

}  // namespace nscdd
