// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/dynamics.hpp"

#include "core/fail.hpp"

namespace nscdd {
namespace {

// A parameter has an effect only if the one `with` has an expected value.
struct Need {
  std::string path, with, expected, found;
  bool met;
};

template <Named Enum, class Predicate>
Need need(std::string path, std::string with, Choice<Enum> now, const Predicate& right) {
  return {std::move(path), std::move(with), names_where<Enum>(right), std::string(to_string(now)), right(now)};
}

void add_needs(std::vector<Need>& needs, const StepSolver& solver) {
  const bool sweeps = has_part(solver.algorithm, StepPart::sweeps);
  StepSolver::options(solver, [&](StepPart part, std::string_view key, const auto&, const Field&) {
    needs.push_back(need(fmt::format("solver.{}", key), "solver.algorithm", solver.algorithm,
                         [part](StepAlgorithm one) { return has_part(one, part); }));
    if (key == "criterion" && !sweeps) needs.back().met = solver.criterion == Criterion::natural_map;  // its own
  });
  const auto add = [&](const char* path, const char* with, auto now, const auto& right) {
    needs.push_back(need(path, with, now, right));
  };
  const auto is = [](auto... values) { return [=](auto now) { return ((now == values) || ...); }; };
  const auto is_not = [](auto value) { return [value](auto now) { return now != value; }; };
  const auto add_for_preconditioner = [&](const char* path, const auto& right) {
    add(path, "solver.interface_preconditioner", solver.interface_preconditioner, right);
  };
  for (const char* path : {"solver.tolerance", "solver.gluing_tolerance"})
    if (sweeps) add(path, "solver.criterion", solver.criterion, is_not(Criterion::none));
  add("solver.seed", "solver.order", solver.order, is(ContactOrder::random));
  add("solver.network", "solver.enrichment", solver.enrichment, is_not(Enrichment::semi_implicit));
  for (const char* path : {"solver.interface_relaxation", "solver.switch"})
    add(path, "solver.interface_method", solver.interface_method, is(InterfaceMethod::richardson));
  using enum InterfacePreconditioner;
  add_for_preconditioner("solver.interface_flexibility", is(network, active));
  add_for_preconditioner("solver.interface_scaling", is(lumped, dirichlet, bddc));
  add_for_preconditioner("solver.coarse_space", is(dirichlet, bddc));
  add("solver.coarse_kappa", "solver.coarse_space", solver.coarse_space, is(CoarseSpace::geneo));
  add("solver.impossible", "solver.verdict", solver.verdict, is_not(VerdictSteps::never));
  for (const char* path : {"solver.switch_after", "solver.switch_flexibility"})
    add(path, "solver.switch", solver.model, is_not(SwitchedModel::none));
  add("solver.switch_cells", "solver.switch", solver.model, is(SwitchedModel::homogenised));
}

void add_needs(std::vector<Need>& needs, const Interaction& interaction, double penetration_correction) {
  const auto add_law = [&](const char* path, const auto& right) {
    needs.push_back(need(path, "interaction.law", interaction.law, [&](LawName law) {
      return std::visit(right, Alternatives<ContactLaw>::at(static_cast<std::size_t>(law)));
    }));
  };
  for (const char* path : {"interaction.friction", "interaction.boundary_friction", "interaction.static_friction"})
    add_law(path, [](const auto& law) { return law.opens && law.rubs; });
  for (const char* path : {"interaction.cohesion", "interaction.cohesion_range"})
    add_law(path, [](const auto& law) { return law.pulls; });
  add_law("interaction.epsilon", [](const auto& law) { return !law.opens; });
  add_law("interaction.tangential_restitution", [](const auto& law) { return law.rubs; });
  for (const char* path : {"solver.switch", "solver.verdict", "solver.impossible"})
    add_law(path, [](const auto& law) { return law.opens; });

  const auto add = [&](const char* path, const char* with, const char* expected, double now, bool met) {
    needs.push_back({path, with, expected, field_text(now == 0 ? 0.0 : now), met});
  };
  for (const char* path : {"dynamics.penetration_correction", "dynamics.maximum_push_speed"}) {
    add(path, "interaction.restitution", "0", interaction.restitution, interaction.restitution == 0);
    needs.push_back(need(path, "interaction.signorini", interaction.signorini,
                         [](Signorini condition) { return condition == Signorini::gap; }));
  }
  add("dynamics.maximum_push_speed", "dynamics.penetration_correction", "> 0", penetration_correction,
      penetration_correction != 0);
}

// The first need of a parameter that is not met.
std::optional<Need> missing_for(const Dynamics& dynamics, std::string_view path) {
  std::vector<Need> needs;
  add_needs(needs, dynamics.solver);
  add_needs(needs, dynamics.interaction, dynamics.time.penetration_correction);
  for (const Need& one : needs)
    if (one.path == path && !one.met) return one;
  return std::nullopt;
}

// Defaults of parameters without effect, so that equal runs have equal texts.
template <class Parameters>
std::string effective_lines(const Dynamics& dynamics, std::string_view section, const Parameters& parameters) {
  const std::vector<FieldDescription> now = describe_fields(parameters), by_default = describe_fields(Parameters{});
  std::string lines;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const bool effective = has_effect(dynamics, fmt::format("{}.{}", section, now[k].key));
    if (now[k].key.starts_with("switch") && !switches_models(dynamics)) continue;  // as if there were none
    lines += fmt::format("{} = {}\n", now[k].key, effective ? now[k].value : by_default[k].value);
  }
  return lines;
}

// Half the length along x or y, m, that a plank or cylinder must find room for in a cell; 0 if it lies along that
// direction, since its images then make one, however long it is.
double half_length_along(const Wall& wall, std::size_t k) {
  constexpr double rounding = 1e-6;  // of directions, whose numbers may have seven digits
  const double radius = std::abs(wall.radius);
  const double along = std::abs(wall.plank() ? wall.axis[k] : wall.normal[k]);
  const double across = wall.plank() ? std::abs(cross(wall.normal, wall.axis)[k]) : 0;
  if (std::max(along, across) > 1 - rounding) return 0;
  if (wall.plank()) return along * wall.half_length + across * wall.half_width + radius;
  if (!wall.has_ends() && along > rounding) return infinity;
  return along * wall.half_length + std::sqrt(1 - along * along) * radius;
}

bool may_turn(const Boundary& boundary) {
  return turns(boundary.motion) || (boundary.body && boundary.body->free(BodyDirection::spin));
}

// Of a plank or cylinder grains see only the nearest image.
void check_length(const GranularSystem& system, const Wall& wall) {
  if (wall.radius == 0) return;
  const Boundary& boundary = system.boundaries[at(wall.boundary)];
  const double all_around = std::hypot(wall.half_length, wall.half_width) + std::abs(wall.radius);
  const std::array periods{system.period.x, system.period.y};
  for (std::size_t k = 0; k < 2; ++k) {
    const double length = 2 * (may_turn(boundary) && wall.half_length > 0 ? all_around : half_length_along(wall, k));
    if (periods[k] > 0 && length > periods[k])
      fail(
          "boundary '{}': expected a {} that is shorter than the periodic cell along {}, met one of {} m in a cell of "
          "{} m",
          boundary.name, wall.plank() ? "plank" : "cylinder", k == 0 ? "x" : "y", length, periods[k]);
  }
}

}  // namespace

GranularScene scene(const Packing& packing, const Dynamics& dynamics, const Period& period) {
  if (packing.mass.empty()) throw Error("dynamics: expected grains with masses, met a packing without");
  GranularScene result;
  GranularSystem& system = result.system;
  system.dimension = packing.dimension();
  system.period = period;
  system.radius = packing.radius;
  system.mass = packing.mass;
  system.driven_by.assign(packing.radius.size(), -1);
  std::vector<double> x = packing.x, y = packing.y;
  for (Index number = 0; const BoundarySpec& spec : dynamics.boundaries)
    add_boundary(system, x, y, spec, number++, packing.size());
  // Disks of boundaries may have doubled the capacity.
  for (std::vector<double>* values : {&system.radius, &system.mass, &x, &y}) values->shrink_to_fit();
  system.driven_by.shrink_to_fit();
  number_bodies(system);
  result.state = initial_state(system, std::move(x), std::move(y), packing.z);
  for (Index i = 0; i < system.grains(); ++i)  // the image of a grain that is nearest to the centre of its body
    if (const Index k = system.driven_by[at(i)]; k >= 0 && system.period.any() && system.boundaries[at(k)].body) {
      const Place& centre = system.boundaries[at(k)].motion.centre;
      const Place place = moved_along(centre, 1, system.apart(centre, centre_of(result.state, at(i))));
      result.state.x[at(i)] = place[0];
      result.state.y[at(i)] = place[1];
    }
  complete(system, result.state, dynamics, packing.size());
  for (const Index k : system.free_bodies) {
    const Boundary& boundary = system.boundaries[at(k)];
    take_free(*boundary.body, boundary.motion.initial.value_or(RigidVelocity{}), result.state.body_velocities[at(k)]);
  }
  release_grains(system, result.state);
  check(system, result.state);
  return result;
}

void complete(GranularSystem& system, const GranularState& first, const Dynamics& dynamics, Index grains) {
  number_bodies(system);
  for (const Wall& wall : system.walls) check_length(system, wall);
  for (Index i = 0; i < system.grains(); ++i) {
    const Index k = system.driven_by[at(i)];
    if (k < 0 || !system.boundaries[at(k)].body) continue;
    double& reach = system.boundaries[at(k)].body->reach;
    const Place arm = difference(centre_of(first, at(i)), first.poses[at(k)].place());
    reach = std::max(reach, system.length(arm) + system.radius[at(i)]);
    // A body that does not turn may be as long as the cell and longer: any image of each of its grains will do.
    for (const double length : {system.period.x, system.period.y})
      if (length > 0 && 2 * reach > length && may_turn(system.boundaries[at(k)]))
        fail(
            "boundary '{}': expected a body that turns to be shorter than the periodic cell, met grains as far as {} m "
            "from its centre, in a cell of {} m",
            system.boundaries[at(k)].name, reach, length);
  }
  if (dynamics.interaction.on_velocity() && dynamics.interaction.cohesion_range > 0)
    throw Error("interaction.cohesion_range",
                "expected the condition on the gap with a range above 0, met that on the velocity, by which bodies in "
                "range would stop apart");
  for (std::size_t k = 0; k < dynamics.pairs.size(); ++k)
    if (dynamics.pairs[k].rule.restitution && !dynamics.interaction.on_velocity())
      throw Error(fmt::format("pair[{}].restitution", k),
                  "expected interaction.signorini = \"velocity\" with it, met \"gap\"");
  for (std::size_t k = 0; k < dynamics.pairs.size(); ++k)
    if (dynamics.pairs[k].rule.bond && to_string(dynamics.interaction.law) != Cohesive::name)
      throw Error(fmt::format("pair[{}].bond", k),
                  fmt::format("expected interaction.law = \"{}\" with it, whose cohesion may be 0, met \"{}\"",
                              Cohesive::name, to_string(dynamics.interaction.law)));
  std::vector<std::string> colours;
  for (const BoundarySpec& spec : dynamics.boundaries)
    if (!spec.part) colours.push_back(spec.colour);
  set_pairs(system, dynamics.colours, dynamics.pairs, colours, grains);
}

void check(const StepSolver& solver) {
  const auto refuse = [](const char* key, std::string_view expected, std::string_view met) {
    throw Error(fmt::format("solver.{}", key), fmt::format("expected {}, met {}", expected, met));
  };
  if (is_contact_solver(solver.algorithm) && solver.tolerance == 0)
    refuse("tolerance", fmt::format("a number > 0 with solver.algorithm {}", to_string(solver.algorithm)), "0");
  if (solver.algorithm == StepAlgorithm::two_stage_newton &&
      solver.interface_preconditioner == InterfacePreconditioner::bddc)
    refuse("interface_preconditioner", "another one with two_stage_newton, whose systems are not symmetric", "bddc");
  if (solver.interface_preconditioner == InterfacePreconditioner::bddc && solver.coarse_space == CoarseSpace::rigid)
    refuse("coarse_space", "none or geneo with solver.interface_preconditioner bddc", "rigid");
  if (solver.criterion != Criterion::gluing) return;
  if (!has_part(solver.algorithm, StepPart::exchanges))
    refuse("criterion", fmt::format("solver.algorithm {} with criterion gluing", algorithms_with(StepPart::exchanges)),
           fmt::format("{}, which has no interface", to_string(solver.algorithm)));
  if (semi_implicit(solver))
    refuse("criterion", "another solver.enrichment with criterion gluing",
           "semi_implicit, which does not iterate on the jumps");
}

bool has_effect(const Dynamics& dynamics, std::string_view path) { return !missing_for(dynamics, path); }

void require_effect(const Dynamics& dynamics, std::string_view path, std::string_view where, bool algorithm_stated) {
  if (const auto missing = missing_for(dynamics, path))
    fail("{}: expected {} {} with it, met {}{}", where, missing->with, missing->expected, missing->found,
         missing->with == "solver.algorithm" && !algorithm_stated ? ", the default" : "");
}

bool switches_models(const Dynamics& dynamics) {
  return dynamics.solver.model != SwitchedModel::none && has_effect(dynamics, "solver.switch");
}

std::string to_toml(const Dynamics& dynamics) {
  std::string text = "\n[interaction]\n" + effective_lines(dynamics, "interaction", dynamics.interaction);
  text += "\n[dynamics]\n" + effective_lines(dynamics, "dynamics", dynamics.time);
  text += "\n[solver]\n" + effective_lines(dynamics, "solver", dynamics.solver);
  for (const BoundarySpec& spec : dynamics.boundaries) text += "\n[[boundary]]\n" + to_toml(spec);
  for (const ColourSpec& spec : dynamics.colours) text += "\n[[colour]]\n" + to_toml(spec);
  for (const PairSpec& spec : dynamics.pairs) text += "\n[[pair]]\n" + to_toml(spec);
  return text;
}

}  // namespace nscdd
