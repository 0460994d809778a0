// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/contact_solvers/friction_solver.hpp>

#include <algorithm>
#include <optional>

namespace nscdd {

/// The algorithms of a step and their parts. An option belongs to a part (see StepSolver::options), and so to the
/// algorithms that have this part.
namespace step_algorithms {

struct Iterations {};        ///< part of every algorithm
struct Relaxation {};        ///< of the local changes of impulse
struct Subdomains {};        ///< into which a step is cut
struct StageTwo {};          ///< of Algorithm 1 of [ADI12]
struct EnrichedStageTwo {};  ///< its preconditioner by the contact network
struct CutSystems {};        ///< linear systems that are cut into subdomains, see CutContacts
struct SofterNetwork {};     ///< a network that preconditions them, softer than their contacts

/// Nonlinear Gauss-Seidel, ended by a criterion of choice.
struct Sweeps {
  static constexpr std::optional<FrictionAlgorithm> contact_solver = {};
};

/// A solver of the contact problem of a step, ended by its natural map.
template <FrictionAlgorithm solver>
struct ContactSolver {
  static constexpr std::optional<FrictionAlgorithm> contact_solver = solver;
};

template <std::size_t size>
struct Name {
  constexpr Name(const char (&text)[size]) { std::ranges::copy(text, letters); }
  char letters[size] = {};
};

template <Name text, class Solver, class... Parts>
struct Algorithm {
  static constexpr std::string_view name = text.letters;
  static constexpr std::optional<FrictionAlgorithm> contact_solver = Solver::contact_solver;
  template <class Part>
  static constexpr bool has = std::is_same_v<Part, Iterations> || std::is_same_v<Part, Solver> ||
                              (std::is_same_v<Part, Parts> || ...);
};

using enum FrictionAlgorithm;
using Nlgs = Algorithm<"nlgs", Sweeps, Relaxation>;
using Generic = Algorithm<"generic", Sweeps, Relaxation, Subdomains, StageTwo>;
using Enriched = Algorithm<"enriched", Sweeps, Relaxation, Subdomains, StageTwo, EnrichedStageTwo>;
using Automatic = Algorithm<"auto", ContactSolver<automatic>, Relaxation>;
using Continuation = Algorithm<"continuation", ContactSolver<continuation>>;
using Newton = Algorithm<"newton", ContactSolver<newton>, Relaxation>;
using Admm = Algorithm<"admm", ContactSolver<admm>>;
using Apgd = Algorithm<"apgd", ContactSolver<apgd>>;
using TwoStageNewton =
    Algorithm<"two_stage_newton", ContactSolver<automatic>, Relaxation, Subdomains, CutSystems, SofterNetwork>;
using TwoStageAdmm = Algorithm<"two_stage_admm", ContactSolver<admm>, Subdomains, CutSystems>;

using Any =
    std::variant<Nlgs, Generic, Enriched, Automatic, Continuation, Newton, Admm, Apgd, TwoStageNewton, TwoStageAdmm>;

}  // namespace step_algorithms

/// An algorithm by its place in step_algorithms::Any.
enum class StepAlgorithm {};
constexpr auto names_of(StepAlgorithm) { return Alternatives<step_algorithms::Any>::names; }

template <class Algorithm>
constexpr StepAlgorithm step_algorithm{static_cast<int>(step_algorithms::Any(Algorithm()).index())};

template <class Visitor>
auto visit_algorithm(StepAlgorithm one, const Visitor& visitor) {
  return std::visit(visitor, Alternatives<step_algorithms::Any>::at(static_cast<std::size_t>(one)));
}

template <class Part>
bool has_part(StepAlgorithm one) {
  return visit_algorithm(one, []<class Algorithm>(const Algorithm&) { return Algorithm::template has<Part>; });
}

/// "nlgs, generic or enriched": the algorithms that have a part.
template <class Part>
std::string algorithms_with() {
  return names_where<StepAlgorithm>(has_part<Part>);
}

/// The contact solver that an algorithm is, if it is one.
inline std::optional<FrictionAlgorithm> contact_solver_of(StepAlgorithm one) {
  return visit_algorithm(one, [](const auto& algorithm) { return algorithm.contact_solver; });
}
inline bool is_contact_solver(StepAlgorithm one) { return contact_solver_of(one).has_value(); }

/// Whether an algorithm cuts a step into subdomains.
inline bool decomposes(StepAlgorithm one) { return has_part<step_algorithms::Subdomains>(one); }

}  // namespace nscdd
