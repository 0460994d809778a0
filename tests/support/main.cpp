// SPDX-License-Identifier: GPL-3.0-or-later
#define DOCTEST_CONFIG_IMPLEMENT
#include "blas_kernels.hpp"

#include <doctest/doctest.h>

int main(int argc, char** argv) {
  nscdd::testing::use_kernels_of_this_processor(argv);
  return doctest::Context(argc, argv).run();
}
