// SPDX-License-Identifier: GPL-3.0-or-later
// Linear systems of contacts that processes share, against those of one process.
#include "../support/cut_lattice.hpp"
#include "ranks.hpp"
#include <nscdd/mpi/multifrontal.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// The same cut with the subdomains of this process and their contacts alone.
struct SharedCut {
  explicit SharedCut(const Cut& one) : process_of(deal_out(one.parts, world().size)) {
    for (Index column = 0; column < one.parts.contacts; ++column)
      if (process_of[at(one.partition.subdomain_of_contact[at(column)])] == world().rank) columns.push_back(column);
  }

  CutContacts<2> cut(const Cut& one, CutOptions options) const {
    options.inertia = mpi::multifrontal(MPI_COMM_WORLD);
    ReferenceProblem own = one.problem;
    own.h.resize(one.problem.h.rows(), count(columns));
    Partition partition{.subdomains = one.partition.subdomains, .subdomain_of_contact = {}};
    SparseMatrix chosen(one.parts.contacts, count(columns));
    for (Index k = 0; k < count(columns); ++k) {
      chosen.insert(columns[at(k)], k) = 1;
      partition.subdomain_of_contact.push_back(one.partition.subdomain_of_contact[at(columns[at(k)])]);
    }
    own.h = one.problem.h * chosen;
    std::vector<Index> numbers = natural_order(one.problem.inertia.size() / 3);
    return {decompose(own, partition, GluingShape::chain, {numbers, process_of, world()}), options};
  }
  std::vector<ContactRelation<2>> of(const std::vector<ContactRelation<2>>& relations) const {
    std::vector<ContactRelation<2>> own;
    for (std::size_t k = 0; k < columns.size(); k += 2) own.push_back(relations[at(columns[k] / 2)]);
    return own;
  }

  std::vector<Index> process_of, columns;
};

}  // namespace

TEST_CASE("shared: linear systems of contacts have the solutions of one process, without X_eta its bits") {
  RandomStream stream(3);
  const Cut one = cut_lattice({4, 2});
  const SharedCut shared(one);
  using enum InterfacePreconditioner;
  for (const bool slides : {false, true})
    for (CutOptions options :
         std::vector<CutOptions>{{.preconditioner = inertia},
                                 {.preconditioner = network},
                                 {},
                                 {.preconditioner = lumped, .scaling = Scaling::stiffness},
                                 {.preconditioner = dirichlet, .coarse_space = CoarseSpace::geneo, .kappa = 2}}) {
      options.tolerance = 1e-12;
      CutContacts<2> alone(one.parts, options), together = shared.cut(one, options);
      const std::vector<ContactRelation<2>> relation = relations(one.parts.contacts / 2, 1e-3, slides);
      REQUIRE(alone.factorise(relation));
      REQUIRE(together.factorise(shared.of(relation)));
      const Vector b = random_vector(stream, one.parts.contacts);
      const Vector expected = alone.solve(b)(shared.columns), found = together.solve(b(shared.columns));
      CHECK((found - expected).norm() < 1e-8 * expected.norm());
      if (!is_enriched(options.preconditioner)) CHECK(found == expected);
      CHECK(together.dense() == alone.dense());
      // The shared factor of a network rounds otherwise, which may take an iteration more or less.
      CHECK(together.work().iterations == doctest::Approx(static_cast<double>(alone.work().iterations)).epsilon(0.1));
      const double operations = together.take_operations(), expected_operations = alone.take_operations();
      CHECK(operations == doctest::Approx(expected_operations).epsilon(0.1));
      if (together.work().iterations == alone.work().iterations) CHECK(operations == expected_operations);
      CHECK(together.work().flops <= together.work().path_flops);
      CHECK(together.work().path_flops <= 1.1 * alone.work().flops);
    }
}

TEST_CASE("shared: all processes know the sign of the determinant, and whether one of them failed to factorise") {
  RandomStream stream(13);
  const Cut one = cut_lattice({4, 2});
  const SharedCut shared(one);
  int negative = 0;
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<ContactRelation<2>> relation = relations(one.parts.contacts / 2, 0.1, true);
    for (ContactRelation<2>& each : relation)  // sliding with frictions that turn the determinant now and then
      if (each.p(1, 0) != 0) each.p(1, 0) = 6 * random_of(stream);
    CutContacts<2> alone(one.parts, {.tolerance = 1e-10}), together = shared.cut(one, {.tolerance = 1e-10});
    REQUIRE(alone.factorise(relation));
    REQUIRE(together.factorise(shared.of(relation)));
    const Vector b = random_vector(stream, one.parts.contacts);
    alone.solve(b);
    together.solve(b(shared.columns));
    CHECK(together.determinant_sign() == alone.determinant_sign());
    negative += alone.determinant_sign() < 0;
  }
  CHECK(negative > 3);
  // A relation that cannot be factorised, of a contact that one process has.
  std::vector<ContactRelation<2>> relation(at(one.parts.contacts / 2));
  relation[at(one.parts.subdomains.back().contacts.front() / 2)].q(0, 0) = not_a_number;
  CutContacts<2> together = shared.cut(one, {.preconditioner = InterfacePreconditioner::inertia});
  CHECK(!together.factorise(shared.of(relation)));
}
