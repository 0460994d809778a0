// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/random.hpp"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include <new>

namespace nscdd {

struct RandomStream::Generator {
  gsl_rng* state;
  explicit Generator(std::uint64_t seed) : state(gsl_rng_alloc(gsl_rng_mt19937)) {
    if (state == nullptr) throw std::bad_alloc();
    gsl_rng_set(state, seed);
  }
  ~Generator() { gsl_rng_free(state); }
  Generator(const Generator&) = delete;
  Generator& operator=(const Generator&) = delete;
};

RandomStream::RandomStream(std::uint64_t seed)
    : generator_(new Generator(seed), [](Generator* generator) { delete generator; }) {}

double RandomStream::uniform() { return gsl_rng_uniform(generator_->state); }

double RandomStream::normal() { return gsl_ran_gaussian_ziggurat(generator_->state, 1.0); }

Vector RandomStream::normal_vector(Index n) {
  Vector x(n);
  for (Index i = 0; i < n; ++i) x[i] = normal();
  return x;
}

Index RandomStream::below(Index n) {
  return static_cast<Index>(gsl_rng_uniform_int(generator_->state, static_cast<unsigned long>(n)));
}

}  // namespace nscdd
