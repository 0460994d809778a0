// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/contact_law.hpp"
#include "mechanics/gauss_seidel.hpp"
#include <nscdd/mechanics/friction_solver.hpp>

#include <map>

namespace nscdd {
namespace {

constexpr double progress_wanted = 0.99;  // of the smallest residual, within `patience` checks
constexpr double growth_allowed = 1e12;

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

using Block = std::array<std::array<double, 2>, 2>;  // of a pair of contacts, (n, t) x (n, t)

// W as compressed rows of 2 x 2 blocks. The diagonal blocks are stored again for the law.
struct BlockRows {
  std::vector<Index> start{0};
  std::vector<int> contact;
  std::vector<Block> block;
  std::vector<FullDelassus> diagonal;
};

BlockRows block_rows(const LocalFrictionProblem& problem) {
  const SparseRows w = problem.w;
  BlockRows rows;
  for (Index c = 0; c < problem.contacts(); ++c) {
    std::map<Index, Block> row;
    for (const Index i : {2 * c, 2 * c + 1})
      for (SparseRows::InnerIterator e(w, i); e; ++e) row[e.col() / 2][at(i % 2)][at(e.col() % 2)] = e.value();
    for (const auto& [contact, block] : row) {
      rows.contact.push_back(static_cast<int>(contact));
      rows.block.push_back(block);
    }
    rows.start.push_back(count(rows.contact));
    rows.diagonal.push_back(diagonal_block(problem, c));
  }
  return rows;
}

LocalVector component(const Vector& values, Index c) { return {values[2 * c], values[2 * c + 1]}; }

// Velocity of contact c under the present impulses. Calls of this function and the next one would take as
// long as they do themselves, hence `inline`.
inline LocalVector velocity(const BlockRows& rows, const Vector& q, const Vector& impulses, Index c) {
  LocalVector u = component(q, c);
  for (Index k = rows.start[at(c)]; k < rows.start[at(c + 1)]; ++k) {
    const Block& b = rows.block[at(k)];
    const Index other = 2 * static_cast<Index>(rows.contact[at(k)]);
    const double n = impulses[other], t = impulses[other + 1];
    u.n += b[0][0] * n + b[0][1] * t;
    u.t += b[1][0] * n + b[1][1] * t;
  }
  return u;
}

// The impulse that would bring contact c to rest, the others held:  r_c - W_c^-1 u_c.
inline LocalVector stopping(const FullDelassus& w, LocalVector impulse, LocalVector u) { return impulse - w.solve(u); }

template <bool relaxed>
void sweep_once(const BlockRows& rows, const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                Vector& impulses) {
  const Index contacts = problem.contacts();
  for (Index k = 0; k < contacts; ++k) {
    const Index c = options.order == SweepOrder::natural ? k : contacts - 1 - k;
    const FullDelassus& w = rows.diagonal[at(c)];
    LocalVector r = component(impulses, c);
    const LocalVector stop = stopping(w, r, velocity(rows, problem.q, impulses, c));
    take_impulse<relaxed>(r, Coulomb{}.impulse(stop, w, problem.friction[c]), options.relaxation);
    impulses[2 * c] = r.n;
    impulses[2 * c + 1] = r.t;
  }
}

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
  double squares = 0, siconos_squares = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const LocalVector r = component(impulses, c), u = component(state.velocities, c);
    const double mu = problem.friction[c];
    squares += squared(natural_map(r, u, mu, 1 / problem.w.coeff(2 * c, 2 * c)));
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
  if (options.maximum_sweeps < 0 || options.check_every < 1 || options.patience < 1)
    fail("sweeps: expected a maximum >= 0, checks every >= 1 sweep and a patience >= 1, met {}, {} and {}",
         options.maximum_sweeps, options.check_every, options.patience);
}

}  // namespace

FrictionState friction_state(const LocalFrictionProblem& problem, const Vector& impulses) {
  return state_of(problem, impulses, lone_impulses(problem));
}

FrictionSolution solve_friction(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                                const Vector& guess, const FrictionObserver& observer) {
  check_options(problem, options, guess);
  FrictionSolution solution;
  solution.impulses = guess.size() == 0 ? Vector::Zero(2 * problem.contacts()) : guess;
  const BlockRows rows = block_rows(problem);
  const double alone = lone_impulses(problem);
  const double scale = std::max(alone, solution.impulses.norm());
  ProgressWatch<FrictionStatus> watch(
      {.tolerance = options.tolerance, .growth = growth_allowed, .fall = progress_wanted, .patience = options.patience},
      FrictionStatus::not_finite);
  for (Index check = 0;; ++check) {
    solution.state = state_of(problem, solution.impulses, alone);
    const auto over = watch.judge(check, solution.state.residual, solution.impulses.norm(), scale);
    const bool go_on = !observer || observer(solution);
    if (over || !go_on || solution.sweeps >= options.maximum_sweeps) {
      solution.status = over ? *over : go_on ? FrictionStatus::maximum_reached : FrictionStatus::stopped;
      return solution;
    }
    const Index many = std::min(options.check_every, options.maximum_sweeps - solution.sweeps);
    for (Index k = 0; k < many; ++k)
      options.relaxation == 1 ? sweep_once<false>(rows, problem, options, solution.impulses)
                              : sweep_once<true>(rows, problem, options, solution.impulses);
    solution.sweeps += many;
  }
}

}  // namespace nscdd
