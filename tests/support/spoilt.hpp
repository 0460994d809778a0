// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

/// Input that must be refused.
namespace nscdd::testing {

/// What an error must name, in this order: where it is, the key, what was expected and met. No test asks for sentences.
using Names = std::vector<std::string>;

/// Text with its first `from` replaced; fails the test where there is none.
std::string replaced(std::string text, const std::string& from, const std::string& to);

/// Fails the test unless `read` throws an Error with these names.
void check_error(const std::function<void()>& read, const Names& names);

/// Reads a good text in which one thing was changed.
struct Spoilt {
  std::string good;
  std::function<void(const std::string&)> read;

  /// Fails the test unless the changed text leads to an Error with these names.
  void operator()(const std::string& from, const std::string& to, const Names& names) const;
};

}  // namespace nscdd::testing
