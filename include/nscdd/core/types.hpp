// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Types of every layer. Files that include this header, even indirectly, do not repeat its standard headers.
namespace nscdd {

using Index = Eigen::Index;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// Sparse matrix, compressed by columns. Unlike Eigen's (3.4) it moves instead of copying, and `= {}` frees its memory.
class SparseMatrix : public Eigen::SparseMatrix<double> {
 public:
  using Base = Eigen::SparseMatrix<double>;
  using Base::Base;
  SparseMatrix() = default;
  SparseMatrix(const SparseMatrix&) = default;
  SparseMatrix(SparseMatrix&& other) noexcept { swap(other); }
  SparseMatrix& operator=(const SparseMatrix&) = default;
  SparseMatrix& operator=(SparseMatrix&& other) noexcept {
    SparseMatrix taken(std::move(other));
    swap(taken);
    return *this;
  }
  template <class Expression>
  SparseMatrix& operator=(const Eigen::EigenBase<Expression>& expression) {
    Base::operator=(expression.derived());
    return *this;
  }
};

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Position in a standard container of an index known to be non-negative.
constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Number of elements of a standard container, signed.
template <class Container>
constexpr Index count(const Container& c) {
  return static_cast<Index>(c.size());
}

/// Sorts values and keeps one of those that are equal.
template <class Value>
void sort_unique(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// 0, 1, ..., n - 1.
template <class Number = Index>
std::vector<Number> natural_order(Index n) {
  std::vector<Number> order(at(n));
  std::iota(order.begin(), order.end(), Number{0});
  return order;
}

/// Invalid input. The message states what was expected, what was met, and where (file and line, key, option or grain);
/// control characters and invalid UTF-8 are escaped as "\x1B". `main` catches an Error and returns exit code 2. A
/// computation that does not converge throws no Error: its result has a flag.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message);
  /// Invalid value of a key of a case ("solver.criterion"); what() is "key: message". The reader adds file and line.
  Error(std::string key, const std::string& message) : Error(key + ": " + message) { key_ = std::move(key); }
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

/// Progress callback of long work, called after each unit with (units done, units in all). If it returns false, the
/// work stops and returns its partial result. An empty Monitor is never called.
using Monitor = std::function<bool(Index done, Index total)>;

inline bool report(const Monitor& monitor, Index done, Index total) { return !monitor || monitor(done, total); }

}  // namespace nscdd
