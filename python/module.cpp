// SPDX-License-Identifier: GPL-3.0-or-later
#include "module.hpp"

#include <nscdd/core/table.hpp>

namespace py = pybind11;

PYBIND11_MODULE(_core, module) {
  module.doc() = "The compiled part of nscdd: the library behind arrays. Use the package nscdd.";
  module.attr("version") = nscdd::version();
  auto& error = py::register_exception<nscdd::Error>(module, "Error", PyExc_ValueError);
  error.attr("__module__") = "nscdd";
  error.attr("__doc__") =
      "Input that cannot be used. The message says what was expected, what was met, and where. What does not converge "
      "is no error: results say so themselves.";
  nscdd::python::bind_packing(module);
  nscdd::python::bind_decomposition(module);
  nscdd::python::bind_spectra(module);
  nscdd::python::bind_modes(module);
  nscdd::python::bind_tables(module);
  nscdd::python::bind_friction(module);
  nscdd::python::bind_simulation(module);
}
