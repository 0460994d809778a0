// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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
}  // namespace nscdd::testing
