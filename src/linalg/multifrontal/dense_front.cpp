// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/dense_front.hpp"

#include "linalg/threads.hpp"

namespace nscdd {

DenseFront::DenseFront(Matrix lower, const std::vector<Index>& group_ends) {
  front_.rows = lower.rows();
  front_.pivots = group_ends.empty() ? 0 : group_ends.back();
  front_.panels = cut_panels(group_ends);
  columns_ = large_array(front_.rows * front_.pivots);
  factor_ = {.columns = columns_.get(),
             .swaps = std::vector<lapack_int>(at(front_.pivots)),
             .off = Vector::Zero(front_.pivots)};
  Block(columns_.get(), front_.rows, front_.pivots, Eigen::OuterStride<>(front_.rows)) = lower.leftCols(front_.pivots);
  update_ = lower.bottomRightCorner(front_.update_rows(), front_.update_rows());
  lower.resize(0, 0);  // frees its memory
  with_threads([&] { negative_ = eliminate_front(front_, factor_, update_, false); });
}

void DenseFront::go_forward(Vector& values) const { nscdd::go_forward(front_, factor_, values); }

void DenseFront::go_back(Vector& values) const { nscdd::go_back(front_, factor_, values); }

}  // namespace nscdd
