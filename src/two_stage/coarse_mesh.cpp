// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/coarse_mesh.hpp"

#include "linalg/sparse_entries.hpp"

#include <Eigen/QR>

namespace nscdd {
namespace {

// Independent columns of one field at the bodies: an orthonormal basis of the values times `scale`.
Matrix basis_of(const Matrix& values, const Vector& scale) {
  Eigen::ColPivHouseholderQR<Matrix> factors(scale.asDiagonal() * values);
  factors.setThreshold(1e-10);
  return factors.householderQ() * Matrix::Identity(values.rows(), factors.rank());
}

// Values of the bilinear functions of the nodes at the bodies.
Matrix bilinear(const std::vector<PlacedBody>& bodies, const std::vector<Index>& moved,
                const std::array<Index, 2>& cells) {
  std::array<double, 2> low{infinity, infinity}, high{-infinity, -infinity};
  for (const Index i : moved)
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], bodies[at(i)].centre[k]);
      high[k] = std::max(high[k], bodies[at(i)].centre[k]);
    }
  Matrix values = Matrix::Zero(count(moved), (cells[0] + 1) * (cells[1] + 1));
  for (Index row = 0; row < count(moved); ++row) {
    std::array<Index, 2> cell{};
    std::array<double, 2> place{};
    for (std::size_t k = 0; k < 2; ++k) {
      const double extent = high[k] - low[k];
      const double s = extent > 0 ? (bodies[at(moved[at(row)])].centre[k] - low[k]) / extent : 0.0;
      const double scaled = s * static_cast<double>(cells[k]);
      cell[k] = std::min(cells[k] - 1, static_cast<Index>(scaled));
      place[k] = scaled - static_cast<double>(cell[k]);
    }
    for (const Index right : {0, 1})
      for (const Index up : {0, 1})
        values(row, (cell[1] + up) * (cells[0] + 1) + cell[0] + right) =
            (right == 1 ? place[0] : 1 - place[0]) * (up == 1 ? place[1] : 1 - place[1]);
  }
  return values;
}

}  // namespace

SparseMatrix coarse_velocities(const FrozenNetwork& network, const std::vector<PlacedBody>& bodies,
                               const std::array<Index, 2>& cells) {
  SparseEntries entries;
  Index columns = 0;
  std::vector<Index> moved;
  for (Index i = 0; i < count(bodies); ++i) {
    const Index first = network.rows[at(i)].first;
    if (first < 0) continue;
    if (!bodies[at(i)].kept) {
      moved.push_back(i);
      continue;
    }
    for (Index k = 0; k < 3; ++k) entries.add(first + k, columns++, network.root[first + k]);
  }
  if (!moved.empty()) {
    const Matrix values = bilinear(bodies, moved, cells);
    Vector radius(count(moved));
    for (Index row = 0; row < count(moved); ++row) radius[row] = bodies[at(moved[at(row)])].radius;
    const Matrix translation = basis_of(values, Vector::Ones(count(moved))), rotation = basis_of(values, radius);
    for (Index k = 0; k < 3; ++k) {
      const Matrix& basis = k < 2 ? translation : rotation;
      for (Index column = 0; column < basis.cols(); ++column, ++columns)
        for (Index row = 0; row < count(moved); ++row) {
          const Index place = network.rows[at(moved[at(row)])].first + k;
          entries.add(place, columns, network.root[place] * basis(row, column));
        }
    }
  }
  return entries.matrix(network.root.size(), columns);
}

}  // namespace nscdd
