// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/factor_work.hpp"

#include "linalg/multifrontal/analysis.hpp"

namespace nscdd {

FactorWork factor_work(const SparseMatrix& symmetric, const std::vector<Index>& group) {
  if (symmetric.rows() == 0) return {0, 0};
  const SymmetricAnalysis analysis(SparseMatrix(symmetric.triangularView<Eigen::Lower>()), group);
  return {analysis.entries(), analysis.work().flops(true)};
}

FactorWork network_work(const Subdomain& subdomain, Index d) {
  SparseMatrix k = subdomain.h * subdomain.h.transpose();
  SparseMatrix diagonal(k.rows(), k.cols());
  diagonal.setIdentity();
  std::vector<Index> grain(at(k.rows()));
  for (Index i = 0; i < k.rows(); ++i) grain[at(i)] = i / d;
  return factor_work(k + diagonal, grain);
}

}  // namespace nscdd
