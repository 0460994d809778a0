// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/scalar.hpp"

#include "core/fail.hpp"
#include "core/process_guard.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_min.h>
#include <gsl/gsl_roots.h>

#include <exception>

namespace nscdd {
namespace {

constexpr int maximum_iterations = 200;

// A callback for GSL, which carries an exception across the C frames.
struct Callback {
  const std::function<double(double)>& f;
  std::exception_ptr failure = nullptr;
  gsl_function as_gsl = {&Callback::call, this};
  static double call(double x, void* self) {
    auto& callback = *static_cast<Callback*>(self);
    try {
      return callback.f(x);
    } catch (...) {
      callback.failure = std::current_exception();
      return 0;
    }
  }
  // The status of a call to GSL, unless f threw in it.
  bool succeeded(int status) const {
    if (failure) std::rethrow_exception(failure);
    return status == GSL_SUCCESS;
  }
};

// Disables GSL's abort on errors; statuses are checked here instead.
using QuietGsl = ProcessGuard<gsl_set_error_handler_off, gsl_set_error_handler>;

template <class Resource>
using Owned = std::unique_ptr<Resource, void (*)(Resource*)>;

// Whether the bracket of a solver came within the tolerance.
template <class Solver>
bool narrowed(const Callback& callback, Solver* solver, int (*iterate)(Solver*), double (*lower)(const Solver*),
              double (*upper)(const Solver*), int (*test)(double, double, double, double), double tolerance) {
  for (int i = 0; i < maximum_iterations; ++i) {
    if (!callback.succeeded(iterate(solver))) return false;
    if (test(lower(solver), upper(solver), tolerance, 0) == GSL_SUCCESS) return true;
  }
  return false;
}

}  // namespace

double integral(const std::function<double(double)>& f, double a, double b, double absolute) {
  constexpr std::size_t most_intervals = 1000;
  const QuietGsl quiet;
  const Owned<gsl_integration_workspace> workspace(gsl_integration_workspace_alloc(most_intervals),
                                                   gsl_integration_workspace_free);
  Callback callback{f};
  double result = 0, error = 0;
  const bool done = callback.succeeded(
      gsl_integration_qags(&callback.as_gsl, a, b, absolute, 1e-12, most_intervals, workspace.get(), &result, &error));
  // On an interval of a few roundings GSL reports rounding, however small the error.
  if (!done && !(error <= std::max(absolute, 1e-12 * std::abs(result))))
    fail("integral from {} to {}: expected an error of at most {}, met {}", a, b, absolute, error);
  return result;
}

LinearFit linear_fit(std::span<const double> x, std::span<const double> y) {
  if (x.size() < 3 || x.size() != y.size()) fail("linear fit: expected at least three points, met {}", x.size());
  LinearFit fit;
  double cov00 = 0, cov01 = 0, cov11 = 0, sum_of_squares = 0;
  gsl_fit_linear(x.data(), 1, y.data(), 1, x.size(), &fit.intercept, &fit.slope, &cov00, &cov01, &cov11,
                 &sum_of_squares);
  fit.slope_error = std::sqrt(cov11);
  return fit;
}

ScalarSearch find_root(const std::function<double(double)>& f, double a, double b, double tolerance) {
  const QuietGsl quiet;
  Callback callback{f};
  const Owned<gsl_root_fsolver> solver(gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  if (!callback.succeeded(gsl_root_fsolver_set(solver.get(), &callback.as_gsl, a, b)))
    fail("root search: no change of sign between {} and {}", a, b);
  const bool converged = narrowed(callback, solver.get(), &gsl_root_fsolver_iterate, &gsl_root_fsolver_x_lower,
                                  &gsl_root_fsolver_x_upper, &gsl_root_test_interval, tolerance);
  const double root = gsl_root_fsolver_root(solver.get());
  return {root, f(root), converged};
}

ScalarSearch find_minimum(const std::function<double(double)>& f, double a, double m, double b, double tolerance) {
  const QuietGsl quiet;
  Callback callback{f};
  const Owned<gsl_min_fminimizer> solver(gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent), gsl_min_fminimizer_free);
  if (!callback.succeeded(gsl_min_fminimizer_set(solver.get(), &callback.as_gsl, m, a, b)))
    fail("minimum search: {} < {} < {} brackets no minimum", a, m, b);
  const bool converged = narrowed(callback, solver.get(), &gsl_min_fminimizer_iterate, &gsl_min_fminimizer_x_lower,
                                  &gsl_min_fminimizer_x_upper, &gsl_min_test_interval, tolerance);
  return {gsl_min_fminimizer_x_minimum(solver.get()), gsl_min_fminimizer_f_minimum(solver.get()), converged};
}

}  // namespace nscdd
