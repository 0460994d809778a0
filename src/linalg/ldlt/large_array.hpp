// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <memory>

namespace nscdd {

/// An array of numbers without a value yet. A large one lies in huge pages if the system has them: to obtain
/// gigabytes in pages of 4 KiB takes seconds. Throws std::bad_alloc.
class LargeArray {
 public:
  explicit LargeArray(Index size) : data_(allocate(at(size) * sizeof(double))) {}
  double* data() { return data_.get(); }

 private:
  struct Release {
    std::size_t mapped;  // bytes, or 0 if it comes from malloc
    void operator()(double* data) const;
  };
  using Data = std::unique_ptr<double[], Release>;
  static Data allocate(std::size_t bytes);
  Data data_;
};

}  // namespace nscdd
