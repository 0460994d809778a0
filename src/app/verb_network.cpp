// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "study/linear/inspection.hpp"

namespace nscdd::app {
namespace {

struct NetworkOptions {
  CaseOptions one;
  std::string csv = "-", grains;
  Choice<ContactSet> contacts = ContactSet::active;
  bool force = false;
  Limits limits;
};

// A contact problem has no places of grains and no loads.
int write_problem(const NetworkOptions& options, const Model& model) {
  if (!options.grains.empty()) require_geometry(model, "--grains");
  const ResultColumns<ProblemContact> columns = problem_contact_columns();
  CsvWriter csv(options.csv, options.force, headings(columns));
  problem_contacts(model, [&](const ProblemContact& one) { csv.write(row(columns, one)); });
  csv.finish();
  return 0;
}

int run_network(const NetworkOptions& options) {
  options.limits.limit_memory();
  const Model model = build(with_overlaps_of_motion(options.one.resolve({options.csv, options.grains})));
  if (!model.has_geometry()) return write_problem(options, model);
  require_distinct({options.csv, options.grains});
  const ContactSet contacts = options.contacts;
  const ResultColumns<Link> columns = link_columns(contacts, model.problem.dimension);
  CsvWriter links(options.csv, options.force, headings(columns));
  const ResultColumns<PackingGrain> of_grains = grain_columns(model.problem.dimension);
  std::optional<CsvWriter> grains;
  if (!options.grains.empty()) grains.emplace(options.grains, options.force, headings(of_grains));
  const ContactChoice choice = nscdd::links(
      model, [&](const Link& link) { links.write(row(columns, link)); }, contacts);
  if (grains) nscdd::grains(model, [&](const PackingGrain& grain) { grains->write(row(of_grains, grain)); });
  links.finish();
  if (grains) grains->finish();
  if (model.problem.arriving_velocity.isZero(0))
    note("nothing is prescribed (--prescribed GRAIN:VX:VY[:VZ]): impulses are nan and every contact counts as active");
  if (choice.idle > 0)
    note("{} of {} contacts are weakly active: they neither carry nor open", choice.idle, model.network.size());
  if (!choice.certain) note("the impulses were not found to 1e-8: the choice of contacts is uncertain");
  return 0;
}

}  // namespace

Action declare_network(Command& command) {
  auto options = std::make_shared<NetworkOptions>();
  options->one.declare(command);
  command
      .preset("--contacts", options->contacts,
              "whose impulses: active (linear rigid problem) or unilateral (no contact pulls)")
      .words = {"active", "unilateral"};
  command.preset("--csv FILE", options->csv, "where the links go, - for standard output");
  command.add("--grains FILE", options->grains, "also write the grains there");
  command.add("--force", options->force, "replace existing outputs");
  options->limits.declare_memory(command);
  command.footer =
      R"(One row per contact: grains, normal, subdomain, impulse of the linear rigid problem under the prescribed
velocity (the least-norm solution for a hyperstatic network, said in impulse_solution), active or not;
with --contacts unilateral those of the frictionless unilateral problem. Of a contact problem: bodies
and subdomain of every contact.
Examples:
  nscdd network disks4
  nscdd network hexagonal --contacts unilateral --set loads.compression=1,1
  nscdd network mine.csv --subdomains 2x2 --prescribed 7:-1:0 --csv links.csv --grains grains.csv)";
  return [options](const Context&) { return run_network(*options); };
}

}  // namespace nscdd::app
