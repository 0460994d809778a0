// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/grain_source.hpp"

namespace nscdd {

void release_grains(GranularSystem& system, GranularState& state) {
  for (std::size_t k = 0; k < system.boundaries.size(); ++k) {
    const auto& source = system.boundaries[k].source;
    const auto next = source ? std::ranges::find(system.driven_by, static_cast<Index>(k)) : system.driven_by.end();
    if (next == system.driven_by.end()) continue;
    const auto grain = next - system.driven_by.begin();
    bool occupied = false;
    for (Index i = 0; i < system.grains() && !occupied; ++i) {
      if (system.waits(i)) continue;
      const double touch = system.radius[at(i)] + system.radius[at(grain)];
      const double near = system.moves(i) && state.step > 0 ? std::max(source->distance, touch) : touch;
      occupied = system.length(system.apart(source->point, centre_of(state, at(i)))) <= near;
    }
    if (occupied) continue;
    *next = -1;
    state.released.push_back({grain});
    state.x[at(grain)] = source->point[0];
    state.y[at(grain)] = source->point[1];
    if (system.dimension == 3) state.z[at(grain)] = source->point[2];
  }
}

void free_released_grains(GranularSystem& system, const GranularState& state) {
  for (const ReleasedGrain& one : state.released) system.driven_by[at(one.grain)] = -1;
}

}  // namespace nscdd
