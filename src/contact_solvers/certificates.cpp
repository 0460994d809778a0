// SPDX-License-Identifier: GPL-3.0-or-later
// Proofs of verdicts in outward-rounded arithmetic, without the method that found their certificates.
#include <nscdd/contact_solvers/verdict.hpp>

namespace nscdd {
namespace {

double below(double x) { return std::nextafter(x, -infinity); }
double above(double x) { return std::nextafter(x, infinity); }

// Numbers between two bounds. One operation is rounded to the nearest number, so its neighbours are bounds.
struct Interval {
  double low = 0, high = 0;

  void add(double a, double b) {  // a b
    const double product = a * b;
    low = below(low + below(product));
    high = above(high + above(product));
  }
  double largest() const { return std::isnan(high) ? high : std::max(-low, high); }  // of the absolute values
};

// The mean of W_nn, rounded downwards.
double mean_below(const LocalFrictionProblem& problem) {
  double sum = 0;
  for (Index c = 0; c < problem.contacts(); ++c)
    sum = below(sum + problem.w.coeff(problem.dimension * c, problem.dimension * c));
  return below(sum / static_cast<double>(problem.contacts()));
}

}  // namespace

double proven_margin(const LocalFrictionProblem& problem, const Vector& friction, const Vector& velocities) {
  const SparseMatrix& columns = problem.h.cols() > 0 ? problem.h : problem.w;
  const Index d = problem.dimension;
  std::vector<Interval> u(at(problem.size()));
  for (Index k = 0; k < problem.size(); ++k) {
    u[at(k)].add(1, problem.q[k]);
    for (SparseMatrix::InnerIterator e(columns, k); e; ++e)
      problem.h.cols() > 0 ? u[at(k)].add(e.value(), velocities[e.row()])
                           : u[at(e.row())].add(e.value(), velocities[k]);
  }
  double margin = infinity;
  for (Index c = 0; c < problem.contacts(); ++c) {
    double squares = 0;
    for (Index k = d * c + 1; k < d * (c + 1); ++k)
      squares = above(squares + above(u[at(k)].largest() * u[at(k)].largest()));
    const double own = below(u[at(d * c)].low - above(friction[c] * above(std::sqrt(squares))));
    if (std::isnan(own)) return -infinity;
    margin = std::min(margin, own);
  }
  return margin;
}

double proven_speed(const LocalFrictionProblem& problem, const std::vector<Index>& chain, const Vector& stress) {
  const bool bodies = problem.h.cols() > 0;
  const SparseMatrix columns =
      bodies ? problem.h : SparseMatrix(problem.w.transpose());  // u_n is a row of W, not a column
  std::vector<Interval> forces(at(columns.rows()));
  Interval power;
  for (Index i = 0; i < count(chain); ++i) {
    if (!(stress[i] >= 0 && std::isfinite(stress[i]))) return 0;
    const Index n = problem.dimension * chain[at(i)];
    for (SparseMatrix::InnerIterator e(columns, n); e; ++e) forces[at(e.row())].add(e.value(), stress[i]);
    power.add(problem.q[n], stress[i]);
  }
  double sum = 0;
  for (const Interval& force : forces)
    if (force.largest() != 0) sum = above(sum + force.largest());  // NaN included
  if (!(power.high < 0) || std::isnan(sum)) return 0;
  if (sum == 0) return infinity;
  return below(below(-power.high / sum) * (bodies ? 1 : mean_below(problem)));
}

}  // namespace nscdd
