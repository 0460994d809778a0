// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

/// Whether sanitizers watch this program. What they look for shows in a few inputs of a kind. A test that tries many,
/// to judge what is found, tries fewer of them then: every operation takes some twenty times as long.
namespace nscdd::testing {
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif
#else
inline constexpr bool sanitized = false;
#endif
/// All of these; of many that are alike every third one where sanitizers watch.
template <class T>
std::vector<T> watched(const std::vector<T>& all) {
  std::vector<T> chosen;
  for (std::size_t k = 0; k < all.size(); k += sanitized ? 3 : 1) chosen.push_back(all[k]);
  return chosen;
}
}  // namespace nscdd::testing
