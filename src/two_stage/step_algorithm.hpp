// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/contact_solvers/friction_solver.hpp>

namespace nscdd {

/// Parts of the algorithms of a step. Options belong to a part (StepSolver::options): algorithms with it have them.
enum class StepPart : unsigned {
  iterations = 0,           ///< part of every algorithm
  sweeps = 1,               ///< nonlinear Gauss-Seidel, ended by a chosen criterion
  relaxation = 2,           ///< of the local changes of impulse
  subdomains = 4,           ///< into which a step is cut
  stage_two = 8,            ///< of Algorithm 1 of [ADI12]
  enriched_stage_two = 16,  ///< its preconditioner by the contact network
  cut_systems = 32,         ///< linear systems that are cut into subdomains, see CutContacts
  softer_network = 64,      ///< a network that preconditions them, softer than their contacts
  exchanges = 128,          ///< between subdomains after their sweeps: Algorithm 1 and Schwarz's method
  whole_copies = 256,       ///< of shared grains, see CopyMass
};
constexpr StepPart operator|(StepPart a, StepPart b) { return StepPart{unsigned(a) | unsigned(b)}; }

/// An algorithm by its place in `step_algorithms`.
enum class StepAlgorithm {
  nlgs,
  generic,
  enriched,
  schwarz,
  automatic,
  continuation,
  newton,
  admm,
  accelerated,
  two_stage_newton,
  two_stage_admm,
};

struct StepAlgorithmParts {
  std::string_view name;
  std::optional<FrictionAlgorithm> contact_solver;  ///< ended by its natural map; none for one that sweeps
  StepPart parts;
};

inline constexpr auto step_algorithms = [] {
  using enum StepPart;
  using enum FrictionAlgorithm;
  return std::to_array<StepAlgorithmParts>({
      {"nlgs", {}, sweeps | relaxation},
      {"generic", {}, sweeps | relaxation | subdomains | exchanges | stage_two},
      {"enriched", {}, sweeps | relaxation | subdomains | exchanges | stage_two | enriched_stage_two},
      {"schwarz", {}, sweeps | relaxation | subdomains | exchanges | whole_copies},
      {"auto", automatic, relaxation},
      {"continuation", continuation, iterations},
      {"newton", newton, relaxation},
      {"admm", admm, iterations},
      {"accelerated", accelerated, relaxation | subdomains},
      {"two_stage_newton", automatic, relaxation | subdomains | cut_systems | softer_network},
      {"two_stage_admm", admm, subdomains | cut_systems},
  });
}();

constexpr auto names_of(StepAlgorithm) {
  std::array<std::string_view, step_algorithms.size()> names;
  std::ranges::transform(step_algorithms, names.begin(), &StepAlgorithmParts::name);
  return names;
}

inline bool has_part(StepAlgorithm one, StepPart part) {
  const StepPart parts = step_algorithms[static_cast<std::size_t>(one)].parts;
  return (parts | part) == parts;
}

/// The algorithms that have a part, such as "nlgs, generic or enriched".
inline std::string algorithms_with(StepPart part) {
  return names_where<StepAlgorithm>([part](StepAlgorithm one) { return has_part(one, part); });
}

inline std::optional<FrictionAlgorithm> contact_solver_of(StepAlgorithm one) {
  return step_algorithms[static_cast<std::size_t>(one)].contact_solver;
}
inline bool is_contact_solver(StepAlgorithm one) { return contact_solver_of(one).has_value(); }

inline bool decomposes(StepAlgorithm one) { return has_part(one, StepPart::subdomains); }

}  // namespace nscdd
