// SPDX-License-Identifier: GPL-3.0-or-later
// Local preconditioners and coarse spaces of the interface: theorems that hold for every network.
#include "../support/cut_lattice.hpp"
#include "../support/literal_formulas.hpp"
#include "../support/mumps.hpp"
#include "../support/problems.hpp"
#include "core/disjoint_sets.hpp"
#include "ddm/local_preconditioner.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "spectra/balanced_spectrum.hpp"
#include "study/linear/coarse.hpp"
#include <nscdd/ddm/interface_operator.hpp>
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

#include <map>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr std::array scalings{Scaling::multiplicity, Scaling::stiffness, Scaling::deluxe};

std::shared_ptr<PrimalInterface> weighted(const Decomposition& parts, double epsilon, Scaling scaling) {
  auto interface = std::make_shared<PrimalInterface>(condense(parts, epsilon));
  weigh(*interface, scaling);
  return interface;
}

// With epsilon in multiples of the mean of W_nn.
std::shared_ptr<PrimalInterface> weighted(const Model& model, double epsilon, Scaling scaling) {
  return weighted(model.parts, epsilon * flexibility_scale(model), scaling);
}

// P^-1 X_eps as a symmetric matrix, L^T P^-1 L, X_eps = L L^T.
Vector dual_spectrum(const Model& model, double epsilon, const LinearMap& p) {
  const Matrix x = InterfaceFamily(model.parts).at(epsilon * flexibility_scale(model)).dense();
  const Matrix lower = cholesky_factor(x);
  Matrix map(x.rows(), x.cols());
  for (Index k = 0; k < x.cols(); ++k) map.col(k) = p(lower.col(k));
  map = (lower.transpose() * map).eval();
  CHECK((map - map.transpose()).norm() <= 1e-6 * map.norm());
  return symmetric_values(map);
}

Model random_network(std::uint64_t seed) {
  const Index columns = 5 + static_cast<Index>(seed % 4), rows = 4 + static_cast<Index>(seed % 3);
  return build(random_lattice(seed, columns, rows, {2, 1 + static_cast<Index>(seed % 2)}));
}

CoarseProblem no_coarse_space(const PrimalInterface& interface) {
  return {interface, CoarseVectors{SparseMatrix(interface.size(), 0), {}, {}}};
}

// Rank of a semidefinite matrix by LAPACK; the inertia that MUMPS counts must agree.
Index rank_of(const Matrix& a) {
  const Vector values = symmetric_values(a);
  const double least = 1e-9 * values.maxCoeff();
  const Index rank = (values.array() > least).count(), n = a.rows();
  const Matrix shifted = a - least * Matrix::Identity(n, n), lower = shifted.triangularView<Eigen::Lower>();
  const InertiaPattern pattern{lower.sparseView(), std::vector<Index>(at(n), 0)};
  const InertiaFactor factor = mumps().analyse(pattern).factorise(pattern.lower, {0, 0});
  REQUIRE(factor.regular);
  CHECK(factor.negative_eigenvalues == n - rank);
  return rank;
}

// The eigenvalues above 1, descending.
Vector upper(Vector eigenvalues) {
  std::vector<double> found;
  for (Index k = eigenvalues.size(); k-- > 0;)
    if (eigenvalues[k] > 1 + 1e-5) found.push_back(eigenvalues[k]);
  return Eigen::Map<Vector>(found.data(), count(found));
}

void check_same_upper(const Vector& a, const Vector& b) {
  const Vector one = upper(a), two = upper(b);
  REQUIRE(one.size() == two.size());
  for (Index k = 0; k < one.size(); ++k) CHECK(one[k] == doctest::Approx(two[k]).epsilon(1e-6));
}

}  // namespace

TEST_CASE("weights of every scaling add up to one on each shared grain, and fix its velocity") {
  on_every_interface([](const Model& model) {
    for (const Scaling scaling : scalings) {
      const auto interface = weighted(model, 1e-2, scaling);
      Matrix sum = Matrix::Zero(interface->size(), interface->size());
      for (const CondensedSubdomain& one : interface->subdomains) sum(one.rows, one.rows) += one.weights;
      CHECK((sum - Matrix::Identity(sum.rows(), sum.cols())).norm() < 1e-10);
    }
  });
}

TEST_CASE("the primal interface is the undivided network condensed onto shared grains") {
  on_every_interface([](const Model& model) {
    const double epsilon = 1e-2 * flexibility_scale(model);
    const PrimalInterface interface = condense(model.parts, epsilon);
    const ReferenceProblem& problem = model.problem;
    Matrix whole = Matrix(problem.h * problem.h.transpose()) / epsilon;
    whole.diagonal() += problem.inertia;
    const Matrix inverse = Dense(whole).inverse();
    std::vector<Index> shared;
    for (Index i = 0; i < problem.grains(); ++i)
      if (model.parts.interface.multiplicity(i) > 1)
        for (Index k = 0; k < problem.dofs_per_grain; ++k) shared.push_back(problem.dofs_per_grain * i + k);
    REQUIRE(count(shared) == interface.size());
    const Matrix product = Matrix(interface.sparse()) * inverse(shared, shared);
    CHECK((product - Matrix::Identity(product.rows(), product.cols())).norm() < 1e-8);
  });
}

TEST_CASE("FETI-Dirichlet and the balanced primal interface have one upper spectrum, with every coarse space") {
  on_every_interface([](const Model& model) {
    for (const Scaling scaling : scalings)
      for (const double epsilon : {1e-3, 0.1}) {
        CAPTURE(epsilon);
        const auto interface = weighted(model, epsilon, scaling);
        const auto none = std::make_shared<const CoarseProblem>(no_coarse_space(*interface));
        const auto geneo = std::make_shared<const CoarseProblem>(*interface, geneo_vectors(*interface, 0.5));
        const auto rigid = std::make_shared<const CoarseProblem>(*interface, rigid_vectors(*interface, model.parts));
        const Vector one_level = BalancedSpectrum(*interface, *none).all(0);
        for (const auto& coarse : {none, rigid, geneo}) {
          const BalancedSpectrum spectrum(*interface, *coarse);
          const Vector primal = spectrum.all(coarse->size());
          if (primal.size() > 0) CHECK(primal[0] > 1 - 1e-7);
          const double kappa = primal.size() > 0 ? primal.maxCoeff() / primal.minCoeff() : 1;
          CHECK(coarse->size() >= fewest_deflated(one_level, kappa * (1 + 1e-7)));  // by interlacing
          const LinearMap dual = local_preconditioner(interface, InterfacePreconditioner::dirichlet, coarse);
          check_same_upper(dual_spectrum(model, epsilon, dual), primal);
        }
      }
  });
}

// sum_E B_E Q_E B_E^T with B_E = (sum A W^-1 A^T)^-1 A_E W_E^-1, W_E the weights of a copy [Rixen and Farhat]: 1, the
// diagonal of M_E + K_E / eps, or the blocks of S_E on grains of the same subdomains [Dohrmann and Widlund].
Matrix literal_preconditioner(const Model& model, const PrimalInterface& interface, bool lumped, Scaling scaling) {
  const Index n = model.parts.interface_size();
  Matrix gram = Matrix::Zero(n, n), sum = gram;
  std::vector<Matrix> jumps;
  for (std::size_t e = 0; e < interface.subdomains.size(); ++e) {
    const CondensedSubdomain& one = interface.subdomains[e];
    const Matrix a = Matrix(model.parts.subdomains[e].a)(Eigen::all, one.local);
    Matrix weight = scaling == Scaling::deluxe      ? Matrix(Dense(one.flexibility).inverse())
                    : scaling == Scaling::stiffness ? Matrix(one.block.diagonal().asDiagonal())
                                                    : Matrix(Matrix::Identity(a.cols(), a.cols()));
    const auto sharing = [&](Index i) { return interface.sharing[at(one.rows[at(i)] / interface.dofs_per_grain)]; };
    for (Index i = 0; i < a.cols(); ++i)
      for (Index j = 0; j < a.cols(); ++j)
        if (sharing(i) != sharing(j)) weight(i, j) = 0;
    jumps.push_back(a * Matrix(Dense(weight).inverse()));
    gram += jumps.back() * a.transpose();
  }
  for (std::size_t e = 0; e < jumps.size(); ++e) {
    const CondensedSubdomain& one = interface.subdomains[e];
    const Matrix b = Matrix(Dense(gram).inverse()) * jumps[e];
    sum += b * (lumped ? one.block : Matrix(Dense(one.flexibility).inverse())) * b.transpose();
  }
  return sum;
}

TEST_CASE("lumped and Dirichlet preconditioners are the formulas of the literature") {
  on_every_interface([](const Model& model) {
    for (const Scaling scaling : scalings)
      for (const bool is_lumped : {false, true}) {
        const auto interface = weighted(model, 0.01, scaling);
        using enum InterfacePreconditioner;
        const LinearMap p = local_preconditioner(interface, is_lumped ? lumped : dirichlet);
        const Matrix literal = literal_preconditioner(model, *interface, is_lumped, scaling);
        for (Index k = 0; k < literal.cols(); ++k)
          CHECK((p(Vector::Unit(literal.cols(), k)) - literal.col(k)).norm() < 1e-8 * literal.norm());
      }
  });
}

TEST_CASE("X, X_eta and X_eta_active have the condition numbers of their formulas") {
  on_every_interface([](const Model& model) {
    const double epsilon = 0.01;
    const Selection selection = select(model, ContactSet::active);
    const Decomposition& active = selection.stage_one(model);
    std::vector<double> kappas;
    coarse_spaces(model, {.epsilon = {epsilon}, .contacts = ContactSet::active},
                  {.preconditioners = {InterfacePreconditioner::inertia, InterfacePreconditioner::network,
                                       InterfacePreconditioner::active}},
                  [&](const CoarseResult& result) { kappas.push_back(result.kappa()); });
    const LiteralFormulas literal(active);
    const std::array stage_two{literal.x(), LiteralFormulas(model.parts).x_eta(10 * epsilon),
                               literal.x_eta(10 * epsilon)};
    REQUIRE(kappas.size() == stage_two.size());
    for (std::size_t k = 0; k < kappas.size(); ++k) {
      const Vector values = pencil_eigenvalues(literal.x_eta(epsilon), stage_two[k]);
      CHECK(kappas[k] == doctest::Approx(values.maxCoeff() / values.minCoeff()).epsilon(1e-7));
    }
  });
}

TEST_CASE("rigid vectors are all motions of the pieces of a subdomain that keep their distances") {
  on_every_interface([&](const Model& model) {
    const Index d = model.problem.dimension;
    if (model.problem.dofs_per_grain != d) return;
    const auto interface = weighted(model, 1e-2, Scaling::multiplicity);
    const CoarseVectors vectors = rigid_vectors(*interface, model.parts);
    for (Index e = 0; e < count(interface->subdomains); ++e) {
      const CondensedSubdomain& one = interface->subdomains[at(e)];
      const Subdomain& subdomain = model.parts.subdomains[at(e)];
      DisjointSets pieces(count(subdomain.grains));
      for (Index c = 0; c < subdomain.h.cols(); ++c)
        for (SparseMatrix::InnerIterator i(subdomain.h, c), first = i; i; ++i)
          pieces.join(first.row() / d, i.row() / d);
      std::vector<Index> own;
      for (Index k = 0; k < count(vectors.subdomains); ++k)
        if (vectors.subdomains[at(k)] == e) own.push_back(k);
      Matrix moves = Matrix(vectors.u)(one.rows, own), centres(d, count(one.rows) / d);
      std::map<Index, std::vector<Index>> shared;  // of each piece
      for (Index i = 0; i < count(one.rows); i += d) {
        const Index grain = one.local[at(i)] / d;
        moves.middleRows(i, d) *= static_cast<double>(model.parts.interface.multiplicity(subdomain.grains[at(grain)]));
        centres.col(i / d) = subdomain.centres.col(grain);
        shared[pieces.root(grain)].push_back(i / d);
      }
      Index expected = 0;
      for (const auto& [label, grains] : shared) {
        const Matrix arms = centres(Eigen::all, grains).colwise() - centres.col(grains[0]).eval();
        const Index line = rank(Dense(arms));  // 0: one grain, 1: grains in a line
        expected += line == 0 ? d : d == 2 ? 3 : line == 1 ? 5 : 6;
        for (const Index i : grains)
          for (const Index j : grains)
            CHECK(((moves.middleRows(d * i, d) - moves.middleRows(d * j, d)).transpose() *
                   (centres.col(i) - centres.col(j)))
                      .norm() <= 1e-9 * moves.norm() * centres.norm());
      }
      CHECK(count(own) == expected);
      CHECK((own.empty() ? 0 : rank(Dense(moves))) == expected);
    }
  });
}

TEST_CASE("spectra of preconditioners do not depend on gluing, numbering, or the unit of mass") {
  for (const Scaling scaling : scalings) {
    const Case one = random_lattice(2, 8, 6, {3, 2});
    const Model model = build(one);
    const auto spectrum = [&](const Model& of, GluingShape shape, double unit) {
      const ReferenceProblem problem{.dimension = of.problem.dimension,
                                     .dofs_per_grain = of.problem.dofs_per_grain,
                                     .columns_per_contact = of.problem.columns_per_contact,
                                     .inertia = unit * of.problem.inertia,
                                     .h = of.problem.h,
                                     .arriving_velocity = of.problem.arriving_velocity,
                                     .centres = of.problem.centres};
      PrimalInterface interface =
          condense(decompose(problem, of.partition, shape), 1e-3 * flexibility_scale(of) / unit);
      weigh(interface, scaling);
      const CoarseProblem coarse(interface, geneo_vectors(interface, 0.2));
      Vector all(2 * interface.size());
      all << BalancedSpectrum(interface, no_coarse_space(interface)).all(0),
          Vector::Constant(interface.size(), static_cast<double>(coarse.size()));
      return all;
    };
    const Vector reference = spectrum(model, GluingShape::chain, 1);
    for (const Vector& other : {spectrum(model, GluingShape::star, 1), spectrum(model, GluingShape::chain, 7),
                                spectrum(build(renumbered(one, 5)), GluingShape::chain, 1)}) {
      REQUIRE(other.size() == reference.size());
      CHECK((other.array() / reference.array() - 1).abs().maxCoeff() < 1e-7);
    }
  }
}

// Returns the fewest vectors.
Index check_geneo(const PrimalInterface& interface, double kappa) {
  const CoarseProblem coarse(interface, geneo_vectors(interface, 1e9));
  CHECK(coarse.is_orthonormal());
  const BalancedSpectrum spectrum(interface, coarse);
  const Index safe = coarse.below(geneo_threshold(interface, kappa));
  CHECK(spectrum.largest(safe) <= kappa * (1 + 1e-9));
  for (const Index k : {Index{0}, safe / 2, safe}) {
    const Vector all = spectrum.all(k);
    if (all.size() == 0) continue;
    CHECK(spectrum.largest(k) == doctest::Approx(std::max(1.0, all[all.size() - 1])).epsilon(1e-6));
    const double shift = 0.5 * (1 + all[all.size() - 1]);  // between 1 and the largest
    if (shift > 1 + 1e-6) CHECK(spectrum.above(shift, k) == (all.array() > shift).count());
  }
  const std::optional<Index> fewest = spectrum.fewest(kappa);
  REQUIRE(fewest);
  CHECK(*fewest <= safe);
  CHECK(*fewest >= fewest_deflated(spectrum.all(0), kappa));
  if (*fewest > 0) CHECK(spectrum.largest(*fewest - 1) > kappa);
  return *fewest;
}

TEST_CASE("GenEO keeps its bound, Lanczos and inertia agree with the dense spectrum, interlacing is never beaten") {
  on_every_interface([](const Model& model) {
    for (const Scaling scaling : scalings)
      for (const double kappa : {3.0, 30.0}) check_geneo(*weighted(model, 1e-4, scaling), kappa);
  });
  std::array<Index, 3> needed{};  // networks that need a coarse space, with each scaling
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    CAPTURE(seed);
    const Model model = random_network(seed);
    const std::size_t k = seed / 6 % 3;
    if (model.parts.interface_size() == 0) continue;
    needed[k] += check_geneo(*weighted(model, std::pow(0.1, 1 + seed % 7), scalings[k]), 10) > 0;
  }
  CHECK(std::ranges::min(needed) > 15);
  // Grains that turn, with contacts that are open, stick or slide.
  const Decomposition parts = cut_lattice({3, 2}).parts;
  RandomStream stream(11);
  Index turning = 0;
  for (int trial = 0; trial < 30; ++trial) {
    CAPTURE(trial);
    std::vector<char> kept;
    for (Index c = 0; c < parts.contacts / 2; ++c) {
      const Index status = stream.below(3);
      kept.push_back(status > 0);
      kept.push_back(status > 1);
    }
    turning += check_geneo(*weighted(restrict_contacts(parts, kept), std::pow(0.1, trial % 7), scalings[at(trial % 3)]),
                           10) > 0;
  }
  CHECK(turning > 10);
}

TEST_CASE("a coarse problem is orthonormal in C, however nearly its vectors depend on each other") {
  on_every_interface([](const Model& model) {
    const auto interface = weighted(model, 1e-6, Scaling::multiplicity);
    const Index n = interface->size();
    RandomStream random(7);
    Matrix u(n, n);
    for (Index j = 0; j < n; ++j) {
      u.col(j) = random.normal_vector(n);
      if (j > 0) u.col(j) = u.col(j - 1) + 1e-4 * u.col(j);
      u.col(j) /= std::sqrt(u.col(j).dot(interface->apply(u.col(j))));
    }
    const CoarseProblem coarse(*interface, {u.sparseView(), Vector::Zero(n), std::vector<Index>(at(n), 0)});
    const Matrix v = coarse.orthonormal(), c = interface->sparse();
    CHECK((v.transpose() * c * v - Matrix::Identity(v.cols(), v.cols())).norm() < 1e-8);
  });
}

TEST_CASE("deluxe is exact for two subdomains") {
  int problems = 0;
  on_every_interface([&](const Model& model) {
    if (model.partition.subdomains != 2) return;
    ++problems;
    const auto interface = weighted(model, 1e-3, Scaling::deluxe);
    const CoarseProblem coarse = no_coarse_space(*interface);
    CHECK(BalancedSpectrum(*interface, coarse).largest(0) == doctest::Approx(1).epsilon(1e-8));
  });
  CHECK(problems >= 3);
}

// Law 1 (docs/theory.md, section 18): rank of N_0 + rank X_0 - sum of the ranks of F_E,0 eigenvalues grow as 1/epsilon.
void check_law_1(const Model& model, Scaling scaling) {
  const auto interface = weighted(model, 1e-9, scaling);
  Matrix n0 = Matrix::Zero(interface->size(), interface->size());
  Index visible = 0;  // motions of the subdomains that move shared grains
  for (std::size_t e = 0; e < model.parts.subdomains.size(); ++e) {
    const Subdomain& subdomain = model.parts.subdomains[e];
    const CondensedSubdomain& one = interface->subdomains[e];
    if (one.rows.empty()) continue;
    const Vector root = subdomain.inertia.cwiseSqrt().cwiseInverse();
    const ValuesAndVectors left = left_singular(root.asDiagonal() * Matrix(subdomain.h));
    const Index loose = (left.values.array() < 1e-7 * left.values.maxCoeff()).count();
    const Matrix moves = (root.asDiagonal() * left.vectors.leftCols(loose))(one.local, Eigen::all);
    const Matrix flexibility = moves * moves.transpose();  // F_E,0
    visible += rank_of(flexibility);
    n0(one.rows, one.rows) += one.weights * flexibility * one.weights.transpose();
  }
  const InterfaceOperator rigid = InterfaceFamily(model.parts).at(0);
  const Index rank = model.parts.interface_size() - rigid.nullity();
  CHECK(rank_of(rigid.dense()) == rank);
  const Index unbounded = rank_of(n0) + rank - visible;
  CHECK(unbounded <= std::min(rank, interface->size()));
  const auto eigenvalues = [&](double epsilon) {
    const auto at_epsilon = weighted(model, epsilon, scaling);
    const CoarseProblem coarse = no_coarse_space(*at_epsilon);
    return BalancedSpectrum(*at_epsilon, coarse).all(0);
  };
  const Vector growth = eigenvalues(1e-9).cwiseQuotient(eigenvalues(1e-8));
  CHECK((growth.array() > 5).count() == unbounded);
}

TEST_CASE("law 1: in the rigid limit the ranks of the network count the vectors that a coarse space needs") {
  on_every_interface([](const Model& model) {
    for (const Scaling scaling : {Scaling::multiplicity, Scaling::stiffness}) check_law_1(model, scaling);
  });
  Index networks = 0;
  for (std::uint64_t seed = 1; networks < 200; ++seed) {
    CAPTURE(seed);
    const Model model = random_network(seed);
    if (model.parts.interface_size() == 0) continue;
    check_law_1(model, Scaling::multiplicity);
    ++networks;
  }
}
