// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_body.hpp"

#include <Eigen/Eigenvalues>

#include <numbers>

namespace nscdd {
namespace {

// Integrals of 1, x and x x^T over triangles or tetrahedra with a vertex at the origin.
struct Moments {
  Index dimension;
  double volume = 0;
  Vector3 first = Vector3::Zero();
  Matrix3 second = Matrix3::Zero();

  // `corners`: the others, as columns.
  void add(double size, const Matrix3& corners) {
    const auto d = static_cast<double>(dimension);
    const Vector3 sum = corners.rowwise().sum();
    volume += size;
    first += size / (d + 1) * sum;
    second += size / ((d + 1) * (d + 2)) * (corners * corners.transpose() + sum * sum.transpose());
  }
};

void add_polygon(const std::vector<Vector3>& vertices, const Vector3& middle, Moments& moments) {
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    Matrix3 corners = Matrix3::Zero();
    corners.col(0) = vertices[k] - middle;
    corners.col(1) = vertices[(k + 1) % vertices.size()] - middle;
    moments.add((corners(0, 0) * corners(1, 1) - corners(1, 0) * corners(0, 1)) / 2, corners);
  }
}

void add_faces(FixedColumns& lines, Index faces, const std::vector<Vector3>& vertices, const Vector3& middle,
               Moments& moments) {
  for (Index face = 0; face < faces; ++face) {
    lines.require_next("a face");
    Matrix3 corners;
    for (Index k = 0; k < 3; ++k) {
      const Index vertex = lines.integer(at(35 + 21 * k), at(41 + 21 * k), fmt::format("ver{}", k + 1));
      if (vertex < 1 || vertex > count(vertices))
        lines.refuse(fmt::format("expected one of the {} vertices", vertices.size()), std::to_string(vertex));
      corners.col(k) = vertices[at(vertex - 1)] - middle;
    }
    moments.add(std::abs(corners.determinant()) / 6, corners);
  }
}

}  // namespace

DatboxSolid read_solid(FixedColumns& lines, bool space) {
  const DatboxPlace place = lines.place();
  const Index number = lines.integer(40, 47, "nb_vertex");
  const Index faces = space ? lines.integer(60, 67, "nb_face") : 0;
  std::vector<Vector3> vertices;
  while (count(vertices) < number) {
    lines.require_next("a vertex");
    vertices.emplace_back(lines.number(35, "coo1"), lines.number(56, "coo2"), space ? lines.number(77, "coo3") : 0);
  }
  Vector3 middle = Vector3::Zero();
  for (const Vector3& vertex : vertices) middle += vertex / static_cast<double>(number);
  Moments moments{.dimension = space ? 3 : 2};
  space ? add_faces(lines, faces, vertices, middle, moments) : add_polygon(vertices, middle, moments);
  if (!(moments.volume > 0))
    refuse(place, "expected a {}, met one of {} {}",
           space ? "polyhedron with a volume" : "polygon with vertices in counter-clockwise order", moments.volume,
           space ? "m^3" : "m^2");
  const Vector3 centre = moments.first / moments.volume;
  const Matrix3 about = moments.second - moments.volume * centre * centre.transpose();
  DatboxSolid solid{.volume = moments.volume, .centre = middle + centre};
  solid.inertia = about.trace() * Matrix3::Identity() - about;
  for (const Vector3& vertex : vertices) solid.reach = std::max(solid.reach, (vertex - solid.centre).norm());
  return solid;
}

void complete_solid(DatboxBody& body, Index dimension) {
  const DatboxSolid& solid = *body.contactors[0].solid;
  if (dimension == 2) {
    constexpr double ignored_offset_squared = 1e-6;  // m^2
    if (body.average_radius == 0 || body.gyration_radius == 0) {
      body.average_radius = std::sqrt(solid.volume / std::numbers::pi);
      body.gyration_radius = std::sqrt(solid.inertia(2, 2) / solid.volume);
    }
    if (body.position.isZero(0) || solid.centre.squaredNorm() >= ignored_offset_squared)
      body.position.head<2>() += solid.centre.head<2>();
    return;
  }
  if (body.average_radius == 0) body.average_radius = std::cbrt(0.75 * solid.volume / std::numbers::pi);
  body.position += solid.centre;
  if (!body.inertia.isZero(0)) return;
  body.inertia = solid.inertia.diagonal();
  const Matrix3 coupling = solid.inertia - Matrix3(body.inertia.asDiagonal());
  if (coupling.cwiseAbs().maxCoeff() <= 1e-12 * body.inertia.maxCoeff()) return;  // else axes could be permuted
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(solid.inertia);
  body.inertia = principal.eigenvalues();
  body.frame = principal.eigenvectors();
  if (body.frame.determinant() < 0) body.frame.col(2) *= -1;
}

}  // namespace nscdd
