// SPDX-License-Identifier: GPL-3.0-or-later
// Counts of memory: what is allocated is what was counted, and what does not fit is refused before any of it is.
#include "core/memory.hpp"

#include "../support/matrices.hpp"
#include "../support/problems.hpp"
#include "../support/sanitized.hpp"
#include "linalg/multifrontal/analysis.hpp"
#include "linalg/multifrontal/factor.hpp"
#include "linalg/multifrontal/lu.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include "study/tables/study.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <numeric>

using namespace nscdd;

namespace {

// Holds the limit of the process, and puts it back.
class Limit {
 public:
  explicit Limit(double more) {
    getrlimit(RLIMIT_RSS, &before_);
    limit_memory(memory_in_use() + more);
  }
  ~Limit() { setrlimit(RLIMIT_RSS, &before_); }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;

 private:
  rlimit before_{};
};

// The lower triangle of a definite matrix on a square of points.
SparseMatrix laplacian(Index width) { return testing::shifted_laplacian(width, width, -1); }

std::vector<Index> last_rows(const SparseMatrix& matrix, Index number) {
  std::vector<Index> rows(at(number));
  std::iota(rows.begin(), rows.end(), matrix.rows() - number);
  return rows;
}

// What `make` makes holds as many bytes as were counted. malloc adds to each block, and large ones begin and end with
// pages of 2 MiB.
template <class Make>
void check_held(double counted, const Make& make) {
  if (testing::sanitized) return;  // they have a heap of their own
  const double before = memory_in_use();
  const auto made = make();
  const double held = memory_in_use() - before;
  CAPTURE(counted);
  CHECK(held > 0.99 * counted);
  CHECK(held < 1.03 * counted + 8 * (1 << 20));
}

// Refused with a megabyte less than what is needed at once, and done with some more.
template <class Work>
void check_refused(double needed, const Work& work, double spare = smallest_checked_need) {
  if (testing::sanitized) return;
  CAPTURE(needed);
  REQUIRE(needed > 4 * smallest_checked_need);
  {
    const Limit limit(needed - smallest_checked_need);
    CHECK_THROWS_AS(work(), Error);
  }
  const Limit limit(needed + spare);
  CHECK_NOTHROW(work());
}

}  // namespace

TEST_CASE("memory: a symmetric factor takes what its analysis counts, on any number of threads") {
  const SparseMatrix lower = laplacian(200);
  for (const Index border : {0, 300}) {
    CAPTURE(border);
    const SymmetricAnalysis analysis(lower, testing::single_rows(lower.rows()), {}, last_rows(lower, border));
    const FactorMemory memory = factor_memory(*analysis.tree(), FactorShape::symmetric);
    CHECK(memory.held > 8 * analysis.entries());
    CHECK(memory.at_once > memory.held);
    CHECK(memory.at_once < 1.6 * memory.held);
    for (const Index threads : {1, 4}) {
      const ThreadLimit limit(threads);
      check_held(memory.held, [&] { return SymmetricFactor(analysis, lower); });
    }
    if (border > 0) {
      const SymmetricInterior interior = eliminated_interior(analysis, lower);
      const SymmetricFactor first(interior, lower);
      check_held(memory.border, [&] { return SymmetricFactor(interior, lower); });
    }
    check_refused(memory.at_once, [&] { return SymmetricFactor(analysis, lower); });
  }
}

TEST_CASE("memory: a Cholesky factor takes what its analysis counts, by columns and by supernodes") {
  SparseEntries chain;
  for (Index i = 0; i < 200'000; ++i)
    for (Index j = std::max<Index>(0, i - 2); j <= i; ++j) chain.add(i, j, i == j ? 5 : -1);
  for (const SparseMatrix& lower :
       testing::watched<SparseMatrix>({laplacian(170), chain.matrix(200'000, 200'000), laplacian(420)})) {
    CAPTURE(lower.rows());
    const CholeskyAnalysis analysis(lower);
    const double counted = analysis.bytes_at_once(lower);
    const SparseCholesky factor(analysis, lower);
    REQUIRE(factor.positive_definite());
    CHECK(counted == doctest::Approx(factor.bytes_at_most()).epsilon(0.002));
    check_refused(counted, [&] { return SparseCholesky(analysis, lower); });
  }
}

TEST_CASE("memory: L U takes what is counted, and is refused before") {
  SparseMatrix a = laplacian(200).selfadjointView<Eigen::Lower>();
  a.makeCompressed();
  const auto factorised = [&] {
    SparseLu lu(a);
    REQUIRE(lu.factorise(a));
    return lu;
  };
  const double counted = SparseLu(a).bytes_at_once();
  const ThreadLimit limit(1);
  check_held(counted, factorised);
  check_refused(counted, factorised, 16 * smallest_checked_need);  // its analysis takes some, too
}

TEST_CASE("memory: a dense pencil takes six matrices, and a study names the case that does not fit") {
  StudyTable table;
  table.cases = {testing::random_lattice(1, 40, 40, {8, 8})};
  table.sweep.spectral.solver = SpectralSolver::dense;
  const Index n = build(table.cases.front()).parts.interface_size();
  const auto run = [&] { run_table(table, [](const Row&) {}); };
  check_refused(6 * bytes_of_matrix(n, n), run, 64 * smallest_checked_need);  // for the model
  table.sweep.spectral.solver = SpectralSolver::arpack;
  const Limit limit(5 * bytes_of_matrix(n, n));
  CHECK_NOTHROW(run());
  table.sweep.spectral.solver = SpectralSolver::dense;
  if (!testing::sanitized) CHECK_THROWS_WITH_AS(run(), doctest::Contains(table.cases.front().spec.name.c_str()), Error);
}
