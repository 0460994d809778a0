// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/ldlt/ordering.hpp"

#include "linalg/cholmod_factor.hpp"
#include "linalg/one_metis.hpp"

#include <metis.h>

#include <new>
#include <numeric>

namespace nscdd {
namespace {

std::vector<int> nested_dissection(GroupGraph graph, std::vector<int> weight) {
  auto n = static_cast<idx_t>(weight.size());
  std::vector<idx_t> order(weight.size()), position(weight.size());
  std::iota(order.begin(), order.end(), 0);
  if (graph.neighbours.empty()) return order;  // METIS does not take a graph without edges
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  const OneMetis one_at_a_time;
  if (METIS_NodeND(&n, graph.start.data(), graph.neighbours.data(), weight.data(), options, order.data(),
                   position.data()) != METIS_OK)
    throw std::bad_alloc();
  return order;
}

// The groups marked `last` are cut out of the graph and put behind the dissection of the others.
std::vector<int> dissection_with_last(const GroupGraph& graph, const std::vector<int>& weight,
                                      const std::vector<char>& last) {
  if (last.empty()) return nested_dissection(graph, weight);
  std::vector<int> kept, number(weight.size(), -1), kept_weight, order, tail;
  for (std::size_t g = 0; g < weight.size(); ++g)
    if (last[g]) {
      tail.push_back(static_cast<int>(g));
    } else {
      number[g] = static_cast<int>(kept.size());
      kept.push_back(static_cast<int>(g));
      kept_weight.push_back(weight[g]);
    }
  GroupGraph inner;
  for (const int g : kept) {
    for (int k = graph.start[at(g)]; k < graph.start[at(g + 1)]; ++k)
      if (const int other = number[at(graph.neighbours[at(k)])]; other >= 0) inner.neighbours.push_back(other);
    inner.start.push_back(static_cast<int>(inner.neighbours.size()));
  }
  for (const int k : nested_dissection(inner, kept_weight)) order.push_back(kept[at(k)]);
  order.insert(order.end(), tail.begin(), tail.end());
  return order;
}

}  // namespace

Supernodes ordered_supernodes(const GroupGraph& graph, const std::vector<int>& weight, const std::vector<char>& last) {
  if (weight.empty()) return {.group = {}, .first_column = {0}, .first_row = {0}, .rows = {}};
  std::vector<int> order = dissection_with_last(graph, weight, last), start{0}, rows;
  for (int j = 0; j < static_cast<int>(order.size()); ++j) {  // lower triangle with its diagonal
    rows.push_back(j);
    for (int k = graph.start[at(j)]; k < graph.start[at(j + 1)]; ++k)
      if (graph.neighbours[at(k)] > j) rows.push_back(graph.neighbours[at(k)]);
    start.push_back(static_cast<int>(rows.size()));
  }
  cholmod_sparse a = lower_triangle_view(order.size(), rows.size(), start.data(), rows.data(), nullptr);
  CholmodFactor cholmod(CHOLMOD_GIVEN);
  cholmod.common.supernodal = CHOLMOD_SUPERNODAL;
  cholmod.factor = cholmod_analyze_p(&a, order.data(), nullptr, 0, &cholmod.common);
  cholmod.require_memory(cholmod.factor != nullptr && cholmod.common.status >= CHOLMOD_OK);
  const cholmod_factor* const factor = cholmod.factor;
  const auto numbers = [](const void* from, std::size_t size) {
    const auto* const first = static_cast<const int*>(from);
    return std::vector<int>(first, first + size);
  };
  Supernodes nodes{.group = numbers(factor->Perm, order.size()),
                   .first_column = numbers(factor->super, factor->nsuper + 1),
                   .first_row = numbers(factor->pi, factor->nsuper + 1),
                   .rows = {}};
  nodes.rows = numbers(factor->s, at(nodes.first_row.back()));
  return nodes;
}

}  // namespace nscdd
