// SPDX-License-Identifier: GPL-3.0-or-later
#include "mumps.hpp"

#include "linalg/threads.hpp"

#include <dmumps_c.h>

#include <mutex>
#include <stdexcept>

namespace nscdd::testing {
namespace {

// A count holds up to an inexactness of 1. Next to an eigenvalue the judge's may exceed what counts as reliable.
constexpr double judge_inexactness = 0.1;

std::mutex one_call_at_a_time;  // MUMPS and its orderings keep state in static memory

// One instance of MUMPS. `icntl` and `infog` are numbered from 1 as in its guide.
class Mumps {
 public:
  Mumps(const SparseMatrix& pattern, double pivot_threshold) : size_(pattern.rows()) {
    const std::lock_guard lock(one_call_at_a_time);
    data_.par = 1;
    data_.sym = 2;  // symmetric, indefinite
    data_.comm_fortran = -987654;
    run(-1);
    for (const int printing : {1, 2, 3}) icntl(printing) = -1;
    icntl(4) = 0;
    icntl(13) = 1;    // the root is factorised like all else: the inertia is exact
    icntl(14) = 100;  // per cent of memory for delayed pivots
    data_.cntl[0] = pivot_threshold;
    for (Index j = 0; j < pattern.outerSize(); ++j)
      for (SparseMatrix::InnerIterator e(pattern, j); e; ++e) {
        rows_.push_back(static_cast<int>(e.row()) + 1);
        columns_.push_back(static_cast<int>(j) + 1);
      }
    data_.n = static_cast<int>(size_);
    data_.nnz = count(rows_);
    data_.irn = rows_.data();
    data_.jcn = columns_.data();
  }
  ~Mumps() {
    const std::lock_guard lock(one_call_at_a_time);
    run(-2);
  }
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  // False if there is no factor.
  bool factorise(const SparseMatrix& lower) {
    const std::lock_guard lock(one_call_at_a_time);
    values_ = Eigen::Map<const Vector>(lower.valuePtr(), lower.nonZeros());
    data_.a = values_.data();
    if (!analysed_) run(1);  // looks at the values as well
    analysed_ = true;
    run(2);
    while (infog(1) == -8 || infog(1) == -9) {  // memory
      icntl(14) *= 2;
      run(2);
    }
    return infog(1) >= 0;
  }
  Index negative_eigenvalues() const { return infog(12); }

  Vector solve(Vector b) {
    const std::lock_guard lock(one_call_at_a_time);
    data_.rhs = b.data();
    run(3);
    if (infog(1) < 0) throw std::runtime_error("MUMPS: no solution");
    return b;
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
  Index size_;
  std::vector<int> rows_, columns_;
  Vector values_;
  bool analysed_ = false;
};

// A factor that solves from, to and on the border by whole solves.
InertiaFactor with_whole_solves(Index negative_eigenvalues, InertiaFactor::Solve solve, const InertiaPattern& pattern) {
  const auto spread = [n = pattern.lower.rows()](const Vector& g) {
    Vector x = Vector::Zero(n);
    x.tail(g.size()) = g;
    return x;
  };
  const auto gather = [border = pattern.border](const Vector& x) -> Vector { return x.tail(border); };
  return {.regular = true,
          .negative_eigenvalues = negative_eigenvalues,
          .solve = solve,
          .solve_from_border = [=](const Vector& g) { return solve(spread(g)); },
          .solve_to_border = [=](const Vector& b) { return gather(solve(b)); },
          .solve_on_border = [=](const Vector& g) { return gather(solve(spread(g))); }};
}

}  // namespace

InertiaMethod mumps(double pivot_threshold) {
  const auto analyse = [pivot_threshold](const InertiaPattern& pattern) {
    // An instance whose factor nobody holds any more serves the next matrix with the analysis it has.
    const auto last = std::make_shared<std::shared_ptr<Mumps>>();
    const auto factorise = [=](const SparseMatrix& lower, const std::array<double, 2>&) -> InertiaFactor {
      if (last->use_count() != 1) *last = std::make_shared<Mumps>(lower, pivot_threshold);
      const std::shared_ptr<Mumps> own = *last;
      if (!own->factorise(lower)) return {};
      const auto solve = [own](const Vector& b) { return own->solve(b); };
      return with_whole_solves(own->negative_eigenvalues(), solve, pattern);
    };
    return InertiaFamily{factorise, [] {}};
  };
  return {"mumps", analyse};
}

InertiaMethod judged(InertiaMethod method, InertiaMethod judge, std::shared_ptr<MumpsVerdict> verdict) {
  const auto analyse = [=](const InertiaPattern& pattern) {
    const InertiaFamily family = method.analyse(pattern), second = judge.analyse(pattern);
    const auto factorise = [=](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
      const auto error_of = [&](const InertiaFactor& factor) {
        return factor.regular ? inexactness(factor, lower, pattern.border) : infinity;
      };
      const InertiaFactor factor = family.factorise(lower, parameters);
      if (error_of(factor) >= reliable_inexactness) return factor;
      const InertiaFactor other = second.factorise(lower, parameters);
      if (error_of(other) >= judge_inexactness) {
        ++verdict->undecided;
      } else {
        ++verdict->judged;
        verdict->differing += other.negative_eigenvalues != factor.negative_eigenvalues;
      }
      return factor;
    };
    return InertiaFamily{factorise, family.release};
  };
  return {method.name + " judged by " + judge.name, analyse};
}

}  // namespace nscdd::testing
