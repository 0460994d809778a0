// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/study/case.hpp>

#include <fmt/format.h>

#include <cmath>

namespace nscdd {
namespace {

void check_criterion(const Case& one) {
  const StepSolver& solver = one.dynamics->solver;
  if (solver.criterion != "gluing") return;
  const auto refuse = [](std::string_view expected, std::string_view met) {
    throw Error(fmt::format("solver.criterion: expected {} with criterion gluing, met {}", expected, met));
  };
  if (solver.algorithm == "nlgs")
    refuse("solver.algorithm generic or enriched", "nlgs, which has no interface");
  if (subdomains(one.partition) == 1) refuse("two subdomains or more", "one, which has no interface");
  if (solver.algorithm == "enriched" && solver.enrichment == "semi_implicit")
    refuse("another solver.enrichment", "semi_implicit, which does not iterate on the jumps");
}

}  // namespace

void check(const BoundarySpec& spec) {
  if (spec.shape == BoundaryShape::grains) return;
  const double length = std::hypot(spec.to[0] - spec.from[0], spec.to[1] - spec.from[1]);
  if (!(length > 0) || !std::isfinite(length))
    throw Error(fmt::format("boundary '{}': from, to: expected distinct ends, met ({}, {}) and ({}, {})",
                            spec.name, spec.from[0], spec.from[1], spec.to[0], spec.to[1]));
  if (spec.shape == BoundaryShape::wall) return;
  if (!(spec.radius > 0))
    throw Error(
        fmt::format("boundary '{}': radius: expected one > 0 of its disks, met {}", spec.name, spec.radius));
  constexpr double most = 1e7;
  if (!(length / spec.distance() < most))
    throw Error(fmt::format("boundary '{}': spacing: expected at most {} disks, met {} m in steps of {} m",
                            spec.name, most, length, spec.distance()));
}

void check_dynamics(const Case& one) {
  if (!one.dynamics)
    throw Error(
        fmt::format("case {}: expected a section [dynamics], met a case that is not made to move", one.name));
  subdomains(one.partition);
  check_criterion(one);
}

}  // namespace nscdd
