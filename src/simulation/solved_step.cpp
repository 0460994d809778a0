// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/solved_step.hpp"

#include <fmt/ranges.h>

#include <set>

namespace nscdd {
namespace {

constexpr double energy_explosion = 10;
constexpr double large_impulses = 10;  // over what drives the step
constexpr double large_work = 10;      // over the energies of motion
constexpr double closing_part = 0.1;   // of the work of boundaries and pushes

// Energies of a step, J, of all ranks: they show whether it went wrong.
struct StepRoom {
  double motion = 0;  // of all free grains: before, in free flight, at the speed of the fastest body or push, pulled
  double in_the_end = 0;  // of all free grains
  double lifting = 0;     // to lift all free grains as far as the fastest body or push moves
  double pushes = 0;      // upper bound of the work of pushes of overlaps
  double boundaries = 0;  // work of boundaries
  double closing = 0;     // sum of r_n max(0, -u_n), with u_n that of the law: 0 in a solution
};

// `pushes`, `closing`: of all contacts.
template <int D>
StepRoom room_of(const Simulation& before, const GranularStep<D>& step, double pushes, double closing) {
  const TimeStepping& scheme = before.dynamics.time;
  const StepStart start = start_of(before);
  const auto motions = step_motions(start), first = first_motions(start);
  const auto poses = poses_at_contacts(start);
  double mass = 0, at_first = 0, free_flight = 0, in_the_end = 0;
  double speed_squared = 0;  // of the fastest driven body or push
  for (Index i = 0; i < before.system.bodies(); ++i) {
    if (i < before.system.grains() && before.system.node_of(i) != i) continue;  // a grain of a free body
    const GrainMotion motion = free_motion(start, poses, motions, i);
    const GrainVelocity<D> free = with_motion<D>(motion, before.system.inverse_mass(i));
    if (free.inverse_mass == 0) {
      speed_squared = std::max(speed_squared, squared_velocity(free) + squared_rim(free));
      continue;
    }
    const auto kinetic = [&](const GrainMotion& v) { return kinetic_energy(with_motion<D>(v, free.inverse_mass)); };
    mass += 1 / free.inverse_mass;
    at_first += kinetic(start_motion(start, poses, first, i));
    free_flight += kinetic(motion);
    in_the_end += kinetic(step.all_grains[at(i)]);
  }
  for (const GrainVelocity<D>& v : step.problem.free)
    if (v.inverse_mass == 0) speed_squared = std::max(speed_squared, squared_velocity(v) + squared_rim(v));
  const double pull = std::visit([](const auto& law) { return law.pull(); }, step.problem.law);  // not that of bonds
  std::vector<double> by_pulls(step.problem.free.size());  // roots of the energies that those of a body can add up to
  for (const GrainContact<D>& c : step.contacts) {
    GrainVelocity<D> a{.inverse_mass = c.inverse_mass_a}, b{.inverse_mass = c.inverse_mass_b};
    if (pull > 0 && c.pull == pull) apply_impulse<D>(c.normal, c.levers.get(), LocalVector<D>{pull}, a, b);
    if (a.inverse_mass > 0) by_pulls[at(c.a)] += std::sqrt(kinetic_energy(a));
    if (b.inverse_mass > 0) by_pulls[at(c.b)] += std::sqrt(kinetic_energy(b));
    // A positive normal bias is the gap over h of a contact that hovers, and pushes nothing.
    const LocalVector<D> push{std::min(c.bias.n, 0.0), c.bias.t};
    speed_squared = std::max(speed_squared, squared(push));
    if (c.levers) speed_squared = std::max(speed_squared, squared(driven_part(c, step.problem.free)));
  }
  double pulled = 0;
  for (const double root : by_pulls) pulled += static_cast<double>(before.processes.size) * root * root;
  speed_squared = before.processes.maximum(speed_squared);
  const Place gravity = gravity_of(scheme, D);
  const double weight = mass * std::sqrt(dot(gravity, gravity));
  return {.motion = at_first + free_flight + mass * speed_squared / 2 + before.processes.sum(pulled),
          .in_the_end = in_the_end,
          .lifting = weight * scheme.step * std::sqrt(speed_squared),
          .pushes = pushes,
          .boundaries = step.work.boundary,
          .closing = closing};
}

// Contacts dissipate. Energy comes only from driven bodies, which pass on at most twice their speed, and from pushes:
// an overlap does the work r_n times the speed at which it is pushed apart. (Speeds of pushes add up along a chain of
// overlaps, but so do the impulses.) A step that ends with many times the energy of all these has diverged.
bool energy_exploded(const StepRoom& room) {
  const double reference = room.motion + room.pushes;
  return reference > 0 && room.in_the_end > energy_explosion * reference;
}

// Whether boundaries or pushes seem to leave no room. If no impulses keep all contacts from closing, solvers raise
// impulses that balance each other. Three signs together: these impulses are much larger than what drives the step,
// their work is much larger than all energies of motion, and a good part of it is that of contacts that still close.
bool no_room(const StepRoom& room, const ContactResidual& residual) {
  const double work = std::max(0.0, room.boundaries) + room.pushes;
  return std::sqrt(residual.impulses) > large_impulses * residual.scale.driving() &&
         room.closing > closing_part * work && work > large_work * (room.motion + room.lifting);
}

// The contacts of a step to be remembered, ascending by (a, b). Each rank keeps those of its own subdomains and all
// contacts of shared grains, so that it knows every contact of its own grains.
template <int D>
std::vector<RememberedSubdomain> subdomains_to_remember(const GranularStep<D>& step, const GranularSystem& system,
                                                        const Processes& processes) {
  std::vector<RememberedSubdomain> known = subdomains_to_remember(step.problem.geometry, step.partition);
  if (processes.alone()) return known;
  std::set<Index> own;
  std::vector<RememberedSubdomain> given;
  const auto is_shared = [&](Index body) {
    return std::ranges::binary_search(step.shared_grains, system.node_of(body));
  };
  for (const RememberedSubdomain& one : known) {
    own.insert(one.subdomain);
    if (is_shared(one.a) || is_shared(one.b)) given.push_back(one);
  }
  given = processes.gather(given);
  std::ranges::copy_if(given, std::back_inserter(known),
                       [&](const RememberedSubdomain& one) { return !own.contains(one.subdomain); });
  std::ranges::sort(known, {}, body_pair);
  return known;
}

// The bonds of a step, on all ranks.
template <int D>
std::vector<RememberedBond> bonds_to_remember(const GranularStep<D>& step, const Simulation& simulation) {
  std::vector<RememberedBond> bonds;
  if (!simulation.system.pairs.bonds()) return bonds;
  const double alert = alert_distance(simulation.system, simulation.dynamics.time);
  for (const StepContact& c : step.problem.geometry)
    if (const auto bond = bond_of(start_of(simulation), c, alert)) bonds.push_back(*bond);
  if (!simulation.processes.alone()) bonds = simulation.processes.gather(bonds);
  std::ranges::sort(bonds, {}, body_pair);
  return bonds;
}

// The velocities of all grains and free bodies at the end of a step; each rank computes those of its own contacts.
template <int D>
std::vector<GrainMotion> velocities_of_grains(const Simulation& before, const GranularStep<D>& step) {
  const GranularSystem& system = before.system;
  const StepStart start = start_of(before);
  const auto motions = step_motions(start);
  const auto poses = poses_at_contacts(start);
  std::vector<GrainMotion> result;
  result.reserve(at(system.bodies()));
  for (Index i = 0; i < system.bodies(); ++i) result.push_back(free_motion(start, poses, motions, i));
  struct Moved {
    Index grain;
    GrainMotion velocity;
  };
  std::vector<Moved> own;
  for (std::size_t body = 0; body < step.velocities.size(); ++body)
    if (step.velocities[body].inverse_mass != 0)
      own.push_back({step.problem.numbers[body], motion_of(step.velocities[body])});
  before.processes.exchange(own, [&](std::span<const Moved> given) {
    for (const Moved& one : given) result[at(one.grain)] = one.velocity;
  });
  if (system.free_bodies.empty()) return result;
  const auto solved = with_free_bodies(start, motions, result);
  for (Index i = 0; i < system.grains(); ++i)
    if (!system.free(i)) result[at(i)] = start_motion(start, poses, solved, i);
  return result;
}

bool finite(const GrainMotion& v) {
  return std::ranges::all_of(v, [](double one) { return std::isfinite(one); });
}

// The text of the rank with the largest merit, or of equal ones with the lowest pair of bodies (a, b). A rank without a
// text has the merit -infinity. Empty if all have none.
std::optional<std::string> words_of_first(const Processes& all, double merit, const StepContact& contact,
                                          const std::string& words) {
  struct Claim {
    double merit;
    Index a, b;
  };
  const std::vector<Claim> claims = all.gather_each(Claim{merit, contact.a, contact.b});
  const auto first =
      std::ranges::min_element(claims, {}, [](const Claim& one) { return std::tuple(-one.merit, one.a, one.b); });
  if (first->merit == -infinity) return std::nullopt;
  const std::vector<char> text = all.gather(first - claims.begin() == all.rank ? words : std::string());
  return std::string(text.begin(), text.end());
}

}  // namespace

template <int D>
void finish_solution(GranularStep<D>& step, const Simulation& before) {
  const Processes& all = before.processes;
  StepReport& report = step.report;
  step.all_grains = velocities_of_grains(before, step);
  report.overlap = {};
  const Vector sums = sums_over_contacts(step.partition, 6, all, [&](Index k, auto&& sum) {
    const GrainContact<D>& c = step.contacts[at(k)];
    const StepContact& geometry = step.problem.geometry[at(k)];
    const double overlap = std::max(0.0, -geometry.gap);
    const ContactWork work = work_of(step.problem, c, step.velocities);
    sum[0] += work.boundary;
    sum[1] += work.dissipation;
    sum[2] += c.impulse.n * std::max(0.0, -c.bias.n);
    sum[3] += overlap;
    sum[4] += geometry.gap < 0;
    sum[5] += c.impulse.n * std::max(0.0, -relative_velocity<D>(c, step.velocities).n - c.bias.n);
    report.overlap.maximum = std::max(report.overlap.maximum, overlap);
    report.overlap.relative =
        std::max(report.overlap.relative, overlap / before.system.smaller_radius(geometry.a, geometry.b));
  });
  step.work = {sums[0], sums[1]};
  report.overlap = {.maximum = all.maximum(report.overlap.maximum),
                    .mean = sums[3] / std::max(1.0, sums[4]),
                    .relative = all.maximum(report.overlap.relative)};
  // A law opens a contact whose velocity is not finite, and the indicators do not see it.
  if (!std::ranges::all_of(step.all_grains, finite)) report.status = SolverStatus::no_number;
  const StepRoom room = room_of(before, step, sums[2], sums[5]);
  step.energy_exploded = report.status != SolverStatus::no_number && energy_exploded(room);
  if (step.energy_exploded) report.status = SolverStatus::diverged;
  report.no_room = no_room(room, report.residual);
  report.step = before.state.step + 1;
}

template <int D>
std::string describe_breakdown(const Simulation& before, const GranularStep<D>& step) {
  const Processes& all = before.processes;
  const auto place = [](const auto& point) { return fmt::format("({:.6g}) m", fmt::join(point, ", ")); };
  const auto name = [&](const StepContact& c) {
    return fmt::format("contact of {} and {} at {}", body_name(before.system, c.a), body_name(before.system, c.b),
                       place(std::span(c.point).first(D)));
  };
  const auto impulse = [](const GrainContact<D>& c) { return std::hypot(c.impulse.n, norm(c.impulse.t)); };
  // The words about a contact, which may be that of another rank.
  const auto said = [&](auto contact, double merit, const std::string& what) {
    if (contact == step.contacts.end()) return words_of_first(all, -infinity, {}, "");
    const StepContact& c = step.problem.geometry[at(contact - step.contacts.begin())];
    return words_of_first(all, merit, c, name(c) + what);
  };
  const auto wrong = std::ranges::find_if_not(
      step.contacts, [](double size) { return std::isfinite(size); }, impulse);
  if (const auto words = said(wrong, 1, ": the impulse is not finite")) return *words;
  for (std::size_t i = 0; i < step.all_grains.size(); ++i) {
    if (finite(step.all_grains[i])) continue;
    if (static_cast<Index>(i) >= before.system.grains())
      return fmt::format("boundary '{}': the velocity is not finite", before.system.body(static_cast<Index>(i)).name);
    const Place centre = centre_of(before.state, i);
    return fmt::format("{} at {}: the velocity is not finite", body_name(before.system, static_cast<Index>(i)),
                       place(std::span(centre).first(D)));
  }
  const auto largest = std::ranges::max_element(step.contacts, {}, impulse);
  const double size = largest == step.contacts.end() ? -infinity : impulse(*largest);
  return said(largest, size, fmt::format(": largest impulse, {:.6g} N s", size)).value_or("no contact");
}

template <int D>
StepReport take_step(Simulation& simulation, const GranularStep<D>& step) {
  StepReport report = step.report;
  GranularState& state = simulation.state;
  check_end_of_step(start_of(simulation), step.all_grains);
  report.energy = finish_step(start_of(simulation), state, step.all_grains, step.work);
  release_grains(simulation.system, state);
  state.bonds = bonds_to_remember(step, simulation);
  state.impulses = impulses_to_remember(step.problem, step.contacts);
  if (decomposes_afresh(simulation, report.step - 1)) {
    state.decomposed_at = report.step - 1;
    state.eta = std::isnan(report.eta) ? 0 : report.eta;
  }
  state.gluing = step.gluing;
  state.models = step.models;
  state.process_of_subdomain = step.process_of_subdomain;
  state.subdomains = subdomains_to_remember(step, simulation.system, simulation.processes);
  report.time = state.time;
  return report;
}

template void finish_solution(GranularStep<2>&, const Simulation&);
template void finish_solution(GranularStep<3>&, const Simulation&);
template std::string describe_breakdown(const Simulation&, const GranularStep<2>&);
template std::string describe_breakdown(const Simulation&, const GranularStep<3>&);
template StepReport take_step(Simulation&, const GranularStep<2>&);
template StepReport take_step(Simulation&, const GranularStep<3>&);

}  // namespace nscdd
