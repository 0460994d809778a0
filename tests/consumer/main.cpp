// SPDX-License-Identifier: GPL-3.0-or-later
// The paper in a few lines, against the installed library: rho(B_0) of the 4 disks is (29 + sqrt 57)/56. The
// program around it has settings of its own: two BLAS threads, an error handler of GSL, a sequence of random
// numbers. It finds them as they were, and results do not depend on them.
#include <nscdd/nscdd.hpp>

#include <gsl/gsl_errno.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

extern "C" {  // null if the BLAS is another than OpenBLAS
__attribute__((weak)) void openblas_set_num_threads(int);
__attribute__((weak)) int openblas_get_num_threads();
}

namespace {

using namespace nscdd;

bool all_well = true;

void expect(bool true_statement, const std::string& what) {
  if (!true_statement) std::cout << "not so: " << what << '\n';
  all_well = all_well && true_statement;
}

int blas_threads() { return openblas_get_num_threads == nullptr ? 0 : openblas_get_num_threads(); }

void set_blas_threads(int threads) {
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(threads);
}

void own_handler(const char*, const char*, int, int) {}

gsl_error_handler_t* gsl_handler() {
  gsl_error_handler_t* const handler = gsl_set_error_handler_off();
  gsl_set_error_handler(handler);
  return handler;
}

struct Model {
  Packing packing;
  ContactNetwork network;
  ReferenceProblem problem;
};

Model strip_of(Index grains, Index rows) {
  const Generator generator = rows == 1 ? Generator(TriangularStrip{.grains = grains})
                                        : Generator(HexagonalLattice{.columns = grains, .rows = rows, .radius = 0.5});
  const Packing packing = with_masses(generate(generator), {MassModel::unit, 0});
  const ContactNetwork network = detect_contacts(packing);
  return {packing, network, assemble(packing, network)};
}

void check_the_paper() {
  const Model disks = strip_of(4, 1);
  const auto parts = decompose(disks.problem, partition(GridPartitioner{{2, 1}}, disks.packing, disks.network));
  const auto b = contraction(parts, Generic{}, LinearViscous{.epsilon = 0});
  const auto rho = spectral_radius(b);  // value, ends of the spectrum, residual, applications, converged
  std::cout.precision(16);
  std::cout << "rho(B_0) = " << rho.value << ", residual " << rho.residual << '\n';
  expect(std::abs(rho.value - (29 + std::sqrt(57.0)) / 56) < 1e-14 && rho.converged, "rho(B_0) of the paper");
}

// Interface matrices of some hundred rows, on which OpenBLAS would use its threads.
void check_the_process() {
  const Model lattice = strip_of(40, 40);
  const auto cut = [&] { return decompose(lattice.problem, partition(MetisPartitioner{.metis = 6}, lattice.problem)); };
  const auto radius = [](const Decomposition& parts, SpectralSolver solver) {
    return spectral_radius(contraction(parts, Enriched{.eta = 0.5}, LinearViscous{.epsilon = 0.1}), {.solver = solver});
  };
  const auto unchanged = [](const char* after) {
    const std::string what = std::string(" of the program after ") + after;
    expect(blas_threads() == 0 || blas_threads() == 2, "BLAS threads" + what);
    expect(gsl_handler() == &own_handler, "GSL's error handler" + what);
  };
  set_blas_threads(1);
  const auto reference = cut();
  const SpectralRadius dense = radius(reference, SpectralSolver::dense);
  const SpectralRadius sparse = radius(reference, SpectralSolver::shift_invert);
  std::srand(7);
  const int expected[] = {std::rand(), std::rand()};

  set_blas_threads(2);
  gsl_set_error_handler(&own_handler);
  std::srand(7);
  const int first = std::rand();
  const auto parts = cut();
  unchanged("a partition by METIS");
  const SpectralRadius dense_again = radius(parts, SpectralSolver::dense);
  unchanged("a dense spectrum");
  const SpectralRadius sparse_again = radius(parts, SpectralSolver::shift_invert);
  unchanged("a sparse spectrum");
  const auto strips = decompose(lattice.problem, partition(GridPartitioner{{3, 1}}, lattice.packing, lattice.network));
  const double eta = optimal_eta(strips, strips);
  unchanged("a search for the best eta");
  expect(eta > 0, "a best eta");
  expect(first == expected[0] && std::rand() == expected[1], "the program's random numbers go on");
  expect(dense.value == dense_again.value && dense.residual == dense_again.residual &&
             dense.mode_max == dense_again.mode_max,
         "the same bits of a dense spectrum with one BLAS thread and with two");
  expect(sparse.value == sparse_again.value && sparse.residual == sparse_again.residual &&
             sparse.mode_max == sparse_again.mode_max,
         "the same bits of a sparse spectrum with one BLAS thread and with two");
  expect(std::abs(dense.value - sparse.value) <= sparse.residual + 1e-10, "both spectra agree");
}

}  // namespace

int main() {
  check_the_paper();
  check_the_process();
  return all_well ? 0 : 1;
}
