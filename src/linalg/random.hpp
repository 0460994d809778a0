// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include <new>

namespace nscdd {

/// Reproducible random stream (GSL, Mersenne twister): the same seed gives the same numbers on every machine.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : generator_(gsl_rng_alloc(gsl_rng_mt19937), &gsl_rng_free) {
    if (generator_ == nullptr) throw std::bad_alloc();
    gsl_rng_set(generator_.get(), seed);
  }
  /// Uniform in [0, 1).
  double uniform() { return gsl_rng_uniform(generator_.get()); }
  std::vector<double> uniforms(Index n) {
    std::vector<double> numbers(at(n));
    for (double& number : numbers) number = uniform();
    return numbers;
  }
  double normal() { return gsl_ran_gaussian_ziggurat(generator_.get(), 1.0); }
  Vector normal_vector(Index n) {
    return Vector::NullaryExpr(n, [this] { return normal(); });
  }
  /// Uniform in 0 ... n-1, n >= 1.
  Index below(Index n) {
    return static_cast<Index>(gsl_rng_uniform_int(generator_.get(), static_cast<unsigned long>(n)));
  }

 private:
  std::unique_ptr<gsl_rng, decltype(&gsl_rng_free)> generator_;
};

}  // namespace nscdd
