// SPDX-License-Identifier: GPL-3.0-or-later
#include "judged_radius.hpp"

#include "mumps.hpp"

#include <doctest/doctest.h>

namespace nscdd::testing {

SpectralRadius judged_radius(const Contraction& b, SpectralOptions options) {
  const auto verdict = std::make_shared<MumpsVerdict>();
  options.inertia = judged(multifrontal(), mumps(), verdict);
  const SpectralRadius radius = spectral_radius(b, options);
  CHECK(verdict->differing == 0);
  CHECK(verdict->undecided == 0);
  if (radius.factorisations > 0) CHECK(verdict->judged > 0);
  return radius;
}

}  // namespace nscdd::testing
