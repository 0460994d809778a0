// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <memory>

namespace nscdd {

/// Numbers without a value yet, in huge pages where they are many and the system has such pages: a factor of
/// gigabytes takes seconds to come by in pages of 4 KiB. Throws std::bad_alloc.
class LargeArray {
 public:
  explicit LargeArray(Index size) : data_(allocate(at(size) * sizeof(double))) {}
  double* data() { return data_.get(); }

 private:
  struct Release {
    std::size_t mapped;  // bytes, or 0 where it comes from malloc
    void operator()(double* data) const;
  };
  using Data = std::unique_ptr<double[], Release>;
  static Data allocate(std::size_t bytes);
  Data data_;
};

}  // namespace nscdd
