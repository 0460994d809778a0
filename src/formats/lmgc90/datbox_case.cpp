// SPDX-License-Identifier: GPL-3.0-or-later
// Packing and case of a DATBOX.
#include "formats/lmgc90/vloc_rloc.hpp"

#include <numbers>

namespace nscdd {
namespace {

// Whether a body has the inertia of its first contactor, a full disk or sphere.
bool has_full_inertia(const DatboxBody& body, bool space) {
  constexpr double tolerance = 1e-3;  // some files have three digits
  const double radius = body.contactors[0].radius, average = body.average_radius;
  if (!space) {
    const double expected = radius / std::numbers::sqrt2;
    return std::abs(body.gyration_radius - expected) <= tolerance * expected;
  }
  const double expected = 0.4 * radius * radius * 4.0 / 3 * std::numbers::pi * average * average * average;
  return ((body.inertia.array() - expected).abs() <= tolerance * expected).all();
}

// Throws Error unless a free body is one grain, as the linear study has it.
void require_grain(const DatboxBody& body, bool space) {
  const std::string grain(shape_of_grains(space ? 3 : 2));
  if (body.contactors.size() > 1)
    refuse(body.place, "expected free bodies of one {}, met one of {}: free clusters are not modelled here", grain,
           body.contactors.size());
  if (!has_full_inertia(body, space))
    refuse(body.place, "{}: expected that of a full {}, met another: other inertias are not modelled here",
           space ? "I1 to I3" : "gyrd", grain);
}

// Calls `visit(body, disk, number)` for every grain of the packing.
template <class Visit>
void for_each_grain(const Datbox& datbox, DatboxGrains which, Visit visit) {
  Index number = 0;
  for (const DatboxBody& body : datbox.bodies)
    for (const DatboxContactor& contactor : body.contactors)
      if (contactor.wall.empty() && (which == DatboxGrains::all || !body.driven())) visit(body, contactor, number++);
}

// The initial velocities of grains, by their numbers in the packing.
std::vector<PrescribedVelocity> moving_grains(const Datbox& datbox, DatboxGrains which) {
  std::vector<PrescribedVelocity> moving;
  for_each_grain(datbox, which, [&](const DatboxBody& body, const DatboxContactor&, Index number) {
    const bool space = datbox.space();
    const auto& source = datbox.command.source;
    if (source && which == DatboxGrains::all && &body - datbox.bodies.data() + 1 >= source->first) {
      if (!body.velocity.isZero(0) || !body.spin.isZero(0))
        refuse(body.place, "expected bodies at rest that a source point releases, met one that moves");
      return;
    }
    if (which == DatboxGrains::all && !is_free_grain(body, space)) return;
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

}  // namespace

Vector3 DatboxBody::place_of(const DatboxContactor& one, bool space) const {
  if (space) return position + frame * one.shift;
  const double c = std::cos(position[2]), s = std::sin(position[2]);
  return {position[0] + c * one.shift[0] - s * one.shift[1], position[1] + s * one.shift[0] + c * one.shift[1], 0};
}

bool is_free_grain(const DatboxBody& body, bool space) {
  const bool loaded = std::ranges::any_of(body.forces, [](const auto& one) { return one.has_value(); });
  return !body.driven() && !loaded && body.contactors.size() == 1 && body.grains() == 1 &&
         body.contactors[0].shift.isZero(0) && has_full_inertia(body, space);
}

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
    const bool space = datbox.space(), grain = which == DatboxGrains::free || is_free_grain(body, space);
    const double size = grain ? body.average_radius : disk.radius;  // a mass of another body has no effect
    if (which == DatboxGrains::free) require_grain(body, space);
    const Vector3 place = body.place_of(disk, space);
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
  const double alert = set_contact_laws(datbox, dynamics);
  dynamics.boundaries = boundaries_of_datbox(datbox, !dynamics.pairs.empty());
  if (!datbox.gravity) fail("{}/BULK_BEHAV.DAT: expected a section $gravy, met none", datbox.folder);
  const auto [x, y, z] = *datbox.gravity;
  dynamics.time.gravity = datbox.space() ? Components<double>{x, y, z} : Components<double>{x, y};
  dynamics.time.alert = std::min(10.0, alert / *std::ranges::min_element(packing.radius));
  dynamics.time.boundary_instant = BoundaryInstant::end;
  dynamics.time.step = datbox.command.step.value_or(datbox.mean_step.value_or(dynamics.time.step));
  dynamics.time.theta = datbox.command.theta.value_or(dynamics.time.theta);
  return dynamics;
}

CaseSpec case_of_datbox(const std::string& path, bool moving) {
  const Datbox datbox = read_datbox(path, DatboxShapes::any);
  CaseSpec spec;
  spec.name = datbox_name(path);
  const auto unmodelled = std::ranges::find_if(datbox.bodies, [](const auto& one) { return !one.unmodelled.empty(); });
  if (unmodelled != datbox.bodies.end()) {
    const std::string network = vloc_rloc_of_datbox(path);
    if (network.empty()) fail("{}", unmodelled->unmodelled);
    if (moving) fail("{}; sweep, inspect and solve take its contacts from {}", unmodelled->unmodelled, network);
    spec.packing = ContactProblemFile{network};
    return spec;
  }
  // Without trailing slashes.
  const std::string folder = path.substr(0, std::max<std::size_t>(path.find_last_not_of('/') + 1, 1));
  spec.packing = PackingFile{folder, moving && !vloc_rloc_of_datbox(folder).empty() ? folder : ""};
  spec.prescribed = moving_grains(datbox, moving ? DatboxGrains::all : DatboxGrains::free);
  spec.contacts.period_x = datbox.command.period_x.value_or(0);
  spec.contacts.period_y = datbox.command.period_y.value_or(0);
  spec.places = datbox.command.places;
  spec.remarks = datbox.remarks;
  if (!moving) return spec;
  spec.dynamics = datbox_dynamics(datbox);
  if (!datbox.command.step)
    spec.remarks["dynamics.step"] =
        fmt::format("COMMAND.DAT has no time step: {} s ({}); --set dynamics.step=SECONDS", spec.dynamics->time.step,
                    datbox.mean_step ? "as before DOF.INI" : "the default");
  return spec;
}

}  // namespace nscdd
