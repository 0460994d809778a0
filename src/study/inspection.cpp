// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/inspection.hpp"

#include "core/disjoint_sets.hpp"
#include "linalg/range_projector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace nscdd {
namespace {

NetworkDegrees degrees(const Subdomain& subdomain, bool ranks) {
  NetworkDegrees result;
  result.grains = count(subdomain.grains);
  result.contacts = subdomain.h.cols();
  if (!ranks) return result;
  result.rank = sparse_rank(subdomain.h);
  result.rigid_modes = subdomain.h.rows() - result.rank;
  result.hyperstaticity = result.contacts - result.rank;
  return result;
}

// Connected pieces of the contact network, isolated grains left out.
Index connected_pieces(const ReferenceProblem& problem) {
  DisjointSets joined(problem.grains());
  std::vector<char> touched(at(problem.grains()), 0);
  Index pieces = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const std::vector<Index> grains = grains_of_contact(problem, c);
    for (const Index grain : grains) {
      if (!std::exchange(touched[at(grain)], char{1})) ++pieces;
      if (joined.join(grains.front(), grain)) --pieces;
    }
  }
  return pieces;
}

// Contacts per grain, on average; a contact with a support counts for one grain.
double coordination_number(const Model& model) {
  Index touches = 0;
  for (Index c = 0; c < model.contacts(); ++c)
    touches += count(grains_of_contact(model.problem, model.problem.columns_per_contact * c));
  return static_cast<double>(touches) / static_cast<double>(model.grains());
}

double largest_overlap_of(const Model& model) {
  const std::vector<double>& radius = model.packing.radius;
  double largest = 0;
  for (const Contact& c : model.network.contacts)
    largest = std::max(largest, -c.gap / std::min(radius[at(c.a)], radius[at(c.b)]));
  return largest;
}

// Rattlers and the coordination number of what remains without them.
void count_rattlers(const ContactNetwork& network, Inspection& result) {
  const std::vector<char> loose = rattlers(network);
  result.rattlers = std::count(loose.begin(), loose.end(), 1);
  const Index held = network.grains - result.rattlers;
  const auto between = std::count_if(network.contacts.begin(), network.contacts.end(),
                                     [&](const Contact& c) { return loose[at(c.a)] == 0 && loose[at(c.b)] == 0; });
  result.coordination_without_rattlers =
      held > 0 ? 2.0 * static_cast<double>(between) / static_cast<double>(held) : not_a_number;
}

}  // namespace

std::string why_empty(const Model& model) {
  if (model.parts.interface_size() > 0) return "";
  const Index subdomains = model.partition.subdomains, pieces = connected_pieces(model.problem);
  std::string why = fmt::format("{} subdomain(s), no shared grain", subdomains);
  if (subdomains > 1 && pieces > 1)
    why += fmt::format("; the network has {} separate pieces, and the partition cuts none of them", pieces);
  return why;
}

Case with_overlaps_of_motion(Case one) {
  double& tolerance = one.spec.contacts.overlap_tolerance;
  if (one.spec.dynamics && tolerance == ContactDetection{}.overlap_tolerance) tolerance = largest_overlap;
  return one;
}

Inspection inspect(const Model& model, Index ranks_up_to) {
  Inspection result;
  for (Index g = 0; g < model.grains(); ++g) {
    const Index multiplicity = model.parts.interface.multiplicity(g);
    if (multiplicity == 0) ++result.isolated_grains;
    if (multiplicity >= 2) ++result.interface_grains[multiplicity];
  }
  result.ranks = model.contacts() <= ranks_up_to;
  if (result.ranks)
    result.whole = degrees(reassemble(model.parts), true);
  else
    result.whole = {.grains = model.grains() - result.isolated_grains, .contacts = model.problem.contacts()};
  result.unit_multiplicity = result.whole.hyperstaticity;
  for (const Subdomain& subdomain : model.parts.subdomains) {
    result.subdomains.push_back(degrees(subdomain, result.ranks));
    result.unit_multiplicity -= result.subdomains.back().hyperstaticity;
    if (subdomain.contacts.empty()) ++result.empty_subdomains;
  }
  result.components = connected_pieces(model.problem);
  result.coordination_number = coordination_number(model);
  result.interface_dofs = model.parts.interface_size();
  if (!model.has_geometry()) return result;
  result.solid_fraction = solid_fraction(model.packing);
  result.largest_overlap = largest_overlap_of(model);
  count_rattlers(model.network, result);
  result.sizes = size_histogram(model.packing);
  return result;
}

}  // namespace nscdd
