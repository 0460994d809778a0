// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// A number per direction: two (x, y) or three (x, y, z). The packing fixes the count later, see `require_components`.
template <class Number>
class Components {
 public:
  constexpr Components() = default;
  constexpr Components(Number x, Number y) : values_{x, y} {}
  constexpr Components(Number x, Number y, Number z) : values_{x, y, z}, size_(3) {}
  constexpr Components(const std::array<Number, 2>& values) : Components(values[0], values[1]) {}
  /// Of two numbers the third is 0.
  constexpr Components(const std::array<Number, 3>& values, std::size_t size = 3) : values_(values), size_(size) {}

  constexpr std::size_t size() const { return size_; }
  /// The number along x, y or z; along z `Number{}` if there are two.
  constexpr Number operator[](std::size_t direction) const { return values_[direction]; }
  constexpr const Number* begin() const { return values_.data(); }
  constexpr const Number* end() const { return values_.data() + size_; }

  friend constexpr bool operator==(const Components&, const Components&) = default;

 private:
  std::array<Number, 3> values_{};
  std::size_t size_ = 2;
};

}  // namespace nscdd
