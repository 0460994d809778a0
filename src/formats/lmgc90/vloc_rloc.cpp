// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/vloc_rloc.hpp"

#include "files/csv.hpp"
#include "linalg/sparse_entries.hpp"

#include <numbers>

namespace nscdd {
namespace {

using Vector6 = Eigen::Vector<double, 6>;

// Translations, then one spin, or three along the axes of the body. One that is driven in some of them keeps all rows,
// so that every body has as many; a driven one has no entry in H, and its velocity is data.
struct NetworkBody {
  Index row = -1;                                             // the first in M; -1: all are driven
  Matrix spin_axes;                                           // as columns
  Vector6 mass = Vector6::Zero();                             // kg or kg m^2
  Vector6 before = Vector6::Zero(), after = Vector6::Zero();  // the step without impulses of contacts, m/s or rad/s
};

// LMGC90 extrapolates tables linearly.
double value_of(const DatboxDrive& drive, double t) {
  if (drive.table.empty())
    return (drive.constant + drive.amplitude * std::cos(drive.omega * t + drive.phase)) *
           std::min(1.0, drive.initial + drive.rate * t);
  const auto& rows = drive.table;
  const auto beyond = std::ranges::find_if(rows, [=](const auto& row) { return t <= row[0]; });
  const auto to = std::clamp(beyond, rows.begin() + 1, rows.end() - 1), from = to - 1;
  return std::lerp((*from)[1], (*to)[1], (t - (*from)[0]) / ((*to)[0] - (*from)[0]));
}

Vector6 masses_of(const Datbox& datbox, const DatboxBody& body) {
  const double radius = body.average_radius, gyration = body.gyration_radius, density = density_of(datbox, body);
  const double m = density * std::numbers::pi * (datbox.space() ? 4.0 / 3 * radius : 1) * radius * radius;
  Vector6 mass;
  mass << m, m, (datbox.space() ? m : m * gyration * gyration), density * body.inertia;
  if (!((datbox.space() ? mass.minCoeff() : mass.head<3>().minCoeff()) > 0))
    refuse(body.place,
           "avrd and {}: expected numbers above 0 of a body that is not driven, met 0, which is computed of "
           "disks, spheres, polygons, polyhedra and planks, and of cylinders in space",
           datbox.space() ? "I1 to I3" : "gyrd");
  return mass;
}

// Of a step h. `rows`: of M.
std::vector<NetworkBody> network_bodies(const Datbox& datbox, double h, Index& rows) {
  const Index dofs = datbox.space() ? 6 : 3;
  if (!datbox.gravity) fail("{}/BULK_BEHAV.DAT: expected a section $gravy, met none", datbox.folder);
  std::vector<NetworkBody> bodies;
  for (const DatboxBody& body : datbox.bodies) {
    require_known_axes(body);
    NetworkBody& own = bodies.emplace_back();
    own.spin_axes = datbox.space() ? Matrix(body.frame) : Matrix(Vector3::UnitZ());
    own.before << body.velocity, body.spin;
    own.after = own.before;
    if (!body.fully_driven(datbox.dimension)) {
      own.mass = masses_of(datbox, body);
      own.row = rows;
      rows += dofs;
    }
    for (Index k = 0; k < dofs; ++k) {
      if (const auto& drive = body.drives[at(k)]) {
        if (const auto& force = body.forces[at(k)])
          refuse(force->place, "expected a velocity or a force of degree of freedom {}, met both", k + 1);
        own.after[k] = value_of(*drive, datbox.start + h);
        continue;
      }
      if (k < datbox.dimension) own.after[k] += h * (*datbox.gravity)[at(k)];
      if (const auto& force = body.forces[at(k)])  // the mean of both ends of the step: theta is 1/2
        own.after[k] += h * (value_of(*force, datbox.start) + value_of(*force, datbox.start + h)) / 2 / own.mass[k];
    }
  }
  return bodies;
}

// From the centre of the body. That of a single disk, hollow disk or sphere is its radius along n, as in LMGC90.
Vector3 lever_of(const DatboxContact& contact, const DatboxBody& body, bool candidate, bool space) {
  const DatboxContactor& shape = body.contactors[0];
  const Vector3 n = contact.frame.col(0), centre(body.position[0], body.position[1], space ? body.position[2] : 0);
  const Vector3 lever = contact.point - centre;
  const bool single = body.contactors.size() == 1, grain = single && shape.wall.empty();
  const double reach = std::max(shape.reach, shape.radius);
  constexpr double margin = 1.5;  // places and points belong to instants one step apart
  if (grain && reach > 0 && lever.norm() > margin * reach + std::abs(contact.gap))
    refuse(contact.place,
           "expected a point of the {} within {} m of its centre, met one at {} m: an image in a periodic cell, whose "
           "period is in no file, is not modelled",
           candidate ? "candidate" : "antagonist", reach, lever.norm());
  if (single && shape.wall == "xKSID") return -shape.radius * n;
  if (grain && shape.radius > 0 && shape.shift.isZero(0)) return (candidate ? -shape.radius : shape.radius) * n;
  return contact.kind == "DKDKx" && !candidate ? Vector3(lever - contact.gap * n) : lever;  // the point is on the other
}

// Adds the columns of H of a contact, and what is data in its relative velocities.
void add_contact(const Datbox& datbox, const std::vector<NetworkBody>& bodies, const DatboxContact& contact,
                 const DatboxLaw& law, double h, SparseEntries& entries, Index column, Eigen::Ref<Vector> w) {
  const Index d = datbox.dimension;
  Vector before = Vector::Zero(d);
  for (const bool candidate : {true, false}) {
    const Index number = candidate ? contact.candidate : contact.antagonist;
    const NetworkBody& own = bodies[at(number)];
    const DatboxBody& body = datbox.bodies[at(number)];
    const Vector3 lever = lever_of(contact, body, candidate, datbox.space());
    for (Index k = 0; k < d; ++k) {
      const Vector3 direction = (candidate ? 1 : -1) * contact.frame.col(k);
      Vector along(d + own.spin_axes.cols());  // the share of each unknown in the relative velocity
      along << direction.head(d), own.spin_axes.transpose() * lever.cross(direction);
      before[k] += along.dot(own.before.head(along.size()));
      for (Index j = 0; j < along.size(); ++j)
        if (own.row >= 0 && !body.drives[at(j)])
          entries.add(own.row + j, column + k, along[j]);
        else
          w[k] += along[j] * own.after[j];
    }
  }
  // A gap may close within the step (LMGC90 leaves contacts of laws on the velocity with a gap out of it).
  if (contact.gap > 0 || law.kind == "GAP_SGR_CLB") {
    w[0] += contact.gap / h;
  } else {
    w[0] += law.restitution * std::min(0.0, before[0]);
    w.tail(d - 1) += law.tangential_restitution * before.tail(d - 1);
  }
}

// The contacts of a file at the state of `datbox`, which `state` names. Throws Error also for another time.
DatboxNetwork network_at_state(const std::string& path, const Datbox& datbox, const std::string& state) {
  DatboxNetwork network = parse_vloc_rloc(read_text(path), path, datbox);
  if (std::abs(network.time - datbox.start) > 1e-6 * std::max(network.time, datbox.start))
    fail("{}: expected the time of {}, {} s, met {} s", path, state, datbox.start, network.time);
  return network;
}

ContactForces contact_forces_of(const Datbox& datbox, const DatboxNetwork& network) {
  ContactForces result{datbox.dimension};
  std::vector<std::vector<Index>> numbers;  // of the shapes of each body, as a case has them
  for (const DatboxBody& body : datbox.bodies) result.grains += body.grains();
  Index grains = 0;
  for (const DatboxBody& body : datbox.bodies) {
    std::vector<Index>& own = numbers.emplace_back();
    for (const DatboxContactor& one : body.contactors)
      own.push_back(one.wall.empty() ? grains++ : result.grains + result.walls++);
  }
  const auto number = [&](Index body, Index shape) -> Index {  // -1 of what is not there
    if (body >= count(numbers) || shape < 0 || shape >= count(numbers[at(body)])) return -1;
    return numbers[at(body)][at(shape)];
  };
  for (const DatboxContact& contact : network.contacts) {
    if (contact.force.isZero(0) || contact.within()) continue;  // as in impulses_to_remember
    const Index candidate = number(contact.candidate, contact.candidate_shape),
                antagonist = number(contact.antagonist, contact.antagonist_shape);
    if (candidate < 0 || antagonist < 0) continue;
    const double sign = candidate > antagonist ? 1 : -1;  // from the force on the candidate to that on b
    const Vector3 force = sign * contact.frame * contact.force, normal = sign * contact.frame.col(0);
    result.forces.push_back({.a = std::min(candidate, antagonist),
                             .b = std::max(candidate, antagonist),
                             .impulse = datbox.space() ? std::array{force[0], force[1], force[2]}
                                                       : std::array{normal.dot(force), normal.cross(force)[2], 0.0},
                             .slid = contact.slid});
  }
  std::ranges::stable_sort(result.forces, {}, body_pair);
  return result;
}

}  // namespace

FclibFile contact_problem_of(const Datbox& datbox, const DatboxNetwork& network, const std::string& name) {
  const bool timed = network.step > 0 && network.time > 0;
  const double h = network.h > 0 ? network.h
                   : timed       ? network.time / static_cast<double>(network.step)
                                 : TimeStepping().step;
  const Index dofs = datbox.space() ? 6 : 3, d = datbox.dimension;
  Index rows = 0;
  const std::vector<NetworkBody> bodies = network_bodies(datbox, h, rows);
  std::vector<DatboxContact> contacts = network.contacts;
  const auto in_doubt = [&](Index body, Index shape) {  // LMGC90 has counted contactors over all bodies, too
    const Index most = body < count(bodies) ? count(datbox.bodies[at(body)].contactors) : 0;
    return most == 0 || (most > 1 && shape >= most);
  };
  for (const DatboxContact& one : contacts)
    if (in_doubt(one.candidate, one.candidate_shape) || in_doubt(one.antagonist, one.antagonist_shape))
      refuse(one.place, "expected two of the {} bodies of BODIES.DAT with contactors that they have, met {} and {}",
             bodies.size(), one.candidate + 1, one.antagonist + 1);
  std::erase_if(contacts, [&](const DatboxContact& one) {
    return one.within() || (bodies[at(one.candidate)].row < 0 && bodies[at(one.antagonist)].row < 0);
  });
  if (contacts.empty()) fail("{}: expected contacts of bodies that are not driven, met none", name);
  FclibFile file;
  GlobalFrictionProblem problem;
  problem.dimension = d;
  problem.w.setZero(d * count(contacts));
  problem.friction.resize(count(contacts));
  file.points.resize(d, count(contacts));
  SparseEntries entries;
  Vector impulses(d * count(contacts)), pulls = Vector::Zero(impulses.size());
  for (Index c = 0; c < count(contacts); ++c) {
    const DatboxContact& contact = contacts[at(c)];
    const DatboxLaw& law = law_named(datbox, contact.law, contact.place);
    if (law.bond()) refuse(contact.place, "expected a contact that may open, met the bond {}", law.kind);
    if (law.wet() && contact.gap <= law.range) pulls[d * c] = h * law.cohesion;
    problem.friction[c] = contact.slid ? law.friction : law.static_friction;
    impulses.segment(d * c, d) = h * contact.force.head(d);
    file.points.col(c) = contact.point.head(d);
    add_contact(datbox, bodies, contact, law, h, entries, d * c, problem.w.segment(d * c, d));
  }
  Vector mass(rows), free(rows);
  for (const NetworkBody& own : bodies) {
    if (own.row < 0) continue;
    mass.segment(own.row, dofs) = own.mass.head(dofs);
    free.segment(own.row, dofs) = own.after.head(dofs);
  }
  problem.mass = diagonal_matrix(mass);
  problem.h = entries.matrix(rows, d * count(contacts));
  problem.f = mass.cwiseProduct(free) - problem.h * pulls;  // impulses are r + pull, which obey Coulomb's law
  check(problem, name);
  const Vector v = free + (problem.h * impulses).cwiseQuotient(mass);
  file.guesses.push_back({v, problem.h.transpose() * v + problem.w, impulses + pulls});
  file.info.title = fmt::format("contacts of LMGC90 at step {}, time {} s; the next step with h = {} s{}", network.step,
                                network.time, h, timed || network.h > 0 ? "" : ", the default");
  file.problem = std::move(problem);
  return file;
}

FclibFile read_vloc_rloc(const std::string& path) {
  if (const auto record = record_at(path)) {
    const Datbox datbox = read_datbox(path, DatboxShapes::any);
    return contact_problem_of(datbox, read_network(*record, datbox), path);
  }
  if (!has_vloc_rloc_name(path)) return read_vloc_rloc((datbox_folder(path) / "Vloc_Rloc.INI").string());
  // Vloc_Rloc.OUT.7 goes with DOF.OUT.7.
  const std::string ending = fs::path(path).filename().string().substr(std::string_view("Vloc_Rloc").size()),
                    state = (fs::path(path).parent_path() / ("DOF" + ending)).string();
  const bool initial = ending == ".INI" && !is_there(state);
  const Datbox datbox = read_datbox(datbox_beside(path), DatboxShapes::any, initial ? "" : state);
  return contact_problem_of(datbox, network_at_state(path, datbox, state), path);
}

ContactForces read_contact_forces(const std::string& path) {
  if (!holds_datbox(path)) fail("{}: expected a folder with BODIES.DAT or a record of LMGC90, met another", path);
  const Datbox datbox = read_datbox(path);
  if (const auto record = record_at(path)) return contact_forces_of(datbox, read_network(*record, datbox));
  const std::string file = vloc_rloc_of_datbox(path);
  if (file.empty()) fail("{}: expected contacts in Vloc_Rloc.INI, met none", path);
  return contact_forces_of(datbox, network_at_state(file, datbox, "the initial state"));
}

std::string vloc_rloc_of_datbox(const std::string& path) {
  if (record_at(path)) return path;
  const std::string file = (datbox_folder(path) / "Vloc_Rloc.INI").string();
  return is_file(file) && read_text(file).find("$icdan") != std::string::npos ? file : "";
}

bool has_vloc_rloc_name(const std::string& path) {
  return fs::path(path).filename().string().starts_with("Vloc_Rloc.");
}

std::string datbox_name(const std::string& folder) {
  const auto record = record_at(folder);
  fs::path path = (record ? fs::absolute(record->file).parent_path() : fs::absolute(folder)).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // of "." and of names that end in a slash
  if ((path.filename() == "DATBOX" || path.filename() == "OUTBOX") && path.has_parent_path()) path = path.parent_path();
  return path.filename().string();
}

}  // namespace nscdd
