// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/memory.hpp"
#include "linalg/multifrontal/fronts.hpp"

namespace nscdd {
namespace {

// Bytes of a front in the factor, of its update for the parent, and of L D during its elimination.
struct FrontMemory {
  FrontMemory(const Front& front, FactorShape shape) {
    const bool full = shape == FactorShape::full;
    kept = bytes_of_matrix(front.pivots, full ? front.rows + front.update_rows() : front.rows) +
           static_cast<double>(at(front.pivots) * (sizeof(lapack_int) + (full ? 0 : sizeof(double))));  // swaps, off
    handed_on = bytes_of_matrix(front.update_rows(), front.update_rows());
    passing = full ? 0 : bytes_of_matrix(front.rows, front.pivots);
  }
  double kept, handed_on, passing;
};

}  // namespace

// An update is kept until its parent is assembled; updates at the edge of the interior stay for later factors. Parallel
// children may all peak at once.
FactorMemory factor_memory(const FrontTree& tree, FactorShape shape) {
  const bool full = shape == FactorShape::full;  // has no interior
  const double records = static_cast<double>(sizeof(FrontFactor) + sizeof(Matrix)) * static_cast<double>(tree.size());
  double interior = records, of_border = records, stays = 0, interior_at_once = 0, border_at_once = 0;
  std::vector<double> largest(tree.fronts.size());  // of the updates below a front, and of its elimination
  for (Index s = 0; s < tree.size(); ++s) {
    const Front& own = tree.front(s);
    const FrontMemory memory(own, shape);
    double waiting = 0, below = 0;
    for (const Index c : own.children) {
      if (tree.front(c).on_border != own.on_border) continue;
      below = tree.in_parallel(own) ? below + largest[at(c)] : std::max(below, waiting + largest[at(c)]);
      waiting += FrontMemory(tree.front(c), shape).handed_on;
    }
    largest[at(s)] = std::max({below, waiting + memory.handed_on, memory.handed_on + memory.passing});
    const bool root = own.parent < 0 || tree.front(own.parent).on_border != own.on_border;
    (own.on_border || full ? of_border : interior) += memory.kept;
    if (root && (own.on_border || full)) border_at_once = std::max(border_at_once, largest[at(s)]);
    if (!root || own.on_border || full) continue;
    interior_at_once += largest[at(s)];
    stays += memory.handed_on;
  }
  return {.held = interior + stays + of_border,
          .border = of_border,
          .at_once = interior + std::max(interior_at_once, stays + of_border + border_at_once)};
}

}  // namespace nscdd
