// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"

#include "core/fail.hpp"

namespace nscdd::python {
namespace {

py::object scipy_sparse(const char* name) { return py::module_::import("scipy.sparse").attr(name); }

// The cells of one column, all of which hold the alternative `Value`.
template <class Value>
std::vector<Value> cells(const std::vector<Row>& rows, std::size_t column) {
  std::vector<Value> values;
  values.reserve(rows.size());
  for (const Row& row : rows) values.push_back(std::get<Value>(row[column]));
  return values;
}

py::object column(const std::vector<Row>& rows, std::size_t number) {
  const auto numpy = py::module_::import("numpy").attr("array");
  if (rows.empty()) return numpy(py::list());
  return std::visit(
      [&]<class Value>(const Value&) -> py::object {
        if constexpr (std::is_same_v<Value, bool> || std::is_same_v<Value, std::string>) {
          return numpy(py::cast(cells<Value>(rows, number)));
        } else {
          const std::vector<Value> values = cells<Value>(rows, number);
          return py::array_t<Value>(count(values), values.data());
        }
      },
      rows.front()[number]);
}

}  // namespace

py::capsule keeper(std::shared_ptr<const void> owner) {
  auto kept = std::make_unique<std::shared_ptr<const void>>(std::move(owner));
  py::capsule capsule(kept.get(), [](void* p) { delete static_cast<std::shared_ptr<const void>*>(p); });
  kept.release();
  return capsule;
}

py::array_t<double> matrix_view(const std::shared_ptr<const void>& owner, const Matrix& matrix) {
  constexpr auto size = static_cast<py::ssize_t>(sizeof(double));
  py::array_t<double> array({matrix.rows(), matrix.cols()}, {size, size * matrix.rows()}, matrix.data(), keeper(owner));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::object sparse_view(const std::shared_ptr<const void>& owner, const SparseMatrix& matrix) {
  if (!matrix.isCompressed()) throw std::logic_error("a matrix that is shown to Python has to be compressed");
  const auto parts = py::make_tuple(view(owner, matrix.valuePtr(), matrix.nonZeros()),
                                    view(owner, matrix.innerIndexPtr(), matrix.nonZeros()),
                                    view(owner, matrix.outerIndexPtr(), matrix.outerSize() + 1));
  return scipy_sparse("csc_matrix")(parts, py::arg("shape") = py::make_tuple(matrix.rows(), matrix.cols()));
}

py::object diagonal_view(const std::shared_ptr<const void>& owner, const Vector& diagonal) {
  const auto row = view(owner, diagonal.data(), diagonal.size()).attr("reshape")(1, -1);
  const auto shape = py::make_tuple(diagonal.size(), diagonal.size());
  return scipy_sparse("dia_matrix")(py::make_tuple(row, py::make_tuple(0)), py::arg("shape") = shape);
}

Array<double> reals(const py::object& given, std::string_view name) {
  const auto numpy = py::module_::import("numpy");
  const auto refuse = [&](const std::string& met) { fail("{}: expected real numbers, met {}", name, met); };
  if (py::bool_(numpy.attr("ma").attr("is_masked")(given))) refuse("an array of which parts are masked");
  const py::array array = [&]() -> py::array {
    try {
      return numpy.attr("asarray")(given);
    } catch (py::error_already_set& error) {
      if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
      refuse(py::str(error.value()));
      throw;
    }
  }();
  const char kind = array.dtype().kind();
  if (array.ndim() != 1 && kind != 'O')
    fail("{}: expected an array of one dimension, met one of {}", name, array.ndim());
  if (std::string_view("biufO").find(kind) == std::string_view::npos)
    refuse("an array of " + std::string(py::str(array.dtype())));
  const auto found = Array<double>::ensure(array);  // of objects, each has to be a number by itself
  PyErr_Clear();
  if (!found || found.ndim() != 1) refuse(py::str(py::type::of(given).attr("__name__")));
  return found;
}

std::vector<double> numbers(const py::object& given, std::string_view name) {
  const Array<double> array = reals(given, name);
  return {array.data(), array.data() + array.size()};
}

Vector vector(const py::object& given, std::string_view name) {
  const Array<double> array = reals(given, name);
  return Eigen::Map<const Vector>(array.data(), array.size());
}

SparseMatrix sparse_matrix(const CompressedColumns& columns, std::string_view name) {
  const auto [rows, cols] = columns.shape;
  const Index entries = columns.data.size();
  const auto at_column = [&](Index j) -> Index { return columns.starts.data()[j]; };
  bool fits = columns.indices.size() == entries && columns.starts.size() == cols + 1 && at_column(0) == 0 &&
              at_column(cols) == entries;
  for (Index j = 0; fits && j < cols; ++j) {
    fits = at_column(j) <= at_column(j + 1) && at_column(j + 1) <= entries;
    Index before = -1;
    for (Index k = at_column(j); fits && k < at_column(j + 1); ++k) {
      const Index row = columns.indices.data()[k];
      fits = before < row && row < rows;
      before = row;
    }
  }
  if (!fits) fail("{}: expected compressed columns with ascending rows below {}, met others", name, rows);
  return SparseMatrix(Eigen::Map<const SparseMatrix::Base>(rows, cols, entries, columns.starts.data(),
                                                           columns.indices.data(), columns.data.data()));
}

py::list columns_of_rows(const std::vector<Column>& headings, const std::vector<Row>& rows) {
  py::list all;
  for (std::size_t k = 0; k < headings.size(); ++k)
    all.append(py::make_tuple(headings[k].name, headings[k].unit, headings[k].description, column(rows, k)));
  return all;
}

}  // namespace nscdd::python
