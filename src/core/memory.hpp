// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <string_view>

namespace nscdd {

inline constexpr double gibibyte = 1 << 30;

/// Limits the memory of this process, bytes. The limit is the one of resident memory that a process has (RLIMIT_RSS,
/// `ulimit -m`): Linux records it and does not enforce it.
void limit_memory(double bytes);

/// Bytes that this process may hold in all: its limit, or without one 90 % of what it holds and of what the system and
/// the control groups leave to it. Infinite if the system does not say.
double memory_limit();

/// Bytes that are allocated, and those of the program and its libraries.
double memory_in_use();

/// Bytes of a dense matrix.
inline double bytes_of_matrix(Index rows, Index columns) {
  return static_cast<double>(sizeof(double)) * static_cast<double>(rows) * static_cast<double>(columns);
}

/// Needs below this many bytes are not compared with the limit.
inline constexpr double smallest_checked_need = 1 << 20;

/// Work does not fit into memory. One rank of several may refuse alone, and the others cannot know.
struct OutOfMemory : Error {
  using Error::Error;
};

/// Throws OutOfMemory with all amounts unless `bytes` more fit within the limit. `what` takes them: "a factor of 12
/// rows".
void require_memory(double bytes, std::string_view what, std::string_view advice = "fewer grains or subdomains");

}  // namespace nscdd
