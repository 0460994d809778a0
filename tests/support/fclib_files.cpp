// SPDX-License-Identifier: GPL-3.0-or-later
#include "fclib_files.hpp"

#include "linalg/random.hpp"
#include "mechanics/contact_frame.hpp"

#include <hdf5.h>

#include <bit>
#include <cmath>
#include <stdexcept>

namespace nscdd::testing {
namespace {

void put_matrix(RawFclib& raw, const std::string& path, const SparseMatrix& matrix, Storage storage) {
  const Eigen::SparseMatrix<double, Eigen::RowMajor> by_rows = matrix;
  const bool triplets = storage == Storage::triplets || storage == Storage::csparse_triplets;
  const int entries = static_cast<int>(matrix.nonZeros());
  raw.integers[path + "/m"] = {static_cast<int>(matrix.rows())};
  raw.integers[path + "/n"] = {static_cast<int>(matrix.cols())};
  raw.integers[path + "/nzmax"] = {entries};
  raw.integers[path + "/nz"] = {triplets ? entries : storage == Storage::columns ? -1 : -2};
  std::vector<int>& p = raw.integers[path + "/p"];
  std::vector<int>& i = raw.integers[path + "/i"];
  std::vector<double>& x = raw.numbers[path + "/x"];
  if (storage == Storage::columns) {
    p.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.cols() + 1);
    i.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + entries);
    x.assign(matrix.valuePtr(), matrix.valuePtr() + entries);
  } else if (storage == Storage::rows) {
    p.assign(by_rows.outerIndexPtr(), by_rows.outerIndexPtr() + matrix.rows() + 1);
    i.assign(by_rows.innerIndexPtr(), by_rows.innerIndexPtr() + entries);
    x.assign(by_rows.valuePtr(), by_rows.valuePtr() + entries);
  } else {
    for (Index row = matrix.rows() - 1; row >= 0; --row)  // in no order a reader could count on
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(by_rows, row); e; ++e) {
        p.push_back(static_cast<int>(e.row()));
        i.push_back(static_cast<int>(e.col()));
        x.push_back(e.value());
      }
    if (storage == Storage::csparse_triplets) std::swap(p, i);
  }
}

using Entries = std::vector<Eigen::Triplet<double>>;

void put(Entries& entries, Index row, Index column, double value) {
  entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
}

void put_disk(Entries& mass, Index body, double m, double radius) {
  for (Index k = 0; k < 3; ++k) put(mass, 3 * body + k, 3 * body + k, k < 2 ? m : m * radius * radius / 2);
}

// The normal and the tangent (-y, x) of a contact on the body behind it (side 1) or before it (-1).
void put_contact(Entries& h, Index contact, Index body, double side, double x, double y, double radius) {
  put(h, 3 * body, 2 * contact, side * x);
  put(h, 3 * body + 1, 2 * contact, side * y);
  put(h, 3 * body, 2 * contact + 1, -side * y);
  put(h, 3 * body + 1, 2 * contact + 1, side * x);
  put(h, 3 * body + 2, 2 * contact + 1, -radius);
}

SparseMatrix matrix_of(const Entries& entries, Index rows, Index columns) {
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

std::vector<double> list(const Vector& values) { return {values.data(), values.data() + values.size()}; }

void require(bool holds) {
  if (!holds) throw std::runtime_error("HDF5: the test's own file cannot be written");
}

template <class Value>
void write_all(hid_t file, const std::map<std::string, std::vector<Value>>& all, hid_t type) {
  const hid_t properties = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(properties, 1);
  for (const auto& [path, values] : all) {
    const hsize_t size = values.size();
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t dataset = H5Dcreate2(file, path.c_str(), type, space, properties, H5P_DEFAULT, H5P_DEFAULT);
    require(dataset >= 0);
    require(size == 0 || H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
    H5Dclose(dataset);
    H5Sclose(space);
  }
  H5Pclose(properties);
}

template <class Value>
void remove_from(std::map<std::string, std::vector<Value>>& all, const std::string& path) {
  std::erase_if(all, [&](const auto& one) { return one.first == path || one.first.rfind(path + "/", 0) == 0; });
}

template <class Value>
void move_in(std::map<std::string, std::vector<Value>>& all, const std::string& from, const std::string& to) {
  std::map<std::string, std::vector<Value>> moved;
  for (auto& [path, values] : all)
    moved[path.rfind(from + "/", 0) == 0 ? to + path.substr(from.size()) : path] = values;
  all = moved;
}

}  // namespace

void RawFclib::remove(const std::string& path) {
  remove_from(integers, path);
  remove_from(numbers, path);
}

void RawFclib::move(const std::string& from, const std::string& to) {
  move_in(integers, from, to);
  move_in(numbers, from, to);
}

std::string RawFclib::bytes() const {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1 << 16, false);
  const hid_t file = H5Fcreate("raw", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  require(file >= 0);
  write_all(file, integers, H5T_NATIVE_INT);
  write_all(file, numbers, H5T_NATIVE_DOUBLE);
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  std::string image(static_cast<std::size_t>(H5Fget_file_image(file, nullptr, 0)), '\0');
  require(H5Fget_file_image(file, image.data(), image.size()) == static_cast<ssize_t>(image.size()));
  H5Fclose(file);
  H5Pclose(access);
  return image;
}

RawFclib raw_local(const LocalFrictionProblem& problem, Storage storage) {
  RawFclib raw;
  raw.integers["fclib_local/spacedim"] = {static_cast<int>(problem.dimension)};
  put_matrix(raw, "fclib_local/W", problem.w, storage);
  raw.numbers["fclib_local/vectors/q"] = list(problem.q);
  raw.numbers["fclib_local/vectors/mu"] = list(problem.friction);
  return raw;
}

RawFclib raw_global(const GlobalFrictionProblem& problem, Storage storage) {
  RawFclib raw;
  raw.integers["fclib_global/spacedim"] = {static_cast<int>(problem.dimension)};
  put_matrix(raw, "fclib_global/M", problem.mass, storage);
  put_matrix(raw, "fclib_global/H", problem.h, storage);
  raw.numbers["fclib_global/vectors/f"] = list(problem.f);
  raw.numbers["fclib_global/vectors/w"] = list(problem.w);
  raw.numbers["fclib_global/vectors/mu"] = list(problem.friction);
  return raw;
}

GlobalFrictionProblem random_bodies_problem(std::uint64_t seed, Index bodies, Index contacts) {
  RandomStream random(seed);
  Entries mass, h;
  Vector radius(bodies);
  for (Index b = 0; b < bodies; ++b) {
    radius[b] = 0.5 + random.uniform();
    const double m = 1 + random.uniform();
    put_disk(mass, b, m, radius[b]);
  }
  for (Index c = 0; c < contacts; ++c) {
    // The first contacts join neighbours; further ones hold a body against a wall.
    const bool wall = c + 1 >= bodies;
    const Index i = wall ? c % bodies : c + 1;
    const double angle = 7 * random.uniform(), x = std::cos(angle), y = std::sin(angle);
    put_contact(h, c, i, 1, x, y, radius[i]);
    if (!wall) put_contact(h, c, c, -1, x, y, radius[c]);
  }
  GlobalFrictionProblem problem;
  problem.mass = matrix_of(mass, 3 * bodies, 3 * bodies);
  problem.h = matrix_of(h, 3 * bodies, 2 * contacts);
  problem.f = random.normal_vector(3 * bodies);
  problem.w = 0.1 * random.normal_vector(2 * contacts);
  problem.friction.resize(contacts);
  for (Index c = 0; c < contacts; ++c) problem.friction[c] = 0.6 * random.uniform();
  return problem;
}

GlobalFrictionProblem random_spheres_problem(std::uint64_t seed, Index bodies, Index contacts) {
  RandomStream random(seed);
  GlobalFrictionProblem problem;
  problem.dimension = 3;
  Vector inertia(6 * bodies);
  std::vector<BodyRows> rows;
  for (Index b = 0; b < bodies; ++b) {
    const double radius = 0.5 + random.uniform(), m = 1 + random.uniform();
    inertia.segment<3>(6 * b).setConstant(m);
    inertia.segment<3>(6 * b + 3).setConstant(0.4 * m * radius * radius);
    rows.push_back({6 * b, radius});
  }
  ConnectivityBuilder<3> h(6 * bodies, at(3 * contacts));
  for (Index c = 0; c < contacts; ++c) {
    // The first contacts join neighbours; further ones hold a body against a wall.
    const bool wall = c + 1 >= bodies;
    const Eigen::Vector3d n = Eigen::Vector3d(random.normal_vector(3)).normalized();
    for (const LocalVector<3>& direction : contact_directions<3>())
      h.add({n[0], n[1], n[2]}, wall ? BodyRows{} : rows[at(c)], rows[at(wall ? c % bodies : c + 1)], direction);
  }
  problem.mass = SparseMatrix(Matrix(inertia.asDiagonal()).sparseView());
  problem.h = h.matrix();
  problem.f = random.normal_vector(6 * bodies);
  problem.w = 0.1 * random.normal_vector(3 * contacts);
  problem.friction.resize(contacts);
  for (Index c = 0; c < contacts; ++c) problem.friction[c] = 0.6 * random.uniform();
  return problem;
}

LocalFrictionProblem in_space(const LocalFrictionProblem& plane) {
  Entries w;
  const auto place = [](Index i) { return static_cast<int>(3 * (i / 2) + i % 2); };
  for (Index j = 0; j < plane.w.cols(); ++j)
    for (SparseMatrix::InnerIterator e(plane.w, j); e; ++e) {
      w.emplace_back(place(e.row()), place(j), e.value());
      if (e.row() % 2 == 1 && j % 2 == 1) w.emplace_back(place(e.row()) + 1, place(j) + 1, e.value());
    }
  LocalFrictionProblem space;
  space.dimension = 3;
  space.w = matrix_of(w, 3 * plane.contacts(), 3 * plane.contacts());
  space.q = Vector::Zero(3 * plane.contacts());
  for (Index i = 0; i < plane.q.size(); ++i) space.q[place(i)] = plane.q[i];
  space.friction = plane.friction;
  return space;
}

GlobalFrictionProblem with_rotations(const Packing& packing, const ContactNetwork& network,
                                     const Vector& arriving_velocity, double friction) {
  Entries mass, h;
  GlobalFrictionProblem problem;
  problem.f = Vector::Zero(3 * packing.size());
  for (Index i = 0; i < packing.size(); ++i) {
    const double m = packing.mass[at(i)], r = packing.radius[at(i)];
    put_disk(mass, i, m, r);
    problem.f.segment(3 * i, 2) = m * arriving_velocity.segment(2 * i, 2);
  }
  for (Index c = 0; c < network.size(); ++c) {
    const Contact& contact = network.contacts[at(c)];
    const double x = contact.normal[0], y = contact.normal[1];  // from a to b
    put_contact(h, c, contact.a, -1, x, y, packing.radius[at(contact.a)]);
    put_contact(h, c, contact.b, 1, x, y, packing.radius[at(contact.b)]);
  }
  problem.mass = matrix_of(mass, 3 * packing.size(), 3 * packing.size());
  problem.h = matrix_of(h, 3 * packing.size(), 2 * network.size());
  problem.w = Vector::Zero(2 * network.size());
  problem.friction = Vector::Constant(network.size(), friction);
  return problem;
}

LocalFrictionProblem squeezed_grain() {
  LocalFrictionProblem problem;
  problem.w = Matrix((Matrix(4, 4) << 1, 0, -1, 0, 0, 1, 0, 1, -1, 0, 1, 0, 0, 1, 0, 1).finished()).sparseView();
  problem.q = (Vector(4) << -1, 0, -1, 0).finished();
  problem.friction = Vector::Constant(2, 0.3);
  return problem;
}

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
           return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
         });
}

bool same_bits(const SparseMatrix& a, const SparseMatrix& b) {  // zeros may be stored or not
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         same_bits(Vector(Matrix(a).reshaped()), Vector(Matrix(b).reshaped()));
}

bool same_bits(const LocalFrictionProblem& a, const LocalFrictionProblem& b) {
  return a.dimension == b.dimension && same_bits(a.w, b.w) && same_bits(a.q, b.q) && same_bits(a.friction, b.friction);
}

bool same_bits(const GlobalFrictionProblem& a, const GlobalFrictionProblem& b) {
  return a.dimension == b.dimension && same_bits(a.mass, b.mass) && same_bits(a.h, b.h) && same_bits(a.f, b.f) &&
         same_bits(a.w, b.w) && same_bits(a.friction, b.friction);
}

}  // namespace nscdd::testing
