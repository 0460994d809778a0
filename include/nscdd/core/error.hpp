// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace nscdd {

/// Input that the program cannot use: says what was expected, what was met, and where (file and line,
/// key, option or grain). Thrown anywhere, caught in `main` only, where it becomes exit code 2.
/// A computation that does not converge is not an Error: it is data in the result.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace nscdd
