// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include "linalg/random.hpp"
#include "linalg/sparse_entries.hpp"
#include "two_stage/two_stage.hpp"
#include <nscdd/ddm/interface_operator.hpp>
#include <nscdd/spectra/optimal_eta.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("4 disks: the partition of the paper") {
  const Model model = build(strip(4));
  // links (0,1) (0,2) (1,2) | (1,3) (2,3): the one that straddles the line goes left
  CHECK(model.partition.subdomain_of_contact == std::vector<Index>{0, 0, 0, 1, 1});
  CHECK(model.parts.subdomains[0].grains == std::vector<Index>{0, 1, 2});
  CHECK(model.parts.subdomains[1].grains == std::vector<Index>{1, 2, 3});
  for (Index g = 0; g < 4; ++g) CHECK(model.parts.interface.multiplicity(g) == (g == 1 || g == 2 ? 2 : 1));
  CHECK(model.parts.interface_size() == 4);
  CHECK(model.parts.subdomains[0].inertia.isApprox((Vector(6) << 1, 1, 0.5, 0.5, 0.5, 0.5).finished()));
}

TEST_CASE("grid: a midpoint on a line goes to the lower cell, outer points stay inside") {
  const Packing packing{{0.0, 1.0, 2.0, 0.0}, {0.0, 0.0, 0.0, 1.0}, {0.5, 0.5, 0.5, 0.5}, {1, 1, 1, 1}};
  const ContactNetwork network = detect_contacts(packing);
  REQUIRE(network.size() == 3);  // (0,1) at x = 0.5, (0,3) at x = 0, (1,2) at x = 1.5
  CHECK(partition(GridPartitioner{{2, 1}}, packing, network).subdomain_of_contact == std::vector<Index>{0, 0, 1});
  CHECK(partition(GridPartitioner{{4, 1}}, packing, network).subdomain_of_contact == std::vector<Index>{0, 0, 2});
  CHECK(partition(GridPartitioner{{1, 2}}, packing, network).subdomain_of_contact == std::vector<Index>{0, 0, 0});
  CHECK(partition(GridPartitioner{{1, 4}}, packing, network).subdomain_of_contact == std::vector<Index>{0, 1, 0});
  CHECK_THROWS_AS(partition(GridPartitioner{{0, 1}}, packing, network), Error);
  CHECK_THROWS_AS(partition(GridPartitioner{{10000, 10000}}, packing, network), Error);
}

TEST_CASE("grid: cells in space, x first and z last, and numbers of cells for every direction of the packing") {
  // (0,1) at x = 1/2; (0,2) at y = 1/2; (1,3) at x = 1, y = 1/2; (0,4) at z = 1/2; (4,5) at z = 3/2: on the box' edges.
  const Packing packing{
      {0, 1, 0, 1, 0, 0}, {0, 0, 1, 1, 0, 0}, std::vector(6, 0.5), std::vector(6, 1.0), {0, 0, 0, 0, 1, 2}};
  const ContactNetwork network = detect_contacts(packing);
  REQUIRE(network.size() == 6);
  const auto cut = [&](Components<Index> grid) {
    std::map<std::pair<Index, Index>, Index> subdomain;
    const Partition found = partition(GridPartitioner{grid}, packing, network);
    REQUIRE(found.subdomains == grid[0] * grid[1] * grid[2]);
    for (Index c = 0; c < network.size(); ++c) {
      const Contact& contact = network.contacts[at(c)];
      subdomain[{contact.a, contact.b}] = found.subdomain_of_contact[at(c)];
    }
    return subdomain;
  };
  using Cut = std::map<std::pair<Index, Index>, Index>;
  // Lines at x = 1/2, y = 1/2, z = 1 go to the lower cell; 3 cells along z have theirs at 2/3 and 4/3.
  CHECK(cut({2, 2, 2}) == Cut{{{0, 1}, 0}, {{0, 2}, 0}, {{0, 4}, 0}, {{1, 3}, 1}, {{2, 3}, 2}, {{4, 5}, 4}});
  CHECK(cut({2, 1, 3}) == Cut{{{0, 1}, 0}, {{0, 2}, 0}, {{0, 4}, 0}, {{1, 3}, 1}, {{2, 3}, 0}, {{4, 5}, 4}});
  CHECK(cut({1, 4, 1}) == Cut{{{0, 1}, 0}, {{0, 2}, 1}, {{0, 4}, 0}, {{1, 3}, 1}, {{2, 3}, 3}, {{4, 5}, 0}});

  const auto refused = [&](Components<Index> grid, const Packing& of, const char* message) {
    CHECK_THROWS_WITH_AS(partition(GridPartitioner{grid}, of, detect_contacts(of)), message, Error);
  };
  refused({2, 2}, packing, "partition.grid: expected three integers for a packing in space, met [2, 2]");
  Packing plane{{0, 1}, {0, 0}, {0.5, 0.5}, {1, 1}};
  refused({2, 1, 1}, plane, "partition.grid: expected two integers for a packing in the plane, met [2, 1, 1]");
  refused({100, 100, 101}, packing, "partition.grid: expected between 1 and 1000000 cells, met 100 x 100 x 101");
  CHECK(subdomains(GridPartitioner{{100, 100, 100}}) == 1000000);
  // One cell is one cell.
  for (const Packing& any : {packing, plane})
    for (const Components<Index> one : {Components<Index>{1, 1}, {1, 1, 1}}) {
      const auto all = partition(GridPartitioner{one}, any, detect_contacts(any)).subdomain_of_contact;
      CHECK(std::ranges::count(all, 0) == count(all));
    }
}

TEST_CASE("METIS: every contact in a part, parts of like size, same result twice, odd numbers of parts, seeds heard") {
  const Model model = build(random_lattice(5, 12, 12, {1, 1}));
  for (const Index parts : {1, 2, 5, 8}) {
    const Partition found = partition(MetisPartitioner{.metis = parts, .seed = 3}, model.problem);
    std::map<Index, Index> sizes;
    for (const Index e : found.subdomain_of_contact) ++sizes[e];
    CHECK(count(sizes) == parts);
    for (const auto& [part, size] : sizes) CHECK(size * parts < 2 * model.problem.contacts());
    const Partition again = partition(MetisPartitioner{.metis = parts, .seed = 3}, model.problem);
    CHECK(again.subdomain_of_contact == found.subdomain_of_contact);
  }
  const Partition single = partition(MetisPartitioner{.metis = 7}, build(strip(2)).problem);
  CHECK(single.subdomain_of_contact == std::vector<Index>{0});
  CHECK_THROWS_WITH_AS(partition(MetisPartitioner{.metis = 0}, build(strip(4)).problem), doctest::Contains("met 0"),
                       Error);
  const Model large = build(random_lattice(5, 30, 30, {1, 1}));
  std::set<std::vector<Index>> met;  // different partitions among a few seeds
  for (const Index seed : {1, 2, 3, 4, 5})
    met.insert(partition(MetisPartitioner{.metis = 6, .seed = seed}, large.problem).subdomain_of_contact);
  CHECK(met.size() > 1);
}

TEST_CASE("METIS: no part is empty where there are as many contacts, and a chain falls into pieces of a line") {
  for (const Index grains : {3, 4, 5, 8, 13, 40}) {
    Case chain;
    chain.spec.packing = PackingFile{"made in a test"};
    chain.packing = {
        .x = {}, .y = std::vector<double>(at(grains), 0), .radius = std::vector<double>(at(grains), 0.5), .mass = {}};
    for (Index i = 0; i < grains; ++i) chain.packing.x.push_back(static_cast<double>(i));
    const Model model = build(chain);
    REQUIRE(model.contacts() == grains - 1);
    for (Index parts = 1; parts < grains; ++parts)
      for (const Index seed : {1, 7}) {
        INFO("grains = ", grains, ", parts = ", parts);
        std::vector<Index> found =
            partition(MetisPartitioner{.metis = parts, .seed = seed}, model.problem).subdomain_of_contact;
        CHECK(count(found) == grains - 1);
        CHECK(std::set<Index>(found.begin(), found.end()).size() == at(parts));
        // Contacts are in the order of the chain.
        if (parts == 2 && grains < 6) CHECK(std::unique(found.begin(), found.end()) - found.begin() == 2);
      }
  }
  const Model lattice = build(random_lattice(5, 8, 6, {1, 1}));  // METIS itself leaves most of so many parts empty
  for (const Index parts : {lattice.contacts() / 3, lattice.contacts() - 1, lattice.contacts()}) {
    CAPTURE(parts);
    const Partition found = partition(MetisPartitioner{.metis = parts}, lattice.problem);
    CHECK(std::set<Index>(found.subdomain_of_contact.begin(), found.subdomain_of_contact.end()).size() == at(parts));
  }
}

TEST_CASE("METIS: few grains are shared, and the columns of a contact stay together") {
  const Model model = build(strip(60));
  const Partition halves = partition(MetisPartitioner{.metis = 2}, model.problem);
  const Decomposition parts = decompose(model.problem, halves);
  Index shared = 0;
  for (Index g = 0; g < model.grains(); ++g) shared += parts.interface.multiplicity(g) > 1;
  CHECK(shared > 0);
  CHECK(shared <= 4);  // a straight cut through a strip meets two

  ReferenceProblem twice = model.problem;  // every column two times
  std::vector<Index> columns;
  for (Index c = 0; c < 2 * model.problem.contacts(); ++c) columns.push_back(c / 2);
  twice.h = selected_columns(model.problem.h, columns);
  twice.columns_per_contact = 2;
  const Partition found = partition(MetisPartitioner{.metis = 3}, twice);
  REQUIRE(count(found.subdomain_of_contact) == 2 * model.problem.contacts());
  for (std::size_t c = 0; c < found.subdomain_of_contact.size(); c += 2)
    CHECK(found.subdomain_of_contact[c] == found.subdomain_of_contact[c + 1]);
}

TEST_CASE("partitioners: as --subdomains names them, and refused with the forms there are") {
  for (const auto& [text, cells] : {std::pair("3x2", 6), {"3x2x4", 24}, {"metis:5", 5}})
    CHECK(subdomains(parse_partitioner(text, "--subdomains")) == cells);
  CHECK(std::get<GridPartitioner>(parse_partitioner("3x2", "--subdomains")).grid == std::array<Index, 2>{3, 2});
  CHECK(std::get<GridPartitioner>(parse_partitioner("3x2x4", "--subdomains")).grid == Components<Index>{3, 2, 4});
  CHECK(std::get<MetisPartitioner>(parse_partitioner("metis:5", "--subdomains")).metis == 5);
  for (const char* text : {"3", "", "metis", "3:2"})
    CHECK_THROWS_WITH_AS(
        parse_partitioner(text, "--subdomains"),
        doctest::Contains("--subdomains: expected NXxNY such as 2x1 (in space NXxNYxNZ such as 2x1x1), "
                          "or metis:N, met"),
        Error);
  for (const char* text : {"3x", "0x2", "metis:0", "metis:x", "2x1x3x4", "2x1x0", "2xx3", "2x1x"})
    CHECK_THROWS_WITH_AS(parse_partitioner(text, "--subdomains"), doctest::Contains("--subdomains"), Error);
}

TEST_CASE("the solver of a spectrum: by size, by request, and what it falls back on") {
  using enum SpectralSolver;
  using Solvers = std::vector<SpectralSolver>;  // the first one, and those it falls back on
  const auto in_order = [](const SolverChoice& choice) {
    Solvers all{choice.solver};
    all.insert(all.end(), choice.fallbacks.begin(), choice.fallbacks.end());
    return all;
  };
  const auto chosen = [&](Index size, SpectralSolver solver, bool alone = true) {
    return in_order(choose_solver(size, {.solver = solver}, alone));
  };
  for (const SpectralSolver solver : {automatic, dense, arpack, shift_invert})  // too small for Lanczos
    CHECK(chosen(4, solver) == Solvers{dense});
  CHECK(chosen(800, automatic) == Solvers{dense, shift_invert, arpack});
  CHECK(chosen(801, automatic) == Solvers{shift_invert, dense, arpack});
  CHECK(chosen(4000, automatic) == Solvers{shift_invert, dense, arpack});
  CHECK(chosen(4001, automatic) == Solvers{shift_invert, arpack});
  CHECK(chosen(800, automatic, false) == Solvers{dense, shift_invert});
  CHECK(chosen(4001, automatic, false) == Solvers{shift_invert});
  CHECK(chosen(5, shift_invert) == Solvers{shift_invert});
  CHECK(chosen(5, arpack) == Solvers{arpack});
  CHECK(chosen(5000, dense) == Solvers{dense});

  const auto inexact = [&](Index size, SpectralSolver solver) {
    return in_order(choose_inexact_solver(size, {.solver = solver}));
  };
  CHECK(inexact(400, automatic) == Solvers{dense, arpack});
  CHECK(inexact(401, automatic) == Solvers{arpack, dense});
  CHECK(inexact(2501, automatic) == Solvers{arpack});
  CHECK(inexact(5, shift_invert) == Solvers{arpack});
  CHECK(inexact(4, arpack) == Solvers{dense});
  CHECK(inexact(5000, dense) == Solvers{dense});
}

TEST_CASE("decomposition: masses add up, gluing has full rank, velocities that agree are glued") {
  for (const Case& one : every_problem()) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    for (const GluingShape shape : {GluingShape::chain, GluingShape::star}) {
      const Decomposition parts = decompose(model.problem, model.partition, shape);
      const Subdomain whole = reassemble(parts);
      Index copies = 0, shared = 0;
      for (const Subdomain& subdomain : parts.subdomains) copies += count(subdomain.grains);
      for (Index g = 0; g < model.grains(); ++g) shared += parts.interface.multiplicity(g) > 0;
      CHECK(count(parts.interface.gluing()) == copies - shared);
      CHECK(count(whole.grains) == shared);
      const Index d = model.problem.dimension;
      for (Index i = 0; i < count(whole.grains); ++i)
        for (Index k = 0; k < d; ++k)
          CHECK(whole.inertia[d * i + k] == doctest::Approx(model.packing.mass[at(whole.grains[at(i)])]));

      const Vector velocity = RandomStream(4).normal_vector(model.problem.inertia.size());
      Vector jumps = Vector::Zero(parts.interface_size());
      Matrix all(parts.interface_size(), 0);
      for (const Subdomain& subdomain : parts.subdomains) {
        Vector local(subdomain.inertia.size());
        for (Index i = 0; i < count(subdomain.grains); ++i)
          local.segment(d * i, d) = velocity.segment(d * subdomain.grains[at(i)], d);
        jumps += subdomain.a * local;
        Matrix wider(all.rows(), all.cols() + subdomain.a.cols());
        wider << all, Matrix(subdomain.a);
        all = wider;
      }
      CHECK(jumps.isZero(1e-14));
      if (all.rows() > 0) CHECK(rank(all) == all.rows());
    }
  }
}

TEST_CASE("restricted contacts keep grains, masses and gluing") {
  const Model model = build(random_lattice(1, 6, 5, {2, 2}));
  std::vector<char> kept(at(model.problem.contacts()), 0);
  for (Index c = 0; c < model.problem.contacts(); c += 3) kept[at(c)] = 1;
  const Decomposition parts = restrict_contacts(model.parts, kept);
  Index contacts = 0;
  for (std::size_t e = 0; e < parts.subdomains.size(); ++e) {
    CHECK(parts.subdomains[e].grains == model.parts.subdomains[e].grains);
    CHECK(parts.subdomains[e].inertia == model.parts.subdomains[e].inertia);
    CHECK(Matrix(parts.subdomains[e].a) == Matrix(model.parts.subdomains[e].a));
    contacts += parts.subdomains[e].h.cols();
    for (const Index c : parts.subdomains[e].contacts) CHECK(kept[at(c)] == 1);
  }
  CHECK(contacts == std::count(kept.begin(), kept.end(), 1));
  CHECK_THROWS_AS(restrict_contacts(model.parts, {1, 0}), Error);
}

TEST_CASE("singleton, no_contacts, one_subdomain: legal, with an empty interface and radius 0") {
  Case singleton;
  singleton.spec.packing = PackingFile{"one grain"};
  singleton.packing = {{0.0}, {0.0}, {1.0}, {}};
  Case apart;
  apart.spec.packing = PackingFile{"two grains apart"};
  apart.packing = {{0.0, 9.0}, {0.0, 0.0}, {1.0, 1.0}, {}};
  apart.spec.partition = GridPartitioner{{2, 2}};
  Case single = strip(12);
  single.spec.partition = GridPartitioner{{1, 1}};
  for (const Case& one : {singleton, apart, single}) {
    const Model model = build(one);
    CHECK(model.parts.interface_size() == 0);
    for (const double eta : {0.5, infinity})
      for (const double epsilon : {0.0, 1.0}) {
        const SpectralRadius radius = spectral_radius(contraction(model.parts, Enriched{eta}, LinearViscous{epsilon}));
        CHECK(radius.value == 0);
        CHECK(radius.converged);
        CHECK(radius.solver == "none");
      }
  }
}

TEST_CASE("refused: partitions that do not fit, wrong flexibilities, the inverse of the rigid limit, 0 sweeps") {
  const Model model = build(strip(4));
  CHECK_THROWS_AS(decompose(model.problem, {2, {0, 1}}), Error);
  CHECK_THROWS_WITH_AS(decompose(model.problem, {2, {0, 1, 2, 0, 0}}), doctest::Contains("contact 2"), Error);
  const InterfaceFamily family(model.parts);
  for (const double eta : {-1.0, not_a_number}) CHECK_THROWS_AS(family.at(eta), Error);
  CHECK_THROWS_AS(family.at(0).solve(Vector::Ones(4)), Error);
  CHECK_THROWS_AS(TwoStageIteration(model.parts, LinearViscous{1}, family.at(1), Index{0}), Error);
}

TEST_CASE("operators outlive what they were made from") {
  InterfaceOperator x = [] {
    const Model model = build(strip(8));
    return InterfaceFamily(model.parts).at(0.5);
  }();
  const Vector f = Vector::LinSpaced(x.rows(), 1, 2);
  CHECK((x.apply(x.solve(f)) - f).norm() < 1e-12);
}

TEST_CASE("radius of a map: converged where the residual is as small as asked for, not where ARPACK stops") {
  const Vector values = Vector::LinSpaced(300, 0.1, 0.9);
  const LinearMap map = [&](const Vector& x) -> Vector { return values.cwiseProduct(x); };
  for (const double tolerance : {1e-12, 0.1}) {
    const SpectralOptions options{
        .solver = SpectralSolver::arpack, .tolerance = tolerance, .arpack = {.tolerance = 1e-2}};
    const MapRadius found = map_radius(300, map, options, UnitEigenvalues::none);
    REQUIRE(found.solver == "arpack");
    REQUIRE(found.residual > 1e-12);
    REQUIRE(found.residual < 0.1);
    CHECK(found.converged == (tolerance == 0.1));
  }
}

TEST_CASE("optimum: spectra that do not converge make no optimum") {
  const Decomposition parts = build(random_lattice(2, 8, 6, {3, 2})).parts;
  const auto singular = [](const InertiaPattern&) {
    return InertiaFamily{[](const SparseMatrix&, const std::array<double, 2>&) { return InertiaFactor{}; }, [] {}};
  };
  const Optimum found =
      optimum(parts, parts, 0.05, {.solver = SpectralSolver::shift_invert, .inertia = {"singular", singular}});
  CHECK(found.status == OptimumStatus::not_converged);
}

TEST_CASE("deal out: every process has subdomains, of about equal weight, and too many processes are refused") {
  Case one = random_lattice(3, 24, 24, {6, 6});
  const Decomposition parts = build(one).parts;
  Index unknowns = 0;
  for (const Subdomain& subdomain : parts.subdomains) unknowns += subdomain.inertia.size();
  for (const Index processes : {1, 2, 3, 4, 9, 17, 36}) {
    CAPTURE(processes);
    const std::vector<Index> process_of = deal_out(parts, processes);
    REQUIRE(process_of.size() == parts.subdomains.size());
    std::vector<Index> load(at(processes), 0);
    for (std::size_t e = 0; e < process_of.size(); ++e) load[at(process_of[e])] += parts.subdomains[e].inertia.size();
    CHECK(*std::ranges::min_element(load) > 0);
    if (processes <= 4) CHECK(4 * *std::ranges::max_element(load) * processes < 5 * unknowns);
  }
  CHECK_THROWS_WITH_AS(deal_out(parts, 37), doctest::Contains("at most 36 (one per subdomain), met 37"), Error);
}

TEST_CASE("shared decomposition: the parts of all processes are the whole") {
  const Model whole = build(random_lattice(3, 12, 12, {3, 2}));
  const Decomposition& parts = whole.parts;
  const Decomposition unfilled = cut(whole.problem, whole.partition);
  const std::vector<Index> process_of = deal_out(parts, 3);
  CHECK(deal_out(unfilled, 3) == process_of);
  RandomStream stream(3);
  std::vector<Vector> velocities;
  for (const Subdomain& subdomain : parts.subdomains)
    velocities.push_back(stream.normal_vector(subdomain.inertia.size()));
  Vector jumps = Vector::Zero(parts.interface_size());
  Index contacts = 0;
  for (Index rank = 0; rank < 3; ++rank) {
    const Decomposition own = of_process(parts, process_of, {.rank = rank, .size = 3});
    CHECK(own.interface_size() == parts.interface_size());
    CHECK(own.interface.same_rows(parts.interface));
    std::vector<Vector> of_own;
    const Decomposition filled =
        with_matrices(of_process(unfilled, process_of, {.rank = rank, .size = 3}), whole.problem);
    for (std::size_t e = 0; e < process_of.size(); ++e) {
      const bool is_own = process_of[e] == rank;
      CHECK(filled.subdomains[e].h.nonZeros() == own.subdomains[e].h.nonZeros());
      CHECK(filled.subdomains[e].a.rows() == own.subdomains[e].a.rows());
      CHECK(filled.subdomains[e].a.nonZeros() == own.subdomains[e].a.nonZeros());
      if (is_own) CHECK((filled.subdomains[e].h - parts.subdomains[e].h).norm() == 0);
      if (is_own) CHECK((filled.subdomains[e].a - own.subdomains[e].a).norm() == 0);
      CHECK(filled.subdomains[e].inertia == own.subdomains[e].inertia);
      CHECK(own.subdomains[e].h.cols() == (is_own ? parts.subdomains[e].h.cols() : 0));
      CHECK(own.interface.ties(static_cast<Index>(e)).empty() == !is_own);
      contacts += count(own.subdomains[e].contacts);
      of_own.push_back(is_own ? velocities[e] : Vector());
    }
    jumps += own.interface.exchange(of_own);
  }
  CHECK(contacts == parts.contacts);
  CHECK(jumps == parts.interface.exchange(velocities));
}
