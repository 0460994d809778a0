// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tables/coarse_parameters.hpp"

#include "core/fail.hpp"

namespace nscdd {
namespace {

using Preconditioner = InterfacePreconditioner;

template <class Value>
std::vector<Value> or_default(const std::vector<Value>& values, std::initializer_list<Value> by_default) {
  return values.empty() ? std::vector<Value>(by_default) : values;
}

bool is_local(Preconditioner one) { return one >= Preconditioner::lumped; }

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
  const auto any = [](const auto& list, const auto& right) { return std::ranges::any_of(list, right); };
  const std::vector<CoarseMethod> methods = methods_of(parameters);
  const bool bddc = any(methods, [](const CoarseMethod& m) { return m.preconditioner == Preconditioner::bddc; });
  const bool dirichlet =
      bddc || any(methods, [](const CoarseMethod& m) { return m.preconditioner == Preconditioner::dirichlet; });
  if (bddc && !parameters.bddc)
    refuse("preconditioner",
           names_where<Preconditioner>([](Preconditioner one) { return one != Preconditioner::bddc; }) + " with nscdd",
           "bddc, which nscdd-mpi has");
  if (bddc && any(methods, [](const CoarseMethod& m) { return m.space == CoarseSpace::rigid; }))
    refuse("preconditioner", "one other than bddc with the coarse space rigid", "bddc");
  const bool scaled = any(methods, [](const CoarseMethod& m) { return m.scaling.has_value(); });
  const bool geneo = any(methods, [](const CoarseMethod& m) { return m.space == CoarseSpace::geneo; });
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
    if (!is_local(one)) {
      methods.push_back({one, {}, CoarseSpace::none});
      continue;
    }
    for (const Scaling scaling : or_default(parameters.scalings, {Scaling::multiplicity, Scaling::deluxe})) {
      if (one == Preconditioner::lumped)
        methods.push_back({one, scaling, CoarseSpace::none});
      else
        for (const CoarseSpace space : or_default(parameters.spaces, {CoarseSpace::none, CoarseSpace::geneo}))
          methods.push_back({one, scaling, space});
    }
  }
  return methods;
}

}  // namespace nscdd
