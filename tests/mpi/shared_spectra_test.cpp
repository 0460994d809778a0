// SPDX-License-Identifier: GPL-3.0-or-later
// Spectra of packings that processes share, against those of one process with our own factorisation.
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "../support/thorough.hpp"
#include "ddm/shifted_pencil.hpp"
#include <nscdd/mpi/multifrontal.hpp>
#include <nscdd/mpi/processes.hpp>
#include <nscdd/mpi/slepc.hpp>
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/model.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

const SpectralOptions serial{.solver = SpectralSolver::shift_invert, .certify = true};

struct Shared {
  Processes processes = mpi::processes_of(MPI_COMM_WORLD);
  InertiaMethod method = mpi::multifrontal(MPI_COMM_WORLD);
  SpectralOptions options{.solver = serial.solver, .certify = true, .inertia = method};
};

struct Pair {
  double epsilon, eta;
};
const std::vector<Pair> pairs{{1e-4, infinity}, {1e-2, infinity}, {1.0, infinity}, {1e-2, 1.0},
                              {1e-2, 1e-3},     {1e2, 5.0},       {0.1, 0.1001}};

// Those that the laws are tested on.
std::vector<Case> packings() {
  std::vector<Case> all = every_problem();
  const std::vector<Case> more = packings_up_to(500);
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

// Packings with as many subdomains as there are processes, or more.
int for_shared_packings(const Shared& shared, Index most_unknowns,
                        const std::function<void(const Model& whole, const Model& own)>& visit) {
  int visited = 0;
  for (const Case& one : packings()) {
    const Model whole = build(one);
    if (count(whole.parts.subdomains) < shared.processes.size || whole.parts.interface_size() < 5 ||
        whole.parts.interface_size() > most_unknowns)
      continue;
    CAPTURE(one.spec.name);
    visit(whole, of_process(whole, shared.processes));
    ++visited;
  }
  return visited;
}

void check_same(const SpectralRadius& found, const SpectralRadius& known, double slack) {
  CHECK(known.converged);
  // Where all eigenvalues crowd next to 0 a factor that rounds otherwise may not prove an end: the row says so then.
  const bool crowded = known.value <= 1e-2;
  if (crowded && !found.certified) {
    CHECK_FALSE(found.converged);
    return;
  }
  CHECK(found.converged);
  CHECK(found.certified);
  CHECK(found.unit_multiplicity == known.unit_multiplicity);
  const double off = found.residual + known.residual + slack;
  CHECK(std::abs(found.value - known.value) <= off);
  CHECK(std::abs(found.subdominant_min - known.subdominant_min) <= off);
  CHECK(std::abs(found.subdominant_max - known.subdominant_max) <= off);
  CHECK(found.within_min == known.within_min);
  CHECK(found.within_max == known.within_max);
  // Where all eigenvalues crowd next to 0, rounding decides how near to an end a count succeeds: intervals that hold
  // the same end differ by their widths then.
  const auto widths = [&](auto interval) {
    return !crowded ? 0.0 : (found.*interval)[1] - (found.*interval)[0] + (known.*interval)[1] - (known.*interval)[0];
  };
  const double off_min = off + widths(&SpectralRadius::interval_min),
               off_max = off + widths(&SpectralRadius::interval_max);
  for (const std::size_t side : {0U, 1U}) {
    CHECK(std::abs(found.interval_min[side] - known.interval_min[side]) <= off_min);
    CHECK(std::abs(found.interval_max[side] - known.interval_max[side]) <= off_max);
  }
}

}  // namespace

TEST_CASE("shared: radii, certified intervals and counts are those of one process") {
  const Shared shared;
  const int visited = for_shared_packings(shared, 500, [&](const Model& whole, const Model& own) {
    const InterfaceFamily family(whole.parts), of_own(own.parts);
    for (const Pair& pair : pairs) {
      const double epsilon = pair.epsilon, eta = pair.eta;
      INFO("epsilon = ", epsilon, ", eta = ", eta);
      const SpectralRadius found = spectral_radius({of_own.at(eta), of_own.at(epsilon)}, shared.options);
      if (shared.processes.first())
        check_same(found, spectral_radius({family.at(eta), family.at(epsilon)}, serial), 1e-10);
    }
  });
  CHECK(visited > 5);
}

TEST_CASE("shared: the scheme schwarz has the radii and counts of one process, rigid too") {
  const Shared shared;
  const int visited = for_shared_packings(shared, 150, [&](const Model& whole, const Model& own) {
    for (const double epsilon : {0.0, 1e-2, 1.0}) {
      CAPTURE(epsilon);
      const SpectralRadius found =
          spectral_radius(schwarz_contraction(own.parts, LinearViscous{epsilon}), shared.options);
      const SpectralRadius known = spectral_radius(schwarz_contraction(whole.parts, LinearViscous{epsilon}), serial);
      if (known.converged) check_same(found, known, 1e-10);
    }
  });
  CHECK(visited > 3);
}

TEST_CASE("shared: SLEPc, which has another pencil and another search, finds the same ends") {
  const Shared shared;
  const SpectralOptions options{.solver = SpectralSolver::slepc, .slepc = mpi::slepc(MPI_COMM_WORLD)};
  const int visited = for_shared_packings(shared, 150, [&](const Model& whole, const Model& own) {
    const InterfaceFamily family(whole.parts), of_own(own.parts);
    // Processes that have to take turns on a core wait for each other a hundred thousand times.
    const std::size_t step = thorough() ? 1 : shared.processes.size > 2 ? pairs.size() : 3;
    for (std::size_t k = 0; k < pairs.size(); k += step) {
      const double epsilon = pairs[k].epsilon, eta = pairs[k].eta;
      INFO("epsilon = ", epsilon, ", eta = ", eta);
      const SpectralRadius found = spectral_radius({of_own.at(eta), of_own.at(epsilon)}, options);
      if (!shared.processes.first()) continue;
      if (eta / epsilon < 1.01 && eta > epsilon) {  // all eigenvalues next to 1: SLEPc may break down, and says so
        CHECK((found.converged || std::isnan(found.residual)));
        continue;
      }
      const SpectralRadius known =
          spectral_radius({family.at(eta), family.at(epsilon)}, {.solver = SpectralSolver::shift_invert});
      CHECK(found.solver == "slepc");
      CHECK(found.converged);
      const double off = 2 * (found.residual + known.residual) + 1e-9;
      CHECK(std::abs(found.value - known.value) <= off);
      CHECK(std::abs(found.subdominant_min - known.subdominant_min) <= off);
      CHECK(std::abs(found.subdominant_max - known.subdominant_max) <= off);
    }
  });
  CHECK(visited > 3);
  const Model own = of_process(build(random_lattice(3, 12, 12, {4, 2})), shared.processes);
  const InterfaceFamily rigid(own.parts);
  CHECK_THROWS_WITH_AS(spectral_radius({rigid.at(infinity), rigid.at(0)}, options),
                       "solver slepc: expected epsilon > 0, met 0: shift-invert has the rigid limit", Error);
}

TEST_CASE("shared: the rigid limit") {
  const Shared shared;
  int found_zeros = 0;
  for_shared_packings(shared, 400, [&](const Model& whole, const Model& own) {
    const InterfaceFamily family(whole.parts), of_own(own.parts);
    for (const double eta : {infinity, 0.3}) {
      const SpectralRadius known = spectral_radius({family.at(eta), family.at(0)}, serial);
      const SpectralRadius found = spectral_radius({of_own.at(eta), of_own.at(0)}, shared.options);
      if (!known.converged) continue;
      CAPTURE(eta);
      check_same(found, known, 1e-10);
      found_zeros += found.unit_multiplicity > 0;
    }
  });
  CHECK(found_zeros > 0);
}

TEST_CASE("shared: the rigid limit of a lattice of spheres, where a cluster has most grains of a subdomain") {
  const Shared shared;
  for (const double vacancies : {0.0, 0.15}) {
    CAPTURE(vacancies);
    Case one;
    one.spec.packing = Generator{FccLattice{{.columns = 10, .rows = 10, .layers = 10, .vacancies = vacancies}}};
    one.spec.masses.model = MassModel::unit;
    one.spec.partition = GridPartitioner{{2, 2, 2}};
    const Model whole = build(one), own = of_process(whole, shared.processes);
    const InterfaceFamily family(whole.parts), of_own(own.parts);
    for (const double eta : {infinity, 0.3}) {
      CAPTURE(eta);
      const SpectralRadius known = spectral_radius({family.at(eta), family.at(0)}, serial);
      const SpectralRadius found = spectral_radius({of_own.at(eta), of_own.at(0)}, shared.options);
      check_same(found, known, 1e-10);
      CHECK(found.unit_multiplicity > 100);
    }
  }
}

TEST_CASE("shared: operators have the bits of one process") {
  const Shared shared;
  const int visited = for_shared_packings(shared, 800, [&](const Model& whole, const Model& own) {
    const InterfaceFamily family(whole.parts), of_own(own.parts);
    const Vector f = Vector::LinSpaced(whole.parts.interface_size(), -1, 2);
    for (const double eta : {infinity, 1.0, 1e-3}) {
      CAPTURE(eta);
      CHECK(of_own.at(eta).apply(f) == family.at(eta).apply(f));
      CHECK(of_own.at(eta).scale() == family.at(eta).scale());
      CHECK(of_own.at(eta).dense() == family.at(eta).dense());
      CHECK(of_own.at(eta).slope(f) == doctest::Approx(family.at(eta).slope(f)).epsilon(1e-13));
    }
    CHECK(of_own.at(infinity).solve(f) == family.at(infinity).solve(f));
    CHECK(Matrix(of_own.at(1).generic()) == Matrix(family.at(1).generic()));
    CHECK(of_own.at(0).nullity() == family.at(0).nullity());
  });
  CHECK(visited > 5);
}

TEST_CASE("shared: a factor counts and solves as our own does, also after the next one was made") {
  const Shared shared;
  const int visited = for_shared_packings(shared, 400, [&](const Model& whole, const Model& own) {
    const InterfaceFamily family(whole.parts), of_own(own.parts);
    const Contraction one{family.at(0.3), family.at(1e-2)}, mine{of_own.at(0.3), of_own.at(1e-2)};
    const ShiftedPencilFamily alone(one), together(mine, SystemForm::condensed, shared.method);
    const Vector g = Vector::LinSpaced(one.rows(), 1, -3);
    std::optional<ShiftedPencil> kept;
    for (const double sigma : {0.05, 0.4, 1.3}) {
      CAPTURE(sigma);
      const ShiftedPencil known = alone.at(1e-2, 0.3, sigma), found = together.at(1e-2, 0.3, sigma);
      REQUIRE(found.reliable());
      CHECK(found.below() == known.below());
      const Vector x = known.solve(g);
      CHECK((found.solve(g) - x).norm() < 1e-8 * x.norm());
      if (kept) CHECK((kept->solve(g) - alone.at(1e-2, 0.3, kept->shift()).solve(g)).norm() < 1e-6 * x.norm());
      kept = found;
    }
  });
  CHECK(visited > 3);
}

TEST_CASE("shared: a matrix after a singular one is factorised") {
  const Shared shared;
  SparseMatrix lower(3, 3);  // a row of each process, and a border of two
  lower.setIdentity();
  const SparseMatrix zero = 0 * lower, negative = -1 * lower;
  const InertiaFamily family = shared.method.analyse({.lower = lower, .group = {0, 1, 2}, .border = 2});
  for (int round = 0; round < 2; ++round) {
    CHECK(!family.factorise(zero, {1, 0}).regular);
    const InertiaFactor factor = family.factorise(negative, {2, 0});
    REQUIRE(factor.regular);
    CHECK(factor.negative_eigenvalues == shared.processes.size + 2);
    const Vector x = factor.solve_on_border(Vector::Ones(2));  // the border is the sum over the processes
    CHECK((x + Vector::Constant(2, 1.0 / static_cast<double>(shared.processes.size))).norm() < 1e-14);
  }
}

TEST_CASE("shared: operations are counted, each once, and along the longest way") {
  const Processes all = mpi::processes_of(MPI_COMM_WORLD);
  int side_by_side = 0;
  const int visited = for_shared_packings({all, {}, {}}, 400, [&](const Model& whole, const Model& own) {
    const auto alone = std::make_shared<WorkCount>(), here = std::make_shared<WorkCount>();
    const auto solve = [](const Model& model, const InertiaMethod& method) {
      SpectralOptions options{.solver = SpectralSolver::shift_invert, .certify = true, .inertia = method};
      const InterfaceFamily family(model.parts);
      spectral_radius({family.at(infinity), family.at(1)}, options);
    };
    solve(whole, multifrontal(alone));
    solve(own, mpi::multifrontal(MPI_COMM_WORLD, here));
    CHECK(alone->flops == alone->path_flops);
    CHECK(alone->flops > 0);
    const double flops = here->flops, path = here->path_flops, sum = all.sum(flops);
    CHECK(path >= flops);
    CHECK(path <= sum);
    CHECK(all.maximum(path) == path);  // all of them know it
    if (all.alone()) CHECK(flops == path);
    side_by_side += path < 0.9 * sum;
  });
  CHECK(visited > 0);
  CHECK((side_by_side > 0) == !all.alone());
}

TEST_CASE("shared: solutions with X_eta are those of the undivided packing, in all processes alike") {
  const Shared shared;
  const int visited = for_shared_packings(shared, 500, [&](const Model& whole, const Model& own) {
    const InterfaceFamily family(whole.parts);
    const InterfaceFamily of_own(own.parts, InterfaceFamily::default_dense_limit, shared.method);
    for (const double eta : {1e-4, 0.3, 1e3}) {
      CAPTURE(eta);
      const InterfaceOperator x = of_own.at(eta);
      const Vector f = Vector::LinSpaced(x.rows(), -1, 2), found = x.solve(x.apply(f));
      CHECK((found - f).norm() < 1e-8 * f.norm());
      Vector of_first = found;
      MPI_Bcast(of_first.data(), static_cast<int>(of_first.size()), MPI_DOUBLE, 0, MPI_COMM_WORLD);
      CHECK(found == of_first);
      const Vector known = family.at(eta).solve(f), again = x.solve(f);
      CHECK((again - known).norm() < 1e-8 * known.norm());
    }
  });
  CHECK(visited > 5);
}

TEST_CASE("shared: what needs the undivided packing is refused") {
  const Shared shared;
  if (shared.processes.alone()) return;
  const int visited = for_shared_packings(shared, 100, [&](const Model&, const Model& own) {
    const InterfaceFamily family(own.parts);
    CHECK_THROWS_WITH_AS(family.at(1).solve(Vector::Ones(own.parts.interface_size())),
                         doctest::Contains("expected one, or a way to factorise, for solutions with X_eta"), Error);
  });
  CHECK(visited > 0);
}
