// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <mutex>

namespace nscdd {

/// Held around every call that may reach METIS. METIS seeds the C library's random numbers and draws from
/// them, and the whole process shares these: orderings found at the same time would disturb each other, and
/// results would depend on timing. While one lives, others wait, and METIS has a state of these numbers to
/// itself; the state that the process had comes back afterwards.
class OneMetis {
 public:
  OneMetis();
  ~OneMetis();
  OneMetis(const OneMetis&) = delete;
  OneMetis& operator=(const OneMetis&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  alignas(8) std::array<char, 128> state_{};  // of the size the C library begins with
  char* before_;
};

}  // namespace nscdd
