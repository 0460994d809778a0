// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/model.hpp>

#include <pybind11/pybind11.h>

/// The module nscdd._core, one function here for each source of it. Users call python/nscdd/, which converts their
/// arguments.
namespace nscdd::python {

void bind_packing(pybind11::module_& module);
void bind_decomposition(pybind11::module_& module);
void bind_spectra(pybind11::module_& module);
void bind_modes(pybind11::module_& module);
void bind_tables(pybind11::module_& module);
void bind_friction(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);

/// Warns (UserWarning) with the caller's line. Throws error_already_set where warnings are errors. `caller`: as
/// `stacklevel` of warnings.warn.
void warn_of(const std::vector<std::string>& remarks, Py_ssize_t caller = 2);

/// How spectra are computed, from keyword arguments. Throws Error naming the argument.
SpectralOptions spectral_options(const pybind11::dict& given);

}  // namespace nscdd::python
