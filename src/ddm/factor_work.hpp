// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/decomposition.hpp>

namespace nscdd {

/// Entries of a sparse factor and the operations of its factorisation, by its symbolic analysis.
struct FactorWork {
  double entries = not_a_number, flops = not_a_number;
};
inline FactorWork operator+(const FactorWork& a, const FactorWork& b) {
  return {a.entries + b.entries, a.flops + b.flops};
}

/// Of a symmetric matrix stored in full. `group`: see SymmetricAnalysis.
FactorWork factor_work(const SparseMatrix& symmetric, const std::vector<Index>& group);
/// Of M_E + K_E / eps, grain by grain.
FactorWork network_work(const Subdomain& subdomain, Index dofs_per_grain);

}  // namespace nscdd
