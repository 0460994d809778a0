// SPDX-License-Identifier: GPL-3.0-or-later
// Continuation (Allgower and Georg 1990, chapters 2 and 6) of a smoothed contact law. With z = r - rho u, rho = 1 /
// W_nn of each contact, Coulomb's law is r = P(z). As in Chen, Harker, Kanzow and Smale, the positive part in P becomes
// (z + sqrt(z^2 + 4 t)) / 2 and the clamp to +- b becomes (sqrt((z + b)^2 + 4 t) - sqrt((z - b)^2 + 4 t)) / 2. Then
//     F(z, t) = rho (W P_t(z) + q) - P_t(z) + z = t F_0 / t_0,   F_0 = F(z_0, t_0),
// is a smooth curve from any point (z_0, t_0) to a solution at t = 0. With friction t need not fall all the time: it
// grows where the determinant of dF/dz is negative.
#pragma once

#include "contact_solvers/solver_run.hpp"

namespace nscdd {

/// The smoothed law P_t(z) of a contact, and its derivatives by z and t.
template <int D>
struct SmoothedLaw {
  using Block = Eigen::Matrix<double, D, D>;
  LocalVector<D> impulse;
  Block by_z, rest;  ///< rest: 1 - P', regular in spite of rounding
  Eigen::Matrix<double, D, 1> by_t;
};

SmoothedLaw<2> smoothed_law(LocalVector<2> z, double friction, double t);
SmoothedLaw<3> smoothed_law(LocalVector<3> z, double friction, double t);

struct SmoothedPoint {
  Vector z;
  double t;  // (N s)^2
};

/// The curve near a point, with the parameter log t.
struct SmoothedCourse {
  SmoothedPoint point;
  Vector tangent;                // dz / dlog t
  Vector correction;             // Newton's step to the curve, at right angles to it
  double direction;              // of log t along the curve, -1 or 1
  double log_correction = 0;     // Newton's step of log t
  double steepest = 0, off = 0;  // largest components of tangent and correction, in units of sqrt(z^2 + 4 t)
  double length = 0;             // of the step from here
};

template <ContactProblem P>
class SmoothedCurve {
 public:
  static constexpr int D = P::dimension;

  SmoothedCurve(P& problem, SolverRun<D>& run, double relative_smoothing)
      : problem_(problem), run_(run), rho_(run.data.normal.cwiseInverse()) {
    constexpr double least_start = 0.1;  // of the first impulses over rho q
    const ContactSums& sums = data_.sums;
    Vector r = run.now.impulses;
    q_ = rho_.cwiseProduct(data_.q + problem.rest(r));
    const double size = sums.norm(q_), entries = static_cast<double>(sums.total(q_.size()));
    // Impulses that sweeps made so small are small.
    if (sums.norm(r) <= (run.now.sweeps > 0 ? 0.0 : least_start) * size)
      for (Index c = 0; c < data_.contacts(); ++c) r[D * c] = std::max(r[D * c], size / std::sqrt(entries));
    start_ = {r - velocities(r) - q_, relative_smoothing * sums.squared_norm(r) / entries};
    slope_ = Vector::Zero(r.size());
    slope_ = defect(start_, impulses(start_)) / start_.t;
  }

  const SmoothedPoint& start() const { return start_; }

  /// None if the matrix of the linear systems of F, (1 - P') + P' rho W, is singular to rounding (r = P_t(z)).
  std::optional<SmoothedCourse> course(const SmoothedPoint& point) {
    const Vector defects = defect(point, impulses(point));
    std::vector<ContactRelation<D>> relations(at(data_.contacts()));
    Vector along(point.z.size()), across(point.z.size());
    for (Index c = 0; c < data_.contacts(); ++c) {
      const SmoothedLaw<D> law = smoothed_law(component<D>(point.z, c), data_.friction[c], point.t);
      relations[at(c)] = {law.rest, rho_[D * c] * law.by_z};
      along.segment<D>(D * c) = point.t * (law.by_t + law.by_z * slope_.template segment<D>(D * c));
      across.segment<D>(D * c) = -law.by_z * defects.segment<D>(D * c);
    }
    ++run_.now.factorisations;
    if (!problem_.factorise(std::move(relations))) {
      run_.now.operations += problem_.take_operations();
      return std::nullopt;
    }
    along = problem_.solve(along);
    across = problem_.solve(across);
    SmoothedCourse found{.point = point,
                         .tangent = along - velocities(along) + point.t * slope_,
                         .correction = across - velocities(across) - defects,
                         .direction = problem_.determinant_sign() < 0 ? 1.0 : -1.0};
    run_.now.operations += problem_.take_operations();
    // Lengths along the curve: the mean of the squared relative changes of z, and the square of that of log t.
    const Vector unit = weight(point), relative = found.tangent.cwiseProduct(unit);
    const ContactSums& sums = data_.sums;
    const double count = static_cast<double>(sums.total(unit.size()));
    const double along_tangent =
        sums.dot(found.correction.cwiseProduct(unit), relative) / (sums.squared_norm(relative) + count);
    found.correction -= along_tangent * found.tangent;
    found.log_correction = -along_tangent;
    found.steepest = sums.largest(relative.cwiseAbs());
    found.off = std::max(sums.largest(found.correction.cwiseProduct(unit).cwiseAbs()), std::abs(found.log_correction));
    return found;
  }

  /// The point after a step of this length, the correction included.
  static SmoothedPoint ahead(const SmoothedCourse& course, double length) {
    const double change = course.direction * length;
    return {course.point.z + course.correction + change * course.tangent,
            course.point.t * std::exp(change + course.log_correction)};
  }

  Vector impulses(const SmoothedPoint& point) const {
    Vector r(point.z.size());
    for (Index c = 0; c < data_.contacts(); ++c)
      set_component(r, c, smoothed_law(component<D>(point.z, c), data_.friction[c], point.t).impulse);
    return r;
  }

  /// The largest component of F - t F_0 / t_0 with P_t(z) = r, in units of sqrt(z^2 + 4 t).
  double residual(const SmoothedPoint& point, const Vector& r) const {
    return data_.sums.largest(defect(point, r).cwiseProduct(weight(point)).cwiseAbs());
  }

 private:
  Vector weight(const SmoothedPoint& point) const { return (point.z.array().square() + 4 * point.t).rsqrt(); }
  // F - t F_0 / t_0, N s.
  Vector defect(const SmoothedPoint& point, const Vector& r) const {
    return velocities(r) + q_ - r + point.z - point.t * slope_;
  }
  Vector velocities(const Vector& r) const { return rho_.cwiseProduct(problem_.symmetric_product(r)); }  // rho W r

  P& problem_;
  SolverRun<D>& run_;
  const ContactData& data_ = run_.data;
  Vector rho_, q_, slope_;  // slope_: F_0 / t_0
  SmoothedPoint start_;
};

}  // namespace nscdd
