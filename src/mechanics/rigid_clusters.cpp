// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/rigid_clusters.hpp"

#include "core/disjoint_sets.hpp"
#include "linalg/pencil.hpp"

#include <Eigen/Geometry>

#include <map>

namespace nscdd {
namespace {

constexpr double least_hold = 0.05;  // the least singular value that counts as held

// Whether bars with the Gram matrix R^T R fix all unknowns.
bool gram_holds(const Matrix& gram) {
  return symmetric_eigen(gram, Eigenvectors::not_wanted).values[0] > least_hold * least_hold;
}

bool hold(const Matrix& rows) { return rows.rows() >= rows.cols() && gram_holds(rows.transpose() * rows); }

class ClusterSearch {
 public:
  ClusterSearch(const Matrix& centres, const std::vector<Bar>& bars)
      : centres_(centres), bars_(bars), cluster_(at(centres.cols()), -1), neighbours_(cluster_.size()) {
    for (const Bar& bar : bars) {
      neighbours_[at(bar.a)].push_back(bar.b);
      neighbours_[at(bar.b)].push_back(bar.a);
    }
    for (std::vector<Index>& own : neighbours_) std::ranges::sort(own);
  }

  std::vector<Index> run() {
    for (Index a = 0; a < centres_.cols(); ++a) seed({a});
    while (merge_pairs()) continue;
    return renumbered(std::move(cluster_));
  }

 private:
  const std::vector<Index>& neighbours(Index i) const { return neighbours_[at(i)]; }
  bool loose(Index i) const { return cluster_[at(i)] < 0; }
  bool tied(Index i, Index j) const { return std::ranges::binary_search(neighbours(i), j); }
  Vector direction(Index from, Index to) const { return (centres_.col(to) - centres_.col(from)).normalized(); }

  // Whether its neighbours in the cluster hold a point.
  bool held(Index i, Index cluster) const {
    const auto own = [&](Index j) { return cluster_[at(j)] == cluster; };
    if (std::ranges::count_if(neighbours(i), own) < d_) return false;
    Matrix gram = Matrix::Zero(d_, d_);
    for (const Index j : neighbours(i))
      if (own(j)) {
        const Vector n = direction(i, j);
        gram += n * n.transpose();
      }
    return gram_holds(gram);
  }

  // Grows a cluster from each loose simplex that begins with these points, in ascending order.
  void seed(const std::vector<Index>& points) {
    if (!std::ranges::all_of(points, [&](Index i) { return loose(i); })) return;
    if (count(points) < d_) {
      for (const Index next : neighbours(points.back())) {
        if (next < points.back()) continue;
        if (!std::ranges::all_of(points, [&](Index i) { return tied(i, next); })) continue;
        std::vector<Index> more = points;
        more.push_back(next);
        seed(more);
      }
      return;
    }
    if (d_ == 3) {  // three points in a line do not hold each other
      const Eigen::Vector3d u = direction(points[0], points[1]), v = direction(points[0], points[2]);
      if (u.cross(v).norm() < least_hold) return;
    }
    const std::vector<Index> members = grow(points, clusters_++);
    if (count(members) == d_)
      for (const Index i : members) cluster_[at(i)] = -1;
  }

  // Adds all points that join a cluster; returns its members.
  std::vector<Index> grow(std::vector<Index> members, Index cluster) {
    for (const Index i : members) cluster_[at(i)] = cluster;
    std::size_t next = 0, ringed = 0;
    const auto join = [&](Index i) {
      cluster_[at(i)] = cluster;
      members.push_back(i);
    };
    while (next < members.size()) {
      for (const Index i : neighbours(members[next]))
        if (loose(i) && held(i, cluster)) join(i);
      // Rings that are held now touch a new member.
      if (++next == members.size())
        for (const std::size_t end = next; ringed < end; ++ringed)
          for (const Index i : neighbours(members[ringed]))
            for (const Index j : held_ring(i, cluster)) join(j);
    }
    return members;
  }

  // A loose point and two others tied to it and to each other that are held together; empty if there are none.
  std::vector<Index> held_ring(Index i, Index cluster) const {
    const auto can = [&](Index j) {
      return loose(j) &&
             std::ranges::count_if(neighbours(j), [&](Index k) { return cluster_[at(k)] == cluster; }) >= d_ - 1;
    };
    if (!can(i)) return {};
    for (const Index j : neighbours(i)) {
      if (!can(j)) continue;
      for (const Index k : neighbours(j))
        if (k > j && k != i && tied(i, k) && can(k) && hold(rows_of({i, j, k}, cluster))) return {i, j, k};
    }
    return {};
  }

  // One row for each bar between some points, and from them to a cluster.
  Matrix rows_of(const std::vector<Index>& points, Index cluster) const {
    std::vector<Vector> rows;
    for (Index p = 0; p < count(points); ++p)
      for (const Index j : neighbours(points[at(p)])) {
        const Index q = std::ranges::find(points, j) - points.begin();
        if (cluster_[at(j)] != cluster && (q == count(points) || q < p)) continue;
        Vector row = Vector::Zero(d_ * count(points));
        const Vector n = direction(points[at(p)], j);
        row.segment(d_ * p, d_) = -n;
        if (q < count(points)) row.segment(d_ * q, d_) = n;
        rows.push_back(row);
      }
    Matrix all(count(rows), d_ * count(points));
    for (Index r = 0; r < all.rows(); ++r) all.row(r) = rows[at(r)];
    return all;
  }

  // Row of a bar for the motion of the body of b relative to that of a, about a point, lengths in units of `length`.
  Vector relative_row(const Bar& bar, const Vector& about, double length) const {
    const Vector n = direction(bar.a, bar.b), arm = (centres_.col(bar.b) - about) / length;
    if (d_ == 2) return Eigen::Vector3d(n[0], n[1], arm[0] * n[1] - arm[1] * n[0]);
    Vector row(6);
    row << n, Eigen::Vector3d(arm).cross(Eigen::Vector3d(n));
    return row;
  }

  bool hold_each_other(const std::vector<Bar>& bars) const {
    const Index motions = d_ * (d_ + 1) / 2;
    if (count(bars) < motions) return false;
    Vector mean = Vector::Zero(d_);
    for (const Bar& bar : bars) mean += centres_.col(bar.b) / static_cast<double>(count(bars));
    double square = 0;
    for (const Bar& bar : bars) square += (centres_.col(bar.b) - mean).squaredNorm() / static_cast<double>(count(bars));
    if (square == 0) return false;
    Matrix rows(count(bars), motions);
    for (Index r = 0; r < rows.rows(); ++r) rows.row(r) = relative_row(bars[at(r)], mean, std::sqrt(square));
    return hold(rows);
  }

  // Merges pairs of clusters that bars between them hold, each at most once; false if there are none.
  bool merge_pairs() {
    std::map<std::array<Index, 2>, std::vector<Bar>> between;
    for (const Bar& bar : bars_) {
      const Index a = cluster_[at(bar.a)], b = cluster_[at(bar.b)];
      if (a < 0 || b < 0 || a == b) continue;
      between[{std::min(a, b), std::max(a, b)}].push_back(a < b ? bar : Bar{bar.b, bar.a});
    }
    std::vector<Index> into(at(clusters_), -1);
    std::vector<char> taken(at(clusters_), 0);
    for (const auto& [pair, bars] : between) {
      const auto& [first, second] = pair;
      if (taken[at(first)] || taken[at(second)] || !hold_each_other(bars)) continue;
      taken[at(first)] = taken[at(second)] = 1;
      into[at(second)] = first;
    }
    std::map<Index, std::vector<Index>> merged;
    for (Index i = 0; i < count(cluster_); ++i) {
      const Index old = cluster_[at(i)];
      if (old < 0 || !taken[at(old)]) continue;
      merged[into[at(old)] < 0 ? old : into[at(old)]].push_back(i);
    }
    for (const auto& [cluster, members] : merged) grow(members, cluster);
    return !merged.empty();
  }

  const Matrix& centres_;
  const std::vector<Bar>& bars_;
  Index d_ = centres_.rows(), clusters_ = 0;
  std::vector<Index> cluster_;
  std::vector<std::vector<Index>> neighbours_;  // of each point, ascending
};

}  // namespace

std::vector<Index> rigid_clusters(const Matrix& centres, const std::vector<Bar>& bars) {
  return ClusterSearch(centres, bars).run();
}

}  // namespace nscdd
