// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include <nscdd/ddm/decomposition.hpp>

#include <metis.h>

#include <map>

namespace nscdd {
namespace {

Index local_number(const std::vector<Index>& ascending, Index global) {
  return std::lower_bound(ascending.begin(), ascending.end(), global) - ascending.begin();
}

// The columns of H of a subdomain's contacts, in its local rows.
SparseMatrix local_connectivity(const ReferenceProblem& problem, const Subdomain& subdomain) {
  const Index d = problem.dofs_per_grain;
  SparseEntries entries;
  for (Index c = 0; c < count(subdomain.contacts); ++c)
    for (SparseMatrix::InnerIterator e(problem.h, subdomain.contacts[at(c)]); e; ++e)
      entries.add(local_number(subdomain.grains, e.row() / d) * d + e.row() % d, c, e.value());
  return entries.matrix(d * count(subdomain.grains), count(subdomain.contacts));
}

// The contacts of every subdomain, and the grains that they touch, ascending.
std::vector<Subdomain> with_contacts(const ReferenceProblem& problem, const Partition& partition) {
  check(partition, problem.contacts());
  std::vector<Subdomain> subdomains(at(partition.subdomains));
  for (Index c = 0; c < problem.contacts(); ++c) {
    Subdomain& subdomain = subdomains[at(partition.subdomain_of_contact[at(c)])];
    subdomain.contacts.push_back(c);
    for (const Index grain : grains_of_contact(problem, c)) subdomain.grains.push_back(grain);
  }
  for (Subdomain& subdomain : subdomains) {
    sort_unique(subdomain.grains);
    subdomain.grains.shrink_to_fit();
  }
  return subdomains;
}

// The numbers in the packing of some grains of the problem.
std::vector<Index> numbers_of(std::vector<Index> grains, const PackingShare& share) {
  if (!share.numbers.empty())
    for (Index& grain : grains) grain = share.numbers[at(grain)];
  return grains;
}

// METIS may leave a part of a small graph empty: it gets the lightest subdomain of a process that has several.
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

void check(const Partition& partition, Index contacts) {
  if (count(partition.subdomain_of_contact) != contacts)
    fail("partition: expected a subdomain for each of {} contacts, met {}", contacts,
         partition.subdomain_of_contact.size());
  for (Index c = 0; c < contacts; ++c)
    if (const Index e = partition.subdomain_of_contact[at(c)]; e < 0 || e >= partition.subdomains)
      fail("partition: expected a subdomain in 0..{} for contact {}, met {}", partition.subdomains - 1, c, e);
}

Decomposition cut(const ReferenceProblem& problem, const Partition& partition, GluingShape shape,
                  const PackingShare& share) {
  Decomposition parts;
  parts.contacts = problem.contacts();
  parts.subdomains = with_contacts(problem, partition);
  std::vector<std::vector<Index>> held;
  for (const Subdomain& subdomain : parts.subdomains) held.push_back(numbers_of(subdomain.grains, share));
  const Index grains = share.numbers.empty() ? problem.grains() : share.numbers.back() + 1;
  parts.interface =
      shared_interface(problem.dofs_per_grain, grains, held, {}, share.process_of_subdomain, share.processes, shape);
  const Index d = problem.dofs_per_grain;
  for (std::size_t e = 0; e < held.size(); ++e) {
    Subdomain& subdomain = parts.subdomains[e];
    subdomain.inertia.resize(d * count(subdomain.grains));
    for (Index i = 0; i < count(subdomain.grains); ++i) {
      const auto copies = static_cast<double>(parts.interface.multiplicity(held[e][at(i)]));
      subdomain.inertia.segment(d * i, d) = problem.inertia.segment(d * subdomain.grains[at(i)], d) / copies;
    }
  }
  return parts;
}

Decomposition with_matrices(Decomposition parts, const ReferenceProblem& problem) {
  for (Index e = 0; e < count(parts.subdomains); ++e) {
    Subdomain& subdomain = parts.subdomains[at(e)];
    subdomain.h = local_connectivity(problem, subdomain);
    subdomain.a = parts.interface.matrix(e);
    if (problem.centres.rows() == problem.dofs_per_grain)
      subdomain.centres = problem.centres(Eigen::all, subdomain.grains);
  }
  return parts;
}

Decomposition decompose(const ReferenceProblem& problem, const Partition& partition, GluingShape shape,
                        const PackingShare& share) {
  Decomposition parts = with_matrices(cut(problem, partition, shape, share), problem);
  const std::vector<Index> contacts = share.processes.gather_each(problem.contacts());
  parts.contacts = std::accumulate(contacts.begin(), contacts.end(), Index{0});
  parts.first_contact = std::accumulate(contacts.begin(), contacts.begin() + share.processes.rank, Index{0});
  for (Subdomain& subdomain : parts.subdomains) {
    subdomain.grains = numbers_of(subdomain.grains, share);
    for (Index& contact : subdomain.contacts) contact += parts.first_contact;
  }
  return parts;
}

Decomposition restrict_contacts(const Decomposition& parts, const std::vector<char>& kept) {
  const Index end = parts.first_contact + count(kept);
  const auto has_flags = [&](const Subdomain& one) { return one.contacts.empty() || one.contacts.back() < end; };
  if (end > parts.contacts || !std::ranges::all_of(parts.subdomains, has_flags))
    fail("contact selection: expected a flag for each of {} contacts, met {}", parts.contacts, kept.size());
  const auto stays = [&](Index contact) { return kept[at(contact - parts.first_contact)] != 0; };
  Decomposition restricted = parts;
  for (Subdomain& subdomain : restricted.subdomains) {
    std::vector<Index> columns;
    for (Index c = 0; c < count(subdomain.contacts); ++c)
      if (stays(subdomain.contacts[at(c)])) columns.push_back(c);
    subdomain.h = selected_columns(subdomain.h, columns);
    std::erase_if(subdomain.contacts, [&](Index contact) { return !stays(contact); });
  }
  return restricted;
}

Decomposition of_process(Decomposition parts, const std::vector<Index>& process_of_subdomain,
                         const Processes& processes) {
  parts.interface = parts.interface.of_process(process_of_subdomain, processes);
  for (std::size_t e = 0; e < process_of_subdomain.size(); ++e)
    if (process_of_subdomain[e] != processes.rank)
      parts.subdomains[e] = {{}, {}, {}, {}, parts.interface.matrix(static_cast<Index>(e))};
  return parts;
}

void require_subdomains(Index subdomains, Index processes) {
  if (processes > subdomains) fail("processes: expected at most {} (one per subdomain), met {}", subdomains, processes);
}

Index own_subdomain(const Decomposition& parts) {
  const Interface& glued = parts.interface;
  if (glued.processes().size != count(parts.subdomains))
    fail("bddc: expected as many processes as subdomains, {}, met {}", count(parts.subdomains), glued.processes().size);
  Index own = 0;
  while (glued.process_of(own) != glued.processes().rank) ++own;
  return own;
}

std::vector<Index> deal_out(const Decomposition& parts, Index processes) {
  std::vector<Index> weight;
  for (const Subdomain& subdomain : parts.subdomains) weight.push_back(1 + subdomain.inertia.size());
  return deal_out(parts.interface, weight, processes);
}

std::vector<Index> deal_out(const Interface& interface, const std::vector<Index>& weight, Index processes) {
  const Index subdomains = count(weight);
  require_subdomains(subdomains, processes);
  if (processes == 1) return std::vector<Index>(at(subdomains), 0);
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
  std::vector<Index> process_of(part.begin(), part.end());
  fill_empty(process_of, weights, processes);
  return process_of;
}

Subdomain reassemble(const Decomposition& parts) {
  const Index d = parts.dofs_per_grain();
  Subdomain whole;
  for (Index g = 0; g < parts.interface.grains(); ++g)
    if (parts.interface.multiplicity(g) > 0) whole.grains.push_back(g);
  for (const Subdomain& subdomain : parts.subdomains)
    whole.contacts.insert(whole.contacts.end(), subdomain.contacts.begin(), subdomain.contacts.end());
  std::sort(whole.contacts.begin(), whole.contacts.end());
  whole.inertia = Vector::Zero(d * count(whole.grains));
  const bool placed = std::ranges::all_of(parts.subdomains,
                                          [](const Subdomain& one) { return one.centres.cols() == count(one.grains); });
  if (placed) whole.centres.resize(d, count(whole.grains));
  SparseEntries entries;
  for (const Subdomain& subdomain : parts.subdomains) {
    for (Index i = 0; i < count(subdomain.grains); ++i) {
      const Index number = local_number(whole.grains, subdomain.grains[at(i)]);
      whole.inertia.segment(d * number, d) += subdomain.inertia.segment(d * i, d);
      if (placed) whole.centres.col(number) = subdomain.centres.col(i);
    }
    for_entries(subdomain.h, [&](Index i, Index c, double value) {
      const Index grain = local_number(whole.grains, subdomain.grains[at(i / d)]);
      entries.add(grain * d + i % d, local_number(whole.contacts, subdomain.contacts[at(c)]), value);
    });
  }
  whole.h = entries.matrix(d * count(whole.grains), count(whole.contacts));
  whole.a = SparseMatrix(0, whole.h.rows());
  return whole;
}

}  // namespace nscdd
