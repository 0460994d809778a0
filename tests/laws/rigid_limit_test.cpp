// SPDX-License-Identifier: GPL-3.0-or-later
// The rigid limit of redundant networks: ranks, unit eigenvalues and ends by sparse factorisation as by dense algebra.
#include "../support/dense.hpp"
#include "../support/judged_radius.hpp"
#include "../support/mumps.hpp"
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "linalg/range_projector.hpp"
#include "linalg/sparse_entries.hpp"
#include "spectra/spectrum_memory.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Case hexagons(Index columns, Index rows, std::array<Index, 2> grid) {
  Case one;
  one.spec.name = std::to_string(columns) + " x " + std::to_string(rows);
  one.spec.packing = Generator{HexagonalLattice{.columns = columns, .rows = rows, .radius = 0.5}};
  one.spec.masses.model = MassModel::unit;
  one.spec.partition = GridPartitioner{grid};
  return one;
}

Index eigenvalues_above(const Dense& symmetric, double bound) {
  return (symmetric_eigenvalues(symmetric).array() > bound).count();
}

// Every third contact of each subdomain a second time, its column turned at random by an angle of about `turn`.
Decomposition with_contacts_given_twice(Decomposition parts, double turn) {
  RandomStream random(11);
  for (Subdomain& part : parts.subdomains) {
    std::vector<Index> twice;
    for (Index c = 0; c < part.h.cols(); c += 3) twice.push_back(c);
    SparseMatrix turned = selected_columns(part.h, twice);
    for (Index j = 0; j < turned.cols(); ++j) {
      const double size = turned.col(j).norm();
      for (SparseMatrix::InnerIterator e(turned, j); e; ++e) e.valueRef() += turn * size * random.normal();
    }
    SparseEntries entries;
    entries.add_block(part.h, 0, 0);
    entries.add_block(turned, 0, part.h.cols());
    part.h = entries.matrix(part.h.rows(), part.h.cols() + turned.cols());
    for (Index j = 0; j < turned.cols(); ++j) part.contacts.push_back(parts.contacts++);
  }
  return parts;
}

SpectralRadius limit_shift_inverted(const Contraction& b, SpectrumMemory* memory = nullptr) {
  const SpectralOptions options{.solver = SpectralSolver::shift_invert};
  return memory == nullptr ? judged_radius(b, options) : spectral_radius(b, options, memory);
}

}  // namespace

TEST_CASE("rank of a full strip of lattice is that of its dense matrix, and as many columns span its range") {
  // Strips of 7 x 100: the least eigenvalue of H^T H above 0 is 2e-5. QR without exchanges has 1 399 for the fourth.
  const Model model = build(hexagons(100, 100, {16, 1}));
  const SparseMatrix& h = model.parts.subdomains[3].h;
  const RangeProjector range(h);
  CHECK(range.rank() == eigenvalues_above(Matrix(h * h.transpose()), 1e-9));
  const RangeBasis found = range_basis(h);
  REQUIRE(found.size() == range.rank());
  Matrix chosen(h.rows(), range.rank());
  for (Index j = 0; j < count(found.columns); ++j) chosen.col(j) = h.col(found.columns[at(j)]);
  chosen.rightCols(found.others.cols()) = found.others;
  const Dense basis = chosen;
  CHECK(eigenvalues_above(basis.transpose() * basis, 1e-6) == range.rank());
  const Vector x = RandomStream(4).normal_vector(h.rows()), inside = range.apply(x);
  CHECK((h.transpose() * (x - inside)).norm() < 1e-12 * x.norm());
  CHECK((range.apply(inside) - inside).norm() < 1e-12 * x.norm());
}

TEST_CASE("a basis of what hyperstatic contacts without order can do is far better conditioned than the contacts") {
  Index full = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    for (const Subdomain& part : build(disordered_fcc(seed, 0.2, GridPartitioner{{2, 2, 1}})).parts.subdomains) {
      const RangeProjector range(part.h);
      const RangeBasis found = range_basis(part.h);
      REQUIRE(found.conclusive);
      REQUIRE(found.size() == range.rank());
      full += found.others.cols();
      Matrix chosen(part.h.rows(), range.rank());
      for (Index j = 0; j < count(found.columns); ++j) chosen.col(j) = part.h.col(found.columns[at(j)]);
      chosen.rightCols(found.others.cols()) = found.others;
      const Dense basis = chosen;
      CHECK(eigenvalues_above(basis.transpose() * basis, 1e-5) == range.rank());
      CHECK((part.h.transpose() * orthonormal_complement(chosen)).norm() < 1e-5);
    }
  }
  CHECK(full > 5);
}

TEST_CASE("rigid limit of hyperstatic packings without order: shift-invert proves what the dense pencil finds") {
  for (const auto& [vacancies, seeds] :
       {std::pair{0.2, std::vector{1U, 3U, 4U, 5U}}, std::pair{0.25, std::vector{3U, 7U}}})
    for (const std::uint64_t seed : seeds) {
      const Case one = disordered_fcc(seed, vacancies, GridPartitioner{{2, 2, 2}});
      CAPTURE(one.spec.name);
      const Contraction b = contraction_of(one, 0);
      const SpectralRadius found = limit_shift_inverted(b);
      const SpectralRadius dense = dense_pencil_radius(b);
      CHECK(found.converged);
      CHECK(dense.converged);
      CHECK(found.unit_multiplicity == dense.unit_multiplicity);
      CHECK(std::abs(found.subdominant_max - dense.subdominant_max) <= 1e-8);
    }
}

TEST_CASE("rigid limit where a rank is in doubt: neither shift-invert nor the dense pencil counts as converged") {
  // A singular value of the contacts lies next to the tolerance of a rank.
  const InterfaceFamily family(build(disordered_fcc(6, 0.25, GridPartitioner{{2, 2, 2}})).parts);
  const Contraction b{family.at(infinity), family.at(0)};
  CHECK_FALSE(b.system.nullity_is_clear());
  CHECK_FALSE(limit_shift_inverted(b).converged);
  CHECK_FALSE(dense_pencil_radius(b).converged);
  CHECK(family.at(1).nullity_is_clear());
}

TEST_CASE("rigid limit where small singular values count as zero: the residual says how far a radius may be off") {
  // Of seed 2 one part has a singular value of 2.7e-7, which counts as zero, beside one of 4e-5, which does not.
  const InterfaceFamily family(build(disordered_fcc(2, 0.25, GridPartitioner{{2, 2, 2}})).parts);
  const Contraction b{family.at(infinity), family.at(0)};
  CHECK(b.system.nullity_is_clear());
  CHECK(b.system.uncertainty() > 1e-3);
  CHECK(family.at(1).uncertainty() == 0);
  for (const SpectralSolver solver : {SpectralSolver::dense, SpectralSolver::shift_invert}) {
    const SpectralRadius found = spectral_radius(b, {.solver = solver, .certify = true});
    CHECK_FALSE(found.converged);
    CHECK(found.residual > 1e-3);
  }
}

TEST_CASE("rigid limit of contacts given twice, slightly turned: two solvers that converge agree, others do not") {
  Index proved = 0, doubtful = 0;
  for (const Case& one :
       {hexagons(12, 12, {3, 2}), hexagons(60, 8, {3, 1}), deposit(100, {2, 2}),
        with_unequal_masses(hexagons(12, 12, {3, 2}), 4), random_fcc(31, 5, 5, 4, GridPartitioner{{2, 1, 1}})})
    for (const auto& turned : {std::pair{1e-14, infinity},
                               {1e-10, infinity},
                               {1e-9, 0.3},
                               {1e-9, infinity},
                               {1e-8, infinity},
                               {3e-8, 0.3},
                               {1e-7, infinity},
                               {2e-7, infinity}}) {
      const double turn = turned.first, eta = turned.second;
      INFO("name = ", one.spec.name, ", turn = ", turn, ", eta = ", eta);
      const InterfaceFamily family(with_contacts_given_twice(build(one).parts, turn));
      const Contraction b{family.at(eta), family.at(0)};
      const SpectralRadius found = spectral_radius(b, {.solver = SpectralSolver::shift_invert, .certify = true});
      const SpectralRadius dense = dense_pencil_radius(b);
      const SpectralRadius lanczos = spectral_radius(b, {.solver = SpectralSolver::arpack});
      if (turn < 1e-13) CHECK((found.converged && dense.converged));
      if (turn > 5e-8) CHECK_FALSE((found.converged || dense.converged));
      proved += found.converged && dense.converged;
      doubtful += !found.converged && !dense.converged;
      if (!std::isfinite(found.residual + dense.residual)) continue;
      const double difference = std::max(std::abs(found.subdominant_max - dense.subdominant_max),
                                         std::abs(found.subdominant_min - dense.subdominant_min));
      CHECK(difference <= found.residual + dense.residual + 1e-12);
      const auto holds = [&](const std::array<double, 2>& interval, double value) {
        return interval[0] - dense.residual <= value && value <= interval[1] + dense.residual;
      };
      CHECK((!found.certified || holds(found.interval_min, dense.subdominant_min)));
      CHECK((!found.certified || holds(found.interval_max, dense.subdominant_max)));
      if (turn > 5e-8) CHECK_FALSE(lanczos.converged);
      CHECK((!lanczos.converged ||
             std::abs(lanczos.subdominant_max - dense.subdominant_max) <= lanczos.residual + dense.residual + 1e-12));
    }
  CHECK(proved > 5);
  CHECK(doubtful > 8);
}

TEST_CASE("rigid limit of redundant packings: shift-invert proves what the dense pencil finds") {
  for (const Case& one : {hexagons(40, 40, {8, 1}), hexagons(40, 40, {4, 4}), random_lattice(31, 36, 32, {4, 3}),
                          with_unequal_masses(hexagons(24, 30, {4, 2}), 3), deposit(900, {3, 3}),
                          random_fcc(31, 8, 8, 7, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    const InterfaceFamily family(build(one).parts);
    SpectrumMemory memory;
    for (const double eta : {0.1, infinity}) {
      CAPTURE(eta);
      const Contraction b{family.at(eta), family.at(0)};
      const SpectralRadius found = limit_shift_inverted(b, &memory);
      const SpectralRadius dense = dense_pencil_radius(b);
      CHECK(found.converged);
      CHECK(found.unit_multiplicity == dense.unit_multiplicity);
      CHECK(std::abs(found.subdominant_min - dense.subdominant_min) <= 1e-8);
      CHECK(std::abs(found.subdominant_max - dense.subdominant_max) <= 1e-8);
    }
  }
}

TEST_CASE("rigid limit along eta: what does not depend on it is found once, and the points help each other") {
  const InterfaceFamily family(build(hexagons(24, 24, {4, 1})).parts);
  SpectrumMemory memory;
  Index warm = 0, cold = 0;
  for (double eta = 0.05; eta < 0.5; eta *= 1.3) {
    CAPTURE(eta);
    const Contraction b{family.at(eta), family.at(0)};
    const SpectralRadius next = limit_shift_inverted(b, &memory), alone = limit_shift_inverted(b);
    CHECK(next.converged);
    CHECK(next.unit_multiplicity == alone.unit_multiplicity);
    CHECK(std::abs(next.subdominant - alone.subdominant) <= next.residual + alone.residual);
    warm += next.factorisations;
    cold += alone.factorisations;
  }
  CHECK(warm < 0.9 * static_cast<double>(cold));
}

TEST_CASE("rigid limit: a number of unit eigenvalues that no count next to zero confirms is no result") {
  const Contraction b = contraction_of(hexagons(24, 24, {4, 1}), 0);
  SpectrumMemory memory;
  const SpectralRadius right = limit_shift_inverted(b, &memory);
  REQUIRE(right.converged);
  REQUIRE(right.unit_multiplicity > 1);
  for (const Index wrong : {right.unit_multiplicity - 1, right.unit_multiplicity + 1}) {
    CAPTURE(wrong);
    memory.forget_ends();
    memory.limit->kernel = wrong;  // as if a rank had been wrong by one
    memory.limit->confirmed = false;
    CHECK_FALSE(limit_shift_inverted(b, &memory).converged);
  }
}

TEST_CASE("rigid limit along eta: a point that cannot be proved spoils none of the others") {
  const InterfaceFamily family(build(hexagons(384, 12, {32, 1})).parts);
  const auto at = [&](double eta) { return Contraction{family.at(eta), family.at(0)}; };
  SpectrumMemory memory;
  const SpectralRadius hardest = limit_shift_inverted(at(1e-9), &memory);
  CHECK_FALSE(hardest.converged);
  CHECK(hardest.unit_multiplicity == 465);
  const SpectralRadius next = limit_shift_inverted(at(infinity), &memory), alone = limit_shift_inverted(at(infinity));
  CHECK(next.converged);
  CHECK(next.unit_multiplicity == 465);
  CHECK(std::abs(next.subdominant - alone.subdominant) <= next.residual + alone.residual);
}

TEST_CASE("rigid limit of 10^4 disks in sixteen full strips: proved, unit eigenvalues counted twice") {
  const Contraction b = contraction_of(hexagons(100, 100, {16, 1}), 0);
  const SpectralRadius found = limit_shift_inverted(b);
  CHECK(found.converged);
  CHECK(found.unit_multiplicity == 2205);
  // the dense pencil, in minutes (`--solver dense`)
  CHECK(std::abs(found.subdominant_max - 0.9989544661468879) <= 1e-8);
  CHECK(std::abs(found.subdominant_min - 0.4545784794904403) <= 1e-8);
}

TEST_CASE("rigid limit at small eta: proved by our factors and by those of MUMPS, as the dense pencil finds it") {
  const InterfaceFamily family(build(hexagons(40, 40, {8, 1})).parts);
  for (const double eta : {1e-3, 1e-4}) {
    CAPTURE(eta);
    const Contraction b{family.at(eta), family.at(0)};
    const SpectralRadius dense = dense_pencil_radius(b);
    for (const InertiaMethod& method : {multifrontal(), mumps(0.3)}) {
      CAPTURE(method.name);
      const SpectralRadius found =
          spectral_radius(b, {.solver = SpectralSolver::shift_invert, .certify = true, .inertia = method});
      CHECK(found.converged);
      CHECK(found.certified);
      CHECK(found.unit_multiplicity == dense.unit_multiplicity);
      CHECK(std::abs(found.subdominant - dense.subdominant) <= found.residual + 1e-10);
    }
  }
}
