// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fingerprint.hpp"

#include <fmt/format.h>

namespace nscdd {

std::string fingerprint(std::string_view bytes) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return fmt::format("{:016x}", hash);
}

std::string fingerprint(std::span<const double> numbers) {
  return fingerprint(std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
}

}  // namespace nscdd
