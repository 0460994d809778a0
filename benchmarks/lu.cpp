// SPDX-License-Identifier: GPL-3.0-or-later
// Our multifrontal L U (src/linalg/multifrontal) against UMFPACK in one run: matrices M + H E H^T of a global contact
// problem, E with random 2 x 2 blocks as the contact solvers have them. Both analyse the pattern once, then factorise
// and solve one matrix after the other.
//
// usage: build/release/lu_benchmark PROBLEM.hdf5 [MATRICES]   (FCLIB, global; 15)
//
// Prints the median seconds of each and the ratio UMFPACK / ours, and ends with 1 if a residual exceeds 1e-6.
#include "linalg/multifrontal/lu.hpp"

#include "linalg/random.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include <nscdd/formats/fclib.hpp>

#include <umfpack.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

using namespace nscdd;

namespace {

struct Times {
  std::vector<double> analyses, factorisations, solves;
  double residual = 0;
};

template <class Work>
void time(std::vector<double>& seconds, Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void judge(Times& times, const SparseMatrix& a, const Vector& x, const Vector& b) {
  times.residual = std::max(times.residual, (a * x - b).norm() / b.norm());
}

class Umfpack {
 public:
  explicit Umfpack(const SparseMatrix& a) {
    umfpack_di_defaults(control_);
    control_[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
    control_[UMFPACK_ORDERING] = UMFPACK_ORDERING_AMD;
    control_[UMFPACK_IRSTEP] = 0;
    const int n = static_cast<int>(a.rows());
    umfpack_di_symbolic(n, n, a.outerIndexPtr(), a.innerIndexPtr(), nullptr, &symbolic_, control_, nullptr);
  }
  ~Umfpack() {
    umfpack_di_free_numeric(&numeric_);
    umfpack_di_free_symbolic(&symbolic_);
  }
  Umfpack(const Umfpack&) = delete;
  Umfpack& operator=(const Umfpack&) = delete;

  void factorise(const SparseMatrix& a) {
    umfpack_di_free_numeric(&numeric_);
    umfpack_di_numeric(a.outerIndexPtr(), a.innerIndexPtr(), a.valuePtr(), symbolic_, &numeric_, control_, nullptr);
  }
  Vector solve(const SparseMatrix& a, const Vector& b) const {
    Vector x(b.size());
    umfpack_di_solve(UMFPACK_A, a.outerIndexPtr(), a.innerIndexPtr(), a.valuePtr(), x.data(), b.data(), numeric_,
                     control_, nullptr);
    return x;
  }

 private:
  double control_[UMFPACK_CONTROL] = {};
  void *symbolic_ = nullptr, *numeric_ = nullptr;
};

// Blocks of sizes over six decades around 1 / W_nn; every third contact slides.
SparseMatrix matrix(const GlobalFrictionProblem& problem, double scale, RandomStream& random) {
  SparseEntries entries;
  for (Index c = 0; c < problem.h.cols() / 2; ++c) {
    const double normal = scale * std::pow(10, 6 * random.uniform() - 3);
    const double tangential = scale * std::pow(10, 6 * random.uniform() - 3);
    entries.add(2 * c, 2 * c, normal);
    entries.add(2 * c + 1, 2 * c + 1, tangential);
    entries.add(2 * c + 1, 2 * c, c % 3 == 0 ? 0.3 * normal : 0);
  }
  const SparseMatrix e = entries.matrix(problem.h.cols(), problem.h.cols());
  SparseMatrix a = problem.h * e * SparseMatrix(problem.h.transpose());
  a += problem.mass;
  a += 0 * SparseMatrix(a.transpose());
  a.makeCompressed();
  return a;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: lu_benchmark PROBLEM.hdf5 [MATRICES]\n");
    return 2;
  }
  const GlobalFrictionProblem problem = read_global_problem(argv[1]);
  const Index matrices = argc > 2 ? std::atol(argv[2]) : 15;
  const ThreadLimit one(1);
  const OneBlasThread serial_blas;
  RandomStream random(1);
  const double scale = problem.mass.diagonal().mean();
  SparseMatrix a = matrix(problem, scale, random);
  Times ours, theirs;
  std::optional<SparseLu> own;
  std::optional<Umfpack> umfpack;
  time(ours.analyses, [&] { own.emplace(a); });
  time(theirs.analyses, [&] { umfpack.emplace(a); });
  Vector x;
  for (Index k = 0; k < matrices; ++k) {  // alternating, so that other work on the machine meets both
    const Vector b = random.normal_vector(a.rows());
    time(ours.factorisations, [&] { own->factorise(a); });
    time(ours.solves, [&] { x = own->solve(b); });
    judge(ours, a, x, b);
    time(theirs.factorisations, [&] { umfpack->factorise(a); });
    time(theirs.solves, [&] { x = umfpack->solve(a, b); });
    judge(theirs, a, x, b);
    a = matrix(problem, scale, random);
  }
  std::printf("%ld rows, %ld entries; median seconds of %ld matrices\n", static_cast<long>(a.rows()),
              static_cast<long>(a.nonZeros()), static_cast<long>(matrices));
  std::printf("%-12s %9s %9s %7s\n", "", "ours", "UMFPACK", "ratio");
  const auto print = [](const char* name, const std::vector<double>& own_times, const std::vector<double>& rival) {
    std::printf("%-12s %9.5f %9.5f %7.2f\n", name, median(own_times), median(rival), median(rival) / median(own_times));
  };
  print("analysis", ours.analyses, theirs.analyses);
  print("factorise", ours.factorisations, theirs.factorisations);
  print("solve", ours.solves, theirs.solves);
  std::printf("%-12s %9.1e %9.1e\n", "residual", ours.residual, theirs.residual);
  return std::max(ours.residual, theirs.residual) > 1e-6 ? 1 : 0;
}
