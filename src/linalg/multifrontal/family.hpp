// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/factor.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

#include <mutex>

namespace nscdd {

/// Analysis of a family, and the interior of its latest matrix.
class SymmetricFamily {
 public:
  explicit SymmetricFamily(SymmetricAnalysis analysis) : analysis_(std::move(analysis)) {}

  /// With equal parameters the interior is kept, see InertiaFamily.
  SymmetricFactor factorise(const SparseMatrix& lower, const std::array<double, 2>& parameters);
  bool keeps_interior(const std::array<double, 2>& parameters);  ///< for matrices with these parameters
  void release();                                                ///< frees the interior

  const SymmetricAnalysis& analysis() const { return analysis_; }

 private:
  SymmetricAnalysis analysis_;
  std::mutex mutex_;
  std::optional<SymmetricInterior> interior_;
  std::array<double, 2> parameters_{};
};

/// Flags of the groups with border rows only; empty if there are none.
std::vector<char> groups_of_border(const InertiaPattern& pattern);

}  // namespace nscdd
