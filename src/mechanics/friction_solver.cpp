// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

constexpr double largest_natural_maps = 1e-3;  // of a solution, relative to the impulses of the contacts each alone

constexpr double largest_impulses = 1e8;  // over those that are to be expected

// The solvers by the places of FrictionAlgorithm.
constexpr void (*contact_solvers[])(SolverRun&) = {automatic, interior_point, nlgs};

// || r^1 ||: impulses of the contacts, each alone.
double lone_impulses(const LocalFrictionProblem& problem) {
  double squares = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const FullDelassus w = diagonal_block(problem, c);
    squares += squared(Coulomb{}.impulse(stopping(w, {}, component(problem.q, c)), w, problem.friction[c]));
  }
  return std::sqrt(squares);
}

// `alone`: lone_impulses, which do not change from check to check.
FrictionState state_of(const LocalFrictionProblem& problem, const Vector& impulses, double alone) {
  FrictionState state;
  state.velocities = problem.w * impulses + problem.q;
  double squares = 0, siconos_squares = 0, largest = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const LocalVector r = component(impulses, c), u = component(state.velocities, c);
    const double mu = problem.friction[c];
    const double own = squared(natural_map(r, u, mu, 1 / problem.w.coeff(2 * c, 2 * c)));
    squares += own;
    if (own > largest) {
      largest = own;
      state.worst = c;
    }
    siconos_squares += squared(natural_map(r, u, mu, 1));
    const ContactStatus status = contact_status(r, mu);
    ++(status == ContactStatus::open ? state.open : status == ContactStatus::stick ? state.stick : state.slide);
  }
  state.residual = squares == 0 ? 0 : std::sqrt(squares) / std::max(impulses.norm(), alone);
  state.siconos_residual = std::sqrt(siconos_squares);
  const double size = std::max({impulses.norm(), state.velocities.norm(), problem.q.norm()});
  state.siconos_relative = size > std::numeric_limits<double>::epsilon();
  if (state.siconos_relative) state.siconos_residual /= size;
  return state;
}

void check_options(const LocalFrictionProblem& problem, const FrictionSolverOptions& options, const Vector& guess) {
  if (guess.size() != 0 && guess.size() != 2 * problem.contacts())
    fail("guess of the impulses: expected 2 x contacts = {} numbers, met {}", 2 * problem.contacts(), guess.size());
  if (!(options.tolerance > 0)) fail("tolerance: expected a number > 0, met {}", options.tolerance);
  if (!(options.relaxation > 0 && options.relaxation < 2))
    fail("relaxation: expected a number between 0 and 2, met {}", options.relaxation);
  if (options.maximum_factorisations < 0)
    fail("factorisations: expected a maximum >= 0, met {}", options.maximum_factorisations);
  if (options.maximum_sweeps < 0 || options.check_every < 1 || options.patience < 1)
    fail("sweeps: expected a maximum >= 0, checks every >= 1 sweep and a patience >= 1, met {}, {} and {}",
         options.maximum_sweeps, options.check_every, options.patience);
}

}  // namespace

FrictionState friction_state(const LocalFrictionProblem& problem, const Vector& impulses) {
  return state_of(problem, impulses, lone_impulses(problem));
}

SolverRun::SolverRun(const LocalFrictionProblem& given, const FrictionSolverOptions& chosen, const Vector& guess,
                     const FrictionObserver& observer)
    : problem(given), options(chosen), alone(lone_impulses(given)), observer_(observer) {
  const Index contacts = given.contacts();
  now.impulses = guess.size() == 0 ? Vector::Zero(2 * contacts) : guess;
  now.status = FrictionStatus::maximum_reached;
  scale_ = std::max(alone, now.impulses.norm());
  if (contacts > 0)
    scale_ = std::max(scale_, given.q.norm() * static_cast<double>(2 * contacts) / given.w.diagonal().sum());
}

double SolverRun::natural_maps() const { return now.state.residual * std::max(now.impulses.norm(), alone); }

bool SolverRun::plausible(const Vector& impulses) const { return impulses.norm() <= largest_impulses * scale_; }

Index SolverRun::changes_of_status() {
  const bool is_first = statuses_.empty();
  statuses_.resize(at(problem.contacts()));
  Index changes = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const ContactStatus status = contact_status(component(now.impulses, c), problem.friction[c]);
    if (std::exchange(statuses_[at(c)], status) != status) ++changes;
  }
  return is_first ? 0 : changes;
}

bool SolverRun::judge(const Vector& impulses, const FrictionStep& step) {
  now.impulses = impulses;
  now.state = state_of(problem, impulses, alone);
  now.step = step;
  now.status_changes = changes_of_status();
  if (plausible(impulses) && natural_maps() < best_maps_) {
    best_ = now;
    best_maps_ = natural_maps();
  }
  const bool go_on = !observer_ || observer_(now);
  // Where there is no solution impulses may grow without end, and next to them every residual looks small.
  const bool small = alone == 0 || natural_maps() <= std::max(largest_natural_maps, options.tolerance) * alone;
  if (!std::isfinite(now.state.residual))
    now.status = FrictionStatus::not_finite;
  else if (now.state.residual <= options.tolerance && small && plausible(impulses))
    now.status = FrictionStatus::converged;
  else if (!go_on)
    now.status = FrictionStatus::stopped;
  else
    return false;
  return true;
}

Vector SolverRun::projected() const {
  Vector result(now.impulses.size());
  for (Index c = 0; c < problem.contacts(); ++c) {
    const LocalVector r = component(now.impulses, c);
    const LocalVector m =
        natural_map(r, component(now.state.velocities, c), problem.friction[c], 1 / problem.w.coeff(2 * c, 2 * c));
    result.segment<2>(2 * c) << r.n - m.n, r.t - m.t;
  }
  return result;
}

FrictionSolution SolverRun::best() const {
  FrictionSolution solution = now.status == FrictionStatus::converged || best_maps_ == infinity ? now : best_;
  solution.sweeps = now.sweeps;
  solution.factorisations = now.factorisations;
  solution.status = now.status;
  return solution;
}

void SolverRun::go_back(const FrictionSolution& earlier) {
  now.impulses = earlier.impulses;
  now.state = earlier.state;
}

Couplings couplings(const LocalFrictionProblem& problem) {
  Couplings result;
  result.symmetric = 0.5 * (problem.w + SparseMatrix(problem.w.transpose()));
  result.rest = problem.w - result.symmetric;
  result.normal.resize(2 * problem.contacts());
  for (Index c = 0; c < problem.contacts(); ++c)
    result.normal[2 * c] = result.normal[2 * c + 1] = problem.w.coeff(2 * c, 2 * c);
  return result;
}

FrictionSolution solve_friction(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                                const Vector& guess, const FrictionObserver& observer) {
  check_options(problem, options, guess);
  SolverRun run(problem, options, guess, observer);
  contact_solvers[static_cast<std::size_t>(FrictionAlgorithm{options.algorithm})](run);
  return options.algorithm == FrictionAlgorithm::nlgs ? run.now : run.best();
}

}  // namespace nscdd
