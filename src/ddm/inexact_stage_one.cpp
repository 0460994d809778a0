// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/inexact_stage_one.hpp"

namespace nscdd {

Vector InexactIteration::apply(const Vector& z) const {
  TwoStageState state = iteration.zero_state();
  Index offset = 0;
  for (Vector& r : state.impulses) {
    r = z.segment(offset, r.size());
    offset += r.size();
  }
  state.interface_impulses = z.tail(iteration.interface_size());
  state = iteration.iterate(std::move(state));
  Vector image(z.size());
  offset = 0;
  for (const Vector& r : state.impulses) {
    image.segment(offset, r.size()) = r;
    offset += r.size();
  }
  image.tail(iteration.interface_size()) = state.interface_impulses;
  return image;
}

MapRadius inexact_radius(const InexactIteration& j, const SpectralOptions& options) {
  return map_radius(j, options, j.iteration.rigid() ? UnitEigenvalues::counted : UnitEigenvalues::none);
}

}  // namespace nscdd
