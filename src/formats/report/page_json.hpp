// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/report/run_report.hpp"
#include "study/linear/packing_report.hpp"

#include <nlohmann/json.hpp>

#include <bit>

/// The data of a page as JSON.
namespace nscdd::page {

using Json = nlohmann::ordered_json;

/// An array as {"type": "float32", "data": "..."}: little-endian numbers in base 64, a half to a third of the size of
/// text. Types are those of the arrays of a browser.
Json packed_bytes(const char* type, std::span<const std::byte> bytes);

/// `get` of each value, as an array of `To`.
template <class To, class Values, class Get = std::identity>
Json packed(const Values& values, Get get = {}) {
  static_assert(std::endian::native == std::endian::little, "bytes are written as they lie in memory");
  constexpr const char* type = std::is_same_v<To, float>          ? "float32"
                               : std::is_same_v<To, std::int16_t> ? "int16"
                               : std::is_same_v<To, std::uint8_t> ? "uint8"
                                                                  : "uint32";
  std::vector<To> numbers;
  for (const auto& value : values) numbers.push_back(static_cast<To>(std::invoke(get, value)));
  return packed_bytes(type, std::as_bytes(std::span(numbers)));
}

/// A number with the seven digits that a picture needs.
Json drawn(double value);

Json json_of(const Model& model, const PackingReport& report);
Json json_of(const RunReport& report);

}  // namespace nscdd::page
