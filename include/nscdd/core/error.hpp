// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace nscdd {

/// Input that the program cannot use. The message says what was expected, what was met, and where (file and
/// line, key, option or grain). An Error may be thrown anywhere; `main` catches it and returns exit code 2.
/// A computation that does not converge throws no Error: it says so in its result.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
  /// About the value of a key of a case ("solver.criterion"): what() is "key: message", and whoever knows the
  /// file adds its name and line.
  Error(std::string key, const std::string& message) : std::runtime_error(key + ": " + message), key_(std::move(key)) {}
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

}  // namespace nscdd
