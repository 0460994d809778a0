// SPDX-License-Identifier: GPL-3.0-or-later
#include "spoilt.hpp"

#include <nscdd/core/types.hpp>

#include <doctest/doctest.h>

namespace nscdd::testing {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto position = text.find(from);
  REQUIRE_MESSAGE(position != std::string::npos, from);
  return text.replace(position, from.size(), to);
}

void check_error(const std::function<void()>& read, const Names& names) {
  std::string met = "no Error";
  try {
    read();
  } catch (const Error& error) {
    met = error.what();
  }
  CAPTURE(met);
  std::size_t place = 0;
  for (const std::string& name : names) {
    const std::size_t found = met.find(name, place);
    CHECK_MESSAGE(found != std::string::npos, name);
    if (found != std::string::npos) place = found + name.size();
  }
  CHECK(met != "no Error");
}

void Spoilt::operator()(const std::string& from, const std::string& to, const Names& names) const {
  CAPTURE(to);
  const std::string text = replaced(good, from, to);
  check_error([&] { read(text); }, names);
}

}  // namespace nscdd::testing
