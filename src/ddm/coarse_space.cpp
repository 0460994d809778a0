// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/coarse_space.hpp"

#include "core/fail.hpp"
#include "linalg/pencil.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

#include <Eigen/Cholesky>

namespace nscdd {
namespace {

constexpr double least_distance = 1e-12;  // squared distance in C from the vectors before, of a vector of norm 1

// Sorts by lambda, and within it by subdomain, and scales to norm 1 in C. `local`: columns of each subdomain of this
// rank, on its shared unknowns, with lambda as the last entry.
CoarseVectors united(const PrimalInterface& interface, std::vector<Matrix> local) {
  interface.processes.share(local);
  std::vector<std::tuple<double, Index, Index>> order;  // lambda, subdomain, column
  for (Index e = 0; e < count(local); ++e)
    for (Index j = 0; j < local[at(e)].cols(); ++j) order.emplace_back(local[at(e)](local[at(e)].rows() - 1, j), e, j);
  std::ranges::sort(order);
  SparseEntries entries;
  CoarseVectors all{{}, Vector(count(order)), {}};
  for (Index k = 0; k < count(order); ++k) {
    const auto& [lambda, e, j] = order[at(k)];
    const std::vector<Index>& rows = interface.subdomains[at(e)].rows;
    for (Index i = 0; i < count(rows); ++i)
      if (const double value = local[at(e)](i, j); value != 0) entries.add(rows[at(i)], k, value);
    all.lambda[k] = lambda;
    all.subdomains.push_back(e);
  }
  all.u = entries.matrix(interface.size(), count(order));
  const SparseMatrix image = interface.sparse() * all.u;
  for (Index k = 0; k < count(order); ++k)
    if (const double square = all.u.col(k).dot(image.col(k)); square > 0) all.u.col(k) /= std::sqrt(square);
  return all;
}

// An orthonormal basis of columns: a lone shared grain has no rotation of its own, a piece without one no motion.
Matrix independent_columns(const Matrix& columns) {
  Matrix basis(columns.rows(), columns.cols());
  Index rank = 0;
  for (Index j = 0; j < columns.cols(); ++j) {
    Vector left = columns.col(j);
    for (Index pass = 0; pass < 2 * rank; ++pass) left -= basis.col(pass % rank).dot(left) * basis.col(pass % rank);
    if (left.norm() > 1e-6 * columns.col(j).norm()) basis.col(rank++) = left.normalized();
  }
  return basis.leftCols(rank);
}

// Connected pieces of a subdomain.
struct Pieces {
  std::vector<Index> of_grain;
  Matrix places;                           // of grains, from the first one of their piece on
  std::vector<std::array<bool, 3>> wraps;  // directions in which a piece touches its own image and cannot turn
};

Pieces pieces_of(const Subdomain& subdomain, Index unknowns, const Period& period) {
  const SparseMatrix touching = subdomain.h * subdomain.h.transpose();
  const Index d = subdomain.centres.rows();
  const std::array cell{period.x, period.y};
  Pieces all{std::vector<Index>(subdomain.grains.size(), -1), Matrix::Zero(d, count(subdomain.grains)), {}};
  for (Index first = 0; first < count(all.of_grain); ++first) {
    if (all.of_grain[at(first)] >= 0) continue;
    const Index piece = all.of_grain[at(first)] = count(all.wraps);
    all.wraps.push_back({});
    for (std::vector<Index> open{first}; !open.empty();) {
      const Index i = open.back();
      open.pop_back();
      for (Index column = unknowns * i; column < unknowns * (i + 1); ++column)
        for (SparseMatrix::InnerIterator e(touching, column); e; ++e) {
          if (e.value() == 0) continue;  // of a contact that is open
          const Index j = e.row() / unknowns;
          std::array<double, 3> step{};
          for (Index k = 0; k < d; ++k) step[at(k)] = subdomain.centres(k, j) - subdomain.centres(k, i);
          step = period.shortest(step);
          const Vector place = all.places.col(i) + Eigen::Map<const Vector>(step.data(), d);
          if (std::exchange(all.of_grain[at(j)], piece) < 0) {
            all.places.col(j) = place;
            open.push_back(j);
          }
          for (Index k = 0; k < 2; ++k)
            all.wraps.back()[at(k)] |= cell[at(k)] > 0 && std::abs(place[k] - all.places(k, j)) > cell[at(k)] / 2;
        }
    }
  }
  return all;
}

// Velocities of the shared grains of connected pieces of a subdomain that move as rigid bodies.
Matrix rigid_motions_of(const CondensedSubdomain& one, const Subdomain& subdomain, Index unknowns,
                        const Period& period) {
  const Pieces all = pieces_of(subdomain, unknowns, period);
  const Index d = subdomain.centres.rows(), motions = d * (d + 1) / 2;
  Matrix velocities = Matrix::Zero(count(one.local), motions * count(all.wraps));
  for (Index i = 0; i < count(one.local); ++i) {
    const Index grain = one.local[at(i)] / unknowns, k = one.local[at(i)] % unknowns, p = all.of_grain[at(grain)];
    if (k < d) velocities(i, motions * p + k) = 1;
    Index rotation = motions * p + d;  // one in each plane (a, b): v_a = -x_b, v_b = x_a
    for (Index a = 0; a < d; ++a)
      for (Index b = a + 1; b < d; ++b, ++rotation)
        if (!all.wraps[at(p)][at(a)] && !all.wraps[at(p)][at(b)])
          velocities(i, rotation) = k >= d
                                        ? subdomain.turning((unknowns - d) * grain + k - d, rotation - motions * p - d)
                                    : k == a ? -all.places(b, grain)
                                    : k == b ? all.places(a, grain)
                                             : 0.0;
  }
  return independent_columns(velocities);
}

}  // namespace

CoarseVectors geneo_vectors(const PrimalInterface& interface, double threshold) {
  if (!(threshold > 0)) fail("threshold of GenEO: expected a number > 0, met {}", threshold);
  const SparseMatrix c = interface.sparse();
  std::vector<Matrix> local(interface.subdomains.size());
  for_each_in_parallel(count(local), [&](Index e) {
    const CondensedSubdomain& one = interface.subdomains[at(e)];
    const Index n = count(one.rows);
    if (n == 0 || !one.own) return;
    const Matrix own = selected_columns(selected_columns(c, one.rows).transpose(), one.rows);  // R_E C R_E^T, C = C^T
    const Eigen::LLT<Matrix> cholesky(one.flexibility);  // F_E = L L^T; w = L y: (L^T T L) y = y / lambda
    const Matrix weighted = one.weights * cholesky.matrixL().toDenseMatrix();
    const Matrix pencil = weighted.transpose() * own * weighted;
    const ValuesAndVectors pairs = symmetric_eigen(0.5 * (pencil + pencil.transpose()));
    Index kept = 0;
    while (kept < n && pairs.values[n - 1 - kept] * threshold > 1) ++kept;
    local[at(e)].resize(n + 1, kept);
    local[at(e)].topRows(n) = weighted * pairs.vectors.rightCols(kept).rowwise().reverse();
    local[at(e)].bottomRows(1) = pairs.values.tail(kept).reverse().cwiseInverse().transpose();
  });
  return united(interface, std::move(local));
}

CoarseVectors rigid_vectors(const PrimalInterface& interface, const Decomposition& parts, const Period& period) {
  std::vector<Matrix> local(interface.subdomains.size());
  for (std::size_t e = 0; e < local.size(); ++e) {
    const CondensedSubdomain& one = interface.subdomains[e];
    const Subdomain& subdomain = parts.subdomains[e];
    if (!one.own) continue;
    if (subdomain.centres.size() + subdomain.turning.rows() != subdomain.inertia.size())
      throw Error(
          "coarse space rigid: expected the centres of grains, and of those that turn their spins, met a network "
          "without; geneo needs none");
    local[e] = one.weights * rigid_motions_of(one, subdomain, interface.dofs_per_grain, period);
    local[e].conservativeResizeLike(Matrix::Zero(local[e].rows() + 1, local[e].cols()));
  }
  return united(interface, std::move(local));
}

// Block Gram-Schmidt in C with two passes: the second restores the orthogonality of vectors that nearly depend on
// others. A triangular factor of U^T C U does not.
CoarseProblem::CoarseProblem(const PrimalInterface& interface, const CoarseVectors& vectors) {
  const OneBlasThread serial_blas;
  constexpr Index width = 32;
  const SparseMatrix c = interface.sparse();
  const Index n = interface.size(), m = vectors.u.cols();
  std::vector<Index> kept;
  v_.resize(n, std::min(m, n));
  const auto reduce = [&](Matrix& block, Index from) {  // by the vectors of V kept so far, from one on
    const auto of_v = v_.middleCols(from, count(kept) - from);
    for (int pass = 0; pass < 2; ++pass) block -= of_v * Matrix(of_v.transpose() * Matrix(c * block));
  };
  for (Index first = 0; first < m; first += width) {
    Matrix block = vectors.u.middleCols(first, std::min(width, m - first));
    const Index before = count(kept);
    reduce(block, 0);
    for (Index j = 0; j < block.cols() && count(kept) < n; ++j) {
      Matrix left = block.col(j);
      const auto square = [&] { return left.col(0).dot(c * left.col(0)); };
      const double size = square();
      reduce(left, before);
      if (square() < 1e-2 * size) reduce(left, 0);  // cancellation: rounding counts
      const double distance = square();
      if (!(distance > least_distance)) continue;
      v_.col(count(kept)) = left / std::sqrt(distance);
      kept.push_back(first + j);
    }
  }
  v_.conservativeResize(n, count(kept));
  u_ = selected_columns(vectors.u, kept);
  lambda_ = vectors.lambda(kept);
  for (const Index j : kept) subdomains_.push_back(vectors.subdomains[at(j)]);
  const Matrix gram = v_.transpose() * Matrix(c * v_);
  orthonormal_ = gram.isIdentity(1e-6);
}

CoarseProblem CoarseProblem::first(Index k) const {
  CoarseProblem part = *this;
  part.u_ = u_.leftCols(k);
  part.v_ = v_.leftCols(k);
  part.lambda_ = lambda_.head(k);
  part.subdomains_.resize(at(k));
  return part;
}

Vector CoarseProblem::solve(const Vector& p, Index k) const {
  const OneBlasThread serial_blas;
  return v_.leftCols(k) * (v_.leftCols(k).transpose() * p);
}

}  // namespace nscdd
