// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpi/mumps.hpp"

#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include "mpi/communicator.hpp"

#include <dmumps_c.h>

#include <exception>
#include <numeric>

namespace nscdd::mpi {
namespace {

constexpr int memory_per_cent = 30;  // beyond the estimate at first, for pivots that are delayed
constexpr int most_memory_per_cent = 2000;
constexpr int singular = -10;  // a status

// Where the rows of each process lie in the shared matrix: one process behind the other, the border last.
struct Layout {
  Layout(const std::shared_ptr<const Communicator>& communicator, const InertiaPattern& pattern)
      : all(communicator), border(pattern.border), own(pattern.lower.rows() - pattern.border) {
    const int mine = static_cast<int>(own);
    rows_of.resize(at(all->size()));
    MPI_Allgather(&mine, 1, MPI_INT, rows_of.data(), 1, MPI_INT, all->get());
    first_of.assign(rows_of.size(), 0);
    std::partial_sum(rows_of.begin(), rows_of.end() - 1, first_of.begin() + 1);
    interior = first_of.back() + rows_of.back();
  }
  Index size() const { return interior + border; }
  int number(Index row) const {  // of a row of this process, from 1
    const Index first = first_of[at(all->rank())];
    return static_cast<int>(row < own ? first + row : interior + row - own) + 1;
  }

  // A vector of this process's rows and the border, as the first process has it whole; and back.
  Vector gathered(const Vector& x) const {
    Vector whole(all->rank() == 0 ? size() : 0);
    MPI_Gatherv(x.data(), static_cast<int>(own), MPI_DOUBLE, whole.data(), rows_of.data(), first_of.data(), MPI_DOUBLE,
                0, all->get());
    if (all->rank() == 0) whole.tail(border) = x.tail(border);
    return whole;
  }
  Vector scattered(const Vector& whole) const {
    Vector x(own + border);
    if (all->rank() == 0) x.tail(border) = whole.tail(border);
    MPI_Scatterv(whole.data(), rows_of.data(), first_of.data(), MPI_DOUBLE, x.data(), static_cast<int>(own), MPI_DOUBLE,
                 0, all->get());
    MPI_Bcast(x.data() + own, static_cast<int>(border), MPI_DOUBLE, 0, all->get());
    return x;
  }

  std::shared_ptr<const Communicator> all;
  Index border, own, interior = 0;
  std::vector<int> rows_of, first_of;
};

// One instance of MUMPS. `icntl` and `infog` are numbered from 1 as in its guide.
class Mumps {
 public:
  Mumps(const std::shared_ptr<const Layout>& layout, const SparseMatrix& pattern) : layout_(layout) {
    data_.par = 1;
    data_.sym = 2;  // symmetric, indefinite
    data_.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(layout->all->get()));
    run(-1);
    for (const int printing : {1, 2, 3}) icntl(printing) = -1;
    icntl(4) = 0;
    icntl(13) = 1;
    icntl(14) = memory_per_cent;
    icntl(18) = 3;  // each process has its part
    for_entries(pattern, [&](Index i, Index j, double) {
      rows_.push_back(layout->number(i));
      columns_.push_back(layout->number(j));
    });
    data_.n = static_cast<MUMPS_INT>(layout->size());
    data_.nnz_loc = count(rows_);
    data_.irn_loc = rows_.data();
    data_.jcn_loc = columns_.data();
  }
  // All processes must take part. One that leaves alone, by an exception, must not wait for the others here.
  ~Mumps() {
    if (std::uncaught_exceptions() == exceptions_) run(-2);
  }
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  // False if the matrix is singular to rounding.
  bool factorise(const SparseMatrix& lower) {
    values_ = Eigen::Map<const Vector>(lower.valuePtr(), lower.nonZeros());
    data_.a_loc = values_.data();
    if (!analysed_) {
      run(1);
      if (infog(1) < 0) fail("MUMPS: expected an analysis, met status {} ({})", infog(1), infog(2));
      analysed_ = true;
    }
    run(2);
    const auto too_small = [this] {  // its work space, or what it sends and receives in
      return infog(1) == -8 || infog(1) == -9 || infog(1) == -17 || infog(1) == -20;
    };
    while (too_small() && icntl(14) < most_memory_per_cent) {
      icntl(14) *= 2;
      run(2);
    }
    if (infog(1) == -13) throw std::bad_alloc();
    if (infog(1) < 0 && infog(1) != singular) fail("MUMPS: expected a factor, met status {} ({})", infog(1), infog(2));
    return infog(1) >= 0;
  }
  Index negative_eigenvalues() const { return infog(12); }

  Vector solve(const Vector& b) {
    Vector whole = layout_->gathered(b);
    data_.rhs = whole.data();
    run(3);
    if (infog(1) < 0) fail("MUMPS: expected a solution, met status {} ({})", infog(1), infog(2));
    return layout_->scattered(whole);
  }

 private:
  void run(int job) {
    const OneBlasThread serial_blas;
    data_.job = job;
    dmumps_c(&data_);
  }
  int& icntl(int k) { return data_.icntl[k - 1]; }
  int infog(int k) const { return data_.infog[k - 1]; }

  DMUMPS_STRUC_C data_{};
  std::shared_ptr<const Layout> layout_;
  std::vector<int> rows_, columns_;
  Vector values_;
  bool analysed_ = false;
  int exceptions_ = std::uncaught_exceptions();
};

}  // namespace

InertiaMethod mumps(MPI_Comm communicator) {
  const auto all = std::make_shared<const Communicator>(communicator);
  const auto analyse = [all](const InertiaPattern& pattern) {
    const auto layout = std::make_shared<const Layout>(all, pattern);
    // An instance whose factor nobody holds any more serves the next matrix with the analysis it has.
    const auto last = std::make_shared<std::shared_ptr<Mumps>>();
    const InertiaPattern border{.lower = SparseMatrix(pattern.lower.rows(), 0), .group = {}, .border = pattern.border};
    const auto factorise = [=](const SparseMatrix& lower, const std::array<double, 2>&) -> InertiaFactor {
      if (last->use_count() != 1) *last = std::make_shared<Mumps>(layout, lower);
      const std::shared_ptr<Mumps> own = *last;
      if (!own->factorise(lower)) return {};
      const auto solve = [own](const Vector& b) { return own->solve(b); };
      return with_whole_solves(own->negative_eigenvalues(), solve, border);
    };
    const auto release = [last] {
      if (last->use_count() == 1) last->reset();
    };
    return InertiaFamily{factorise, release};
  };
  return {"mumps", analyse};
}

}  // namespace nscdd::mpi
