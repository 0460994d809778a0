// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

constexpr double largest_natural_maps = 1e-3;  // of a solution, relative to the impulses of the contacts each alone

constexpr double largest_impulses = 1e8;  // over those that are to be expected

constexpr Index checks_looked_back = 10;

// The solvers by the places of FrictionAlgorithm.
constexpr void (*contact_solvers[])(SolverRun&) = {automatic, continuation, newton, nlgs, admm, apgd};

// || r^1 ||: impulses of the contacts, each alone.
double lone_impulses(const LocalFrictionProblem& problem) {
  double squares = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const FullDelassus w = diagonal_block(problem, c);
    squares += squared(Coulomb{}.impulse(stopping(w, {}, component(problem.q, c)), w, problem.friction[c]));
  }
  return std::sqrt(squares);
}

JudgedProblem judged_problem(const LocalFrictionProblem& problem) {
  JudgedProblem judged{ContactBlocks(problem.w), Vector(problem.contacts()), lone_impulses(problem)};
  for (Index c = 0; c < problem.contacts(); ++c) judged.normal[c] = problem.w.coeff(2 * c, 2 * c);
  return judged;
}

// Squares of the natural maps of every contact, with rho = 1 / W_nn and with rho = 1, and the status.
struct ContactCheck {
  double own, siconos;
  ContactStatus status;
};

// The contacts by themselves, in threads.
std::vector<ContactCheck> checked_contacts(const JudgedProblem& judged, const LocalFrictionProblem& problem,
                                           const Vector& impulses, Vector& velocities) {
  const Index contacts = problem.contacts();
  std::vector<ContactCheck> checks(at(contacts));
  for_parts(contacts, [&](const ContactRange& range) {
    for (Index c = range.first; c < range.last; ++c) {
      const LocalVector<2> r = component(impulses, c), u = judged.w.add_row(c, impulses, {}) + component(problem.q, c);
      velocities.segment<2>(2 * c) << u.n, u.t;
      const double mu = problem.friction[c];
      checks[at(c)] = {squared(natural_map(r, u, mu, 1 / judged.normal[c])), squared(natural_map(r, u, mu, 1)),
                       contact_status(r, mu)};
    }
  });
  return checks;
}

FrictionState state_of(const JudgedProblem& judged, const LocalFrictionProblem& problem, const Vector& impulses) {
  FrictionState state;
  state.velocities.resize(impulses.size());
  const std::vector<ContactCheck> checks = checked_contacts(judged, problem, impulses, state.velocities);
  double squares = 0, siconos_squares = 0, largest = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const auto& [own, siconos, status] = checks[at(c)];
    squares += own;
    if (own > largest) {
      largest = own;
      state.worst = c;
    }
    siconos_squares += siconos;
    ++(status == ContactStatus::open ? state.open : status == ContactStatus::stick ? state.stick : state.slide);
  }
  state.residual = squares == 0 ? 0 : std::sqrt(squares) / std::max(impulses.norm(), judged.alone);
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
  if (options.seed < 0) fail("seed: expected a number >= 0, met {}", options.seed);
}

}  // namespace

FrictionState friction_state(const LocalFrictionProblem& problem, const Vector& impulses) {
  return state_of(judged_problem(problem), problem, impulses);
}

std::vector<Index> contacts_with_residual(const LocalFrictionProblem& problem, const FrictionSolution& solution,
                                          double share) {
  std::vector<std::pair<double, Index>> carried;  // squares, with a sign that sorts
  double sum = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const LocalVector<2> m = natural_map(component(solution.impulses, c), component(solution.state.velocities, c),
                                         problem.friction[c], 1 / problem.w.coeff(2 * c, 2 * c));
    carried.emplace_back(-squared(m), c);
    sum += squared(m);
  }
  std::sort(carried.begin(), carried.end());
  std::vector<Index> contacts;
  double held = 0;
  for (std::size_t k = 0; k < carried.size() && held < share * sum; ++k) {
    held -= carried[k].first;
    contacts.push_back(carried[k].second);
  }
  return contacts;
}

SolverRun::SolverRun(const LocalFrictionProblem& given, const FrictionSolverOptions& chosen, const Vector& guess,
                     const FrictionObserver& observer, const RelationSolver& relations)
    : problem(given), options(chosen), linear(relations), judged(judged_problem(given)), observer_(observer) {
  const Index contacts = given.contacts();
  now.impulses = guess.size() == 0 ? Vector::Zero(2 * contacts) : guess;
  now.status = FrictionStatus::maximum_reached;
  scale_ = std::max(judged.alone, now.impulses.norm());
  if (contacts > 0)
    scale_ = std::max(scale_, given.q.norm() * static_cast<double>(2 * contacts) / given.w.diagonal().sum());
}

double SolverRun::natural_maps() const { return now.state.residual * std::max(now.impulses.norm(), judged.alone); }

bool SolverRun::plausible(const Vector& impulses) const { return impulses.norm() <= largest_impulses * scale_; }

Index SolverRun::changes_of_status() {
  const bool is_first = statuses_.empty();
  statuses_.resize(at(problem.contacts()));
  changed_.resize(at(problem.contacts()));
  Index changes = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const ContactStatus status = contact_status(component(now.impulses, c), problem.friction[c]);
    if (std::exchange(statuses_[at(c)], status) == status) continue;
    ++changes;
    changed_[at(c)] = checks_;
  }
  ++checks_;
  return is_first ? 0 : changes;
}

std::vector<Index> SolverRun::unsettled() const {
  std::vector<Index> contacts;
  for (Index c = 0; c < count(changed_); ++c)  // at the first check all were unknown
    if (changed_[at(c)] > std::max<Index>(0, checks_ - 1 - checks_looked_back)) contacts.push_back(c);
  return contacts;
}

bool SolverRun::judge(const Vector& impulses, const FrictionStep& step) {
  using Clock = std::chrono::steady_clock;
  now.seconds += std::chrono::duration<double>(Clock::now() - resumed_).count();
  const bool over = decide(impulses, step);
  resumed_ = Clock::now();
  return over;
}

bool SolverRun::decide(const Vector& impulses, const FrictionStep& step) {
  now.impulses = impulses;
  now.state = state_of(judged, problem, impulses);
  now.step = step;
  now.status_changes = changes_of_status();
  if (plausible(impulses) && natural_maps() < best_maps_) {
    best_ = now;
    best_maps_ = natural_maps();
  }
  const bool small =
      judged.alone == 0 || natural_maps() <= std::max(largest_natural_maps, options.tolerance) * judged.alone;
  now.credible = small && plausible(impulses);
  const bool go_on = !observer_ || observer_(now);
  if (!std::isfinite(now.state.residual))
    now.status = FrictionStatus::not_finite;
  else if (now.state.residual <= options.tolerance && now.credible)
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
    const LocalVector<2> r = component(now.impulses, c);
    const LocalVector<2> m =
        natural_map(r, component(now.state.velocities, c), problem.friction[c], 1 / judged.normal[c]);
    result.segment<2>(2 * c) << r.n - m.n, r.t - m.t;
  }
  return result;
}

FrictionSolution SolverRun::best() const {
  FrictionSolution solution = now.status == FrictionStatus::converged || best_maps_ == infinity ? now : best_;
  solution.sweeps = now.sweeps;
  solution.factorisations = now.factorisations;
  solution.operations = now.operations;
  solution.seconds = now.seconds;
  solution.status = now.status;
  return solution;
}

void SolverRun::go_back(const FrictionSolution& earlier) {
  now.impulses = earlier.impulses;
  now.state = earlier.state;
}

Couplings::Couplings(const LocalFrictionProblem& problem, const RelationSolver& solver)
    : symmetric(0.5 * (problem.w + SparseMatrix(problem.w.transpose()))),
      rest(problem.w - symmetric),
      blocks(symmetric),
      normal(2 * problem.contacts()),
      matrix(solver) {
  if (!matrix.factorise) {
    const auto whole = std::make_shared<std::optional<ContactMatrix>>();  // made when it is asked for
    matrix.factorise = [whole, this, &problem](std::vector<ContactRelation> relations) {
      if (!*whole) whole->emplace(problem, symmetric);
      return (*whole)->factorise(std::move(relations));
    };
    matrix.solve = [whole](const Vector& b) { return (*whole)->solve(b); };
    matrix.take_operations = [whole] { return (*whole)->take_operations(); };
    matrix.determinant_sign = [whole] { return (*whole)->determinant_sign(); };
  }
  for (Index c = 0; c < problem.contacts(); ++c) normal[2 * c] = normal[2 * c + 1] = problem.w.coeff(2 * c, 2 * c);
}

FrictionSolution solve_friction(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                                const Vector& guess, const FrictionObserver& observer) {
  return solve_friction(problem, options, guess, observer, {});
}

FrictionSolution solve_friction(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                                const Vector& guess, const FrictionObserver& observer, const RelationSolver& linear) {
  check_options(problem, options, guess);
  SolverRun run(problem, options, guess, observer, linear);
  contact_solvers[static_cast<std::size_t>(FrictionAlgorithm{options.algorithm})](run);
  FrictionSolution solution = options.algorithm == FrictionAlgorithm::nlgs ? run.now : run.best();
  solution.unsettled = run.unsettled();
  return solution;
}

}  // namespace nscdd
