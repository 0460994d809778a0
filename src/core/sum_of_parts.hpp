// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/processes.hpp>

namespace nscdd {

/// Sums over parts, one column of `parts` each, in their order, so that no bit depends on the number of ranks. Columns
/// of other ranks are 0.
inline Vector sum_of_parts(Eigen::MatrixXd parts, const Processes& processes) {
  processes.add_up({parts.data(), at(parts.size())});
  Vector sum = Vector::Zero(parts.rows());
  for (Index e = 0; e < parts.cols(); ++e) sum += parts.col(e);
  return sum;
}

}  // namespace nscdd
