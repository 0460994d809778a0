// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/contact_problem/fclib_matrices.hpp"

#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"

#include <map>

namespace nscdd {

using hdf5::Group;

constexpr std::int64_t largest_index = std::numeric_limits<int>::max();

Vector vector_of(const Group& group, const std::string& name) {
  const std::vector<double> values = group.numbers<double>(name);
  return Eigen::Map<const Vector>(values.data(), count(values));
}

void require_length(const Group& group, const std::string& name, Index met, Index expected) {
  if (met != expected) fail("{}: expected {} numbers, met {}", group.of(name), expected, met);
}

std::int64_t size_of(const Group& group, const std::string& name) {
  const std::int64_t size = group.integer(name);
  if (size < 0 || size >= largest_index)
    fail("{}: expected a number from 0 to {}, met {}", group.of(name), largest_index - 1, size);
  return size;
}

namespace {

// The position of the first index outside 0 ... bound - 1, or the size of `indices` if there is none.
Index first_outside(const std::vector<std::int64_t>& indices, std::int64_t bound) {
  return std::ranges::find_if(indices, [=](std::int64_t i) { return i < 0 || i >= bound; }) - indices.begin();
}

bool all_inside(const std::vector<std::int64_t>& indices, std::int64_t bound) {
  return first_outside(indices, bound) == count(indices);
}

void require_inside(const Group& group, const std::string& name, const std::vector<std::int64_t>& indices,
                    std::int64_t bound) {
  const Index k = first_outside(indices, bound);
  if (k < count(indices))
    fail("{}: expected indices in 0..{}, met {} at position {}", group.of(name), bound - 1, indices[at(k)], k);
}

// nz >= 0: entry k lies at (p_k, i_k), or at (i_k, p_k) if only that fits the matrix. `either`: both fit.
SparseEntries triplet_entries(const Group& group, std::int64_t rows, std::int64_t columns, Index entries,
                              bool& either) {
  auto p = group.numbers<std::int64_t>("p"), i = group.numbers<std::int64_t>("i");
  const Vector x = vector_of(group, "x");
  require_length(group, "p", count(p), entries);
  require_length(group, "i", count(i), entries);
  if (x.size() < entries) require_length(group, "x", x.size(), entries);  // may be longer, of length nzmax
  const bool documented = all_inside(p, rows) && all_inside(i, columns);
  const bool swapped = all_inside(p, columns) && all_inside(i, rows);
  either = documented && swapped;
  if (!documented && swapped) std::swap(p, i);
  require_inside(group, "p", p, rows);
  require_inside(group, "i", i, columns);
  SparseEntries found;
  for (Index k = 0; k < entries; ++k) found.add(p[at(k)], i[at(k)], x[k]);
  return found;
}

// nz = -1 (lines are columns) or -2 (rows): line k holds entries p_k ... p_(k+1) - 1 at i within the line.
SparseEntries compressed_entries(const Group& group, std::int64_t lines, std::int64_t width, Index nzmax,
                                 bool by_columns) {
  auto p = group.numbers<std::int64_t>("p"), i = group.numbers<std::int64_t>("i");
  const Vector x = vector_of(group, "x");
  require_length(group, "p", count(p), lines + 1);
  require_length(group, "i", count(i), nzmax);
  require_length(group, "x", x.size(), nzmax);
  if (p.front() != 0) fail("{}: expected 0 at position 0, met {}", group.of("p"), p.front());
  for (Index k = 1; k < count(p); ++k)
    if (p[at(k)] < p[at(k - 1)] || p[at(k)] > nzmax)
      fail("{}: expected numbers that ascend to {} at most, met {} at position {}", group.of("p"), nzmax, p[at(k)], k);
  i.resize(at(p.back()));  // the rest is room
  require_inside(group, "i", i, width);
  SparseEntries found;
  for (Index line = 0; line < lines; ++line)
    for (Index k = p[at(line)]; k < p[at(line + 1)]; ++k)
      by_columns ? found.add(i[at(k)], line, x[k]) : found.add(line, i[at(k)], x[k]);
  return found;
}

// `either`: whether its triplets fit in either order.
SparseMatrix read_either(const Group& group, bool& either) {
  const std::int64_t rows = size_of(group, "m"), columns = size_of(group, "n");
  const std::int64_t nz = group.integer("nz"), nzmax = size_of(group, "nzmax");
  SparseEntries entries;
  if (nz == -1) {
    entries = compressed_entries(group, columns, rows, nzmax, true);
  } else if (nz == -2) {
    entries = compressed_entries(group, rows, columns, nzmax, false);
  } else if (nz >= 0 && nz <= nzmax) {
    entries = triplet_entries(group, rows, columns, nz, either);
  } else {
    fail("{}: expected -1 (by columns), -2 (by rows) or a number of triplets up to nzmax = {}, met {}", group.of("nz"),
         nzmax, nz);
  }
  return entries.matrix(rows, columns);  // sums duplicate entries, as CSparse does
}

// Whether every contact acts on one or two bodies, each with an orthogonal block of its translations.
bool is_of_rigid_bodies(const SparseMatrix& h, Index dimension) {
  constexpr double rounding = 1e-5;
  const Index of_body = dimension == 2 ? 3 : 6;
  if (h.rows() % of_body != 0) return false;
  for (Index c = 0; c < h.cols(); c += dimension) {
    std::map<Index, Eigen::MatrixXd> blocks;
    for (Index k = 0; k < dimension; ++k)
      for (SparseMatrix::InnerIterator entry(h, c + k); entry; ++entry) {
        const Index body = entry.row() / of_body, row = entry.row() % of_body;
        Eigen::MatrixXd& block = blocks.try_emplace(body, Eigen::MatrixXd::Zero(dimension, dimension)).first->second;
        if (row < dimension) block(row, k) = entry.value();
      }
    if (blocks.empty() || blocks.size() > 2) return false;
    for (const auto& [body, block] : blocks)
      if (!(block.transpose() * block).isIdentity(rounding)) return false;
  }
  return true;
}

}  // namespace

SparseMatrix read_matrix(const Group& parent, const std::string& name) {
  bool either = false;
  return read_either(parent.group(name), either);
}

SparseMatrix read_h(const Group& parent, Index dimension) {
  const Group group = parent.group("H");
  bool either = false;
  SparseMatrix h = read_either(group, either);
  if (!either || is_of_rigid_bodies(h, dimension)) return h;
  SparseMatrix swapped = h.transpose();  // the triplets in the other order, in the room of h
  swapped.conservativeResize(h.rows(), h.cols());
  if ((h - swapped).norm() == 0) return h;
  if (is_of_rigid_bodies(swapped, dimension)) return swapped;
  fail(
      "{}: expected triplets that fit in one order only, (p, i) or (i, p), or an H of rigid bodies in one of them, met "
      "triplets that fit in both; nz = -1 (by columns) is clear",
      group.path());
}

void write_integer(const Group& group, const std::string& name, Index value) {
  const auto number = static_cast<std::int32_t>(value);
  group.put<std::int32_t>(name, {&number, 1});
}

void write_matrix(const Group& parent, const std::string& name, SparseMatrix matrix) {
  matrix.makeCompressed();
  const Group group = parent.make_group(name);
  write_integer(group, "nzmax", matrix.nonZeros());
  write_integer(group, "m", matrix.rows());
  write_integer(group, "n", matrix.cols());
  write_integer(group, "nz", -1);
  group.put<std::int32_t>("p", {matrix.outerIndexPtr(), at(matrix.cols() + 1)});
  group.put<std::int32_t>("i", {matrix.innerIndexPtr(), at(matrix.nonZeros())});
  group.put<double>("x", {matrix.valuePtr(), at(matrix.nonZeros())});
}

}  // namespace nscdd
