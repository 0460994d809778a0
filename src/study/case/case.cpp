// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/case/case.hpp"

#include "core/fail.hpp"
#include "core/text.hpp"
#include "simulation/simulation.hpp"

#include <filesystem>

namespace nscdd {
namespace {

// The points of contacts as a packing with their midpoints.
std::pair<Packing, ContactNetwork> geometry_of(const Matrix& points) {
  const auto row = [&](Index k) { return std::vector<double>(points.row(k).begin(), points.row(k).end()); };
  Packing packing{.x = row(0), .y = row(1), .radius = std::vector<double>(at(points.cols()), 1.0), .mass = {}};
  if (points.rows() == 3) packing.z = row(2);
  ContactNetwork network;
  for (Index c = 0; c < points.cols(); ++c) {
    Contact contact;
    std::ranges::copy(points.col(c), contact.midpoint.begin());
    network.contacts.insert(network.contacts.end(), at(points.rows()), contact);  // one per column of H
  }
  return {packing, network};
}

Partition partition_of_problem(const Partitioner& partitioner, const ReferenceProblem& problem, const Matrix& points,
                               const std::string& path) {
  if (subdomains(partitioner) == 1)
    return {.subdomains = 1, .subdomain_of_contact = std::vector<Index>(at(problem.contacts()), 0)};
  const auto geometry = [&] {
    if (points.size() > 0) return geometry_of(points);
    fail(
        "{}: expected subdomains metis:N (partition.metis) for a contact problem, which has no geometry, met {} "
        "subdomains by another partitioner",
        path, subdomains(partitioner));
  };
  return distribute(partitioner, geometry, [&]() -> const ReferenceProblem& { return problem; });
}

std::string grain_key(std::size_t k) { return fmt::format("prescribed[{}].grain", k); }

// Prescribed velocities with grains counted from 0. Throws Error for a grain met twice and missing components.
std::vector<PrescribedVelocity> numbered(std::vector<PrescribedVelocity> prescribed, const Packing& packing) {
  const Index grains = packing.size();
  for (std::size_t k = 0; k < prescribed.size(); ++k) {
    PrescribedVelocity& velocity = prescribed[k];
    if (velocity.grain < -grains || velocity.grain >= grains)
      throw Error(grain_key(k), fmt::format("expected a grain in 0..{} (or -1 for the last), met grain {}", grains - 1,
                                            velocity.grain));
    if (velocity.grain < 0) velocity.grain += grains;
    require_components(velocity.velocity, packing.dimension(), fmt::format("prescribed[{}].velocity", k));
    if (std::ranges::count(std::span(prescribed).first(k), velocity.grain, &PrescribedVelocity::grain) > 0)
      throw Error(grain_key(k), fmt::format("expected each grain once, met grain {} again", velocity.grain));
  }
  return prescribed;
}

// Bodies of grains that are free along all directions and have no velocity start with the mean one of their grains.
void set_bodies(GranularScene& start, Index grains, const std::vector<GrainMotion>& motions) {
  const GranularSystem& system = start.system;
  std::vector<double> mass(system.boundaries.size(), 0);
  std::vector<Place> momentum(mass.size(), Place{});
  for (std::size_t i = 0; i < at(grains); ++i) {
    if (system.driven_by[i] < 0) continue;
    const auto k = at(system.driven_by[i]);
    mass[k] += system.mass[i];
    momentum[k] = moved_along(momentum[k], system.mass[i], velocity_of(motions[i]));
  }
  for (const Index k : system.free_bodies) {
    const Boundary& boundary = system.boundaries[at(k)];
    if (boundary.motion.initial || mass[at(k)] == 0 || !boundary.body->wholly_free(system.dimension)) continue;
    const auto& [x, y, z] = momentum[at(k)];
    const double m = mass[at(k)];
    start.state.body_velocities[at(k)] = {.x = x / m, .y = y / m, .z = z / m};
  }
}

// Free grains start with the arriving velocities of the linear study.
void set_moving(const Case& one, const Packing& packing, GranularScene& start) {
  const ContactNetwork none{
      .contacts = {}, .grains = packing.size(), .dimension = packing.dimension(), .period = one.spec.contacts.period()};
  const std::vector<PrescribedVelocity> prescribed = numbered(one.spec.prescribed, packing);
  // By a source, at rest.
  const auto released = [&](Index grain) { return std::ranges::count(start.state.released, grain) > 0; };
  for (std::size_t k = 0; k < prescribed.size(); ++k)
    if (const Index grain = prescribed[k].grain; !start.system.free(grain) || released(grain))
      throw Error(grain_key(k), fmt::format("expected a free grain, met {}{}", body_name(start.system, grain),
                                            released(grain) ? ", which a source releases at rest" : ""));
  const Vector v = assemble(packing, none, prescribed, one.spec.loads).arriving_velocity;
  std::vector<GrainMotion> motions(at(packing.size()));  // with spins, since the radius is 1 for them
  for (Index i = 0; i < packing.size(); ++i)
    std::copy_n(v.data() + none.dimension * i, none.dimension, motions[at(i)].begin());
  for (const PrescribedVelocity& spinning : prescribed)
    std::ranges::copy(spinning.spin, motions[at(spinning.grain)].begin() + 3);
  for (Index i = 0; i < packing.size(); ++i)
    if (start.system.free(i) && !released(i)) set_motion(start.state, at(i), motions[at(i)], 1);
  set_bodies(start, packing.size(), motions);
}

// The impulses of a step before the first, which had the same time step and these forces.
void set_forces(const Case& one, Index grains, Simulation& simulation) {
  const ContactForces& start = one.start;
  if (start.forces.empty()) return;
  const GranularSystem& system = simulation.system;
  if (start.dimension != system.dimension || start.grains != grains || start.walls != count(system.walls))
    throw Error("packing.forces",
                fmt::format("expected contacts of {} {}s and {} walls, met those of {} {}s and {} walls", grains,
                            shape_of_grains(system.dimension), system.walls.size(), start.grains,
                            shape_of_grains(start.dimension), start.walls));
  simulation.state.impulses = start.forces;
  for (RememberedImpulse& each : simulation.state.impulses) {
    for (double& component : each.impulse) component *= simulation.dynamics.time.step;
    if (each.b >= grains) each.b += system.grains() - grains;  // behind the disks of boundaries
  }
}

// `contacts = {}` would keep their memory.
void without_contacts(ContactNetwork& network) { std::vector<Contact>().swap(network.contacts); }

Model without_parts(const Case& one, const Monitor& monitor) try {
  Model model;
  model.name = one.spec.name;
  if (const auto* file = std::get_if<ContactProblemFile>(&one.spec.packing)) {
    if (!one.spec.prescribed.empty())
      fail("{}: expected no prescribed velocities for a contact problem, whose loads are those of its f, met {}",
           file->path, one.spec.prescribed.size());
    model.problem = reference_problem(one.problem, file->path);
    model.friction = std::make_shared<const GlobalFrictionProblem>(one.problem);
    model.partition = partition_of_problem(one.spec.partition, model.problem, one.points, file->path);
    return model;
  }
  model.packing = with_masses(packing_of(one, monitor), one.spec.masses);
  try {
    model.network = detect_contacts(model.packing, one.spec.contacts);
  } catch (const Error& error) {
    const auto* file = std::get_if<PackingFile>(&one.spec.packing);
    fail("{}: {}", file != nullptr ? file->path : "case " + one.spec.name, error.what());
  }
  model.problem = assemble(model.packing, model.network, numbered(one.spec.prescribed, model.packing), one.spec.loads);
  model.partition = distribute(
      one.spec.partition, [&] { return std::tie(model.packing, model.network); },
      [&]() -> const ReferenceProblem& { return model.problem; });
  return model;
} catch (const Error& error) {
  if (error.key().empty()) throw;
  throw located(one.spec, error);
}

std::string content(const Packing& packing) {
  std::string all;  // with the length of each list: masses of disks are not heights of spheres
  for (const auto* values : {&packing.x, &packing.y, &packing.radius, &packing.mass, &packing.z})
    all += fmt::format("{} {} ", values->size(), fingerprint(*values));
  return fmt::format("{} grains, content {}", packing.size(), fingerprint(all));
}

std::string content(const GlobalFrictionProblem& problem) {
  std::vector<double> all;
  for (const SparseMatrix* matrix : {&problem.mass, &problem.h})
    for (Index j = 0; j < matrix->cols(); ++j)
      for (SparseMatrix::InnerIterator e(*matrix, j); e; ++e)
        all.insert(all.end(), {static_cast<double>(e.row()), static_cast<double>(j), e.value()});
  for (const Vector* values : {&problem.f, &problem.w, &problem.friction}) {
    all.push_back(static_cast<double>(values->size()));
    all.insert(all.end(), values->begin(), values->end());
  }
  return fmt::format("{} contacts, content {}", problem.contacts(), fingerprint(all));
}

// The name of a file, without its folder, and its content.
std::string file_text(const std::string& path, const std::string& content) {
  return fmt::format("{} ({})", std::filesystem::path(path).filename().string(), content);
}

}  // namespace

std::string fingerprint_of_forces(const Case& one) {
  std::vector<double> numbers;
  for (const RememberedImpulse& each : one.start.forces) {
    const auto& [x, y, z] = each.impulse;
    numbers.insert(numbers.end(),
                   {static_cast<double>(each.a), static_cast<double>(each.b), x, y, z, each.slid ? 1.0 : 0.0});
  }
  return fingerprint(std::span<const double>(numbers));
}

std::string text_with_contents(const Case& one, CaseSpec spec) {
  if (auto* file = std::get_if<PackingFile>(&spec.packing)) {
    file->path = file_text(file->path, content(one.packing));
    if (!file->forces.empty()) file->forces = file_text(file->forces, fingerprint_of_forces(one));
  }
  if (auto* file = std::get_if<ContactProblemFile>(&spec.packing))
    file->path = file_text(file->path, content(one.problem));
  if (auto* settled = std::get_if<SettledFrom>(&spec.packing))
    settled->name = fmt::format("{} ({})", settled->name, content(one.packing));
  return fmt::format("name = {}\n", field_text(spec.name)) + to_toml(spec);
}

std::optional<Index> dimension_of(const Case& one) {
  if (const auto* generator = std::get_if<Generator>(&one.spec.packing)) return dimension(*generator);
  return one.packing.size() > 0 ? std::optional(one.packing.dimension()) : std::nullopt;
}

Packing packing_of(const Case& one, const Monitor& monitor) {
  if (const auto* file = std::get_if<ContactProblemFile>(&one.spec.packing))
    fail("{}: expected a packing, met a contact problem, which has no geometry", file->path);
  const auto* generator = std::get_if<Generator>(&one.spec.packing);
  Packing packing = generator ? generate(*generator, monitor) : one.packing;
  check(packing);
  return one.spec.masses.model ? with_masses(std::move(packing), one.spec.masses) : packing;
}

void require_geometry(const Model& model, std::string_view what) {
  if (!model.has_geometry())
    fail("{}: {}: expected a packing, met a contact problem, which has no geometry", model.name, what);
}

Simulation simulation_of(const Case& one, const Monitor& monitor) try {
  check_dynamics(one.spec);
  Packing packing = with_masses(packing_of(one, monitor), one.spec.masses);
  // The default is downwards in either dimension, see gravity_of. A stated one must fit the dimension.
  if (const auto& gravity = one.spec.dynamics->time.gravity;
      one.spec.places.contains("dynamics.gravity") || gravity != TimeStepping().gravity)
    require_components(gravity, packing.dimension(), "dynamics.gravity");
  const bool homogenised = one.spec.dynamics->solver.model == SwitchedModel::homogenised;
  if (homogenised && packing.dimension() == 3)
    throw Error("solver.switch", "expected none or linear with spheres in space, met homogenised");
  if (homogenised) require_components(one.spec.dynamics->solver.switch_cells, 2, "solver.switch_cells");
  GranularScene start = scene(packing, *one.spec.dynamics, one.spec.contacts.period());
  set_moving(one, packing, start);
  const Index grains = packing.size();
  packing = {};  // frees its memory
  Simulation simulation{std::move(start.system), std::move(start.state), *one.spec.dynamics, one.spec.partition};
  set_forces(one, grains, simulation);
  if (switches_models(simulation)) simulation.state.models.resize(at(subdomains(simulation.partitioner)));
  check_next_step(simulation);
  return simulation;
} catch (const Error& error) {
  throw located(one.spec, error);
}

Model of_process(Model model, const Processes& processes) {
  if (processes.alone()) return model;
  const std::vector<Index> process_of = deal_out(model.parts, processes.size);
  model.parts = of_process(std::move(model.parts), process_of, processes);
  without_contacts(model.network);
  return model;
}

Model cut_up(const Case& one, const Processes& processes, const Monitor& monitor) {
  Model model = without_parts(one, monitor);
  if (one.made) one.made(model);
  if (!processes.alone()) without_contacts(model.network);
  model.parts = cut(model.problem, model.partition);
  if (model.problem.contacts() > 0) model.flexibility = mean_normal_delassus(model.problem);
  return model;
}

Model share_of(Model cut, const Processes& processes) {
  Model own = of_process(std::move(cut), processes);
  own.parts = with_matrices(std::move(own.parts), own.problem);
  return own;
}

Model build(const Case& one, const Monitor& monitor) { return share_of(cut_up(one, {}, monitor), {}); }

}  // namespace nscdd
