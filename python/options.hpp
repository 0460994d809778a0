// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include <nscdd/core/fields.hpp>

#include <pybind11/pybind11.h>

/// Parameter structs (core/fields.hpp) as keyword arguments.
namespace nscdd::python {

/// Sets a parameter. Throws Error naming the key for an object of another type or out of bounds.
template <class Value>
void set_field(Value& value, const pybind11::object& given, std::string_view key, const Field& field) {
  const auto cast = [&]<class Type>(Type& target, std::string_view expected, bool possible) {
    try {
      if (possible) {
        target = given.cast<Type>();
        return;
      }
    } catch (const pybind11::cast_error&) {  // a text, or an integer beyond 64 bits
    }
    fail("{}: expected {}, met {}", key, expected, std::string(pybind11::repr(given)));
  };
  if constexpr (std::is_same_v<Value, Index>)
    cast(value, "an integer", PyIndex_Check(given.ptr()));
  else if constexpr (std::is_same_v<Value, double>)
    cast(value, "a number", true);
  else if constexpr (std::is_same_v<Value, bool>)
    cast(value, "True or False", true);
  else {
    std::string text;
    cast(text, "a text", pybind11::isinstance<pybind11::str>(given));
    parse_value(text, value, key);
  }
  check_bounds(value, field, key);
}

/// The parameters with those that are given. Their names are known: `takes` of _arguments.py lets no other one pass.
template <class Parameters>
Parameters with_fields(const pybind11::dict& given) {
  Parameters parameters;
  Parameters::fields(parameters, [&](std::string_view key, auto& value, const Field& field) {
    if (const pybind11::str name(key.data(), key.size()); given.contains(name))
      set_field(value, pybind11::object(given[name]), key, field);
  });
  return parameters;
}

/// (key, default, description) of every parameter, for signatures and documentation.
template <class Parameters>
pybind11::list described_fields() {
  pybind11::list all;
  const Parameters defaults;
  Parameters::fields(defaults, [&]<class Value>(std::string_view key, const Value& value, const Field& field) {
    pybind11::object initial;
    if constexpr (requires { to_string(value); })
      initial = pybind11::cast(std::string(to_string(value)));
    else
      initial = pybind11::cast(value);
    all.append(pybind11::make_tuple(key, initial, field.description));
  });
  return all;
}

}  // namespace nscdd::python
