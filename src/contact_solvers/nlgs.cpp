// SPDX-License-Identifier: GPL-3.0-or-later
// Nonlinear Gauss-Seidel (Jean and Moreau) on W.
#include "contact_solvers/stall_watch.hpp"
#include "linalg/threads.hpp"

namespace nscdd {

template <int D>
bool sweep(SolverRun<D>& run, Index most) {
  const FrictionSolverOptions& options = run.options;
  const auto sweeps = run.problem.sweeps(options);
  const OneBlasThread serial_blas;  // for all sweeps: that of each is then cheap
  Vector impulses = run.now.impulses;
  const Index end = run.now.sweeps + most;
  StallWatch<D> watch(run);
  for (;;) {
    if (run.judge(impulses) || watch.ends(run)) return true;
    if (run.now.sweeps >= end) return false;
    const Index many = std::min(options.check_every, end - run.now.sweeps);
    impulses = sweeps(impulses, run.now.sweeps, many);
    run.now.sweeps += many;
    run.now.operations += static_cast<double>(many) * run.problem.product_operations;
  }
}

template <int D>
void nlgs(SolverRun<D>& run) {
  sweep(run, run.options.maximum_sweeps);
}

template bool sweep(SolverRun<2>&, Index);
template bool sweep(SolverRun<3>&, Index);
template void nlgs(SolverRun<2>&);
template void nlgs(SolverRun<3>&);

}  // namespace nscdd
