// SPDX-License-Identifier: GPL-3.0-or-later
// Nonlinear Gauss-Seidel (Jean and Moreau) on W.
#include "mechanics/contact_solvers/contact_solver.hpp"
#include "mechanics/gauss_seidel.hpp"

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

// Velocity of contact c under the present impulses. A call would take as long as it does itself, hence `inline`.
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

}  // namespace

bool sweep(SolverRun& run, Index most) {
  const FrictionSolverOptions& options = run.options;
  const BlockRows rows = block_rows(run.problem);
  Vector impulses = run.now.impulses;
  const double scale = std::max(run.alone, impulses.norm());
  const Index end = run.now.sweeps + most;
  ProgressWatch<FrictionStatus> watch({.tolerance = -1,  // `judge` says what has converged
                                       .growth = growth_allowed,
                                       .fall = progress_wanted,
                                       .patience = options.patience},
                                      FrictionStatus::not_finite);
  for (Index check = 0;; ++check) {
    if (run.judge(impulses)) return true;
    if (const auto over = watch.judge(check, run.now.state.residual, impulses.norm(), scale)) {
      run.now.status = *over;
      return true;
    }
    if (run.now.sweeps >= end) return false;
    const Index many = std::min(options.check_every, end - run.now.sweeps);
    for (Index k = 0; k < many; ++k)
      options.relaxation == 1 ? sweep_once<false>(rows, run.problem, options, impulses)
                              : sweep_once<true>(rows, run.problem, options, impulses);
    run.now.sweeps += many;
  }
}

void nlgs(SolverRun& run) { sweep(run, run.options.maximum_sweeps); }

}  // namespace nscdd
