// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tables/coarse_parameters.hpp"

#include "core/fail.hpp"

namespace nscdd {

void check_coarse(const CoarseParameters& parameters, std::string_view dashes) {
  if (!(parameters.kappa > 1)) fail("{}kappa: expected a number > 1, met {}", dashes, parameters.kappa);
  if (parameters.threshold && !(*parameters.threshold > 0))
    fail("{}threshold: expected a number > 0, met {}", dashes, *parameters.threshold);
}

std::vector<CoarseMethod> methods_of(const CoarseParameters& parameters) {
  if (parameters.counts) return {CoarseMethod{}};  // nothing depends on the method
  std::vector<CoarseMethod> methods;
  for (const InterfacePreconditioner one : parameters.preconditioners) {
    if (one == InterfacePreconditioner::inertia || one == InterfacePreconditioner::network) {
      methods.push_back({one, {}, CoarseSpace::none});
      continue;
    }
    for (const Scaling scaling : parameters.scalings) {
      if (one == InterfacePreconditioner::lumped)
        methods.push_back({one, scaling, CoarseSpace::none});
      else
        for (const CoarseSpace space : parameters.spaces) methods.push_back({one, scaling, space});
    }
  }
  return methods;
}

}  // namespace nscdd
