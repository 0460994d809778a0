// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/threads.hpp"
#include <nscdd/ddm/decomposition.hpp>

#include <metis.h>

#include <map>

namespace nscdd {
namespace {

// METIS may leave a part of a small graph empty: it takes the lightest subdomain of a process that has several.
void fill_empty(std::vector<Index>& process_of, const std::vector<idx_t>& weight, Index processes) {
  for (Index process = 0; process < processes; ++process) {
    if (std::ranges::count(process_of, process) > 0) continue;
    std::optional<std::size_t> lightest;
    for (std::size_t e = 0; e < process_of.size(); ++e)
      if (std::ranges::count(process_of, process_of[e]) > 1 && (!lightest || weight[e] < weight[*lightest]))
        lightest = e;
    process_of[*lightest] = process;
  }
}

}  // namespace

void require_subdomains(Index subdomains, Index processes) {
  if (processes > subdomains)
    fail("processes: expected at most one for each of {} subdomain(s), met {}", subdomains, processes);
}

std::vector<Index> deal_out(const Decomposition& parts, Index processes) {
  std::vector<Index> weight;
  for (const Subdomain& subdomain : parts.subdomains) weight.push_back(1 + subdomain.inertia.size());
  return deal_out(parts.interface, weight, processes);
}

std::vector<Index> deal_out(const Interface& interface, const std::vector<Index>& weight, Index processes) {
  const Index subdomains = count(weight);
  require_subdomains(subdomains, processes);
  std::vector<Index> process_of(at(subdomains), 0);
  if (processes == 1) return process_of;
  std::vector<std::map<Index, idx_t>> shared(at(subdomains));  // rows that a subdomain shares with each other one
  for (const Gluing& row : interface.gluing()) {
    ++shared[at(row.first.subdomain)][row.second.subdomain];
    ++shared[at(row.second.subdomain)][row.first.subdomain];
  }
  std::vector<idx_t> start{0}, neighbours, rows, weights;
  for (Index e = 0; e < subdomains; ++e) {
    for (const auto& [other, number] : shared[at(e)]) {
      neighbours.push_back(static_cast<idx_t>(other));
      rows.push_back(number);
    }
    start.push_back(static_cast<idx_t>(neighbours.size()));
    weights.push_back(static_cast<idx_t>(weight[at(e)]));
  }
  auto vertices = static_cast<idx_t>(subdomains), wanted = static_cast<idx_t>(processes);
  idx_t constraints = 1, cut = 0;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  std::vector<idx_t> part(at(subdomains), 0);
  const int status = metis_status([&] {
    return METIS_PartGraphRecursive(&vertices, &constraints, start.data(), neighbours.data(), weights.data(), nullptr,
                                    rows.data(), &wanted, nullptr, nullptr, options, &cut, part.data());
  });
  if (status != METIS_OK)
    fail("METIS: expected subdomains dealt out to {} processes, met status {}", processes, status);
  process_of.assign(part.begin(), part.end());
  fill_empty(process_of, weights, processes);
  return process_of;
}

}  // namespace nscdd
