// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/packing/generators/triangular_strip.hpp>

#include <numbers>

namespace nscdd {

Packing generate(const TriangularStrip& strip, const Monitor& monitor) {
  Packing packing;
  for (Index i = 0; i < strip.grains; ++i) {
    if (i % 4096 == 0 && !report(monitor, i, strip.grains)) break;
    packing.x.push_back(static_cast<double>(i) * strip.radius);
    packing.y.push_back(i % 2 == 0 ? 0.0 : std::numbers::sqrt3 * strip.radius);
    packing.radius.push_back(strip.radius);
  }
  return packing;
}

}  // namespace nscdd
