// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/body_blocks.hpp"

namespace nscdd {

template <int D>
std::optional<BodyBlocks<D>> BodyBlocks<D>::of(const LocalFrictionProblem& problem, const std::vector<Index>& contact) {
  const SparseMatrix& h = problem.h;
  if (h.cols() == 0 || h.rows() % K != 0 || problem.mass.nonZeros() != h.rows()) return std::nullopt;
  for (Index i = 0; i < h.rows(); ++i)
    if (problem.mass.coeff(i, i) == 0) return std::nullopt;  // the entry of this column is not on the diagonal
  const Vector root = problem.mass.diagonal().cwiseSqrt();
  BodyBlocks blocks;
  blocks.nobody_ = static_cast<int>(h.rows());
  for (const Index c : contact) {
    Contact own{.first = {-1, -1}, .rows = {}};
    for (auto& rows : own.rows) rows.setZero();
    for (Index d = 0; d < D; ++d)
      for (SparseMatrix::InnerIterator e(h, D * c + d); e; ++e) {
        const int first = static_cast<int>(e.row() / K * K);
        std::size_t side = 0;
        while (side < 2 && own.first[side] != first && own.first[side] >= 0) ++side;
        if (side == 2) return std::nullopt;
        own.first[side] = first;
        own.rows[side](d, e.row() - first) = e.value() / root[e.row()];
      }
    for (int& first : own.first)
      if (first < 0) first = blocks.nobody_;
    blocks.contacts_.push_back(own);
  }
  return blocks;
}

template class BodyBlocks<2>;
template class BodyBlocks<3>;

}  // namespace nscdd
