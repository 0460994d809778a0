// SPDX-License-Identifier: GPL-3.0-or-later
// What the whole process shares is left as it was found: settings held by guards, BLAS threads, random numbers.
#include "core/process_guard.hpp"
#include "linalg/scalar.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/threads.hpp"

#include <doctest/doctest.h>
#include <gsl/gsl_errno.h>
#include <metis.h>

#include <csignal>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

using namespace nscdd;

extern "C" {
__attribute__((weak)) void openblas_set_num_threads(int);
__attribute__((weak)) int openblas_get_num_threads();
}

namespace {

int setting = 0, taken = 0;
int take() {
  ++taken;
  return std::exchange(setting, 1);
}
void restore(int before) { setting = before; }
using Guard = ProcessGuard<take, restore>;

void own_handler(const char*, const char*, int, int) {}

}  // namespace

TEST_CASE("process guard: the last of several puts back what the first one met, in whatever order they go") {
  setting = 5;
  taken = 0;
  std::optional<Guard> first(std::in_place), second(std::in_place);
  CHECK(setting == 1);
  first.reset();
  CHECK(setting == 1);
  {
    const Guard third;
    second.reset();
    CHECK(setting == 1);
  }
  CHECK(setting == 5);
  CHECK(taken == 1);
  setting = 8;
  { const Guard again; }
  CHECK(setting == 8);
}

TEST_CASE("parallel work keeps to one BLAS thread per call and gives the process its own number back") {
  if (openblas_set_num_threads == nullptr) return;
  const int before = openblas_get_num_threads();
  for (const int threads : {1, 2, 3}) {
    openblas_set_num_threads(threads);
    for_each_in_parallel(20, [](Index) {
      with_threads([] { CHECK(openblas_get_num_threads() == 1); });
      CHECK(openblas_get_num_threads() == 1);
    });
    CHECK(openblas_get_num_threads() == threads);
    CHECK_THROWS_AS(with_threads([] { throw std::runtime_error("stop"); }), std::runtime_error);
    CHECK(openblas_get_num_threads() == threads);
  }
  openblas_set_num_threads(before);
}

TEST_CASE("scalar searches leave GSL's error handler, whether they succeed or fail") {
  gsl_error_handler_t* const before = gsl_set_error_handler(&own_handler);
  find_root([](double x) { return x - 0.3; }, 0, 1, 1e-9);
  CHECK_THROWS(find_root([](double) { return 1.0; }, 0, 1, 1e-9));
  find_root(  // a search within a search
      [](double x) { return x - find_root([](double y) { return y - 0.3; }, 0, 1, 1e-9).x; }, 0, 1, 1e-9);
  const bool unchanged = gsl_set_error_handler(before) == &own_handler;
  CHECK(unchanged);
}

TEST_CASE("elimination orders leave the random numbers of the C library alone, and do not depend on them") {
  std::srand(3);
  const int first = std::rand(), second = std::rand();
  SparseMatrix a(400, 400);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < 400; ++i) {
    entries.emplace_back(i, i, 4.0);
    if (i + 1 < 400) entries.emplace_back(i + 1, i, -1.0);
    if (i + 20 < 400) entries.emplace_back(i + 20, i, -1.0);
  }
  a.setFromTriplets(entries.begin(), entries.end());
  std::srand(3);
  CHECK(std::rand() == first);
  const SparseCholesky factor(CholeskyAnalysis(a), a);
  CHECK(std::rand() == second);
  CHECK(factor.positive_definite());
}

namespace {
volatile std::sig_atomic_t caught = 0;
}

TEST_CASE("a signal that METIS takes for its own failure reaches the process; a failure of METIS is no signal") {
  caught = 0;
  const auto before = std::signal(SIGTERM, [](int) { caught = caught + 1; });
  int calls = 0;
  CHECK(metis_status([&] { return ++calls == 1 ? METIS_ERROR : METIS_OK; }) == METIS_OK);
  CHECK(calls == 2);
  CHECK(caught == 1);
  CHECK(metis_status([] { return METIS_ERROR; }) == METIS_ERROR);
  CHECK(metis_status([] { return METIS_ERROR_MEMORY; }) == METIS_ERROR_MEMORY);
  CHECK(metis_status([] { return METIS_OK; }) == METIS_OK);
  CHECK(caught == 1);
  std::signal(SIGTERM, before);
}
