// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/network_tables.hpp"

#include <nscdd/packing/statistics.hpp>

namespace nscdd {

std::vector<Column> link_columns(ContactSet contacts) {
  const std::string problem = contacts == ContactSet::unilateral ? "frictionless unilateral" : "linear rigid";
  return {
      {"case", "", "name of the case"},
      {"contact", "1", "number of the contact"},
      {"grain_a", "1", "first grain"},
      {"grain_b", "1", "second grain, the larger number"},
      {"x_a", "m", "centre of grain_a"},
      {"y_a", "m", "centre of grain_a"},
      {"x_b", "m", "centre of grain_b"},
      {"y_b", "m", "centre of grain_b"},
      {"normal_x", "1", "unit normal from grain_a to grain_b"},
      {"normal_y", "1", "unit normal from grain_a to grain_b"},
      {"gap", "m", "distance of the surfaces, negative for an overlap"},
      {"subdomain", "1", "subdomain that owns the contact"},
      {"impulse", "kg m/s", "impulse of the " + problem + " problem, > 0 in compression; nan without a load"},
      {"active", "1", "in compression (every contact where nothing is prescribed)"},
      {"impulse_solution", "",
       contacts == ContactSet::unilateral
           ? "unilateral_unique, unilateral_maximal (carrying in some solution), or none without a load"
           : "unique, least_norm (hyperstatic network), or none without a load"}};
}

ContactChoice link_rows(const Model& model, const RowSink& sink, ContactSet contacts) {
  require_geometry(model, "links");
  const bool loaded = !model.problem.arriving_velocity.isZero(0);
  const ContactChoice choice = choose_contacts(model, !loaded                       ? ContactSet::all
                                                      : contacts == ContactSet::all ? ContactSet::active
                                                                                    : contacts);
  const Packing& p = model.packing;
  for (Index c = 0; c < model.network.size(); ++c) {
    const Contact& k = model.network.contacts[at(c)];
    sink({model.name, std::int64_t{c}, std::int64_t{k.a}, std::int64_t{k.b}, p.x[at(k.a)], p.y[at(k.a)],
          p.x[at(k.b)], p.y[at(k.b)], k.normal[0], k.normal[1], k.gap,
          std::int64_t{model.partition.subdomain_of_contact[at(c)]},
          loaded ? choice.impulses[c] : not_a_number, choice.active[at(c)] != 0, choice.solution});
  }
  return choice;
}

std::vector<Column> grain_columns() {
  return {{"case", "", "name of the case"},
          {"grain", "1", "number of the grain"},
          {"x", "m", "centre"},
          {"y", "m", "centre"},
          {"radius", "m", "radius"},
          {"mass", "kg", "mass"},
          {"contacts", "1", "contacts of the grain"},
          {"multiplicity", "1", "subdomains that share the grain; 0 for a grain that touches nothing"},
          {"velocity_x", "m/s", "prescribed velocity, 0 where none is"},
          {"velocity_y", "m/s", "prescribed velocity, 0 where none is"}};
}

void grain_rows(const Model& model, const RowSink& sink) {
  require_geometry(model, "grains");
  const std::vector<Index> contacts = contact_counts(model.network);
  const Packing& p = model.packing;
  for (Index i = 0; i < p.size(); ++i)
    sink({model.name, std::int64_t{i}, p.x[at(i)], p.y[at(i)], p.radius[at(i)], p.mass[at(i)],
          std::int64_t{contacts[at(i)]}, std::int64_t{model.parts.multiplicity[at(i)]},
          model.problem.arriving_velocity[2 * i], model.problem.arriving_velocity[2 * i + 1]});
}

std::vector<Column> size_columns() {
  return {{"case", "", "name of the case"},
          {"radius_from", "m", "smallest radius of the class"},
          {"radius_to", "m", "upper bound of the class, its own in the last class only"},
          {"grains", "1", "grains of the class"},
          {"number_fraction", "1", "of all grains"},
          {"area_fraction", "1", "of the area of all grains"}};
}

void size_rows(const Model& model, const RowSink& sink) {
  require_geometry(model, "sizes of grains");
  const std::vector<SizeClass> classes = size_histogram(model.packing);
  double area = 0;
  for (const SizeClass& one : classes) area += one.area;
  for (const SizeClass& one : classes)
    sink({model.name, one.from, one.to, std::int64_t{one.grains},
          static_cast<double>(one.grains) / static_cast<double>(model.packing.size()), one.area / area});
}

}  // namespace nscdd
