// SPDX-License-Identifier: GPL-3.0-or-later
// Accelerated projected gradients with restarts (Mazhar, Heyn, Negrut and Tasora 2015), as in Chrono. For a given shift
// s of De Saxce, contact with friction is the minimum of r^T W r / 2 + r^T (q + s n) over Coulomb's cones. Chrono takes
// s = 0, which lifts sliding contacts. Here an outer loop renews s = mu |u_t|, so that the answer is Coulomb's.
#pragma once

#include "contact_solvers/solver_run.hpp"
#include "core/fail.hpp"

namespace nscdd {

/// Steps of the gradient method. Norms and gradients are those of impulses times the root of W_nn of their contact,
/// because masses may be very unequal.
template <int D>
class ProjectedGradients {
 public:
  ProjectedGradients(const ContactData& data, const ContactBlocks<D>& w, const Vector& impulses)
      : data_(data), w_(w), shift_(Vector::Zero(data.q.size())) {
    restart(impulses, w * impulses + data.q);
    next_ = next_velocity_ = Vector::Zero(data.q.size());
  }

  void renew_shift() {
    for (Index c = 0; c < data_.contacts(); ++c) shift_[D * c] = data_.friction[c] * norm(component<D>(velocity_, c).t);
    restart(impulses_, velocity_);
  }

  /// One step. Returns its length in multiples of 1 / W_nn.
  double advance() {
    length_ /= 0.9;  // it may grow again
    Sums sums = step_ahead();
    for (; sums.curved * length_ > sums.metric; sums = step_ahead()) length_ /= 2;
    if (sums.uphill > 0) {
      restart(next_, next_velocity_);
      return length_;
    }
    const double before = std::exchange(momentum_, (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2);
    const double beta = (before - 1) / momentum_;
    for_parts(data_.contacts(), [&](const ContactRange& range) {
      const Index first = D * range.first, size = D * range.last - first;
      const auto go = [&](const Vector& next, Vector& last, Vector& ahead) {
        ahead.segment(first, size) = (1 + beta) * next.segment(first, size) - beta * last.segment(first, size);
      };
      go(next_, impulses_, ahead_);
      go(next_velocity_, velocity_, velocity_ahead_);
    });
    impulses_.swap(next_);
    velocity_.swap(next_velocity_);
    return length_;
  }
  const Vector& impulses() const { return impulses_; }
  Index products() { return std::exchange(products_, 0); }  ///< with W, since the last call
  /// || r - P(r - (W r + q + s n) / W_nn) ||, N s, with the present shift s.
  double natural_maps() const {
    double squares = 0;
    for (Index c = 0; c < data_.contacts(); ++c)
      squares += squared(component<D>(impulses_, c) -
                         projected(c, impulses_, component<D>(velocity_, c) + component<D>(shift_, c), 1));
    return std::sqrt(squares);
  }

 private:
  // Of the change by a step from the impulses ahead.
  struct Sums {
    double curved = 0, metric = 0;  // change^T W change, change^T D change
    double uphill = 0;              // gradient^T (next impulses - last ones)
  };

  void restart(const Vector& impulses, const Vector& velocity) {
    impulses_ = ahead_ = impulses;
    velocity_ = velocity_ahead_ = velocity;
    momentum_ = 1;
  }
  LocalVector<D> projected(Index c, const Vector& from, LocalVector<D> gradient, double length) const {
    return project_on_cone(component<D>(from, c) - (length / data_.normal[D * c]) * gradient, data_.friction[c]);
  }
  LocalVector<D> gradient_ahead(Index c) const { return component<D>(velocity_ahead_, c) + component<D>(shift_, c); }
  // Adds up the parts in their order, so the number of threads changes no bit.
  Sums step_ahead() {
    const Index contacts = data_.contacts();
    for_parts(contacts, [&](const ContactRange& range) {
      for (Index c = range.first; c < range.last; ++c)
        set_component(next_, c, projected(c, ahead_, gradient_ahead(c), length_));
    });
    std::vector<Sums> of_parts(at(parts_of(contacts)));
    for_parts(contacts, [&](const ContactRange& range) {
      Sums sums;
      for (Index c = range.first; c < range.last; ++c) {
        const LocalVector<D> r = component<D>(next_, c), u = w_.add_row(c, next_, component<D>(data_.q, c));
        set_component(next_velocity_, c, u);
        const LocalVector<D> change = r - component<D>(ahead_, c);
        sums.curved += dot(change, u - component<D>(velocity_ahead_, c));
        sums.metric += data_.normal[D * c] * squared(change);
        sums.uphill += dot(gradient_ahead(c), r - component<D>(impulses_, c));
      }
      of_parts[at(range.part)] = sums;
    });
    ++products_;
    Sums total;
    for (const Sums& sums : of_parts) {
      total.curved += sums.curved;
      total.metric += sums.metric;
      total.uphill += sums.uphill;
    }
    return total;
  }

  const ContactData& data_;
  const ContactBlocks<D>& w_;
  Vector shift_;
  Vector impulses_, ahead_;           // the last ones, and those ahead by Nesterov's momentum
  Vector velocity_, velocity_ahead_;  // W r + q of both
  Vector next_, next_velocity_;
  double momentum_ = 1, length_ = 1;
  Index products_ = 1;
};

template <int D>
void projected_gradients(const ContactBlocks<D>& w, SolverRun<D>& run) {
  constexpr double inner_part = 0.3;  // of the residual with the shift renewed, at which it is renewed
  const FrictionSolverOptions& options = run.options;
  ProjectedGradients<D> gradients(run.data, w, run.now.impulses);
  StallWatch<D> watch(run);
  double length = not_a_number;
  for (;;) {
    if (run.judge(gradients.impulses(), {.length = length}) || watch.ends(run)) return;
    if (run.now.sweeps >= options.maximum_sweeps) return;
    if (gradients.natural_maps() <= inner_part * run.natural_maps()) gradients.renew_shift();
    const Index many = std::min(options.check_every, options.maximum_sweeps - run.now.sweeps);
    for (Index k = 0; k < many; ++k) length = gradients.advance();
    run.now.sweeps += many;
    run.now.operations += run.data.product_operations * static_cast<double>(gradients.products());
  }
}

/// Throws Error if W is not stored.
template <ContactProblem P>
void apgd(P& problem, SolverRun<P::dimension>& run) {
  if constexpr (StoredProblem<P>)
    projected_gradients(problem.rows(), run);
  else
    fail("apgd: expected a stored W, met a problem without one");
}

}  // namespace nscdd
