// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/ldlt/factor.hpp"

#include <vector>

namespace nscdd {

/// One front of the multifrontal method, a dense symmetric matrix of `rows` rows, of which the first `pivots`
/// are eliminated.
struct Front {
  Index first_row = 0;  ///< of its `rows` entries in row_of
  Index rows = 0, pivots = 0;
  Index parent = -1;
  Index first_entry = 0, last_entry = 0;  ///< its entries of the matrix: first_entry ... last_entry - 1
  std::vector<Index> panels;              ///< ends of the panels of pivot columns, the last one being `pivots`
  std::vector<Index> children;            ///< ascending
  double subtree_flops = 0;               ///< of the front and all below it
  bool on_border = false;                 ///< lies on the way from a border row to the root
  Index update_rows() const { return rows - pivots; }
};

/// An entry of the matrix put into a front.
struct FrontEntry {
  int source = 0;           ///< position among the stored values of the matrix
  int row = 0, column = 0;  ///< in the front, row >= column
};

struct RowGroups;
struct Supernodes;

class SymmetricAnalysis::Implementation {
 public:
  /// The arguments of SymmetricAnalysis.
  Implementation(const SparseMatrix& pattern, std::vector<Index> group, const std::vector<char>& last,
                 const std::vector<Index>& border);

  Index size = 0;
  std::vector<Front> fronts;          ///< children before parents
  std::vector<int> row_of;            ///< rows of the matrix, front by front, pivots first
  std::vector<int> place_in_parent;   ///< at row_of's positions: place of an update row in the parent's rows
  std::vector<FrontEntry> entries;    ///< front by front
  std::vector<int> front_of_row;      ///< the front that eliminates a row of the matrix
  std::vector<Index> border;          ///< rows of the matrix
  std::vector<Index> interior_roots;  ///< fronts off the border whose parents, if any, are on it
  double factor_entries = 0;

 private:
  void lay_out_fronts(const Supernodes& nodes, const RowGroups& groups);
  void share_out_entries(const SparseMatrix& pattern, const RowGroups& groups);
  void place_rows(const RowGroups& groups);
  void mark_border();
};

}  // namespace nscdd
