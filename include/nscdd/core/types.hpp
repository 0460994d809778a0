// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <cstddef>
#include <limits>

/// NonSmooth Contact Domain Decomposition: convergence study of the two-stage algorithms of
/// P. Alart, D. Iceta, D. Dureisseix, CMAME 205-208 (2012) 59-67, cited as [ADI12] throughout.
namespace nscdd {

using Index = Eigen::Index;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double>;  ///< compressed by columns

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Position in a standard container of an index known to be non-negative.
constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Number of elements of a standard container, signed.
template <class Container>
constexpr Index count(const Container& c) {
  return static_cast<Index>(c.size());
}

}  // namespace nscdd
