// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <cstdint>
#include <memory>

namespace nscdd {

/// Reproducible random stream (GSL, Mersenne twister): the same seed gives the same numbers on every machine.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed);
  double uniform();  ///< in [0, 1)
  double normal();   ///< standard normal
  Vector normal_vector(Index n);
  Index below(Index n);  ///< uniform in 0 ... n-1, n >= 1
  struct Generator;

 private:
  std::unique_ptr<Generator, void (*)(Generator*)> generator_;
};

}  // namespace nscdd
