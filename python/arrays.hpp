// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

/// How arrays of the library are seen from NumPy and SciPy.
namespace nscdd::python {

namespace py = pybind11;

/// One-dimensional array of numbers, as NumPy hands it over: other types and strides are converted.
template <class Number>
using Array = py::array_t<Number, py::array::c_style | py::array::forcecast>;

/// What keeps memory alive for as long as an array looks at it.
py::capsule keeper(std::shared_ptr<const void> owner);

/// An array that looks at numbers of `owner` and cannot be written to; nothing is copied.
template <class Number>
py::array_t<Number> view(const std::shared_ptr<const void>& owner, const Number* data, Index size) {
  py::array_t<Number> array(size, data, keeper(owner));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}
template <class Owner, class Number>
py::array_t<Number> view(const std::shared_ptr<Owner>& owner, const std::vector<Number>& numbers) {
  return view(std::shared_ptr<const void>(owner), numbers.data(), count(numbers));
}
template <class Owner>
py::array_t<double> view(const std::shared_ptr<Owner>& owner, const Vector& numbers) {
  return view(std::shared_ptr<const void>(owner), numbers.data(), numbers.size());
}

/// One member of each of `size` structs that lie one after the other, the first of them at `first`.
template <class Number>
py::array_t<Number> strided_view(const std::shared_ptr<const void>& owner, const Number* first, Index size,
                                 std::size_t stride) {
  py::array_t<Number> array({size}, {static_cast<py::ssize_t>(stride)}, first, keeper(owner));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// A dense matrix of `owner`, by columns as Eigen has it, that cannot be written to; nothing is copied.
py::array_t<double> matrix_view(const std::shared_ptr<const void>& owner, const Matrix& matrix);

/// A sparse matrix of `owner` as scipy.sparse.csc_matrix, whose arrays cannot be written to; nothing is copied.
py::object sparse_view(const std::shared_ptr<const void>& owner, const SparseMatrix& matrix);

/// A diagonal matrix as scipy.sparse.dia_matrix; nothing is copied.
py::object diagonal_view(const std::shared_ptr<const void>& owner, const Vector& diagonal);

/// The real numbers that an array, or what NumPy makes one of, holds. Throws Error naming it for one of more or fewer
/// dimensions than one, and for what a conversion would change in silence: complex numbers, texts, dates, and arrays
/// of which parts are masked.
Array<double> reals(const py::object& given, std::string_view name);
std::vector<double> numbers(const py::object& given, std::string_view name);
Vector vector(const py::object& given, std::string_view name);

/// The arrays (data, indices, indptr) of a scipy.sparse.csc_matrix whose indices ascend.
struct CompressedColumns {
  Array<double> data;
  Array<int> indices, starts;
  std::array<Index, 2> shape{};
};
/// The matrix of these. Throws Error naming it where they do not fit together.
SparseMatrix sparse_matrix(const CompressedColumns& columns, std::string_view name);

/// Columns of rows as a list of (name, unit, description, array).
py::list columns_of_rows(const std::vector<Column>& headings, const std::vector<Row>& rows);

}  // namespace nscdd::python
