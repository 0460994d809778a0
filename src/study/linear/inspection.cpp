// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/inspection.hpp"

#include "core/disjoint_sets.hpp"
#include "ddm/rigid_motions.hpp"
#include "packing/precision.hpp"
#include "study/tables/study.hpp"

#include <set>

namespace nscdd {
namespace {

NetworkDegrees degrees(const Subdomain& subdomain, bool ranks) {
  NetworkDegrees result{.grains = count(subdomain.grains), .contacts = subdomain.h.cols()};
  if (!ranks) return result;
  const Index dofs_per_grain = subdomain.h.rows() / std::max<Index>(result.grains, 1);
  result.rank = rigid_rank(dofs_per_grain, subdomain.centres, subdomain.inertia, subdomain.h).value;
  result.rigid_modes = subdomain.h.rows() - result.rank;
  result.hyperstaticity = result.contacts - result.rank;
  return result;
}

// Connected pieces of the contact network without isolated grains.
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

// Counts the rattlers, and finds the coordination number of the other grains.
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
  if (subdomains == 1) return "one subdomain; --subdomains metis:2, for example, cuts it";
  std::string why = fmt::format("{} subdomains, no shared grain", subdomains);
  if (pieces > 1)
    why += fmt::format("; the network has {} separate pieces, and the partition cuts none of them", pieces);
  return why;
}

std::vector<std::string> remarks_on(const Model& model, const Partitioner& partitioner) {
  std::vector<std::string> remarks = rounding_remarks(model.network, model.name);
  const Index subdomains = model.partition.subdomains, contacts = model.contacts();
  if (std::holds_alternative<MetisPartitioner>(partitioner) && subdomains > contacts)
    remarks.push_back(fmt::format("{}: {} contacts cannot fill {} subdomains: {} of these are empty", model.name,
                                  contacts, subdomains, subdomains - contacts));
  return remarks;
}

Case with_overlaps_of_motion(Case one) {
  if (!one.spec.dynamics) return one;
  double& tolerance = one.spec.contacts.overlap_tolerance;
  if (tolerance == ContactDetection{}.overlap_tolerance) tolerance = largest_overlap;
  if (one.made)  // small gaps of grains that move are not due to rounding
    one.made = [told = one.made](Model model) {
      model.network.rounding.one_sided = {};
      told(model);
    };
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
  result.whole = {.grains = model.grains() - result.isolated_grains, .contacts = model.problem.contacts()};
  if (result.ranks) result.whole = degrees(reassemble(model.parts), true);
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
  result.solid_fraction = solid_fraction(model.packing, model.network.period);
  result.largest_overlap = largest_overlap_of(model);
  count_rattlers(model.network, result);
  result.sizes = size_histogram(model.packing);
  return result;
}

ResultColumns<Link> link_columns(ContactSet contacts, Index dimension) {
  const bool unilateral = contacts == ContactSet::unilateral;
  const auto of = [](auto member) {
    return [member](const Link& link) { return std::invoke(member, link.contact()); };
  };
  const auto centre = [](Index Contact::*grain) {
    return [=](const Link& link, Index k) { return link.model.packing.centre(link.contact().*grain)[at(k)]; };
  };
  return joined<Link>(
      {{{"case", "", "name of the case", [](const Link& link) { return link.model.name; }},
        {"contact", "1", "number of the contact", [](const Link& link) { return link.number; }},
        {"grain_a", "1", "first grain", of(&Contact::a)},
        {"grain_b", "1", "second grain, the larger number", of(&Contact::b)}},
       vector_columns<Link>(dimension, "{}_a", "m", "centre of grain_a", centre(&Contact::a)),
       vector_columns<Link>(dimension, "{}_b", "m", "centre of grain_b", centre(&Contact::b)),
       vector_columns<Link>(dimension, "normal_{}", "1", "unit normal from grain_a to grain_b",
                            [](const Link& link, Index k) { return link.contact().normal[at(k)]; }),
       {{"gap", "m", "distance of the surfaces, negative for an overlap", of(&Contact::gap)},
        {"subdomain", "1", "subdomain that owns the contact",
         [](const Link& link) { return link.model.partition.subdomain_of_contact[at(link.number)]; }},
        {"impulse", "kg m/s",
         std::string("impulse of the ") + (unilateral ? "frictionless unilateral" : "linear rigid") +
             " problem, > 0 in compression; nan without a load",
         &Link::impulse},
        {"active", "1", "in compression (every contact where nothing is prescribed)",
         [](const Link& link) { return link.choice.active[at(link.number)] != 0; }},
        {"impulse_solution", "",
         unilateral ? "unilateral_unique, unilateral_maximal (carrying in some solution), or none without a load"
                    : "unique, least_norm (hyperstatic network), or none without a load",
         [](const Link& link) { return link.choice.solution; }}}});
}

ContactChoice links(const Model& model, const Sink<Link>& sink, ContactSet contacts) {
  require_geometry(model, "links");
  const bool loaded = !model.problem.arriving_velocity.isZero(0);
  if (contacts == ContactSet::all) contacts = ContactSet::active;
  const ContactChoice choice = choose_contacts(model, loaded ? contacts : ContactSet::all);
  for (Index c = 0; c < model.network.size(); ++c) sink({model, choice, c, loaded ? choice.impulses[c] : not_a_number});
  return choice;
}

ResultColumns<ProblemContact> problem_contact_columns() {
  return {{"case", "", "name of the case", [](const ProblemContact& c) { return c.model.name; }},
          {"contact", "1", "number of the contact in the file", &ProblemContact::number},
          {"body_a", "1", "first body", &ProblemContact::body_a},
          {"body_b", "1", "second body, the larger number; -1 for a support", &ProblemContact::body_b},
          {"subdomain", "1", "subdomain that owns the contact", [](const ProblemContact& c) {
             return c.model.partition.subdomain_of_contact[at(c.model.problem.columns_per_contact * c.number)];
           }}};
}

void problem_contacts(const Model& model, const Sink<ProblemContact>& sink) {
  const Index columns = model.problem.columns_per_contact;
  for (Index c = 0; c < model.contacts(); ++c) {
    std::set<Index> bodies;
    for (Index k = 0; k < columns; ++k)
      for (const Index body : grains_of_contact(model.problem, columns * c + k)) bodies.insert(body);
    sink({model, c, bodies.empty() ? -1 : *bodies.begin(), bodies.size() > 1 ? *bodies.rbegin() : -1});
  }
}

ResultColumns<PackingGrain> grain_columns(Index dimension) {
  const auto of = [](std::vector<double> Packing::*values) {
    return [=](const PackingGrain& grain) { return (grain.model.packing.*values)[at(grain.number)]; };
  };
  return joined<PackingGrain>(
      {{{"case", "", "name of the case", [](const PackingGrain& grain) { return grain.model.name; }},
        {"grain", "1", "number of the grain", &PackingGrain::number}},
       vector_columns<PackingGrain>(
           dimension, "{}", "m", "centre",
           [](const PackingGrain& grain, Index k) { return grain.model.packing.centre(grain.number)[at(k)]; }),
       {{"radius", "m", "radius", of(&Packing::radius)},
        {"mass", "kg", "mass", of(&Packing::mass)},
        {"contacts", "1", "contacts of the grain", &PackingGrain::contacts},
        {"multiplicity", "1", "subdomains that share the grain; 0 for a grain that touches nothing",
         [](const PackingGrain& grain) { return grain.model.parts.interface.multiplicity(grain.number); }}},
       vector_columns<PackingGrain>(dimension, "velocity_{}", "m/s", "prescribed velocity, 0 if the grain has none",
                                    [](const PackingGrain& grain, Index k) {
                                      const ReferenceProblem& problem = grain.model.problem;
                                      return problem.arriving_velocity[problem.dofs_per_grain * grain.number + k];
                                    })});
}

void grains(const Model& model, const Sink<PackingGrain>& sink) {
  require_geometry(model, "grains");
  const std::vector<Index> contacts = contact_counts(model.network);
  for (Index i = 0; i < model.packing.size(); ++i) sink({model, i, contacts[at(i)]});
}

ResultColumns<GrainSizes> size_columns(Index dimension) {
  const std::string measure = dimension == 2 ? "area" : "volume";
  return {{"case", "", "name of the case", [](const GrainSizes& s) { return s.model.name; }},
          {"radius_from", "m", "smallest radius of the class", [](const GrainSizes& s) { return s.one.from; }},
          {"radius_to", "m", "upper bound of the class, its own in the last class only",
           [](const GrainSizes& s) { return s.one.to; }},
          {"grains", "1", "grains of the class", [](const GrainSizes& s) { return s.one.grains; }},
          {"number_fraction", "1", "of all grains",
           [](const GrainSizes& s) {
             return static_cast<double>(s.one.grains) / static_cast<double>(s.model.packing.size());
           }},
          {measure + "_fraction", "1", "of the " + measure + " of all grains",
           [](const GrainSizes& s) { return s.one.measure / s.all; }}};
}

void grain_sizes(const Model& model, const Sink<GrainSizes>& sink) {
  require_geometry(model, "sizes of grains");
  const std::vector<SizeClass> classes = size_histogram(model.packing);
  double all = 0;
  for (const SizeClass& one : classes) all += one.measure;
  for (const SizeClass& one : classes) sink({model, one, all});
}

constinit const Observable observables::links{
    .name = "links",
    .summary = "contact network: grains, normal, subdomain, impulse, active",
    .keys = {"contacts"},
    .columns =
        [](const StudyTable& table) { return headings(link_columns(table.sweep.contacts, dimension_of(table))); },
    .run =
        [](const ObservedCase& work) {
          const ContactSet contacts = work.table.sweep.contacts;
          nscdd::links(build(work.one), as_rows(link_columns(contacts, dimension_of(work.table)), work.sink), contacts);
          return Index{0};
        }};

constinit const Observable observables::grains{
    .name = "grains",
    .summary = "grains: position, radius, mass, multiplicity, prescribed velocity",
    .keys = {},
    .columns = [](const StudyTable& table) { return headings(grain_columns(dimension_of(table))); },
    .run =
        [](const ObservedCase& work) {
          nscdd::grains(build(work.one), as_rows(grain_columns(dimension_of(work.table)), work.sink));
          return Index{0};
        }};

}  // namespace nscdd
