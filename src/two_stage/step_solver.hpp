// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/local_preconditioner.hpp"
#include "mechanics/flexibility.hpp"
#include "two_stage/step_algorithm.hpp"

namespace nscdd {

/// Indicator that ends the iterations of a step (see IterationRecord and ContactResidual).
enum class Criterion {
  zeta,
  interface_change,
  gluing,
  natural_map,
  quad_dv,
  quad_dvr,
  mean_dv_over_r,
  qm_16,
  normal_change,
  none,
};
constexpr auto names_of(Criterion) {
  return std::to_array<std::string_view>({"zeta", "interface_change", "gluing", "natural_map", "quad_dv", "quad_dvr",
                                          "mean_dv_over_r", "qm_16", "normal_change", "none"});
}

enum class ContactOrder {
  natural,   ///< ascending by the grains
  reverse,   ///< descending
  random,    ///< a new permutation each step
  coloured,  ///< contacts of one colour share no free grain
  /// Along a space-filling curve, in blocks of 256 contacts, each coloured: the fastest. Neighbours in space are
  /// neighbours in memory, yet no contact waits for the one before.
  interleaved,
};
constexpr auto names_of(ContactOrder) {
  return std::to_array<std::string_view>({"natural", "reverse", "random", "coloured", "interleaved"});
}

enum class StageTwoNetwork {
  all,     ///< all considered
  active,  ///< those that carried an impulse in the last step
};
constexpr auto names_of(StageTwoNetwork) { return std::to_array<std::string_view>({"all", "active"}); }

/// In which iterations an enriched Stage 2 acts.
enum class Enrichment {
  every_iteration,
  first_iteration,
  semi_implicit,  ///< once, on the contacts that carried an impulse in the last step
};
constexpr auto names_of(Enrichment) {
  return std::to_array<std::string_view>({"every_iteration", "first_iteration", "semi_implicit"});
}

enum class InterfaceMethod { richardson, conjugate_gradient };
constexpr auto names_of(InterfaceMethod) {
  return std::to_array<std::string_view>({"richardson", "conjugate_gradient"});
}

/// Model of a subdomain once its statuses have stood still, see ModelSwitch.
enum class SwitchedModel {
  none,         ///< the contact law, everywhere
  linear,       ///< its network at frozen statuses
  homogenised,  ///< the same on a coarse mesh
};
constexpr auto names_of(SwitchedModel) { return std::to_array<std::string_view>({"none", "linear", "homogenised"}); }

/// The steps of which it is decided whether they have a solution.
enum class VerdictSteps {
  failed,  ///< those that broke down, and those that end unconverged with the signs of no room
  every,
  never,
};
constexpr auto names_of(VerdictSteps) { return std::to_array<std::string_view>({"failed", "every", "never"}); }

/// What a run does at a step that has no solution.
enum class IfImpossible { stop, go_on };
constexpr auto names_of(IfImpossible) { return std::to_array<std::string_view>({"stop", "go_on"}); }

/// The flexibility eta of an enriched Stage 2 in a case: a Flexibility > 0, or "optimal".
struct EtaChoice {
  static constexpr std::string_view expected =
      "\"optimal\", a number > 0 in 1/kg such as 0.5, or a multiple of the mean of W_nn such as \"30 W\"";

  EtaChoice() = default;
  EtaChoice(const char* text) : EtaChoice(std::string(text)) {}
  /// Throws Error naming `what` for any other text.
  EtaChoice(const std::string& text, std::string_view what = "eta") : optimal(text == "optimal") {
    if (!optimal) value = parse_flexibility(text, {.above = 0}, what, expected);
  }

  // Safe, see "Flexibilities relative to the packing" in docs/cases.md.
  Flexibility value{30, true};
  bool optimal = false;

  bool operator==(const EtaChoice&) const = default;
};

inline void parse_value(std::string_view text, EtaChoice& choice, std::string_view key) {
  choice = {std::string(text), key};
}
inline std::string field_text(const EtaChoice& choice) {
  return choice.optimal ? field_text(std::string("optimal")) : field_text(choice.value);
}
inline void check_bounds(const EtaChoice&, const Field&, std::string_view) {}

/// Solver of the contact problem of a step. A key means the same to all algorithms, and keeps its value if they change.
struct StepSolver {
  Choice<StepAlgorithm> algorithm = StepAlgorithm::automatic;
  Index gauss_seidel_sweeps = 1;  ///< n_GS
  Index maximum_iterations = 1000;
  Choice<Criterion> criterion = Criterion::natural_map;
  Index criterion_interval = 1;
  double tolerance = 1e-8;
  double gluing_tolerance = 0.01;
  Choice<ContactOrder> order = ContactOrder::interleaved;
  Index seed = 1;
  double contact_relaxation = 1;
  bool warm_start = true;
  EtaChoice eta = {};  ///< 1/kg
  Choice<StageTwoNetwork> network = StageTwoNetwork::all;
  Choice<Enrichment> enrichment = Enrichment::every_iteration;
  Choice<InterfaceMethod> interface_method = InterfaceMethod::richardson;
  double interface_relaxation = 1;  ///< omega
  Choice<InterfacePreconditioner> interface_preconditioner = InterfacePreconditioner::active;
  double interface_flexibility = 10;  ///< c, eta / alpha
  Choice<Scaling> interface_scaling = Scaling::deluxe;
  Choice<CoarseSpace> coarse_space = CoarseSpace::none;
  double coarse_kappa = 30;
  Index redecompose = 1;
  Choice<SwitchedModel> model = SwitchedModel::none;  ///< key `switch`
  Index switch_after = 100;                           ///< k
  Flexibility switch_flexibility{1e-6, true};         ///< alpha, 1/kg
  Components<Index> switch_cells{2, 2};               ///< of a homogenised subdomain
  Choice<VerdictSteps> verdict = VerdictSteps::failed;
  Choice<IfImpossible> impossible = IfImpossible::stop;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    options(self, [&](auto, std::string_view key, auto& value, const Field& field) { visit(key, value, field); });
  }

  /// The fields, each with the part of an algorithm that it belongs to.
  template <class Self, class Visitor>
  static void options(Self& self, Visitor&& visit) {
    using enum StepPart;
    visit(iterations, "algorithm", self.algorithm, Field{.description = "solver of a step"});
    visit(sweeps, "gauss_seidel_sweeps", self.gauss_seidel_sweeps,
          Field{.description = "sweeps per iteration and subdomain", .minimum = 1, .maximum = 1e9});
    visit(iterations, "maximum_iterations", self.maximum_iterations,
          Field{.description = "largest number of iterations of a step", .minimum = 1, .maximum = 1e9});
    visit(sweeps, "criterion", self.criterion, Field{.description = "indicator that ends the iterations"});
    visit(sweeps, "criterion_interval", self.criterion_interval,
          Field{.description = "iterations between two checks of the criterion", .minimum = 1, .maximum = 1e9});
    visit(iterations, "tolerance", self.tolerance,
          Field{.description = "tolerance on the indicator", .minimum = 0, .maximum = 1});
    visit(exchanges, "gluing_tolerance", self.gluing_tolerance,
          Field{.description = "largest jump at the interface of a converged step, relative to the speeds of "
                               "its grains (not required of the semi-implicit scheme)",
                .minimum = 0});
    visit(sweeps, "order", self.order, Field{.description = "order of a sweep"});
    visit(sweeps, "seed", self.seed, Field{.description = "seed of order random", .minimum = 0});
    visit(relaxation, "contact_relaxation", self.contact_relaxation,
          Field{.description = "relaxation of each local change of impulse", .above = 0, .maximum = 1.99});
    visit(iterations, "warm_start", self.warm_start,
          Field{.description = "start from the impulses of the last step, not from zero"});
    visit(enriched_stage_two, "eta", self.eta,
          Field{.description = "flexibility of the enriched Stage 2: a number, a multiple of W, or optimal",
                .unit = "1/kg"});
    visit(enriched_stage_two, "network", self.network,
          Field{.description = "contacts of Stage 2: all considered, or those that carried an impulse in the "
                               "last step"});
    visit(enriched_stage_two, "enrichment", self.enrichment,
          Field{.description = "iterations in which the enriched Stage 2 acts; the semi-implicit scheme: once, on the "
                               "contacts that carried an impulse in the last step"});
    visit(stage_two, "interface_method", self.interface_method, Field{.description = "how Stage 2 uses its operator"});
    visit(exchanges, "interface_relaxation", self.interface_relaxation,
          Field{.description = "relaxation omega of Stage 2, or of the resultants that Schwarz's method exchanges",
                .above = 0,
                .maximum = 1000});
    visit(cut_systems, "interface_preconditioner", self.interface_preconditioner,
          Field{.description = "preconditioner of the interface of the two-stage Newton method and ADMM"});
    visit(softer_network, "interface_flexibility", self.interface_flexibility,
          Field{.description = "c: flexibility of the preconditioning contacts, relative to that of the contacts in "
                               "the linear systems",
                .above = 0,
                .maximum = 1e6});
    visit(cut_systems, "interface_scaling", self.interface_scaling,
          Field{.description = "weights of the copies of shared grains in this preconditioner"});
    visit(cut_systems, "coarse_space", self.coarse_space,
          Field{.description = "vectors that a coarse problem solves exactly in this preconditioner"});
    visit(cut_systems, "coarse_kappa", self.coarse_kappa,
          Field{.description = "condition number that the vectors of geneo shall keep", .above = 1});
    visit(subdomains, "redecompose", self.redecompose,
          Field{.description = "steps between two decompositions", .minimum = 1, .maximum = 1e9});
    visit(stage_two, "switch", self.model, Field{.description = "model of a subdomain once its statuses stand still"});
    visit(stage_two, "switch_after", self.switch_after,
          Field{.description = "iterations for which the statuses of a subdomain stand still before it is switched; "
                               "with warm_start they are counted over steps",
                .minimum = 1,
                .maximum = 1e9});
    visit(stage_two, "switch_flexibility", self.switch_flexibility,
          Field{.description = "flexibility of the contacts of a switched subdomain: a number, or a multiple of W",
                .unit = "1/kg",
                .above = 0});
    visit(stage_two, "switch_cells", self.switch_cells,
          Field{.description = "cells of the coarse mesh over a homogenised subdomain", .minimum = 1, .maximum = 1000});
    visit(iterations, "verdict", self.verdict,
          Field{.description = "steps of which it is decided whether they have a solution; failed: those that broke "
                               "down or that end unconverged where boundaries may leave no room"});
    visit(iterations, "impossible", self.impossible,
          Field{.description = "what a run does at a step that has no solution"});
  }
};

/// Whether Stage 2 acts once, without iterations on the jumps at the interface.
inline bool semi_implicit(const StepSolver& solver) {
  return has_part(solver.algorithm, StepPart::enriched_stage_two) && solver.enrichment == Enrichment::semi_implicit;
}

}  // namespace nscdd
