// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <concepts>
#include <functional>

namespace nscdd {

/// Anything that maps R^cols to R^rows linearly: y = apply(x).
template <class Operator>
concept LinearOperator = requires(const Operator& op, const Vector& x) {
  { op.rows() } -> std::convertible_to<Index>;
  { op.cols() } -> std::convertible_to<Index>;
  { op.apply(x) } -> std::convertible_to<Vector>;
};

/// A linear map with its kind forgotten, as the iterative solvers take it.
using LinearMap = std::function<Vector(const Vector&)>;

template <LinearOperator Operator>
LinearMap linear_map(Operator op) {
  return [op = std::move(op)](const Vector& x) -> Vector { return op.apply(x); };
}

/// Dense matrix of an operator, one application per column.
template <LinearOperator Operator>
Matrix dense(const Operator& op) {
  Matrix a(op.rows(), op.cols());
  for (Index j = 0; j < op.cols(); ++j) a.col(j) = op.apply(Vector::Unit(op.cols(), j));
  return a;
}

}  // namespace nscdd
