// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

inline constexpr double gibibyte = 1 << 30;

/// Sets the limit of resident memory (RLIMIT_RSS, `ulimit -m`), bytes. Linux records and does not enforce it.
void limit_memory(double bytes);

double memory_in_use();  ///< bytes allocated, and those of the program and its libraries

inline double bytes_of_matrix(Index rows, Index columns) {
  return static_cast<double>(sizeof(double)) * static_cast<double>(rows) * static_cast<double>(columns);
}

inline constexpr double smallest_checked_need = 1 << 20;  ///< smaller needs are not compared with the limit, bytes

/// Work does not fit into memory. A single rank may throw it, unknown to the others.
struct OutOfMemory : Error {
  using Error::Error;
};

/// Throws OutOfMemory unless `bytes` more fit within the limit. `what` needs them, such as "a factor of 12 rows".
void require_memory(double bytes, std::string_view what, std::string_view advice = "fewer grains or subdomains");

}  // namespace nscdd
