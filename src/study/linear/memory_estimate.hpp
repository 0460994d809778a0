// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/tables/study.hpp"

namespace nscdd {

/// Memory that some work on a case is estimated to need at its peak.
struct MemoryNeed {
  double bytes = 0;
  std::string name;    ///< of the case
  std::string what;    ///< takes the memory
  std::string advice;  ///< what may help
};

/// A sweep of a model. With n_Gamma interface unknowns, n grain unknowns (copies included), and z impulses and
/// interface unknowns of an inexact Stage 1 it adds up
///     model and Stage 1       model_bytes n + local modes of small subdomains, sum (d n_E)^2 8
///     dense pencil            dense_matrices n_Gamma^2 8 (rigid_dense_matrices where epsilon = 0 occurs)
///     shift-invert            shift_fill s b log2(s) 8 + shift_bytes n + program_bytes, where the saddle point has
///                             s = n + n_Gamma rows (2 n + n_Gamma with a finite eta) and b is s over the
///                             unknowns of the undivided packing; in space shift_fill_space b s^(4/3) 8 in its
///                             first term
///     ARPACK                  factors factor_fill n log2(n) 8 + 8 (basis + 5) n_Gamma
///     inexact Stage 1, dense  inexact_matrices z^2 8
/// Of the last four lines only the largest counts that the options may choose. Counts of dense matrices are
/// exact up to terms of lower order. The fill of factors is an estimate, for planar networks and for those in space;
/// the source file tells what its constants were fitted to.
MemoryNeed sweep_need(const Model& model, const SweepParameters& parameters);

/// The impulses of `links`, and the ranks of `inspect`. Beside the model, which is all that is needed where
/// nothing is prescribed, both take rank_bytes m log2(m) bytes with m = n + contacts, in space
/// rank_bytes_space m^(4/3). Up to `dense_impulse_limit`
/// contacts the impulses of the linear rigid problem come from dense matrices instead, with as many rows as the
/// packing has unknowns.
MemoryNeed link_need(const Model& model, ContactSet contacts);
MemoryNeed rank_need(const Model& model);

/// The operators that `nscdd export --operators` hands on. With `dense` these are n_Gamma x n_Gamma matrices, which the
/// HDF5 file holds in memory once more. Else it is the sparse ones alone, W among them.
MemoryNeed operators_need(const Model& model, ContactSet contacts, bool dense);

/// The case of a table that needs most, of those that rows from `first` on belong to; builds one at a time. Tables
/// of cases that move, and those whose number of rows is not known, are taken to need nothing. Throws Error naming
/// the case if one cannot be built.
MemoryNeed largest_need(const StudyTable& table, Index first = 0);

}  // namespace nscdd
