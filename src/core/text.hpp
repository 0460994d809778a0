// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

std::string_view trimmed(std::string_view text);  ///< the text without blanks and tabs at its ends

/// Parses a number, also with a Fortran exponent ("1.0D+00"); nothing for any other text.
std::optional<double> number_of(std::string_view text);

/// Printable text: control characters except line feeds and tabs, and invalid UTF-8, are escaped as "\x1B".
std::string printable(std::string_view text);

/// Throws Error "name: expected UTF-8, met UTF-16" for UTF-16 or UTF-32, by their mark or a NUL byte at the beginning.
void require_utf8(std::string_view text, std::string_view name);

/// The character that ends the lines of a text: a line feed or, in a text without any, a carriage return.
char line_end_of(std::string_view text);

std::string_view without_byte_order_mark(std::string_view text);  ///< of UTF-8

/// The parts of a text between separators, without blanks around them: one more than there are separators.
std::vector<std::string_view> split(std::string_view text, char separator);

/// The lines of a text, one at a time, without byte order mark, line ends and carriage returns before them.
class TextLines {
 public:
  explicit TextLines(std::string_view text);
  bool next();                                     ///< goes to the next line; false after the last one
  std::string_view line() const { return line_; }  ///< without its end; empty after the last one
  std::size_t number() const { return number_; }   ///< of the line, counted from 1

 private:
  std::string_view rest_, line_;
  std::size_t number_ = 0;
  char end_;
};

/// Fingerprint of a content, 16 hexadecimal digits: the 64-bit FNV-1a hash (Fowler, Noll, Vo),
///     h <- (h xor byte) * 1099511628211 mod 2^64, from 14695981039346656037.
/// It detects accidental changes, not deliberate collisions.
std::string fingerprint(std::string_view bytes);

std::string fingerprint(std::span<const double> numbers);  ///< fingerprint of the bits of numbers: -0 and 0 differ

}  // namespace nscdd
