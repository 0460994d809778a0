// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/threads.hpp"
#include <nscdd/ddm/partitioners/metis.hpp>

#include <metis.h>

namespace nscdd {
namespace {

Graph contact_graph(const ReferenceProblem& problem, Index contacts) {
  const auto for_each_grain = [&problem, k = problem.columns_per_contact](Index contact, auto&& visit) {
    for (Index column = k * contact; column < k * (contact + 1); ++column)
      for (const Index grain : grains_of_contact(problem, column)) visit(at(grain));
  };
  std::vector<std::vector<Index>> contacts_of_grain(at(problem.grains()));
  for (Index c = 0; c < contacts; ++c)
    for_each_grain(c, [&](std::size_t grain) {
      auto& known = contacts_of_grain[grain];
      if (known.empty() || known.back() != c) known.push_back(c);
    });
  Graph graph;
  std::vector<Index> others;
  for (Index c = 0; c < contacts; ++c) {
    others.clear();
    for_each_grain(c, [&](std::size_t grain) {
      const auto& touching = contacts_of_grain[grain];
      others.insert(others.end(), touching.begin(), touching.end());
    });
    sort_unique(others);
    std::erase(others, c);
    graph.neighbours.insert(graph.neighbours.end(), others.begin(), others.end());
    graph.start.push_back(static_cast<idx_t>(graph.neighbours.size()));
  }
  return graph;
}

// The vertices of one part in breadth-first order from one far from the first, so that a half of them is connected.
std::vector<idx_t> in_breadth(const Graph& graph, const std::vector<idx_t>& part, idx_t one) {
  std::vector<char> taken(part.size(), 0);
  std::vector<idx_t> order;
  const auto visit = [&](idx_t from) {
    std::size_t next = order.size();
    order.push_back(from);
    taken[at(from)] = 1;
    for (; next < order.size(); ++next)
      for (idx_t k = graph.start[at(order[next])]; k < graph.start[at(order[next] + 1)]; ++k) {
        const idx_t other = graph.neighbours[at(k)];
        if (part[at(other)] != one || taken[at(other)] != 0) continue;
        taken[at(other)] = 1;
        order.push_back(other);
      }
  };
  const auto visit_all = [&] {
    for (std::size_t v = 0; v < part.size(); ++v)
      if (part[v] == one && taken[v] == 0) visit(static_cast<idx_t>(v));
  };
  visit_all();
  const idx_t far = order.back();
  order.clear();
  std::ranges::fill(taken, 0);
  visit(far);
  visit_all();
  return order;
}

void fill_empty_parts(const Graph& graph, idx_t parts, std::vector<idx_t>& part) {
  std::vector<Index> size(at(parts), 0);
  for (const idx_t one : part) ++size[at(one)];
  for (idx_t empty = 0; empty < parts; ++empty) {
    if (size[at(empty)] > 0) continue;
    const auto largest = std::ranges::max_element(size);
    const std::vector<idx_t> order = in_breadth(graph, part, static_cast<idx_t>(largest - size.begin()));
    const Index half = *largest / 2;
    for (Index k = 0; k < half; ++k) part[at(order[at(k)])] = empty;
    *largest -= half;
    size[at(empty)] = half;
  }
}

}  // namespace

Partition partition(const MetisPartitioner& partitioner, const ReferenceProblem& problem) {
  require_bounds(partitioner, "partition");
  Partition result{.subdomains = partitioner.metis,
                   .subdomain_of_contact = std::vector<Index>(at(problem.contacts()), 0)};
  // METIS refuses an empty graph and more parts than vertices; one contact per part is then as good.
  if (partitioner.metis == 1 || problem.contacts() == 0) return result;
  const Index columns = problem.columns_per_contact, contacts = problem.contacts() / columns;
  if (partitioner.metis >= contacts) {
    for (Index c = 0; c < problem.contacts(); ++c) result.subdomain_of_contact[at(c)] = c / columns;
    return result;
  }
  Graph graph = contact_graph(problem, contacts);
  idx_t vertices = static_cast<idx_t>(contacts), constraints = 1;
  idx_t parts = static_cast<idx_t>(partitioner.metis), cut = 0;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = static_cast<idx_t>(partitioner.seed);
  std::vector<idx_t> part(at(contacts));
  const int status = metis_status([&] {
    return METIS_PartGraphKway(&vertices, &constraints, graph.start.data(), graph.neighbours.data(), nullptr, nullptr,
                               nullptr, &parts, nullptr, nullptr, options, &cut, part.data());
  });
  if (status != METIS_OK)
    fail("METIS: expected a partition into {} subdomains, met status {}", partitioner.metis, status);
  fill_empty_parts(graph, parts, part);
  for (Index c = 0; c < problem.contacts(); ++c) result.subdomain_of_contact[at(c)] = part[at(c / columns)];
  return result;
}

}  // namespace nscdd
