// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/rigid_motions.hpp"

#include "linalg/pencil.hpp"
#include "mechanics/rigid_clusters.hpp"

#include <Eigen/Dense>

namespace nscdd {
namespace {

constexpr Index dimensions = 3;         // clusters are sought in space only
constexpr double independent = 1e-2;    // least singular value of columns of unit length that clearly are
constexpr double straight = 1e-9;       // angle between a column of H and the line of centres
constexpr double least_inertia = 1e-8;  // of a cluster, smallest over largest: below, the smallest is rounding

// The two grains of a column of a frictionless contact, of any length; nothing for other columns.
std::optional<Bar> bar_of(const Matrix& centres, const SparseMatrix& h, Index column) {
  std::array<Index, 2> grain{-1, -1};
  std::array<Eigen::Vector3d, 2> part{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (SparseMatrix::InnerIterator e(h, column); e; ++e) {
    const Index own = e.row() / dimensions;
    const std::size_t k = grain[0] < 0 || grain[0] == own ? 0 : 1;
    if (grain[k] >= 0 && grain[k] != own) return std::nullopt;
    grain[k] = own;
    part[k][e.row() % dimensions] = e.value();
  }
  if (grain[1] < 0) return std::nullopt;
  const Eigen::Vector3d line = (centres.col(grain[1]) - centres.col(grain[0])).normalized();
  const double size = part[1].norm();
  const bool opposite = (part[0] + part[1]).norm() <= straight * size;
  const bool along = (part[1] - line.dot(part[1]) * line).norm() <= straight * size;
  if (!(size > 0) || !opposite || !along) return std::nullopt;
  return Bar{grain[0], grain[1]};
}

// The rotations about the principal axes through the centre of mass, a column each, and their inertia.
struct Rotations {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes;  // over the radius of gyration
  Eigen::Vector3d inertia;
  double mass = 0;
};

Rotations rotations_of(const Matrix& centres, const Vector& inertia, const std::vector<Index>& grains) {
  Rotations result;
  for (const Index i : grains) {
    result.mass += inertia[dimensions * i];
    result.centre += inertia[dimensions * i] * centres.col(i);
  }
  result.centre /= result.mass;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Index i : grains) {
    const Eigen::Vector3d r = centres.col(i) - result.centre;
    moments += inertia[dimensions * i] * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(moments);
  const double square = moments.trace() / (2 * result.mass);
  result.axes = principal.eigenvectors() / std::sqrt(square);
  result.inertia = principal.eigenvalues() / square;
  return result;
}

// The grains of each cluster; some clusters may have none.
std::vector<std::vector<Index>> members_of(const std::vector<Index>& cluster_of_grain) {
  std::vector<std::vector<Index>> members;
  for (Index i = 0; i < count(cluster_of_grain); ++i)
    if (const Index cluster = cluster_of_grain[at(i)]; cluster >= 0) {
      if (cluster >= count(members)) members.resize(at(cluster + 1));
      members[at(cluster)].push_back(i);
    }
  return members;
}

// The cluster of each grain, or -1, and a flag for each column that is a bar within one.
struct Clusters {
  std::vector<Index> of_grain;
  std::vector<char> within;
};

void find_clusters(Clusters& result, const Matrix& centres, const Vector& inertia, const SparseMatrix& h) {
  for (Index i = 0; i < centres.cols(); ++i)  // only point masses, equal in all directions, form clusters
    if (const auto own = inertia.segment<dimensions>(dimensions * i); own.maxCoeff() != own.minCoeff()) return;
  std::vector<Bar> bars;
  std::vector<Index> column_of_bar;
  for (Index c = 0; c < h.cols(); ++c)
    if (const std::optional<Bar> bar = bar_of(centres, h, c)) {
      bars.push_back(*bar);
      column_of_bar.push_back(c);
    }
  result.of_grain = rigid_clusters(centres, bars);
  const auto cluster_of = [&](const Bar& bar) {
    const Index a = result.of_grain[at(bar.a)];
    return a == result.of_grain[at(bar.b)] ? a : -1;
  };
  const std::vector<std::vector<Index>> members = members_of(result.of_grain);
  std::vector<Index> bars_within(members.size(), 0);
  for (const Bar& bar : bars)
    if (const Index cluster = cluster_of(bar); cluster >= 0) ++bars_within[at(cluster)];
  for (std::size_t k = 0; k < members.size(); ++k) {
    // If all bars of a cluster are independent, it only hides that its grains can be set aside. If a few heavy grains
    // lie in a line among light ones, it has next to no inertia about that line.
    const std::vector<Index>& own = members[k];
    if (bars_within[k] > 3 * count(own) - 6) {
      const Eigen::Vector3d moments = rotations_of(centres, inertia, own).inertia;
      if (moments.minCoeff() > least_inertia * moments.maxCoeff()) continue;
    }
    for (const Index i : own) result.of_grain[at(i)] = -1;
  }
  for (std::size_t k = 0; k < bars.size(); ++k) result.within[at(column_of_bar[k])] = cluster_of(bars[k]) >= 0;
}

// Sets aside, repeatedly, each body that has few columns of Z^T H, all clearly independent by their rows of this body.
// An empty column is in neither list.
class Peeling {
 public:
  Peeling(const std::vector<RigidBody>& bodies, const SparseMatrix& h)
      : bodies_(bodies), h_(h), columns_of_(bodies.size()), remains_(at(h.cols()), 1) {
    for (Index b = 0; b < count(bodies); ++b)  // bodies follow each other
      body_of_row_.resize(body_of_row_.size() + at(bodies[at(b)].rows), b);
    for (Index c = 0; c < h.cols(); ++c) {
      for (const Index b : bodies_of(c)) columns_of_[at(b)].push_back(c);
      if (bodies_of(c).empty()) remains_[at(c)] = 0;
    }
    for (Index b = 0; b < count(bodies); ++b) queue_.push_back(b);
    for (std::size_t k = 0; k < queue_.size(); ++k) try_body(queue_[k]);
    for (Index c = 0; c < h.cols(); ++c)
      if (remains_[at(c)]) left.push_back(c);
  }

  std::vector<Index> set_aside;  // columns independent of each other and of all that are left
  std::vector<Index> left;       // ascending; none of these columns acts on a body that was set aside

 private:
  std::vector<Index> bodies_of(Index column) const {
    std::vector<Index> bodies;
    for (SparseMatrix::InnerIterator e(h_, column); e; ++e)
      if (const Index b = body_of_row_[at(e.row())]; std::ranges::count(bodies, b) == 0) bodies.push_back(b);
    return bodies;
  }

  void try_body(Index b) {
    const RigidBody& body = bodies_[at(b)];
    std::vector<Index>& columns = columns_of_[at(b)];
    std::erase_if(columns, [&](Index c) { return !remains_[at(c)]; });
    if (columns.empty() || count(columns) > body.rows) return;
    Matrix block = Matrix::Zero(body.rows, count(columns));
    for (Index j = 0; j < block.cols(); ++j) {
      double square = 0;
      for (SparseMatrix::InnerIterator e(h_, columns[at(j)]); e; ++e) {
        square += e.value() * e.value();
        if (body_of_row_[at(e.row())] == b) block(e.row() - body.first_row, j) = e.value();
      }
      if (!(square > 0)) return;
      block.col(j) *= std::sqrt(2 / square);
    }
    const Vector squares = symmetric_eigen(block.transpose() * block, Eigenvectors::not_wanted).values;
    if (!(squares[0] > independent * independent)) return;
    for (const Index c : columns) {
      remains_[at(c)] = 0;
      set_aside.push_back(c);
      for (const Index other : bodies_of(c))
        if (other != b) queue_.push_back(other);
    }
  }

  const std::vector<RigidBody>& bodies_;
  const SparseMatrix& h_;
  std::vector<Index> body_of_row_;
  std::vector<std::vector<Index>> columns_of_;
  std::vector<char> remains_;
  std::vector<Index> queue_;
};

}  // namespace

RigidMotions rigid_motions(Index d, const Matrix& centres, const Vector& inertia, const SparseMatrix& h) {
  const Index grains = h.rows() / std::max<Index>(d, 1);
  RigidMotions motions;
  motions.searched = d == 3 && centres.rows() == 3 && centres.cols() == grains;
  Clusters clusters{std::vector<Index>(at(grains), -1), std::vector<char>(at(h.cols()), 0)};
  if (motions.searched) find_clusters(clusters, centres, inertia, h);
  std::vector<std::vector<Index>> members = members_of(clusters.of_grain);
  std::erase_if(members, [](const std::vector<Index>& own) { return own.empty(); });
  SparseEntries z;
  std::vector<double> weight;
  const auto add = [&](Index row, double value) { z.add(row, count(weight), value); };
  for (Index i = 0; i < grains; ++i) {
    if (clusters.of_grain[at(i)] >= 0) continue;
    motions.bodies.push_back({count(weight), d, 1});
    for (Index k = 0; k < d; ++k) {
      add(d * i + k, 1);
      weight.push_back(inertia[d * i + k]);
    }
  }
  for (const std::vector<Index>& own : members) {
    const Rotations rotations = rotations_of(centres, inertia, own);
    const Index spins = 3;
    motions.bodies.push_back({count(weight), d + spins, count(own)});
    for (Index k = 0; k < d; ++k) {
      for (const Index i : own) add(d * i + k, 1);
      weight.push_back(rotations.mass);
    }
    for (Index k = 0; k < spins; ++k) {
      for (const Index i : own) {
        const Eigen::Vector3d r = centres.col(i) - rotations.centre, v = rotations.axes.col(k).cross(r);
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

RangeBasis range_basis(const RigidMotions& motions, Tilt tilt) {
  if (!motions.searched) return range_basis(motions.h, tilt);
  const Peeling peeled(motions.bodies, motions.h);
  RangeBasis result = range_basis(selected_columns(motions.h, peeled.left), tilt);
  for (Index& c : result.columns) c = peeled.left[at(c)];
  result.columns.insert(result.columns.end(), peeled.set_aside.begin(), peeled.set_aside.end());
  std::sort(result.columns.begin(), result.columns.end());
  return result;
}

MatrixRank rigid_rank(Index d, const Matrix& centres, const Vector& inertia, const SparseMatrix& h) {
  const RigidMotions motions = rigid_motions(d, centres, inertia, h);
  if (!motions.searched) return sparse_rank(h);
  const Peeling peeled(motions.bodies, motions.h);
  MatrixRank rank = sparse_rank(selected_columns(motions.h, peeled.left));
  rank.value += h.rows() - motions.h.rows() + count(peeled.set_aside);
  return rank;
}

}  // namespace nscdd
