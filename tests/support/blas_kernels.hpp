// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <string_view>

extern "C" __attribute__((weak)) const char* openblas_get_corename();

namespace nscdd::testing {

/// Starts a program of tests again with other kernels if OpenBLAS has chosen those of the Prescott of 2004 for a
/// processor that it does not know: their dsymv may crash in sanitized programs. To be called first in `main`.
inline void use_kernels_of_this_processor([[maybe_unused]] char** argv) {
#ifdef __x86_64__
  if (openblas_get_corename == nullptr || std::string_view(openblas_get_corename()) != "Prescott") return;
  if (!__builtin_cpu_supports("avx2") || std::getenv("OPENBLAS_CORETYPE") != nullptr) return;
  setenv("OPENBLAS_CORETYPE", __builtin_cpu_supports("avx512bw") ? "SkylakeX" : "Haswell", 1);
  execv("/proc/self/exe", argv);  // returns only if this fails: the program then runs with the kernels it has
#endif
}

}  // namespace nscdd::testing
