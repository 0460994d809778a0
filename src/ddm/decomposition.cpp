// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/ddm/decomposition.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace nscdd {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

void put(Triplets& entries, Index row, Index column, double value) {
  entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
}

SparseMatrix from(const Triplets& entries, Index rows, Index columns) {
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Index local_number(const std::vector<Index>& ascending, Index global) {
  return std::lower_bound(ascending.begin(), ascending.end(), global) - ascending.begin();
}

void check(const ReferenceProblem& problem, const Partition& partition) {
  if (count(partition.subdomain_of_contact) != problem.contacts())
    throw Error(fmt::format("partition: expected a subdomain for each of {} contacts, met {}",
                            problem.contacts(), partition.subdomain_of_contact.size()));
  for (Index c = 0; c < problem.contacts(); ++c) {
    const Index e = partition.subdomain_of_contact[at(c)];
    if (e < 0 || e >= partition.subdomains)
      throw Error(fmt::format("partition: expected a subdomain in 0..{} for contact {}, met {}",
                              partition.subdomains - 1, c, e));
  }
}

// Subdomain-local rows of the columns `contacts` of H.
SparseMatrix local_connectivity(const ReferenceProblem& problem, const Subdomain& subdomain) {
  const Index d = problem.dofs_per_grain;
  Triplets entries;
  for (Index c = 0; c < count(subdomain.contacts); ++c)
    for (SparseMatrix::InnerIterator e(problem.h, subdomain.contacts[at(c)]); e; ++e) {
      const Index grain = local_number(subdomain.grains, e.row() / d);
      put(entries, grain * d + e.row() % d, c, e.value());
    }
  return from(entries, d * count(subdomain.grains), count(subdomain.contacts));
}

void glue(Decomposition& parts, GluingShape shape) {
  std::vector<std::vector<GrainCopy>> copies(parts.multiplicity.size());
  for (Index e = 0; e < count(parts.subdomains); ++e)
    for (Index i = 0; i < count(parts.subdomains[at(e)].grains); ++i)
      copies[at(parts.subdomains[at(e)].grains[at(i)])].push_back({e, i});
  for (Index g = 0; g < count(copies); ++g)
    for (std::size_t k = 1; k < copies[at(g)].size(); ++k) {
      const GrainCopy& tied_to = copies[at(g)][shape == GluingShape::chain ? k - 1 : 0];
      parts.gluing.push_back({g, tied_to, copies[at(g)][k]});
    }
  const Index d = parts.dofs_per_grain;
  std::vector<Triplets> entries(parts.subdomains.size());
  for (Index row = 0; row < count(parts.gluing); ++row)
    for (Index k = 0; k < d; ++k) {
      const auto& [grain, first, second] = parts.gluing[at(row)];
      put(entries[at(first.subdomain)], row * d + k, first.grain * d + k, 1.0);
      put(entries[at(second.subdomain)], row * d + k, second.grain * d + k, -1.0);
    }
  for (Index e = 0; e < count(parts.subdomains); ++e) {
    Subdomain& subdomain = parts.subdomains[at(e)];
    subdomain.a = from(entries[at(e)], parts.interface_size(), d * count(subdomain.grains));
  }
}

}  // namespace

Decomposition decompose(const ReferenceProblem& problem, const Partition& partition, GluingShape shape) {
  check(problem, partition);
  Decomposition parts;
  parts.dofs_per_grain = problem.dofs_per_grain;
  parts.contacts = problem.contacts();
  parts.subdomains.resize(at(partition.subdomains));
  parts.multiplicity.assign(at(problem.grains()), 0);
  for (Index c = 0; c < problem.contacts(); ++c) {
    Subdomain& subdomain = parts.subdomains[at(partition.subdomain_of_contact[at(c)])];
    subdomain.contacts.push_back(c);
    for (const Index grain : grains_of_contact(problem, c)) subdomain.grains.push_back(grain);
  }
  for (Subdomain& subdomain : parts.subdomains) {
    auto& grains = subdomain.grains;
    std::sort(grains.begin(), grains.end());
    grains.erase(std::unique(grains.begin(), grains.end()), grains.end());
    for (const Index grain : grains) ++parts.multiplicity[at(grain)];
  }
  const Index d = problem.dofs_per_grain;
  for (Subdomain& subdomain : parts.subdomains) {
    subdomain.inertia.resize(d * count(subdomain.grains));
    for (Index i = 0; i < count(subdomain.grains); ++i) {
      const Index grain = subdomain.grains[at(i)];
      subdomain.inertia.segment(d * i, d) =
          problem.inertia.segment(d * grain, d) / static_cast<double>(parts.multiplicity[at(grain)]);
    }
    subdomain.h = local_connectivity(problem, subdomain);
  }
  glue(parts, shape);
  return parts;
}

Decomposition restrict_contacts(const Decomposition& parts, const std::vector<char>& kept) {
  if (count(kept) != parts.contacts)
    throw Error(fmt::format("contact selection: expected {} flags, met {}", parts.contacts, kept.size()));
  Decomposition restricted = parts;
  for (Subdomain& subdomain : restricted.subdomains) {
    const SparseMatrix all = subdomain.h;
    std::vector<Index> contacts;
    Triplets entries;
    for (Index c = 0; c < count(subdomain.contacts); ++c) {
      if (!kept[at(subdomain.contacts[at(c)])]) continue;
      for (SparseMatrix::InnerIterator e(all, c); e; ++e) put(entries, e.row(), count(contacts), e.value());
      contacts.push_back(subdomain.contacts[at(c)]);
    }
    subdomain.h = from(entries, all.rows(), count(contacts));
    subdomain.contacts = std::move(contacts);
  }
  return restricted;
}

Subdomain reassemble(const Decomposition& parts) {
  const Index d = parts.dofs_per_grain;
  Subdomain whole;
  for (Index g = 0; g < count(parts.multiplicity); ++g)
    if (parts.multiplicity[at(g)] > 0) whole.grains.push_back(g);
  for (const Subdomain& subdomain : parts.subdomains)
    whole.contacts.insert(whole.contacts.end(), subdomain.contacts.begin(), subdomain.contacts.end());
  std::sort(whole.contacts.begin(), whole.contacts.end());
  whole.inertia = Vector::Zero(d * count(whole.grains));
  Triplets entries;
  for (const Subdomain& subdomain : parts.subdomains) {
    for (Index i = 0; i < count(subdomain.grains); ++i)
      whole.inertia.segment(d * local_number(whole.grains, subdomain.grains[at(i)]), d) +=
          subdomain.inertia.segment(d * i, d);
    for (Index c = 0; c < count(subdomain.contacts); ++c)
      for (SparseMatrix::InnerIterator e(subdomain.h, c); e; ++e) {
        const Index grain = local_number(whole.grains, subdomain.grains[at(e.row() / d)]);
        put(entries, grain * d + e.row() % d, local_number(whole.contacts, subdomain.contacts[at(c)]),
            e.value());
      }
  }
  whole.h = from(entries, d * count(whole.grains), count(whole.contacts));
  whole.a = SparseMatrix(0, whole.h.rows());
  return whole;
}

}  // namespace nscdd
