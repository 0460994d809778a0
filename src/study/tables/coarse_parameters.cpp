// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tables/coarse_parameters.hpp"

#include "core/fail.hpp"

namespace nscdd {
namespace {

using Preconditioner = InterfacePreconditioner;

template <class Value>
std::vector<Value> or_default(const std::vector<Value>& values, std::vector<Value> by_default) {
  return values.empty() ? by_default : values;
}

}  // namespace

void check_coarse(const CoarseParameters& parameters, bool option) {
  const auto refuse = [option](std::string name, std::string_view expected, std::string_view met) {
    if (option) std::ranges::replace(name, '_', '-');
    fail("{}{}: expected {}, met {}", option ? "--" : "", name, expected, met);
  };
  if (parameters.kappa && !(*parameters.kappa > 1))
    refuse("kappa", "a number > 1", fmt::format("{}", *parameters.kappa));
  if (parameters.threshold && !(*parameters.threshold > 0))
    refuse("threshold", "a number > 0", fmt::format("{}", *parameters.threshold));
  if (parameters.kappa && parameters.threshold) refuse("threshold", "either it or kappa", "both");
  const std::vector<CoarseMethod> methods = methods_of(parameters);
  const auto any = [&](auto member, auto value) { return std::ranges::count(methods, value, member) > 0; };
  const bool bddc = any(&CoarseMethod::preconditioner, Preconditioner::bddc);
  const bool dirichlet = bddc || any(&CoarseMethod::preconditioner, Preconditioner::dirichlet);
  if (bddc && !parameters.bddc)
    refuse("preconditioner",
           names_where<Preconditioner>([](Preconditioner one) { return one != Preconditioner::bddc; }) + " with nscdd",
           "bddc, which nscdd-mpi has");
  if (bddc && any(&CoarseMethod::space, CoarseSpace::rigid))
    refuse("preconditioner", "one other than bddc with the coarse space rigid", "bddc");
  const bool scaled = std::ranges::any_of(methods, [](const CoarseMethod& m) { return m.scaling.has_value(); });
  const bool geneo = any(&CoarseMethod::space, CoarseSpace::geneo);
  const std::string_view others = parameters.counts ? "counts, without spectra" : "others only";
  if (parameters.counts && !parameters.preconditioners.empty()) refuse("preconditioner", "spectra with it", others);
  if (!parameters.scalings.empty() && !scaled)
    refuse("scaling", "the preconditioner lumped or dirichlet with it", others);
  if (!parameters.spaces.empty() && !dirichlet) refuse("coarse_space", "the preconditioner dirichlet with it", others);
  if (parameters.kappa && !geneo) refuse("kappa", "the coarse space geneo with it", others);
  if (parameters.threshold && !geneo) refuse("threshold", "the coarse space geneo with it", others);
}

std::vector<CoarseMethod> methods_of(const CoarseParameters& parameters) {
  if (parameters.counts) return {CoarseMethod{}};  // nothing depends on the method
  std::vector<CoarseMethod> methods;
  for (const Preconditioner one : or_default(parameters.preconditioners, {Preconditioner::dirichlet})) {
    if (one < Preconditioner::lumped) {  // not local
      methods.push_back({one});
      continue;
    }
    std::vector<CoarseSpace> spaces{CoarseSpace::none};
    if (one != Preconditioner::lumped) spaces = or_default(parameters.spaces, {CoarseSpace::none, CoarseSpace::geneo});
    for (const Scaling scaling : or_default(parameters.scalings, {Scaling::multiplicity, Scaling::deluxe}))
      for (const CoarseSpace space : spaces) methods.push_back({one, scaling, space});
  }
  return methods;
}

}  // namespace nscdd
