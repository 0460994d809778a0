// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/contact_solver.hpp"
#include "core/fail.hpp"
#include "mechanics/impulse_scale.hpp"

namespace nscdd {
namespace {

constexpr double credible_natural_maps = 1e-3;  // relative to max(|| r^1 ||, p)

// The length of a tangential impulse in space that is on the edge of the cone may come out below it.
template <int D>
constexpr double edge_rounding = D == 3 ? 1e-12 : 0;

constexpr double largest_impulses = 1e8;  // over those that are to be expected
constexpr double drift_of_guess = 1.001;  // a guess that is larger may change, not grow

constexpr Index checks_looked_back = 10;

// The solvers by the places of FrictionAlgorithm.
template <int D>
constexpr void (*contact_solvers[])(SolverRun<D>&) = {automatic<D>, continuation<D>, newton<D>,
                                                      nlgs<D>,      admm<D>,         apgd<D>};

// What `function` returns, called as function.template operator()<D>() with the dimension of the problem.
template <class Function>
auto in_dimension_of(const LocalFrictionProblem& problem, const Function& function) {
  return problem.dimension == 3 ? function.template operator()<3>() : function.template operator()<2>();
}

template <int D>
double trace(const FullDelassus<D>& w) {
  if constexpr (D == 2)
    return w.nn + w.tt;
  else
    return w.nn + w.tt.first + w.tt.second;
}

// || r^1 ||: impulses of the contacts, each alone.
template <int D>
double lone_impulses(const ContactProblem<D>& problem) {
  if (problem.alone) return *problem.alone;
  return std::sqrt(problem.sums.add_up(1, problem.contacts(), [&](Index c, auto&& squares) {
    const FullDelassus<D> w = problem.diagonal(c);
    squares[0] += squared(Coulomb{}.impulse(stopping(w, {}, component<D>(problem.q, c)), w, problem.friction[c]));
  })[0]);
}

// p: what the bodies that meet at the contacts bring.
template <int D>
double momenta(const ContactProblem<D>& problem) {
  return std::sqrt(problem.sums.add_up(1, problem.contacts(), [&](Index c, auto&& squares) {
    const double momentum = problem.speeds[c] / problem.normal[D * c];
    squares[0] += momentum * momentum;
  })[0]);
}

// Squares of the natural maps of every contact, with rho = 1 / W_nn and with rho = 1, and the status.
struct ContactCheck {
  double own, siconos;
  ContactStatus status;
};

// The contacts by themselves, in threads.
template <int D>
std::vector<ContactCheck> checked_contacts(const ContactProblem<D>& problem, const Vector& impulses,
                                           const Vector& velocities) {
  const Index contacts = problem.contacts();
  std::vector<ContactCheck> checks(at(contacts));
  for_parts(contacts, [&](const ContactRange& range) {
    for (Index c = range.first; c < range.last; ++c) {
      const LocalVector<D> r = component<D>(impulses, c), u = component<D>(velocities, c);
      const double mu = problem.friction[c];
      checks[at(c)] = {squared(natural_map(r, u, mu, 1 / problem.normal[D * c])), squared(natural_map(r, u, mu, 1)),
                       contact_status(r, mu, edge_rounding<D>)};
    }
  });
  return checks;
}

// The state under impulses of the norm `size`.
template <int D>
FrictionState state_of(const ContactProblem<D>& problem, double alone, double momenta, const Vector& impulses,
                       double size, double believed) {
  FrictionState state;
  state.velocities = problem.product(impulses) + problem.q;
  const std::vector<ContactCheck> checks = checked_contacts(problem, impulses, state.velocities);
  double largest = 0;
  const Vector sums = problem.sums.add_up(5, problem.contacts(), [&](Index c, auto&& sum) {
    const auto& [own, siconos, status] = checks[at(c)];
    if (own > largest) {
      largest = own;
      state.worst = c;
    }
    sum[0] += own;
    sum[1] += siconos;
    sum[status == ContactStatus::open ? 2 : status == ContactStatus::stick ? 3 : 4] += 1;
  });
  state.open = static_cast<Index>(sums[2]);
  state.stick = static_cast<Index>(sums[3]);
  state.slide = static_cast<Index>(sums[4]);
  // Velocities under impulses that grew beyond measure may vanish by rounding alone.
  const double unknown = size > believed ? rounding_of_sums * size : 0;
  const double maps = std::sqrt(sums[0]) + unknown, driving = std::max(alone, momenta);
  state.scale = natural_map_scale(maps, size, alone, momenta, false, believed);
  if (maps != 0) {  // nor a number
    state.residual = maps / state.scale;
    state.driven_residual = maps / driving;
  }
  state.siconos_residual = std::sqrt(sums[1]);
  const double scale = std::max({size, problem.sums.norm(state.velocities), problem.sums.norm(problem.q)});
  state.siconos_relative = scale > std::numeric_limits<double>::epsilon();
  if (state.siconos_relative) state.siconos_residual /= scale;
  return state;
}

void check_options(Index dimension, Index contacts, const FrictionSolverOptions& options, const Vector& guess) {
  if (guess.size() != 0 && guess.size() != dimension * contacts)
    fail("guess of the impulses: expected {} x contacts = {} numbers, met {}", dimension, dimension * contacts,
         guess.size());
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
  return in_dimension_of(problem, [&]<int D>() {
    const ContactProblem<D> stored = stored_contacts<D>(problem);
    return state_of(stored, lone_impulses(stored), momenta(stored), impulses, impulses.norm(), infinity);
  });
}

std::vector<Index> contacts_with_residual(const LocalFrictionProblem& problem, const FrictionSolution& solution,
                                          double share) {
  std::vector<std::pair<double, Index>> carried;  // squares, with a sign that sorts
  double sum = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const double square = in_dimension_of(problem, [&]<int D>() {
      return squared(natural_map(component<D>(solution.impulses, c), component<D>(solution.state.velocities, c),
                                 problem.friction[c], 1 / problem.w.coeff(D * c, D * c)));
    });
    carried.emplace_back(-square, c);
    sum += square;
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

template <int D>
SolverRun<D>::SolverRun(const ContactProblem<D>& given, const FrictionSolverOptions& chosen, const Vector& guess,
                        const FrictionObserver& observer)
    : problem(given), options(chosen), alone(lone_impulses(given)), observer_(observer), momenta_(momenta(given)) {
  now.impulses = guess.size() == 0 ? Vector::Zero(D * given.contacts()) : guess;
  now.status = FrictionStatus::maximum_reached;
  expected_ = std::max(alone, momenta_);
  guessed_ = given.sums.norm(now.impulses);
  const double traces =
      given.sums.add_up(1, given.contacts(), [&](Index c, auto&& sum) { sum[0] += trace(given.diagonal(c)); })[0];
  const Index contacts = given.sums.total(given.contacts());
  if (contacts > 0)
    expected_ = std::max(expected_, given.sums.norm(given.q) * static_cast<double>(D * contacts) / traces);
}

template <int D>
double SolverRun<D>::natural_maps() const {
  return now.state.residual * now.state.scale;
}

template <int D>
bool SolverRun<D>::plausible(const Vector& impulses) const {
  return plausible(problem.sums.norm(impulses));
}

// A guess may be the state of a network at rest. One that grew without bound must not make room for more growth.
template <int D>
double SolverRun<D>::largest_plausible() const {
  return std::max(largest_impulses * expected_, drift_of_guess * guessed_);
}

template <int D>
bool SolverRun<D>::plausible(double size) const {
  return size <= largest_plausible();
}

template <int D>
Index SolverRun<D>::changes_of_status() {
  const bool is_first = checks_ == 0;
  statuses_.resize(at(problem.contacts()));
  changed_.resize(at(problem.contacts()));
  Index changes = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const ContactStatus status = contact_status(component<D>(now.impulses, c), problem.friction[c], edge_rounding<D>);
    if (std::exchange(statuses_[at(c)], status) == status) continue;
    ++changes;
    changed_[at(c)] = checks_;
  }
  ++checks_;
  return is_first ? 0 : problem.sums.total(changes);
}

template <int D>
std::vector<Index> SolverRun<D>::unsettled() const {
  std::vector<Index> contacts;
  for (Index c = 0; c < count(changed_); ++c)  // at the first check all were unknown
    if (changed_[at(c)] > std::max<Index>(0, checks_ - 1 - checks_looked_back)) contacts.push_back(c);
  return contacts;
}

template <int D>
bool SolverRun<D>::judge(const Vector& impulses, const FrictionStep& step) {
  using Clock = std::chrono::steady_clock;
  now.seconds += std::chrono::duration<double>(Clock::now() - resumed_).count();
  const bool over = decide(impulses, step);
  resumed_ = Clock::now();
  return over;
}

template <int D>
bool SolverRun<D>::decide(const Vector& impulses, const FrictionStep& step) {
  now.impulses = impulses;
  const double size = problem.sums.norm(impulses);
  now.state = state_of(problem, alone, momenta_, impulses, size, largest_plausible());
  const double maps = natural_maps();
  now.step = step;
  now.status_changes = changes_of_status();
  if (plausible(size) && maps < best_maps_) {
    best_ = now;
    best_maps_ = maps;
  }
  const double rounding = rounding_of_sums * std::min(size, drift_of_guess * guessed_);  // of a network at rest
  now.credible = maps <= rounding || expected_ == 0 || size <= expected_ ||
                 (maps <= std::max(credible_natural_maps, options.tolerance) * std::max(alone, momenta_) &&
                  size <= largest_impulses * expected_);
  const bool go_on = !observer_ || observer_(now);
  if (!std::isfinite(now.state.residual))
    now.status = FrictionStatus::not_finite;
  else if (now.state.residual <= options.tolerance)
    now.status = FrictionStatus::converged;
  else if (!go_on)
    now.status = FrictionStatus::stopped;
  else
    return false;
  return true;
}

template <int D>
Vector SolverRun<D>::projected() const {
  Vector result(now.impulses.size());
  for (Index c = 0; c < problem.contacts(); ++c) {
    const LocalVector<D> r = component<D>(now.impulses, c);
    const LocalVector<D> u = component<D>(now.state.velocities, c);
    set_component(result, c, r - natural_map(r, u, problem.friction[c], 1 / problem.normal[D * c]));
  }
  return result;
}

template <int D>
FrictionSolution SolverRun<D>::best() const {
  FrictionSolution solution = now.status == FrictionStatus::converged || best_maps_ == infinity ? now : best_;
  solution.sweeps = now.sweeps;
  solution.factorisations = now.factorisations;
  solution.operations = now.operations;
  solution.seconds = now.seconds;
  solution.status = now.status;
  return solution;
}

template <int D>
void SolverRun<D>::go_back(const FrictionSolution& earlier) {
  now.impulses = earlier.impulses;
  now.state = earlier.state;
}

FrictionSolution solve_friction(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                                const Vector& guess, const FrictionObserver& observer) {
  if (problem.dimension != 2 && problem.dimension != 3) fail("dimension: expected 2 or 3, met {}", problem.dimension);
  check_options(problem.dimension, problem.contacts(), options, guess);
  return in_dimension_of(
      problem, [&]<int D>() { return solve_contacts(stored_contacts<D>(problem), options, guess, observer); });
}

template <int D>
FrictionSolution solve_contacts(const ContactProblem<D>& problem, const FrictionSolverOptions& options,
                                const Vector& guess, const FrictionObserver& observer) {
  check_options(D, problem.contacts(), options, guess);
  SolverRun<D> run(problem, options, guess, observer);
  contact_solvers<D>[static_cast<std::size_t>(FrictionAlgorithm{options.algorithm})](run);
  FrictionSolution solution = options.algorithm == FrictionAlgorithm::nlgs ? run.now : run.best();
  solution.unsettled = run.unsettled();
  return solution;
}

template class SolverRun<2>;
template class SolverRun<3>;
template FrictionSolution solve_contacts(const ContactProblem<2>&, const FrictionSolverOptions&, const Vector&,
                                         const FrictionObserver&);
template FrictionSolution solve_contacts(const ContactProblem<3>&, const FrictionSolverOptions&, const Vector&,
                                         const FrictionObserver&);

}  // namespace nscdd
