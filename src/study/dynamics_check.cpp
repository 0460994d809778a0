// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/case.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

namespace nscdd {
namespace {

void check_criterion(const CaseSpec& spec) {
  const StepSolver& solver = spec.dynamics->solver;
  if (solver.criterion != Criterion::gluing) return;
  const auto refuse = [](std::string_view expected, std::string_view met) {
    throw Error("solver.criterion", fmt::format("expected {} with criterion gluing, met {}", expected, met));
  };
  if (solver.algorithm == StepAlgorithm::nlgs)
    refuse("solver.algorithm generic or enriched", "nlgs, which has no interface");
  if (solver.algorithm == StepAlgorithm::enriched && solver.enrichment == Enrichment::semi_implicit)
    refuse("another solver.enrichment", "semi_implicit, which does not iterate on the jumps");
}

}  // namespace

void check_dynamics(const CaseSpec& spec) {
  if (!spec.dynamics)
    throw Error(fmt::format("case {}: expected a section [dynamics], met a case that is not made to move", spec.name));
  subdomains(spec.partition);
  check_criterion(spec);
}

}  // namespace nscdd
