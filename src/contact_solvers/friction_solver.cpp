// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/solve_contacts.hpp"
#include "contact_solvers/stored_contacts.hpp"
#include "core/fail.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>

namespace nscdd {
void check_options(Index dimension, Index contacts, const FrictionSolverOptions& options, const Vector& guess) {
  if (guess.size() != 0 && guess.size() != dimension * contacts)
    fail("guess of the impulses: expected {} x contacts = {} numbers, met {}", dimension, dimension * contacts,
         guess.size());
  FrictionSolverOptions::fields(
      options, [](std::string_view key, const auto& value, const Field& field) { check_bounds(value, field, key); });
  if (options.relaxation == 2) fail("relaxation: expected a number between 0 and 2, met 2");
  if (options.patience < 1) fail("patience: expected an integer >= 1, met {}", options.patience);
}

FrictionState friction_state(const LocalFrictionProblem& problem, const Vector& impulses) {
  if (impulses.size() != problem.size())
    fail("impulses: expected {} x contacts, {}, met {}", problem.dimension, problem.size(), impulses.size());
  return in_dimension(problem, [&](auto dimension) {
    constexpr int D = dimension();
    const StoredContacts<D> stored(problem);
    return SolverRun<D>::state_of(stored.data, impulses, stored.product(impulses) + problem.q, impulses.norm(),
                                  infinity);
  });
}

std::vector<Index> contacts_with_residual(const LocalFrictionProblem& problem, const FrictionSolution& solution,
                                          double share) {
  std::vector<std::pair<double, Index>> carried;  // squares, with a sign that sorts
  double sum = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const double square = in_dimension(problem, [&](auto dimension) {
      constexpr int D = dimension();
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

FrictionSolution solve_friction(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                                const Vector& guess, const FrictionObserver& observer) {
  if (problem.dimension != 2 && problem.dimension != 3) fail("dimension: expected 2 or 3, met {}", problem.dimension);
  return in_dimension(problem, [&](auto dimension) {
    constexpr int D = dimension();
    StoredContacts<D> stored(problem);
    return solve_contacts(stored, options, guess, observer);
  });
}

template FrictionSolution solve_contacts(StoredContacts<2>&, const FrictionSolverOptions&, const Vector&,
                                         const FrictionObserver&);
template FrictionSolution solve_contacts(StoredContacts<3>&, const FrictionSolverOptions&, const Vector&,
                                         const FrictionObserver&);

}  // namespace nscdd
