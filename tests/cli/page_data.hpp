// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "session.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <cstring>

/// The data of a page of nscdd report.
namespace nscdd::testing {

using Json = nlohmann::json;

inline Json data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const std::size_t start = page.find(open) + open.size();
  return Json::parse(page.substr(start, page.find("</script>", start) - start));
}

/// What a page has as a packed array.
template <class Value>
std::vector<Value> unpacked(const Json& array) {
  static const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  unsigned gathered = 0;
  int bits = 0;
  for (const char letter : array["data"].get<std::string>()) {
    if (letter == '=') break;
    gathered = (gathered << 6 | static_cast<unsigned>(letters.find(letter))) & 0xFFFFU;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(gathered >> bits & 0xFFU));
  }
  std::vector<Value> values(bytes.size() / sizeof(Value));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(Value));
  return values;
}

}  // namespace nscdd::testing
