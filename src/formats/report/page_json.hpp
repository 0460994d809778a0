// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/report/problem_report.hpp"
#include "study/linear/packing_report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <bit>

/// The data of a page as JSON.
namespace nscdd::page {

using Json = nlohmann::ordered_json;

/// An array as {"type": "float32", "data": "..."}: little-endian numbers in base 64, a half to a third of the size of
/// text. Types are those of the arrays of a browser.
inline Json packed_bytes(const char* type, std::span<const std::byte> bytes) {
  static constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t there = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (k < there ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= there ? letters[three >> (18 - 6 * k) & 63U] : '=';
  }
  return {{"type", type}, {"data", std::move(text)}};
}

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
inline Json drawn(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr);  // std::stod throws for numbers below 2e-308
}

/// What `get` makes of each item.
template <class Items, class Get>
Json list_of(const Items& items, Get get) {
  Json all = Json::array();
  for (const auto& item : items) all.push_back(get(item));
  return all;
}

/// Of a packing or contact problem.
Json json_of(const Model& model, const PackingReport& report, const ProblemReport* problem);

}  // namespace nscdd::page
