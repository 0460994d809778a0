// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/solver_run.hpp"

#include "mechanics/contact_residual.hpp"

namespace nscdd {
namespace {

constexpr double credible_natural_maps = 1e-3;  // relative to max(|| r^1 ||, p)

// In space the length of a tangential impulse on the edge of the cone may be rounded to below it.
template <int D>
constexpr double edge_rounding = D == 3 ? 1e-12 : 0;

constexpr double largest_impulses = 1e8;  // over those to be expected
constexpr double drift_of_guess = 1.001;  // growth of a larger guess

constexpr Index unsettled_checks = 10;

struct ContactCheck {
  double own, siconos;  // squares of the natural maps with rho = 1 / W_nn and with rho = 1
  ContactStatus status;
};

template <int D>
std::vector<ContactCheck> checked_contacts(const ContactData& data, const Vector& impulses, const Vector& velocities) {
  const Index contacts = data.contacts();
  std::vector<ContactCheck> checks(at(contacts));
  for_parts(contacts, [&](const ContactRange& range) {
    for (Index c = range.first; c < range.last; ++c) {
      const LocalVector<D> r = component<D>(impulses, c), u = component<D>(velocities, c);
      const double mu = data.friction[c];
      checks[at(c)] = {squared(natural_map(r, u, mu, 1 / data.normal[D * c])), squared(natural_map(r, u, mu, 1)),
                       contact_status(r, mu, edge_rounding<D>)};
    }
  });
  return checks;
}

}  // namespace

template <int D>
FrictionState SolverRun<D>::state_of(const ContactData& data, const Vector& impulses, Vector velocities, double size,
                                     double believed) {
  FrictionState state;
  state.velocities = std::move(velocities);
  const std::vector<ContactCheck> checks = checked_contacts<D>(data, impulses, state.velocities);
  double largest = 0;
  const Vector sums = data.sums.add_up(5, data.contacts(), [&](Index c, auto&& sum) {
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
  // Velocities under impulses that grew so far may vanish only by rounding.
  const double unknown = size > believed ? rounding_of_sums * size : 0;
  const double maps = std::sqrt(sums[0]) + unknown, driving = std::max(data.alone, data.momenta);
  state.scale = natural_map_scale(maps, size, data.alone, data.momenta, false, believed);
  if (maps != 0) {  // NaN included
    state.residual = maps / state.scale;
    state.driven_residual = maps / driving;
  }
  state.siconos_residual = std::sqrt(sums[1]);
  const double scale = std::max({size, data.sums.norm(state.velocities), data.sums.norm(data.q)});
  state.siconos_relative = scale > std::numeric_limits<double>::epsilon();
  if (state.siconos_relative) state.siconos_residual /= scale;
  return state;
}

template <int D>
SolverRun<D>::SolverRun(const ContactData& given, Product product, const FrictionSolverOptions& chosen,
                        const Vector& guess, const FrictionObserver& observer)
    : data(given), options(chosen), product_(std::move(product)), observer_(observer) {
  now.impulses = guess.size() == 0 ? Vector::Zero(D * data.contacts()) : guess;
  now.status = FrictionStatus::maximum_reached;
  expected_ = std::max(data.alone, data.momenta);
  guessed_ = data.sums.norm(now.impulses);
  if (const Index contacts = data.sums.total(data.contacts()); contacts > 0)
    expected_ = std::max(expected_, data.sums.norm(data.q) * static_cast<double>(D * contacts) / data.trace);
}

// A large guess may be the state of a network at rest; one that grew without bound must not allow more growth.
template <int D>
double SolverRun<D>::largest_plausible() const {
  return std::max(largest_impulses * expected_, drift_of_guess * guessed_);
}

template <int D>
Index SolverRun<D>::changes_of_status() {
  const bool is_first = checks_ == 0;
  statuses_.resize(at(data.contacts()));
  changed_.resize(at(data.contacts()));
  Index changes = 0;
  for (Index c = 0; c < data.contacts(); ++c) {
    const ContactStatus status = contact_status(component<D>(now.impulses, c), data.friction[c], edge_rounding<D>);
    if (std::exchange(statuses_[at(c)], status) == status) continue;
    ++changes;
    changed_[at(c)] = checks_;
  }
  ++checks_;
  return is_first ? 0 : data.sums.total(changes);
}

template <int D>
std::vector<Index> SolverRun<D>::unsettled() const {
  std::vector<Index> contacts;
  for (Index c = 0; c < count(changed_); ++c)  // changes at the first check do not count
    if (changed_[at(c)] > std::max<Index>(0, checks_ - 1 - unsettled_checks)) contacts.push_back(c);
  return contacts;
}

template <int D>
bool SolverRun<D>::judge(const Vector& impulses, const FrictionStep& step) {
  now.seconds += seconds_since(resumed_);
  const bool over = decide(impulses, step);
  resumed_ = Clock::now();
  return over;
}

template <int D>
bool SolverRun<D>::decide(const Vector& impulses, const FrictionStep& step) {
  now.impulses = impulses;
  const double size = data.sums.norm(impulses);
  now.state = state_of(data, impulses, product_(impulses) + data.q, size, largest_plausible());
  const double maps = now.state.residual * now.state.scale;  // || m ||, N s
  now.step = step;
  now.status_changes = changes_of_status();
  const double rounding = rounding_of_sums * std::min(size, drift_of_guess * guessed_);  // of a network at rest
  now.credible = maps <= rounding || expected_ == 0 || size <= expected_ ||
                 (maps <= std::max(credible_natural_maps, options.tolerance) * std::max(data.alone, data.momenta) &&
                  size <= largest_impulses * expected_);
  if (size <= largest_plausible()) keep_better(now);
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
  for (Index c = 0; c < data.contacts(); ++c) {
    const LocalVector<D> r = component<D>(now.impulses, c), u = component<D>(now.state.velocities, c);
    set_component(result, c, r - natural_map(r, u, data.friction[c], 1 / data.normal[D * c]));
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
void SolverRun<D>::keep_better(const FrictionSolution& found) {
  const double maps = found.state.residual * found.state.scale;  // || m ||, N s
  if (!(maps < best_maps_)) return;
  best_ = found;
  best_maps_ = maps;
}

template <int D>
void SolverRun<D>::begin_again() {
  now.impulses.setZero();
  now.status = FrictionStatus::maximum_reached;
  changed_.clear();
  checks_ = 0;
  guessed_ = 0;
  best_maps_ = infinity;
}

template class SolverRun<2>;
template class SolverRun<3>;

}  // namespace nscdd
