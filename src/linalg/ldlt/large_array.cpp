// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/ldlt/large_array.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <new>

namespace nscdd {
namespace {

constexpr std::size_t mapped_from = 8 << 20;  // bytes, some huge pages

}  // namespace

LargeArray::Data LargeArray::allocate(std::size_t bytes) {
  if (bytes < mapped_from) {
    auto* const small = static_cast<double*>(std::malloc(std::max<std::size_t>(bytes, 1)));
    if (small == nullptr) throw std::bad_alloc();
    return {small, {0}};
  }
  void* const mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  madvise(mapped, bytes, MADV_HUGEPAGE);  // may be refused; small pages serve as well
#endif
  return {static_cast<double*>(mapped), {bytes}};
}

void LargeArray::Release::operator()(double* data) const {
  if (mapped > 0) {
    munmap(data, mapped);
  } else {
    std::free(data);
  }
}

}  // namespace nscdd
