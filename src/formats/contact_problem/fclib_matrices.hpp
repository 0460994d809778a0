// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/hdf5_file.hpp"
#include <nscdd/core/types.hpp>

/// Sparse matrices and numbers in files of FCLIB (docs/formats.md). Errors name the file and the place in it.
namespace nscdd {

Vector vector_of(const hdf5::Group& group, const std::string& name);
void require_length(const hdf5::Group& group, const std::string& name, Index met, Index expected);
std::int64_t size_of(const hdf5::Group& group, const std::string& name);

SparseMatrix read_matrix(const hdf5::Group& parent, const std::string& name);

/// H of a global problem with `dimension` columns per contact. If its triplets fit in either order (p, i) or (i, p),
/// the order counts that makes H one of rigid bodies: a contact acts on at most two, with orthogonal blocks.
SparseMatrix read_h(const hdf5::Group& parent, Index dimension);

void write_integer(const hdf5::Group& group, const std::string& name, Index value);
void write_matrix(const hdf5::Group& parent, const std::string& name, SparseMatrix matrix);

}  // namespace nscdd
