// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/report/run_report.hpp"
#include "study/linear/packing_report.hpp"

#include <nlohmann/json.hpp>

/// The data of a page as JSON, keys in the order in which they are written.
namespace nscdd::page {

using Json = nlohmann::ordered_json;

/// A long array as {"type": "float32", "data": "..."}: little-endian numbers in base 64. As text they would take two to
/// three times the room. Types are those that a browser has arrays of.
Json packed(const std::vector<float>& values);          ///< float32
Json packed(const std::vector<std::int16_t>& values);   ///< int16
Json packed(const std::vector<std::uint8_t>& values);   ///< uint8
Json packed(const std::vector<std::uint32_t>& values);  ///< uint32

/// Numbers of any type as those of a packed array.
template <class To, class Values>
std::vector<To> converted(const Values& values) {
  std::vector<To> result;
  for (const auto& value : values) result.push_back(static_cast<To>(value));
  return result;
}

/// A number with seven digits, for what is only drawn.
Json drawn(double value);

Json json_of(const Model& model, const PackingReport& report);
Json json_of(const RunReport& report);

}  // namespace nscdd::page
