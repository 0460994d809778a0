// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/linalg/range_projector.hpp>
#include <nscdd/study/inspection.hpp>

#include <numeric>

namespace nscdd {
namespace {

NetworkDegrees degrees(const Subdomain& subdomain) {
  NetworkDegrees result;
  result.grains = count(subdomain.grains);
  result.contacts = subdomain.h.cols();
  result.rank = sparse_rank(subdomain.h);
  result.rigid_modes = subdomain.h.rows() - result.rank;
  result.hyperstaticity = result.contacts - result.rank;
  return result;
}

// Connected pieces of the contact graph, by union-find over its grains.
Index components(const ContactNetwork& network) {
  std::vector<Index> parent(at(network.grains));
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index i) {
    while (parent[at(i)] != i) i = parent[at(i)] = parent[at(parent[at(i)])];
    return i;
  };
  for (const Contact& contact : network.contacts) parent[at(root(contact.a))] = root(contact.b);
  const std::vector<Index> contacts = contact_counts(network);
  Index pieces = 0;
  for (Index i = 0; i < network.grains; ++i)
    if (contacts[at(i)] > 0 && root(i) == i) ++pieces;
  return pieces;
}

}  // namespace

Inspection inspect(const Model& model) {
  Inspection result;
  result.whole = degrees(reassemble(model.parts));
  Index local_hyperstaticity = 0;
  for (const Subdomain& subdomain : model.parts.subdomains) {
    result.subdomains.push_back(degrees(subdomain));
    local_hyperstaticity += result.subdomains.back().hyperstaticity;
    if (subdomain.contacts.empty()) ++result.empty_subdomains;
  }
  result.unit_multiplicity = result.whole.hyperstaticity - local_hyperstaticity;
  for (const Index multiplicity : model.parts.multiplicity) {
    if (multiplicity == 0) ++result.isolated_grains;
    if (multiplicity >= 2) ++result.interface_grains[multiplicity];
  }
  result.components = components(model.network);
  result.coordination_number =
      2.0 * static_cast<double>(model.network.size()) / static_cast<double>(model.packing.size());
  result.interface_dofs = model.parts.interface_size();
  return result;
}

}  // namespace nscdd
