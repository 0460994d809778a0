// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>

#include <fmt/format.h>

namespace nscdd {

/// The columns of a vector, one along x, one along y and in space one along z: `name` has {} for the direction, and
/// component(result, k) is the k-th number.
template <class Result, class Component>
ResultColumns<Result> vector_columns(Index dimension, std::string_view name, const std::string& unit,
                                     const std::string& description, Component component) {
  ResultColumns<Result> columns;
  for (Index k = 0; k < dimension; ++k)
    columns.push_back({fmt::format(fmt::runtime(name), "xyz"[k]), unit, description,
                       [component, k](const Result& result) { return component(result, k); }});
  return columns;
}

/// The k-th coordinate of a grain of a packing or a state, m.
double coordinate(const auto& of, Index grain, Index k) { return (k == 0 ? of.x : k == 1 ? of.y : of.z)[at(grain)]; }

}  // namespace nscdd
