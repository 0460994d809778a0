// SPDX-License-Identifier: GPL-3.0-or-later
// Our multifrontal L D L^T (src/linalg/multifrontal) against sequential MUMPS in one run: the shifted pencils of a
// deposit in vertical strips, factorised at several shifts. Both are asked the same: analyse the pattern
// once, then for each shift factorise, count the negative eigenvalues and solve on the interface.
//
// usage: build/release/ldlt_benchmark [GRAINS [STRIPS [SHIFTS [THREADS]]]]   (10000 16 5 1)
//
// Prints the seconds of each, best and median over the shifts, and the ratio MUMPS / ours of the medians.
// Ends with 1 if the two count differently.
#include "../tests/support/mumps.hpp"
#include "ddm/shifted_pencil.hpp"
#include "linalg/threads.hpp"
#include <nscdd/ddm/contraction.hpp>
#include <nscdd/ddm/partitioners/grid.hpp>
#include <nscdd/packing/generator.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

using namespace nscdd;

namespace {

template <class Work>
double seconds(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Times {
  double analysis = 0;
  std::vector<double> factorisations, solves;
  std::vector<Index> counts;
  double worst_inexactness = 0;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void measure(const ShiftedPencilFamily& family, double epsilon, double eta, double shift, Index border, Times& times) {
  std::optional<ShiftedPencil> pencil;
  times.factorisations.push_back(seconds([&] { pencil = family.at(epsilon, eta, shift); }));
  times.counts.push_back(pencil->below());
  times.worst_inexactness = std::max(times.worst_inexactness, pencil->inexactness());
  const Vector g = Vector::LinSpaced(border, -1, 1);
  times.solves.push_back(seconds([&] { pencil->solve(g); }));
}

void print_row(const char* name, const std::vector<double>& ours, const std::vector<double>& mumps) {
  std::printf("%-22s %9.4f %9.4f   %9.4f %9.4f   %6.2f\n", name, *std::min_element(ours.begin(), ours.end()),
              median(ours), *std::min_element(mumps.begin(), mumps.end()), median(mumps), median(mumps) / median(ours));
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int k, long standard) { return argc > k ? std::atol(argv[k]) : standard; };
  const Index grains = argument(1, 10000), strips = argument(2, 16), shifts = argument(3, 5);
  const ThreadLimit limit(argument(4, 1));
  const Packing packing = with_masses(generate(Deposit{.grains = grains}), {MassModel::unit, 0});
  const ContactNetwork network = detect_contacts(packing);
  const auto problem = assemble(packing, network);
  const auto parts = decompose(problem, partition(GridPartitioner{{strips, 1}}, packing, network));
  bool agree = true;
  for (const double eta : {infinity, 0.5}) {
    const double epsilon = 0.01;
    const Contraction b = contraction(parts, Enriched{.eta = eta}, LinearViscous{.epsilon = epsilon});
    Times ours, mumps;
    std::optional<ShiftedPencilFamily> own, other;
    ours.analysis = seconds([&] { own.emplace(b, SystemForm::condensed, multifrontal()); });
    mumps.analysis = seconds([&] { other.emplace(b, SystemForm::condensed, testing::mumps()); });
    for (Index k = 0; k < shifts; ++k) {  // alternating, so that other work on the machine meets both
      const double shift = 0.02 * static_cast<double>(k + 1);
      measure(*own, epsilon, eta, shift, b.rows(), ours);
      measure(*other, epsilon, eta, shift, b.rows(), mumps);
    }
    std::printf("%ld grains, %ld strips, eta = %g: %ld unknowns on the interface\n", static_cast<long>(grains),
                static_cast<long>(strips), eta, static_cast<long>(b.rows()));
    std::printf("%-22s %19s   %19s   %6s\n", "seconds (best, median)", "ours", "MUMPS", "ratio");
    print_row("analysis", {ours.analysis}, {mumps.analysis});
    print_row("first shift", {ours.factorisations[0]}, {mumps.factorisations[0]});
    ours.factorisations.erase(ours.factorisations.begin());
    mumps.factorisations.erase(mumps.factorisations.begin());
    if (!ours.factorisations.empty()) print_row("further shifts", ours.factorisations, mumps.factorisations);
    print_row("solve on the interface", ours.solves, mumps.solves);
    std::printf("inexactness at most %.1e, %.1e; counts %s\n\n", ours.worst_inexactness, mumps.worst_inexactness,
                ours.counts == mumps.counts ? "equal" : "DIFFER");
    agree = agree && ours.counts == mumps.counts;
  }
  return agree ? 0 : 1;
}
