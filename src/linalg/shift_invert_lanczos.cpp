// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/krylov.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

constexpr double share_of_fixed_vector = 0.1;
constexpr double breakdown = 1e-14;       // least length of a new direction, relative to its image
constexpr double in_kernel = 1e-11;       // of a semidefinite M: Rayleigh quotient of a vector, over the largest
constexpr Index first_estimate = 3;       // steps before the gaps of Ritz values are meaningful
constexpr Index every_step = 40;          // steps that each check convergence; later every tenth does
constexpr std::uint64_t fixed_seed = 12;  // of the fixed vector and of those after a breakdown

// M-orthonormal basis with its images, orthogonal to the locked vectors as well.
class Basis {
 public:
  Basis(Index n, Index capacity, const LinearMap& m, const Matrix& locked, bool semidefinite)
      : m_(m),
        locked_(locked),
        locked_image_(n, locked.cols()),
        q_(n, capacity),
        mq_(n, capacity),
        semidefinite_(semidefinite) {
    for (Index k = 0; k < locked.cols(); ++k) locked_image_.col(k) = m(locked.col(k));
  }

  // Appends the part of w orthogonal to the basis, if there is room; returns its length, 0 if it is rounding.
  double append(Vector w) {
    double old = 0;
    for (int pass = 0; pass < 2; ++pass) {  // twice is enough
      const Vector c = locked_image_.transpose() * w;
      if (c.size() > 0) w -= locked_ * c;
      const Vector d = mq_.leftCols(size_).transpose() * w;
      w -= q_.leftCols(size_) * d;
      old += c.squaredNorm() + d.squaredNorm();
    }
    const Vector mw = m_(w);
    const double length = std::sqrt(std::max(0.0, w.dot(mw)));
    if (!(length > breakdown * std::sqrt(old))) return 0;
    largest_ = std::max(largest_, length * length / w.squaredNorm());
    if (semidefinite_ && length * length < in_kernel * largest_ * w.squaredNorm()) return 0;
    if (size_ == q_.cols()) return length;
    q_.col(size_) = w / length;
    mq_.col(size_++) = mw / length;
    return length;
  }

  auto image() const { return mq_.col(size_ - 1); }  // M q of the last vector
  Matrix combine(const Matrix& s) const { return q_.leftCols(s.rows()) * s; }

 private:
  const LinearMap& m_;
  const Matrix& locked_;
  Matrix locked_image_, q_, mq_;
  bool semidefinite_;
  double largest_ = 0;  // Rayleigh quotient of M so far
  Index size_ = 0;
};

// Ritz values nu of the tridiagonal matrix on the chosen side, by decreasing modulus.
struct RitzPairs {
  Vector nu, residuals, gaps;
  Matrix s;
};

RitzPairs ritz_pairs(const std::vector<double>& alpha, const std::vector<double>& beta, bool positive, Index wanted) {
  const Index steps = count(alpha);
  const auto [all, vectors] = tridiagonal_eigen(Vector::Map(alpha.data(), steps), Vector::Map(beta.data(), steps - 1));
  const Index side = positive ? (all.array() > 0).count() : (all.array() < 0).count();
  const Index found = std::min(wanted, side);
  RitzPairs pairs{Vector(found), Vector(found), Vector(found), Matrix(steps, found)};
  for (Index k = 0; k < found; ++k) {
    const Index i = positive ? steps - 1 - k : k;
    pairs.nu[k] = all[i];
    pairs.s.col(k) = vectors.col(i);
    pairs.residuals[k] = beta.back() * std::abs(pairs.s(steps - 1, k));
    const double before = i > 0 ? all[i] - all[i - 1] : infinity;
    pairs.gaps[k] = i + 1 < steps ? std::min(before, all[i + 1] - all[i]) : before;
  }
  return pairs;
}

// From nu to lambda = sigma + 1/nu.
void set_values(ShiftInvertResult& result, const RitzPairs& pairs, double sigma) {
  const Index found = pairs.nu.size();
  result.values = sigma + pairs.nu.array().inverse();
  result.bounds = result.errors = Vector::Constant(found, infinity);
  for (Index k = 0; k < found; ++k) {
    const double nu = std::abs(pairs.nu[k]), r = pairs.residuals[k], room = pairs.gaps[k] - r;
    if (r >= nu) continue;
    result.bounds[k] = r / (nu * (nu - r));
    result.errors[k] = std::min(result.bounds[k], room > 0 ? r * r / room / (nu * nu) : infinity);
  }
}

bool accurate_enough(const ShiftInvertResult& result, const RitzPairs& pairs, Index wanted, Index steps,
                     const ShiftInvertOptions& options) {
  if (pairs.nu.size() < wanted) return false;
  for (Index k = 0; k < wanted; ++k) {
    const bool near = pairs.residuals[k] <= options.tolerance * std::abs(pairs.nu[k]);
    if (!near && (steps < first_estimate || !(result.errors[k] <= options.accuracy))) return false;
  }
  return true;
}

}  // namespace

ShiftInvertResult shift_invert_lanczos(const ShiftedProblem& problem, SpectrumEnd end, Index wanted,
                                       const ShiftInvertOptions& options, const Vector& start, const Matrix& locked) {
  const Index n = problem.size;
  const OneBlasThread serial_blas;
  if (n < arpack_smallest_size) fail("Lanczos: expected a problem of size >= {}, met {}", arpack_smallest_size, n);
  ShiftInvertResult result;
  const Index capacity = std::min(n - locked.cols(), std::max(options.maximum_steps, wanted + 1));
  // A multiple eigenvalue needs new random vectors in each run.
  RandomStream random(fixed_seed + static_cast<std::uint64_t>(locked.cols()));
  Basis basis(n, capacity, problem.m, locked, problem.offset != 0);
  Vector first = random.normal_vector(n);
  if (start.size() == n && start.norm() > 0)
    first = start / start.norm() + share_of_fixed_vector * first / first.norm();
  if (problem.offset != 0) first = problem.solve(problem.m(first));  // no part in the kernel of M
  if (capacity < 1 || basis.append(first) == 0) return result;
  std::vector<double> alpha, beta;
  RitzPairs pairs;
  for (Index steps = 1;; ++steps) {
    const Vector mq = basis.image();
    const Vector w = problem.solve(mq);
    ++result.applications;
    alpha.push_back(mq.dot(w) + problem.offset);
    beta.push_back(basis.append(w));
    const bool spent = beta.back() == 0 && (steps == capacity || basis.append(random.normal_vector(n)) == 0);
    const bool last = steps == capacity || spent;
    if (!last && steps > every_step && steps % 10 != 0) continue;
    pairs = ritz_pairs(alpha, beta, end == SpectrumEnd::smallest, wanted);
    set_values(result, pairs, problem.sigma);
    result.converged = accurate_enough(result, pairs, wanted, steps, options);
    if (result.converged || last) break;
  }
  result.vectors = basis.combine(pairs.s);
  return result;
}

}  // namespace nscdd
