// SPDX-License-Identifier: GPL-3.0-or-later
// Alternating directions (ADMM): all couplings and no law, then the law and no coupling, in turns. With De Saxce's
// shift s = mu |u_t| of the velocities that the law sees, u + s n = -rho D l, and D = W_nn of each contact,
//     x <- (W + rho D)^-1 (rho D (z - l) - q - s n),   z <- P(x' + l),   l <- l + x' - z,   x' = 1.6 x - 0.6 z.
// W + rho D is factorised once, and again where another rho is wanted. Where M and H are known M + H (rho D)^-1 H^T
// takes its place, whole or cut into subdomains.
#include "contact_solvers/stall_watch.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

constexpr double first_weight = 0.1, most_weight = 1e8;  // rho
constexpr double relaxation = 1.6;
constexpr double renewed_part = 0.1;  // of the shift in an iteration: the whole of it goes round where rho is small
constexpr Index first_wait = 500;     // iterations with the first rho; then twice as many with each further one
constexpr double unbalanced = 10;     // the primal residual |x - z| over the dual one, the change of z, or the reverse
constexpr double fall_wanted = 0.3;   // of the smallest residual while rho stands

template <int D>
class AlternatingDirections {
 public:
  AlternatingDirections(SolverRun<D>& run, const Couplings<D>& w);

  void iterate();
  /// rho that would balance the primal and the dual residual of the last iteration.
  double balanced_weight() const;
  /// Factorises with another rho, or a larger one where W + rho D is not positive definite. False if none was found.
  bool change_weight(double weight);
  /// Lets the antisymmetric part of W act from the present impulses.
  void renew_rest() { rest_ = w_.rest(impulses_); }
  const Vector& impulses() const { return impulses_; }
  double weight() const { return weight_; }

 private:
  bool factorise();

  SolverRun<D>& run_;
  const Couplings<D>& w_;
  std::optional<CholeskyAnalysis> analysis_;  // none where M and H are known, or the system is cut
  std::optional<SparseCholesky> cholesky_;
  double weight_ = first_weight;
  Vector impulses_, multiplier_, shift_, rest_;  // z, l, s, the antisymmetric part of W times z
  Vector primal_, dual_;                         // x - z, and the change of z, in the last iteration
};

template <int D>
AlternatingDirections<D>::AlternatingDirections(SolverRun<D>& run, const Couplings<D>& w)
    : run_(run),
      w_(w),
      impulses_(run.now.impulses),
      multiplier_(Vector::Zero(impulses_.size())),
      shift_(Vector::Zero(run.problem.contacts())) {
  if (const SparseMatrix* symmetric = w.without_bodies.get()) analysis_.emplace(*symmetric);
  renew_rest();
  if (run.problem.sums.all_zero(impulses_)) return;  // the velocities of no impulses are far from those of a solution
  multiplier_ = -run.now.state.velocities.cwiseQuotient(weight_ * run.problem.normal);
  for (Index c = 0; c < run.problem.contacts(); ++c) {
    shift_[c] = run.problem.friction[c] * norm(component<D>(run.now.state.velocities, c).t);
    multiplier_[D * c] -= shift_[c] / (weight_ * run.problem.normal[D * c]);
  }
}

template <int D>
bool AlternatingDirections<D>::factorise() {
  ++run_.now.factorisations;
  if (!analysis_) {
    using Relation = ContactRelation<D>;
    std::vector<Relation> relations(at(run_.problem.contacts()), {.q = Relation::Block::Identity()});
    for (Index c = 0; c < count(relations); ++c) relations[at(c)].p *= weight_ * run_.problem.normal[D * c];
    return w_.factorise(std::move(relations));
  }
  SparseMatrix matrix = *w_.without_bodies;
  matrix.diagonal() += weight_ * run_.problem.normal;
  cholesky_.emplace(*analysis_, matrix);
  run_.now.operations += cholesky_->factorisation_operations();
  return cholesky_->positive_definite();
}

template <int D>
bool AlternatingDirections<D>::change_weight(double weight) {
  for (; weight <= most_weight && !run_.spent(); weight *= 10) {
    multiplier_ *= weight_ / weight;
    weight_ = weight;
    if (factorise()) return true;
  }
  return false;
}

template <int D>
void AlternatingDirections<D>::iterate() {
  const Vector scaled = weight_ * run_.problem.normal, velocities = -scaled.cwiseProduct(multiplier_);
  Vector right = scaled.cwiseProduct(impulses_ - multiplier_) - run_.problem.q - rest_;
  for (Index c = 0; c < run_.problem.contacts(); ++c) {
    shift_[c] += renewed_part * (run_.problem.friction[c] * norm(component<D>(velocities, c).t) - shift_[c]);
    right[D * c] -= shift_[c];
  }
  const Vector coupled = cholesky_ ? Vector(cholesky_->solve(right)) : w_.solve(right);
  const Vector relaxed = relaxation * coupled + (1 - relaxation) * impulses_, before = impulses_;
  for (Index c = 0; c < run_.problem.contacts(); ++c) {
    const LocalVector<D> moved = component<D>(relaxed, c) + component<D>(multiplier_, c);
    set_component(impulses_, c, project_on_cone(moved, run_.problem.friction[c]));
  }
  multiplier_ += relaxed - impulses_;
  primal_ = coupled - impulses_;
  dual_ = impulses_ - before;
  run_.now.operations += cholesky_ ? cholesky_->solve_operations() : w_.take_operations();
}

template <int D>
double AlternatingDirections<D>::balanced_weight() const {
  const auto squared = [&](const Vector& x) { return run_.problem.sums.dot(x.cwiseAbs2(), run_.problem.normal); };
  const double ratio = std::sqrt(squared(primal_) / squared(dual_));
  if (!(ratio > unbalanced || ratio < 1 / unbalanced)) return weight_;
  return weight_ * std::clamp(std::sqrt(ratio), 0.1, 10.0);
}

}  // namespace

template <int D>
void admm(SolverRun<D>& run) {
  const FrictionSolverOptions& options = run.options;
  if (run.judge(run.now.impulses) || run.spent()) return;
  const OneBlasThread serial_blas;  // for all solves: that of each is then cheap
  const Couplings<D> w = run.problem.couplings();
  AlternatingDirections<D> directions(run, w);
  bool regular = directions.change_weight(first_weight);
  StallWatch<D> watch(run);
  double smallest = infinity, smallest_before = infinity;
  for (Index wait = first_wait, next = wait; regular && run.now.sweeps < options.maximum_sweeps;) {
    const Index many = std::min(options.check_every, options.maximum_sweeps - run.now.sweeps);
    for (Index k = 0; k < many; ++k) directions.iterate();
    run.now.sweeps += many;
    if (run.judge(directions.impulses(), {.proximal_weight = directions.weight()}) || watch.ends(run)) return;
    directions.renew_rest();
    smallest = std::min(smallest, run.now.state.residual);
    if (run.now.sweeps < next || run.spent()) continue;
    // Where the residual does not fall the shift goes round: a larger rho lets it change more slowly.
    const bool falls = std::exchange(smallest_before, smallest) * fall_wanted >= smallest;
    const double weight = falls ? directions.balanced_weight() : 3 * directions.weight();
    if (weight != directions.weight()) regular = directions.change_weight(weight);
    wait *= 2;
    next = run.now.sweeps + wait;
  }
  if (!regular && !run.spent()) run.now.status = FrictionStatus::stalled;
}

template void admm(SolverRun<2>&);
template void admm(SolverRun<3>&);

}  // namespace nscdd
