// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/rigid_motions.hpp"

#include "linalg/sparse_entries.hpp"
#include "mechanics/rigid_clusters.hpp"

#include <Eigen/Dense>

#include <numeric>

namespace nscdd {
namespace {

constexpr double straight = 1e-9;       // how far a column of H may point beside the line of centres
constexpr double least_inertia = 1e-8;  // of a cluster, the smallest over the largest: below, the smallest is rounding

// The two grains of a column that is that of a contact without friction, whatever its length.
std::optional<Bar> bar_of(const Matrix& centres, const SparseMatrix& h, Index column) {
  const Index d = centres.rows();
  std::array<Index, 2> grain{-1, -1};
  std::array<Eigen::Vector3d, 2> part{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (SparseMatrix::InnerIterator e(h, column); e; ++e) {
    const Index own = e.row() / d;
    const std::size_t k = grain[0] < 0 || grain[0] == own ? 0 : 1;
    if (grain[k] >= 0 && grain[k] != own) return std::nullopt;
    grain[k] = own;
    part[k][e.row() % d] = e.value();
  }
  if (grain[1] < 0) return std::nullopt;
  Eigen::Vector3d line = Eigen::Vector3d::Zero();
  line.head(d) = (centres.col(grain[1]) - centres.col(grain[0])).normalized();
  const double size = part[1].norm();
  const bool opposite = (part[0] + part[1]).norm() <= straight * size;
  const bool along = (part[1] - line.dot(part[1]) * line).norm() <= straight * size;
  if (!(size > 0) || !opposite || !along) return std::nullopt;
  return Bar{grain[0], grain[1]};
}

// The rotations about the centre of mass along the principal axes, a column each, and what they weigh.
struct Rotations {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();  // over the radius of gyration
  Eigen::Vector3d inertia;
  double mass = 0;
};

Rotations rotations_of(const Matrix& centres, const Vector& inertia, const std::vector<Index>& grains) {
  const Index d = centres.rows();
  Rotations result;
  const auto place = [&](Index i) {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    x.head(d) = centres.col(i);
    return x;
  };
  result.centre.setZero();
  for (const Index i : grains) {
    result.mass += inertia[d * i];
    result.centre += inertia[d * i] * place(i);
  }
  result.centre /= result.mass;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Index i : grains) {
    const Eigen::Vector3d r = place(i) - result.centre;
    moments += inertia[d * i] * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(moments);
  const double square = moments.trace() / (2 * result.mass);
  result.axes = principal.eigenvectors() / std::sqrt(square);
  result.inertia = principal.eigenvalues() / square;
  return result;
}

// The cluster of each grain, or -1, and which columns are bars within one.
struct Clusters {
  std::vector<Index> of_grain;
  std::vector<char> within;
};

Clusters clusters_of(const Matrix& centres, const Vector& inertia, const SparseMatrix& h) {
  const Index d = centres.rows(), grains = centres.cols();
  Clusters result{std::vector<Index>(at(grains), -1), std::vector<char>(at(h.cols()), 0)};
  std::vector<Bar> bars;
  std::vector<Index> column_of_bar;
  for (Index c = 0; c < h.cols(); ++c)
    if (const std::optional<Bar> bar = bar_of(centres, h, c)) {
      bars.push_back(*bar);
      column_of_bar.push_back(c);
    }
  result.of_grain = rigid_clusters(centres, bars);
  for (Index i = 0; i < grains; ++i)  // motions are told apart by masses that are the same in all directions
    if (inertia.segment(d * i, d).maxCoeff() != inertia.segment(d * i, d).minCoeff())
      return {std::vector<Index>(at(grains), -1), std::vector<char>(at(h.cols()), 0)};
  // A cluster whose bars are all independent would spare nothing but unknowns, and hide that its grains can be set
  // aside.
  std::vector<Index> bars_within, points;
  const auto add = [](std::vector<Index>& to, Index cluster) {
    if (cluster >= count(to)) to.resize(at(cluster + 1), 0);
    ++to[at(cluster)];
  };
  const auto cluster_of = [&](const Bar& bar) {
    const Index a = result.of_grain[at(bar.a)];
    return a == result.of_grain[at(bar.b)] ? a : -1;
  };
  for (const Index cluster : result.of_grain)
    if (cluster >= 0) add(points, cluster);
  bars_within.resize(points.size(), 0);
  for (const Bar& bar : bars)
    if (const Index cluster = cluster_of(bar); cluster >= 0) add(bars_within, cluster);
  for (Index& cluster : result.of_grain)
    if (cluster >= 0 && bars_within[at(cluster)] <= d * points[at(cluster)] - d * (d + 1) / 2) cluster = -1;
  // One with a few heavy grains in a line among light ones has next to no inertia about that line.
  std::vector<std::vector<Index>> members(points.size());
  for (Index i = 0; i < grains; ++i)
    if (const Index cluster = result.of_grain[at(i)]; cluster >= 0) members[at(cluster)].push_back(i);
  for (const std::vector<Index>& own : members) {
    if (own.empty()) continue;
    const Eigen::Vector3d moments = rotations_of(centres, inertia, own).inertia;
    if (!(moments.minCoeff() > least_inertia * moments.maxCoeff()))
      for (const Index i : own) result.of_grain[at(i)] = -1;
  }
  for (std::size_t k = 0; k < bars.size(); ++k) result.within[at(column_of_bar[k])] = cluster_of(bars[k]) >= 0;
  return result;
}

// The matrix without the rows of the grounded bodies, which stay empty.
SparseMatrix without_rows(const RigidMotions& motions, const std::vector<char>& grounded) {
  std::vector<char> dropped(at(motions.h.rows()), 0);
  for (std::size_t b = 0; b < grounded.size(); ++b)
    if (grounded[b]) std::fill_n(dropped.begin() + motions.bodies[b].first_row, motions.bodies[b].rows, char{1});
  SparseEntries entries;
  for_entries(motions.h, [&](Index i, Index j, double value) {
    if (!dropped[at(i)]) entries.add(i, j, value);
  });
  return entries.matrix(motions.h.rows(), motions.h.cols());
}

}  // namespace

RigidMotions rigid_motions(const RigidNetwork& network) {
  const auto& [d, centres, inertia, h] = network;
  const Index grains = h.rows() / std::max<Index>(d, 1);
  RigidMotions motions;
  motions.searched = d == 3 && centres.rows() == 3 && centres.cols() == grains;
  if (!motions.searched) {
    for (Index i = 0; i < grains; ++i) motions.bodies.push_back({d * i, d, 1, i});
    motions.inertia = inertia;
    motions.z = SparseMatrix(h.rows(), h.rows());
    motions.z.setIdentity();
    motions.contacts.resize(at(h.cols()));
    std::iota(motions.contacts.begin(), motions.contacts.end(), Index{0});
    motions.h = h;
    return motions;
  }
  const Clusters clusters = clusters_of(centres, inertia, h);
  std::vector<std::vector<Index>> members;
  for (Index i = 0; i < grains; ++i)
    if (const Index cluster = clusters.of_grain[at(i)]; cluster >= 0) {
      if (cluster >= count(members)) members.resize(at(cluster + 1));
      members[at(cluster)].push_back(i);
    }
  std::erase_if(members, [](const std::vector<Index>& own) { return own.empty(); });
  SparseEntries z;
  std::vector<double> weight;
  const auto add = [&](Index row, double value) { z.add(row, count(weight), value); };
  for (Index i = 0; i < grains; ++i) {
    if (clusters.of_grain[at(i)] >= 0) continue;
    motions.bodies.push_back({count(weight), d, 1, i});
    for (Index k = 0; k < d; ++k) {
      add(d * i + k, 1);
      weight.push_back(inertia[d * i + k]);
    }
  }
  for (const std::vector<Index>& own : members) {
    const Rotations rotations = rotations_of(centres, inertia, own);
    const Index spins = d * (d - 1) / 2;
    motions.bodies.push_back({count(weight), d + spins, count(own), -1});
    for (Index k = 0; k < d; ++k) {
      for (const Index i : own) add(d * i + k, 1);
      weight.push_back(rotations.mass);
    }
    for (Index k = 0; k < spins; ++k) {
      for (const Index i : own) {
        Eigen::Vector3d r = -rotations.centre;
        r.head(d) += centres.col(i);
        const Eigen::Vector3d v = rotations.axes.col(k).cross(r);
        for (Index m = 0; m < d; ++m) add(d * i + m, v[m]);
      }
      weight.push_back(rotations.inertia[k]);
    }
  }
  motions.z = z.matrix(h.rows(), count(weight));
  motions.inertia = Eigen::Map<const Vector>(weight.data(), count(weight));
  for (Index c = 0; c < h.cols(); ++c)
    if (!clusters.within[at(c)]) motions.contacts.push_back(c);
  motions.h = SparseMatrix(motions.z.transpose() * selected_columns(h, motions.contacts));
  return motions;
}

RangeBasis range_basis(const RigidMotions& motions, const std::vector<char>& grounded, Tilt tilt) {
  const SparseMatrix h = grounded.empty() ? motions.h : without_rows(motions, grounded);
  if (!motions.searched) return range_basis(h, tilt);
  const Peeled peeled = peel(motions.bodies, grounded, h);
  RangeBasis result = range_basis(selected_columns(h, peeled.left), tilt);
  for (Index& c : result.columns) c = peeled.left[at(c)];
  result.columns.insert(result.columns.end(), peeled.set_aside.begin(), peeled.set_aside.end());
  std::sort(result.columns.begin(), result.columns.end());
  return result;
}

MatrixRank rigid_rank(const RigidNetwork& network) {
  const RigidMotions motions = rigid_motions(network);
  if (!motions.searched) return sparse_rank(network.h);
  const Peeled peeled = peel(motions.bodies, {}, motions.h);
  MatrixRank rank = sparse_rank(selected_columns(motions.h, peeled.left));
  rank.value += network.h.rows() - motions.h.rows() + count(peeled.set_aside);
  return rank;
}

}  // namespace nscdd
