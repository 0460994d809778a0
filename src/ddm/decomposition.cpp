// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include <nscdd/ddm/partitioner.hpp>

#include <numeric>

namespace nscdd {
namespace {

Index local_number(const std::vector<Index>& ascending, Index global) {
  return std::lower_bound(ascending.begin(), ascending.end(), global) - ascending.begin();
}

// Subdomain-local rows of the columns `contacts` of H.
SparseMatrix local_connectivity(const ReferenceProblem& problem, const Subdomain& subdomain) {
  const Index d = problem.dofs_per_grain;
  SparseEntries entries;
  for (Index c = 0; c < count(subdomain.contacts); ++c)
    for (SparseMatrix::InnerIterator e(problem.h, subdomain.contacts[at(c)]); e; ++e)
      entries.add(local_number(subdomain.grains, e.row() / d) * d + e.row() % d, c, e.value());
  return entries.matrix(d * count(subdomain.grains), count(subdomain.contacts));
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

Partitioner parse_partitioner(std::string_view text, std::string_view what) {
  std::optional<Partitioner> found;
  std::string forms;
  for_each_partitioner([&](auto one) {
    forms += fmt::format("{}{}", forms.empty() ? "" : ", or ", one.option_form);
    if (const auto colon = text.find(':'); colon < text.size() && text.substr(0, colon) != one.name) return;
    const std::optional<std::string> value = one.value_of_option(text);
    if (!value || found) return;
    override_field(one, one.name, *value, what);
    found = one;
  });
  if (!found) fail("{}: expected {}, met '{}'", what, forms, text);
  return *found;
}

namespace {

// The contacts of every subdomain, and the grains that these touch, ascending.
std::vector<Subdomain> with_contacts(const ReferenceProblem& problem, const Partition& partition) {
  check(partition, problem.contacts());
  std::vector<Subdomain> subdomains(at(partition.subdomains));
  for (Index c = 0; c < problem.contacts(); ++c) {
    Subdomain& subdomain = subdomains[at(partition.subdomain_of_contact[at(c)])];
    subdomain.contacts.push_back(c);
    for (const Index grain : grains_of_contact(problem, c)) subdomain.grains.push_back(grain);
  }
  for (Subdomain& subdomain : subdomains) {
    auto& grains = subdomain.grains;
    std::sort(grains.begin(), grains.end());
    grains.erase(std::unique(grains.begin(), grains.end()), grains.end());
    grains.shrink_to_fit();
  }
  return subdomains;
}

// M_E of every subdomain. `number`: what the interface calls a grain.
template <class Number>
void share_inertia(Decomposition& parts, const ReferenceProblem& problem, Number number) {
  const Index d = problem.dofs_per_grain;
  for (Subdomain& subdomain : parts.subdomains) {
    subdomain.inertia.resize(d * count(subdomain.grains));
    for (Index i = 0; i < count(subdomain.grains); ++i) {
      const Index grain = subdomain.grains[at(i)];
      subdomain.inertia.segment(d * i, d) =
          problem.inertia.segment(d * grain, d) / static_cast<double>(parts.interface.multiplicity(number(grain)));
    }
  }
}

}  // namespace

Decomposition cut(const ReferenceProblem& problem, const Partition& partition, GluingShape shape) {
  Decomposition parts;
  parts.contacts = problem.contacts();
  parts.subdomains = with_contacts(problem, partition);
  std::vector<std::span<const Index>> held;
  for (const Subdomain& subdomain : parts.subdomains) held.emplace_back(subdomain.grains);
  parts.interface = Interface(problem.dofs_per_grain, problem.grains(), held, {}, shape);
  share_inertia(parts, problem, [](Index grain) { return grain; });
  return parts;
}

Decomposition decompose_own(const ReferenceProblem& problem, const Partition& partition,
                            const std::vector<Index>& numbers, const std::vector<Index>& process_of_subdomain,
                            const Processes& processes) {
  const auto number = [&](Index grain) { return numbers[at(grain)]; };
  Decomposition parts;
  parts.subdomains = with_contacts(problem, partition);
  std::vector<std::vector<Index>> held;
  for (const Subdomain& subdomain : parts.subdomains) {
    held.emplace_back();
    std::ranges::transform(subdomain.grains, std::back_inserter(held.back()), number);
  }
  parts.interface = shared_interface(problem.dofs_per_grain, numbers.empty() ? 0 : numbers.back() + 1, held, {},
                                     process_of_subdomain, processes);
  share_inertia(parts, problem, number);
  parts = with_matrices(std::move(parts), problem);
  const auto own = static_cast<double>(problem.contacts());
  const std::vector<double> contacts = processes.gather({&own, 1});
  const auto first = std::accumulate(contacts.begin(), contacts.begin() + processes.rank, 0.0);
  parts.contacts = static_cast<Index>(std::accumulate(contacts.begin(), contacts.end(), 0.0));
  for (std::size_t e = 0; e < held.size(); ++e) {
    parts.subdomains[e].grains = std::move(held[e]);
    for (Index& contact : parts.subdomains[e].contacts) contact += static_cast<Index>(first);
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

Decomposition decompose(const ReferenceProblem& problem, const Partition& partition, GluingShape shape) {
  return with_matrices(cut(problem, partition, shape), problem);
}

namespace {

// `kept`: one flag per contact from number `first` on.
Decomposition restricted(Decomposition parts, const std::vector<char>& kept, Index first) {
  const auto stays = [&](Index contact) { return kept[at(contact - first)] != 0; };
  for (Subdomain& subdomain : parts.subdomains) {
    std::vector<Index> columns;
    for (Index c = 0; c < count(subdomain.contacts); ++c)
      if (stays(subdomain.contacts[at(c)])) columns.push_back(c);
    subdomain.h = selected_columns(subdomain.h, columns);
    std::erase_if(subdomain.contacts, [&](Index contact) { return !stays(contact); });
  }
  return parts;
}

}  // namespace

Decomposition restrict_contacts(const Decomposition& parts, const std::vector<char>& kept) {
  if (count(kept) != parts.contacts) fail("contact selection: expected {} flags, met {}", parts.contacts, kept.size());
  return restricted(parts, kept, 0);
}

Decomposition restrict_own(const Decomposition& parts, const std::vector<char>& kept) {
  Index first = parts.contacts, end = 0;  // the contacts of this process, of which some may be left out already
  for (const Subdomain& subdomain : parts.subdomains)
    if (!subdomain.contacts.empty()) {
      first = std::min(first, subdomain.contacts.front());
      end = std::max(end, subdomain.contacts.back() + 1);
    }
  if (end - first > count(kept)) fail("contact selection: expected {} flags, met {}", end - first, kept.size());
  return restricted(parts, kept, first);
}

Decomposition of_process(Decomposition parts, const std::vector<Index>& process_of_subdomain,
                         const Processes& processes) {
  parts.interface = parts.interface.of_process(process_of_subdomain, processes);
  for (std::size_t e = 0; e < process_of_subdomain.size(); ++e)
    if (process_of_subdomain[e] != processes.rank)
      parts.subdomains[e] = {.grains = {},
                             .contacts = {},
                             .inertia = {},
                             .h = {},
                             .a = parts.interface.matrix(static_cast<Index>(e)),
                             .centres = {}};
  return parts;
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
    for (Index c = 0; c < count(subdomain.contacts); ++c)
      for (SparseMatrix::InnerIterator e(subdomain.h, c); e; ++e) {
        const Index grain = local_number(whole.grains, subdomain.grains[at(e.row() / d)]);
        entries.add(grain * d + e.row() % d, local_number(whole.contacts, subdomain.contacts[at(c)]), e.value());
      }
  }
  whole.h = entries.matrix(d * count(whole.grains), count(whole.contacts));
  whole.a = SparseMatrix(0, whole.h.rows());
  return whole;
}

}  // namespace nscdd
