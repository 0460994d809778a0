// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/study.hpp>

#include <string>

namespace nscdd {

/// Bytes that a sweep of a model is expected to hold at its peak, known before it begins. With n_Gamma
/// interface unknowns, n grain unknowns (copies included), z impulses and interface unknowns of an inexact
/// Stage 1:
///     model and Stage 1       model_bytes n + local modes of small subdomains, sum (d n_E)^2 8
///     dense pencil            dense_matrices n_Gamma^2 8 (rigid_dense_matrices where epsilon = 0 occurs)
///     shift-invert            shift_fill s b log2(s) 8 + shift_bytes n + program_bytes; s = n + n_Gamma rows
///                             of the saddle point (2 n + n_Gamma with a finite eta), b = s / unknowns of the
///                             undivided packing
///     ARPACK                  factors factor_fill n log2(n) 8 + 8 (basis + 5) n_Gamma
///     inexact Stage 1, dense  inexact_matrices z^2 8
/// and of the last four the largest that the options may choose.
/// Dense counts are exact but for lower-order terms; the fill is an estimate for planar networks (see
/// memory.cpp).
double estimated_bytes(const Model& model, const SweepParameters& parameters);

/// The same for the impulses of `link_rows` (active or unilateral; the model alone where nothing is
/// prescribed), and for the ranks of `inspect`: rank_bytes (n + contacts) log2(n + contacts) beside the
/// model; up to 4 000 contacts the impulses of the linear rigid problem come from dense matrices, of as many
/// rows as the packing has unknowns.
double estimated_link_bytes(const Model& model, ContactSet contacts);
double estimated_rank_bytes(const Model& model);

/// The case of a table that needs most.
struct MemoryNeed {
  double bytes = 0;
  std::string name;          ///< of the case
  Index interface_size = 0;  ///< its n_Gamma
};

/// Looks at every case that rows from `first` on belong to, building one at a time. No need for links and
/// grains. Throws Error naming the case where one cannot be built.
MemoryNeed largest_need(const StudyTable& table, Index first = 0);

}  // namespace nscdd
