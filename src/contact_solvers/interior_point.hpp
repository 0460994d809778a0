// SPDX-License-Identifier: GPL-3.0-or-later
// A primal-dual interior point method for contacts without friction, whose problem is a convex quadratic program:
//     minimise r^T W r / 2 + q^T r over r >= 0,   with u = W r + q >= 0 and r_c u_c = 0 in the end,
// r and u along the normals. Statuses of hyperstatic packings may cycle under Newton's steps. Here r and a copy s of u
// stay positive, and all r_c s_c fall to zero together. Each iteration factorises W + diag(s/r) once and solves twice,
// by Mehrotra's predictor and corrector.
#pragma once

#include "contact_solvers/solver_run.hpp"

namespace nscdd {

template <ContactProblem P>
class InteriorPointSteps {
 public:
  static constexpr int D = P::dimension;

  /// `problem`: without friction.
  InteriorPointSteps(P& problem, SolverRun<D>& run) : problem_(problem), run_(run), normal_(of_normals(data_.normal)) {
    constexpr double inside = 0.01;  // of the root mean square of impulses, at the start
    const double size = std::max(data_.sums.norm(run.now.impulses), data_.alone) / std::sqrt(contacts_);
    r_ = of_normals(run.now.impulses).cwiseMax(inside * size);
    s_ = of_normals(run.now.state.velocities).cwiseMax(inside * size * normal_);
  }

  /// Iterations from the present impulses. Returns whether the run is over: not if they make no progress, as where no
  /// impulses keep all contacts from closing.
  bool finish() {
    constexpr Index most_iterations = 100;
    constexpr double towards_edge = 0.995, shortest_step = 1e-6;
    for (Index iteration = 0; iteration < most_iterations && !run_.spent(); ++iteration) {
      if (!factorise()) return false;
      const Vector apart = s_ - of_normals(problem_.product(all(r_)) + data_.q);
      const Step ahead = step(apart, -s_);
      const double reach = std::min(1.0, longest(ahead)), now = complementarity(r_, s_);
      const double after = complementarity(r_ + reach * ahead.r, s_ + reach * ahead.s);
      const double centre = now * std::pow(std::clamp(after / now, 0.0, 1.0), 3);
      const Step whole = step(apart, (centre - ahead.r.array() * ahead.s.array()).matrix().cwiseQuotient(r_) - s_);
      const double length = std::min(1.0, towards_edge * longest(whole));
      if (!(length > shortest_step)) return false;
      r_ += length * whole.r;
      s_ += length * whole.s;
      const Vector impulses = (r_.array() * normal_.array() > s_.array()).select(r_, 0.0);
      if (run_.judge(all(impulses), {.length = length})) return true;
    }
    return false;
  }

 private:
  struct Step {
    Vector r, s;
  };

  static Vector of_normals(const Vector& v) { return v(Eigen::seqN(0, v.size() / D, D)); }
  static Vector all(const Vector& along_normals) {
    Vector v = Vector::Zero(D * along_normals.size());
    v(Eigen::seqN(0, along_normals.size(), D)) = along_normals;
    return v;
  }

  bool factorise() {
    constexpr double stiff = 1e12;  // of surfaces, whose impulses are 0
    Vector shift = stiff * data_.normal;
    shift(Eigen::seqN(0, normal_.size(), D)) = s_.cwiseQuotient(r_);
    ++run_.now.factorisations;
    return problem_.factorise_shifted(shift);
  }
  // W dr - ds = apart,  (s/r) dr + ds = target.
  Step step(const Vector& apart, const Vector& target) {
    Step result;
    result.r = of_normals(problem_.solve(all(apart + target)));
    result.s = target - s_.cwiseQuotient(r_).cwiseProduct(result.r);
    run_.now.operations += problem_.take_operations();
    return result;
  }
  // The length of a step to the first r_c or s_c that is 0; 0 if it is not finite.
  double longest(const Step& step) const {
    const Vector falls = (-step.r.cwiseQuotient(r_)).cwiseMax(-step.s.cwiseQuotient(s_));
    if (data_.sums.any(!falls.allFinite())) return 0;
    return 1 / data_.sums.largest(falls.cwiseMax(0));
  }
  // The mean of r_c s_c.
  double complementarity(const Vector& r, const Vector& s) const { return data_.sums.dot(r, s) / contacts_; }

  P& problem_;
  SolverRun<D>& run_;
  const ContactData& data_ = run_.data;
  const Vector normal_;  // W_nn, 1/kg
  const double contacts_ = static_cast<double>(data_.sums.total(data_.contacts()));
  Vector r_, s_;  // N s and m/s
};

}  // namespace nscdd
