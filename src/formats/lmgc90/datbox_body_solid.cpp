// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_body.hpp"

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

void read_solid(FixedColumns& lines, bool space, DatboxContactor& contactor) {
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
  const double over = space ? 1 : std::numbers::pi;
  const Vector3 centre = moments.first / moments.volume;
  const Matrix3 about = moments.second - moments.volume * centre * centre.transpose();
  contactor.weight = moments.volume / over;
  contactor.shift = middle + centre;
  contactor.inertia = (about.trace() * Matrix3::Identity() - about) / over;
  for (const Vector3& vertex : vertices) contactor.reach = std::max(contactor.reach, (vertex - contactor.shift).norm());
}

}  // namespace nscdd
