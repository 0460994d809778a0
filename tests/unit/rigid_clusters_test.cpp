// SPDX-License-Identifier: GPL-3.0-or-later
// Clusters of points that bars hold together, and what is left of a network whose clusters move as one.
#include "mechanics/rigid_clusters.hpp"

#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include "../support/sanitized.hpp"
#include "../support/thorough.hpp"
#include "ddm/rigid_motions.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Points that are 1 m apart are tied.
std::vector<Bar> ties_of(const Matrix& centres) {
  std::vector<Bar> bars;
  for (Index j = 0; j < centres.cols(); ++j)
    for (Index i = 0; i < j; ++i)
      if (std::abs((centres.col(i) - centres.col(j)).norm() - 1) < 1e-9) bars.push_back({i, j});
  return bars;
}

std::vector<Index> clusters_of(const Matrix& centres) { return rigid_clusters(centres, ties_of(centres)); }

Matrix columns(const std::vector<std::vector<double>>& points) {
  Matrix all(count(points[0]), count(points));
  for (Index j = 0; j < all.cols(); ++j) all.col(j) = Eigen::Map<const Vector>(points[at(j)].data(), all.rows());
  return all;
}

// Sites of the face-centred cubic lattice with the least distance 1.
Matrix fcc(Index n) {
  std::vector<std::vector<double>> points;
  const double half = 1 / std::sqrt(2.0);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      for (Index k = 0; k < n; ++k)
        if ((i + j + k) % 2 == 0)
          points.push_back(
              {half * static_cast<double>(i), half * static_cast<double>(j), half * static_cast<double>(k)});
  return columns(points);
}

Matrix triangles(Index n, bool in_space) {
  std::vector<std::vector<double>> points;
  for (Index row = 0; row < n; ++row)
    for (Index column = 0; column < n; ++column) {
      points.push_back(
          {static_cast<double>(column) + 0.5 * static_cast<double>(row), std::sqrt(0.75) * static_cast<double>(row)});
      if (in_space) points.back().push_back(0.3);
    }
  return columns(points);
}

Matrix squares(Index n) {
  std::vector<std::vector<double>> points;
  for (Index row = 0; row < n; ++row)
    for (Index column = 0; column < n; ++column)
      points.push_back({static_cast<double>(column), static_cast<double>(row)});
  return columns(points);
}

const double high = std::sqrt(2.0 / 3), deep = std::sqrt(0.75);
Matrix bipyramid() {
  return columns({{0, 0, 0}, {1, 0, 0}, {0.5, deep, 0}, {0.5, deep / 3, high}, {0.5, deep / 3, -high}});
}

Index free_motions(const Matrix& centres, const std::vector<Bar>& bars, const std::vector<Index>& members) {
  const Index d = centres.rows();
  Matrix gram = Matrix::Zero(d * count(members), d * count(members));
  for (const Bar& bar : bars) {
    const Index a = std::ranges::find(members, bar.a) - members.begin();
    const Index b = std::ranges::find(members, bar.b) - members.begin();
    if (a == count(members) || b == count(members)) continue;
    Vector row = Vector::Zero(gram.rows());
    const Vector n = centres.col(bar.b) - centres.col(bar.a);
    row.segment(d * a, d) = -n;
    row.segment(d * b, d) = n;
    gram += row * row.transpose();
  }
  return (symmetric_eigenvalues(gram).array() < 1e-10).count();
}

}  // namespace

TEST_CASE("rigid clusters: two tetrahedra with a face in common, an octahedron, a block of lattice are one each") {
  const double half = 1 / std::sqrt(2.0);
  const Matrix octahedron =
      columns({{half, 0, 0}, {-half, 0, 0}, {0, half, 0}, {0, -half, 0}, {0, 0, half}, {0, 0, -half}});
  for (const Matrix& centres : {bipyramid(), octahedron, fcc(5), triangles(4, false)}) {
    CAPTURE(centres.cols());
    CHECK(clusters_of(centres) == std::vector<Index>(at(centres.cols()), 0));
  }
}

TEST_CASE("rigid clusters: chains, squares, triangles by themselves and spheres in a plane are none") {
  const Matrix chain = columns({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 1, 1}});
  const Matrix triangle = columns({{0, 0, 0}, {1, 0, 0}, {0.5, deep, 0}});
  for (const Matrix& centres : {chain, squares(5), triangle, triangles(4, true)}) {
    CAPTURE(centres.cols());
    CHECK(clusters_of(centres) == std::vector<Index>(at(centres.cols()), -1));
  }
}

TEST_CASE("rigid clusters: what hangs on one by less than it takes stays by itself") {
  Matrix centres(3, 7);
  centres.leftCols(5) = bipyramid();
  centres.col(5) = Vector::Unit(3, 0) * -1;                                                // one bar
  centres.col(6) = 0.5 * (centres.col(0) + centres.col(1)) - Eigen::Vector3d(0, deep, 0);  // two
  CHECK(clusters_of(centres) == std::vector<Index>{0, 0, 0, 0, 0, -1, -1});
}

TEST_CASE("rigid clusters: two tetrahedra that share a point are two; six bars between them make them one") {
  Matrix centres(3, 8);
  centres.leftCols(4) = columns({{0, 0, 0}, {1, 0, 0}, {0.5, deep, 0}, {0.5, deep / 3, high}});
  centres.rightCols(4) = centres.leftCols(4).colwise() + Eigen::Vector3d(0.1, 0.2, 3);
  std::vector<Bar> bars = ties_of(centres);
  CHECK(rigid_clusters(centres, bars) == std::vector<Index>{0, 0, 0, 0, 1, 1, 1, 1});
  // No point of one has three bars to the other, so that it would join by itself.
  for (const Bar& bar : {Bar{0, 4}, Bar{0, 5}, Bar{1, 5}, Bar{1, 6}, Bar{2, 6}}) bars.push_back(bar);
  CHECK(rigid_clusters(centres, bars) == std::vector<Index>{0, 0, 0, 0, 1, 1, 1, 1});
  bars.push_back({2, 4});
  CHECK(rigid_clusters(centres, bars) == std::vector<Index>(8, 0));
}

TEST_CASE("rigid clusters of random lattices have the motions of a rigid body, and no others") {
  for (std::uint64_t seed = 1; seed <= (sanitized ? 1 : thorough() ? 6 : 2); ++seed) {
    CAPTURE(seed);
    const Model model = build(random_fcc(seed, 7, 7, 6, GridPartitioner{{1, 1, 1}}));
    const Matrix& centres = model.problem.centres;
    std::vector<Bar> bars;
    for (const Contact& contact : model.network.contacts) bars.push_back({contact.a, contact.b});
    const std::vector<Index> cluster = rigid_clusters(centres, bars);
    const Index clusters = 1 + *std::ranges::max_element(cluster);
    CHECK(clusters > 0);
    for (Index c = 0; c < clusters; ++c) {
      std::vector<Index> members;
      for (Index i = 0; i < count(cluster); ++i)
        if (cluster[at(i)] == c) members.push_back(i);
      CHECK(count(members) > 3);
      CHECK(free_motions(centres, bars, members) == 6);
    }
  }
}

TEST_CASE("motions that rigid clusters leave: all that contacts allow, ranks, independent columns") {
  std::vector<Case> cases = spatial_problems();
  for (const std::uint64_t seed : {2U, 3U}) cases.push_back(random_fcc(seed, 8, 8, 7, GridPartitioner{{2, 1, 1}}));
  Index clusters = 0;
  for (const Case& one : cases) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    for (const Subdomain& part : model.parts.subdomains) {
      const RigidMotions motions = rigid_motions(3, part.centres, part.inertia, part.h);
      clusters += std::ranges::count_if(motions.bodies, [](const RigidBody& body) { return body.grains > 1; });
      const auto zeros = [](const Dense& gram) { return (symmetric_eigenvalues(gram).array() < 1e-10).count(); };
      const Dense h = Matrix(part.h), reduced = Matrix(motions.h);
      const Index allowed = zeros(h * h.transpose());
      CHECK(zeros(reduced * reduced.transpose()) == allowed);
      CHECK(rigid_rank(3, part.centres, part.inertia, part.h).value == h.rows() - allowed);
      // What the clusters allow, the contacts within them allow.
      const Matrix image = Matrix(part.h.transpose() * motions.z);
      for (Index c = 0, next = 0; c < part.h.cols(); ++c) {
        if (next < count(motions.contacts) && motions.contacts[at(next)] == c)
          ++next;
        else
          CHECK(image.row(c).norm() < 1e-13);
      }
      const Matrix weighed = motions.z.transpose() * part.inertia.asDiagonal() * Matrix(motions.z);
      CHECK((weighed - Matrix(motions.inertia.asDiagonal())).norm() < 1e-12 * weighed.norm());
      const RangeBasis basis = range_basis(motions);
      CHECK(basis.conclusive);
      CHECK(basis.size() == motions.h.rows() - allowed);
      CHECK(basis.others.cols() == 0);
      Matrix kept(motions.h.rows(), count(basis.columns));
      for (Index j = 0; j < kept.cols(); ++j) kept.col(j) = motions.h.col(basis.columns[at(j)]);
      const Dense columns = kept;
      if (columns.cols() > 0) CHECK(zeros(columns.transpose() * columns) == 0);
    }
  }
  CHECK(clusters > 2);
}
