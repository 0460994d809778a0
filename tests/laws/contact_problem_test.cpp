// SPDX-License-Identifier: GPL-3.0-or-later
// The linear study of a frictional contact problem given by M and H.
#include "../support/dense.hpp"
#include "../support/fclib_files.hpp"
#include "../support/literal_formulas.hpp"
#include "../support/problems.hpp"
#include "formats/case/case_file.hpp"
#include "linalg/random.hpp"
#include "study/linear/inspection.hpp"
#include "study/tables/study.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Case lattice() {
  Case one = random_lattice(3, 7, 6, {1, 1});
  one.spec.prescribed.clear();
  one.spec.loads.compression = {1.0, 0.5};
  one.spec.partition = MetisPartitioner{.metis = 4};
  return one;
}

// The contact problem of a packing, with its tangents or with columns of zeros in their place.
Case as_problem(const Case& one, bool with_tangents) {
  const Model model = build(one);
  Case problem = one;
  problem.spec.packing = ContactProblemFile{"lattice.hdf5"};
  problem.problem = with_rotations(model.packing, model.network, model.problem.arriving_velocity, 0.3);
  if (!with_tangents)
    for (Index c = 1; c < problem.problem.h.cols(); c += 2)
      for (SparseMatrix::InnerIterator e(problem.problem.h, c); e; ++e) e.valueRef() = 0;
  problem.spec.loads = {};
  return problem;
}

double radius(const Model& model, double epsilon, double eta) {
  double value = not_a_number;
  sweep(model, {.epsilon = {epsilon}, .eta = {eta}}, [&](const SweepResult& result) { value = result.radius.value; });
  return value;
}

// Interface operator sum A_E (M_E + K_E / flexibility)^-1 A_E^T from M, H and the grains of the subdomains
// alone, with a gluing of its own: each further copy of a grain to the first.
Dense dense_interface(const GlobalFrictionProblem& problem, const std::vector<std::vector<Index>>& contacts,
                      double flexibility) {
  const Matrix mass = problem.mass, h = problem.h;
  const Index bodies = mass.rows() / 3;
  std::vector<std::vector<char>> holds;
  Vector multiplicity = Vector::Zero(bodies);
  for (const auto& of_one : contacts) {
    holds.emplace_back(at(bodies), 0);
    for (Index b = 0; b < bodies; ++b)
      for (const Index c : of_one)
        if (h.block(3 * b, 2 * c, 3, 2).norm() > 0) holds.back()[at(b)] = 1;
    for (Index b = 0; b < bodies; ++b) multiplicity[b] += holds.back()[at(b)];
  }
  std::vector<std::array<Index, 3>> rows;  // body, subdomain of its first copy, of another one
  for (Index b = 0; b < bodies; ++b) {
    Index first = -1;
    for (Index e = 0; e < count(holds); ++e) {
      if (!holds[at(e)][at(b)]) continue;
      if (first < 0)
        first = e;
      else
        rows.push_back({b, first, e});
    }
  }
  Dense x = zero(3 * count(rows), 3 * count(rows));
  for (Index e = 0; e < count(contacts); ++e) {
    Vector shared_mass(mass.rows());
    for (Index b = 0; b < bodies; ++b)
      for (Index i = 3 * b; i < 3 * b + 3; ++i) shared_mass[i] = mass(i, i) / std::max(1.0, multiplicity[b]);
    Dense k = diagonal(shared_mass);
    for (const Index c : contacts[at(e)]) {
      const Dense h_c = Matrix(h.middleCols(2 * c, 2));
      if (std::isfinite(flexibility)) k += h_c * h_c.transpose() / flexibility;
    }
    Matrix signs = Matrix::Zero(3 * count(rows), mass.rows());
    for (Index r = 0; r < count(rows); ++r)
      for (const Index side : {1, 2})
        if (rows[at(r)][at(side)] == e)
          signs.block(3 * r, 3 * rows[at(r)][0], 3, 3).diagonal().setConstant(side == 1 ? 1 : -1);
    const Dense a = signs;
    x += a * solve(k, a.transpose());
  }
  return x;
}

}  // namespace

TEST_CASE("radii of a frictional problem are those of the formulas, dense and from M and H alone") {
  const Case one = as_problem(lattice(), true);
  const Model model = build(one);
  CHECK(model.problem.dofs_per_grain == 3);
  CHECK(model.parts.interface_size() % 3 == 0);
  REQUIRE(model.parts.interface_size() > 0);
  std::vector<std::vector<Index>> contacts(at(model.partition.subdomains));
  for (Index c = 0; c < model.contacts(); ++c) {
    const Index e = model.partition.subdomain_of_contact[at(2 * c)];
    CHECK(model.partition.subdomain_of_contact[at(2 * c + 1)] == e);  // normal and tangent stay together
    contacts[at(e)].push_back(c);
  }
  const GlobalFrictionProblem& problem = one.problem;
  for (const double epsilon : {0.05, 1.0, 20.0})
    for (const double eta : {0.3, infinity}) {
      const Dense system = dense_interface(problem, contacts, epsilon);
      const Dense preconditioner = dense_interface(problem, contacts, eta);
      const Dense b = identity(system.rows()) - solve(preconditioner, system);
      const double expected = general_eigenvalues(b).cwiseAbs().maxCoeff();
      CHECK(radius(model, epsilon, eta) == doctest::Approx(expected).epsilon(1e-9));
      if (eta == infinity) {
        const LiteralFormulas paper(model.parts);
        CHECK(contraction_eigenvalues(paper.x(), paper.y(epsilon)).cwiseAbs().maxCoeff() ==
              doctest::Approx(expected).epsilon(1e-9));
      }
    }
}

TEST_CASE("without tangents a contact problem has the radii of the packing it was made of") {
  const Model packing = build(lattice());
  const Model problem = build(as_problem(lattice(), false));
  CHECK(problem.contacts() == packing.contacts());
  CHECK(problem.grains() == packing.grains());
  for (Index c = 0; c < packing.contacts(); ++c)
    CHECK(problem.partition.subdomain_of_contact[at(2 * c)] == packing.partition.subdomain_of_contact[at(c)]);
  for (const double epsilon : {0.02, 1.0, 50.0})
    for (const double eta : {0.2, infinity})
      CHECK(radius(problem, epsilon, eta) == doctest::Approx(radius(packing, epsilon, eta)).epsilon(1e-9));
  for (Index i = 0; i < packing.grains(); ++i)
    CHECK((problem.problem.arriving_velocity.segment(3 * i, 2) - packing.problem.arriving_velocity.segment(2 * i, 2))
              .norm() < 1e-14);
}

TEST_CASE("friction takes motions away: fewer rigid modes, the same network") {
  const Inspection packing = inspect(build(lattice()));
  const Inspection problem = inspect(build(as_problem(lattice(), true)));
  CHECK(problem.components == packing.components);
  CHECK(problem.coordination_number == packing.coordination_number);
  CHECK(problem.isolated_grains == packing.isolated_grains);
  CHECK(problem.whole.contacts == 2 * packing.whole.contacts);
  // A translation and a rotation of the whole for each piece, if nothing else slips.
  CHECK(problem.whole.rigid_modes >= 3 * packing.components);
  CHECK(problem.whole.rigid_modes < packing.whole.rigid_modes + packing.whole.grains);
}

TEST_CASE("contacts of a problem: its bodies and subdomains are those of the packing it comes from") {
  const Model packing = build(lattice());
  for (const bool with_tangents : {false, true}) {
    const Model problem = build(as_problem(lattice(), with_tangents));
    Index contacts = 0;
    problem_contacts(problem, [&](const ProblemContact& one) {
      const Row cells = row(problem_contact_columns(), one);
      const Contact& contact = packing.network.contacts[at(contacts)];
      const Index owner = problem.partition.subdomain_of_contact[at(2 * contacts)];
      CHECK(cells == Row{problem.name, to_cell(contacts), to_cell(contact.a), to_cell(contact.b), to_cell(owner)});
      if (with_tangents) CHECK(owner == packing.partition.subdomain_of_contact[at(contacts)]);
      ++contacts;
    });
    CHECK(contacts == packing.network.size());
  }
}

TEST_CASE("the frozen contacts of a problem are those that its solution holds") {
  Case one = as_problem(lattice(), true);
  RandomStream random(4);
  one.problem.f = random.normal_vector(one.problem.f.size());
  one.problem.friction.setConstant(0.3);
  const Model model = build(one);
  const LocalFrictionProblem problem = reduce(one.problem);
  const FrictionSolution solution = solve_friction(problem);
  REQUIRE(solution.status == FrictionStatus::converged);
  const ContactChoice choice = choose_contacts(model, ContactSet::frozen);
  Index stick = 0, slide = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const double normal = solution.impulses[2 * c], tangential = std::abs(solution.impulses[2 * c + 1]);
    const bool carries = choice.active[at(2 * c)] != 0, sticks = choice.active[at(2 * c + 1)] != 0;
    stick += sticks;
    slide += carries && !sticks;
    if (!carries) CHECK(normal < 1e-6);
    if (sticks) CHECK(tangential <= 0.3 * normal * (1 + 1e-6));
    if (carries && !sticks) CHECK(tangential == doctest::Approx(0.3 * normal).epsilon(1e-5));
  }
  CHECK(stick > 3);
  CHECK(slide > 3);
  const Selection selection = select(model, ContactSet::frozen);
  CHECK(selection.of_case.active_contacts == stick + slide);
  CHECK(selection.stage_one(model).subdomains[0].h.cols() < model.parts.subdomains[0].h.cols());
}

TEST_CASE("what a contact problem cannot do is refused") {
  Case one = as_problem(lattice(), true);
  const Model model = build(one);
  CHECK_THROWS_WITH_AS(links(model, [](const Link&) {}), doctest::Contains("links: expected a packing"), Error);
  CHECK_THROWS_WITH_AS(grains(model, [](const PackingGrain&) {}), doctest::Contains("grains: expected a packing"),
                       Error);
  CHECK_THROWS_WITH_AS(packing_of(one), doctest::Contains("expected a packing"), Error);
  CHECK_THROWS_WITH_AS(choose_contacts(model, ContactSet::active),
                       doctest::Contains("expected --contacts all or frozen for a problem with friction, met active"),
                       Error);
  for (const char* key : {"packing.grains", "contacts.tolerance", "masses.density", "loads.shear"})
    CHECK_THROWS_WITH_AS(override_case(one.spec, key, "1"), doctest::Contains("expected only partition.*"), Error);
  override_case(one.spec, "partition.metis", "3");
  CHECK(build(one).partition.subdomains == 3);
  one.spec.prescribed = {{0, {1, 0}}};
  CHECK_THROWS_WITH_AS(build(one), doctest::Contains("no prescribed velocities"), Error);
  one.spec.prescribed.clear();
  one.spec.partition = GridPartitioner{{2, 1}};
  CHECK_THROWS_WITH_AS(build(one), doctest::Contains("expected subdomains metis:N"), Error);
  one.spec.partition = GridPartitioner{};
  CHECK(build(one).parts.interface_size() == 0);
  GlobalFrictionProblem& problem = one.problem;
  problem.mass.coeffRef(0, 1) = problem.mass.coeffRef(1, 0) = 0.1;
  CHECK_THROWS_WITH_AS(
      build(one), doctest::Contains("lattice.hdf5: M: expected a diagonal matrix, met 0.1 at row 1, column 0"), Error);
  problem.mass.coeffRef(0, 1) = problem.mass.coeffRef(1, 0) = 0;
  CHECK_NOTHROW(build(one));
  problem.mass.coeffRef(5, 5) = 0;
  CHECK_THROWS_WITH_AS(build(one), doctest::Contains("expected positive numbers on the diagonal"), Error);
}

TEST_CASE("a case with a contact problem reads back from its text") {
  CaseSpec spec = as_problem(lattice(), true).spec;
  spec.name = "one";
  const CaseSpec back = parse_case(to_toml(spec), "one.toml");
  CHECK(std::get<ContactProblemFile>(back.packing).path == "lattice.hdf5");
  CHECK(to_toml(back) == to_toml(spec));
  CHECK_THROWS_WITH_AS(resolve(back), doctest::Contains("one.toml:4: problem.file: lattice.hdf5"), Error);
  CHECK_THROWS_WITH_AS(parse_case("[problem]\nfile = \"p\"\n[partition]\nmetis = 2\n[masses]\ndensity = 1\n", "c.toml"),
                       doctest::Contains("unknown key 'masses'"), Error);
}

TEST_CASE("rows of a contact problem are gone on with for the same content alone, wherever the file lies") {
  StudyTable table;
  table.cases = {as_problem(lattice(), true)};
  StudyTable other = table;
  other.cases[0].spec.packing = ContactProblemFile{"elsewhere/lattice.hdf5"};
  CHECK(difference(work_identity(table), work_identity(other)).empty());
  other.cases[0].problem.h.coeffRef(0, 0) *= 1 + 1e-15;
  CHECK(difference(work_identity(table), work_identity(other)).find("the case differs") == 0);
}
