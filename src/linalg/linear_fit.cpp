// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/linear_fit.hpp"

#include <nscdd/core/error.hpp>

#include <fmt/format.h>
#include <gsl/gsl_fit.h>

#include <cmath>

namespace nscdd {

LinearFit linear_fit(std::span<const double> x, std::span<const double> y) {
  if (x.size() < 3 || x.size() != y.size())
    throw Error(fmt::format("linear fit: expected at least three points, met {}", x.size()));
  LinearFit fit;
  double cov00 = 0, cov01 = 0, cov11 = 0, sum_of_squares = 0;
  gsl_fit_linear(x.data(), 1, y.data(), 1, x.size(), &fit.intercept, &fit.slope, &cov00, &cov01, &cov11,
                 &sum_of_squares);
  fit.slope_error = std::sqrt(cov11);
  return fit;
}

}  // namespace nscdd
