// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/threads.hpp"
#include "mpi/slepc_pencil.hpp"
#include <nscdd/mpi/slepc.hpp>

namespace nscdd::mpi {
namespace {

constexpr int most_shifts = 200;      // on the way to one end
constexpr double between_shifts = 4;  // that are tried on the way to an end

// A shift beyond an end of the spectrum, where `wanted` eigenvalues lie above 1 / tau: none is further out, 1 / lambda
// of the end is less than half as large or as small again, and nearer to the shift than 0 is. None if there is no such
// shift on the way from `tau`, by steps outwards and then inwards.
std::optional<double> shift_next_to_end(SlepcPencil& pencil, double tau, bool low, Index wanted) {
  int shifts = 0;
  bool broken = false;
  const auto beyond = [&](double shift) {
    for (const double nudge : {1.0, 1.01, 0.99}) {
      tau = shift * nudge;
      if (const std::optional<Index> count = pencil.above(tau)) return *count == wanted;
    }
    broken = true;
    return false;
  };
  const double outwards = low ? between_shifts : 1 / between_shifts, inwards = low ? 1 / 1.4 : 1.4;
  while (!beyond(tau)) {
    if (broken || ++shifts > most_shifts) return std::nullopt;
    tau *= outwards;
  }
  double last = tau;
  for (; beyond(last * inwards); last = tau)
    if (++shifts > most_shifts) return std::nullopt;
  if (broken) return std::nullopt;
  return last * (low ? 1.1 : 0.9);  // not on an eigenvalue: 1 often is one
}

SpectralRadius radius(const Contraction& b, const SpectralOptions& options,
                      const std::shared_ptr<const Communicator>& all) {
  if (b.system.flexibility() == 0) fail("solver slepc: expected epsilon > 0, met 0: shift-invert has the rigid limit");
  const OneBlasThread serial_blas;
  const QuietPetsc quiet;
  SlepcPencil pencil(b, all, options);
  const auto end = [&](double tau, bool low) {  // and the shift it was found from
    const std::optional<double> shift = shift_next_to_end(pencil, tau, low, low ? b.rows() : 0);
    return std::pair(shift ? pencil.nearest(*shift) : std::nullopt, shift.value_or(1));
  };
  auto [low, shift] = end(1, true);  // lambda lies on both sides of 1 or next to it
  std::optional<PencilPair> high = end(shift, false).first;
  SpectralRadius result;
  if (!low || !high) return result;
  result.factorisations = pencil.factorisations;
  result.residual = std::max(low->residual, high->residual);
  result.low = {1 - high->lambda};
  result.high = {1 - low->lambda};
  result.mode_min = std::move(high->f);
  result.mode_max = std::move(low->f);
  return result;
}

}  // namespace

SpectrumSolver slepc(MPI_Comm communicator) {
  const auto all = std::make_shared<const Communicator>(communicator);
  const auto session = std::make_shared<std::shared_ptr<const SlepcSession>>();  // begins where it is asked for
  return [session, all](const Contraction& b, const SpectralOptions& options) {
    if (!*session) *session = SlepcSession::present();
    return radius(b, options, all);
  };
}

}  // namespace nscdd::mpi
