// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <cstddef>
#include <functional>
#include <limits>

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

/// Long work calls it after each unit with (units done, units in all). If it returns false, the work stops at
/// once and returns what it has. An empty Monitor is never called.
using Monitor = std::function<bool(Index done, Index total)>;

inline bool report(const Monitor& monitor, Index done, Index total) { return !monitor || monitor(done, total); }

}  // namespace nscdd
