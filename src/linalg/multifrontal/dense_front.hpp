// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/fronts.hpp"

namespace nscdd {

/// L D L^T of the first rows of a dense matrix, pivoted as in SymmetricFactor, and the Schur complement on the others.
class DenseFront {
 public:
  /// `lower`: its lower triangle. `group_ends`: ends of the groups of rows that are eliminated, ascending.
  DenseFront(Matrix lower, const std::vector<Index>& group_ends);

  bool regular() const { return negative_.has_value(); }            ///< false if a pivot is exactly zero
  Index negative_eigenvalues() const { return negative_.value(); }  ///< among the pivots
  Matrix take_update() { return std::move(update_); }               ///< the Schur complement, lower triangle

  /// Multiplies the values of eliminated rows by L^-1 and subtracts their contribution from the others.
  void go_forward(Vector& values) const;
  void go_back(Vector& values) const;  ///< solves for the eliminated rows, given the solution on the others

 private:
  Front front_;
  LargeArray columns_;
  FrontFactor factor_;
  Matrix update_;
  std::optional<Index> negative_;
};

}  // namespace nscdd
