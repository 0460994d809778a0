// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace nscdd {

/// The text without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

/// 16 hexadecimal digits by which two contents are told apart: the 64-bit FNV-1a hash (Fowler, Noll, Vo),
///     h <- (h xor byte) * 1099511628211 mod 2^64, from 14695981039346656037.
/// It notices every accident; it is no protection from somebody who looks for two contents with one hash.
std::string fingerprint(std::string_view bytes);

/// The same of the bits of numbers: -0 and 0 differ.
std::string fingerprint(std::span<const double> numbers);

}  // namespace nscdd
