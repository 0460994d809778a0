// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/scalar_search.hpp"

#include "core/process_guard.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <gsl/gsl_roots.h>

#include <exception>
#include <memory>

namespace nscdd {
namespace {

constexpr int maximum_iterations = 200;

// A callback GSL can call: counts evaluations and carries an exception across the C frames.
struct Callback {
  const std::function<double(double)>& f;
  int evaluations = 0;
  std::exception_ptr failure;
  static double call(double x, void* self) {
    auto& callback = *static_cast<Callback*>(self);
    ++callback.evaluations;
    try {
      return callback.f(x);
    } catch (...) {
      callback.failure = std::current_exception();
      return 0;
    }
  }
  gsl_function as_gsl() { return {&Callback::call, this}; }
  void rethrow() const {
    if (failure) std::rethrow_exception(failure);
  }
};

// GSL aborts the process on an error unless told otherwise; statuses are read here instead.
using QuietGsl = ProcessGuard<gsl_set_error_handler_off, gsl_set_error_handler>;

}  // namespace

ScalarSearch find_root(const std::function<double(double)>& f, double a, double b, double tolerance) {
  const QuietGsl quiet;
  Callback callback{f, 0, nullptr};
  gsl_function function = callback.as_gsl();
  const std::unique_ptr<gsl_root_fsolver, decltype(&gsl_root_fsolver_free)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), &gsl_root_fsolver_free);
  const int start = gsl_root_fsolver_set(solver.get(), &function, a, b);
  callback.rethrow();
  if (start != GSL_SUCCESS) throw Error(fmt::format("root search: no change of sign between {} and {}", a, b));
  ScalarSearch result;
  for (int i = 0; i < maximum_iterations && !result.converged; ++i) {
    const int status = gsl_root_fsolver_iterate(solver.get());
    callback.rethrow();
    if (status != GSL_SUCCESS) break;
    result.converged = gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()),
                                              gsl_root_fsolver_x_upper(solver.get()), tolerance, 0) == GSL_SUCCESS;
  }
  result.x = gsl_root_fsolver_root(solver.get());
  result.value = f(result.x);
  result.evaluations = callback.evaluations + 1;
  return result;
}

ScalarSearch find_minimum(const std::function<double(double)>& f, double a, double m, double b, double tolerance) {
  const QuietGsl quiet;
  Callback callback{f, 0, nullptr};
  gsl_function function = callback.as_gsl();
  const std::unique_ptr<gsl_min_fminimizer, decltype(&gsl_min_fminimizer_free)> solver(
      gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent), &gsl_min_fminimizer_free);
  const int start = gsl_min_fminimizer_set(solver.get(), &function, m, a, b);
  callback.rethrow();
  if (start != GSL_SUCCESS) throw Error(fmt::format("minimum search: {} < {} < {} brackets no minimum", a, m, b));
  ScalarSearch result;
  for (int i = 0; i < maximum_iterations && !result.converged; ++i) {
    const int status = gsl_min_fminimizer_iterate(solver.get());
    callback.rethrow();
    if (status != GSL_SUCCESS) break;
    result.converged = gsl_min_test_interval(gsl_min_fminimizer_x_lower(solver.get()),
                                             gsl_min_fminimizer_x_upper(solver.get()), tolerance, 0) == GSL_SUCCESS;
  }
  result.x = gsl_min_fminimizer_x_minimum(solver.get());
  result.value = gsl_min_fminimizer_f_minimum(solver.get());
  result.evaluations = callback.evaluations;
  return result;
}

}  // namespace nscdd
