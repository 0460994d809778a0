// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "study/linear/inspection.hpp"

namespace nscdd::app {
namespace {

struct InspectOptions {
  CaseOptions one;
  std::string histogram;
  bool ranks = false, force = false;
  Limits limits;
};

void print_degrees(const std::string& name, const NetworkDegrees& network, bool ranks) {
  const auto text = [&](Index value) { return ranks ? fmt::format("{}", value) : "-"; };
  fmt::print("{:<12}{:>9}{:>11}{:>8}{:>14}{:>17}\n", name, network.grains, network.contacts, text(network.rank),
             text(network.rigid_modes), text(network.hyperstaticity));
}

void print_network(const Model& model, const Inspection& found, Index ranks_up_to) {
  fmt::print("case                 {}\n", model.name);
  fmt::print("grains               {}\n", model.grains());
  fmt::print("  touching nothing   {}\n", found.isolated_grains);
  fmt::print("contacts             {}\n", model.contacts());
  const bool friction = model.problem.columns_per_contact > 1;
  if (friction)
    fmt::print("  links              {} (normal and {} of each contact)\n", model.problem.contacts(),
               model.problem.dimension == 2 ? "tangent" : "two tangents");
  fmt::print("coordination number  {:.6g}\n", found.coordination_number);
  const std::string scale = fmt::format("{:.6g} 1/kg (scale of eta and epsilon)", flexibility_scale(model));
  fmt::print("mean of W_nn         {}\n", model.contacts() == 0 ? "- (no contact)" : scale);
  fmt::print("connected pieces     {}\n", found.components);
  fmt::print("subdomains           {} ({} without a contact)\n", model.partition.subdomains, found.empty_subdomains);
  fmt::print("interface unknowns   {}{}\n", found.interface_dofs,
             found.interface_dofs > 0 ? "" : fmt::format(" (empty interface: {})", why_empty(model)));
  for (const auto& [multiplicity, grains] : found.interface_grains)
    fmt::print("  grains shared by {:<3} {}\n", multiplicity, grains);
  if (found.ranks) {
    fmt::print("unit eigenvalues of B_0  {} (self-stresses across the interface)\n\n", found.unit_multiplicity);
  } else {
    fmt::print("unit eigenvalues of B_0  not computed, nor ranks (more than {} contacts; --ranks asks for them)\n\n",
               ranks_up_to);
  }
  fmt::print("{:<12}{:>9}{:>11}{:>8}{:>14}{:>17}\n", "subdomain", "grains", friction ? "links" : "contacts", "rank W",
             "rigid modes", "hyperstaticity");
  for (std::size_t e = 0; e < found.subdomains.size(); ++e)
    print_degrees(fmt::format("{}", e), found.subdomains[e], found.ranks);
  print_degrees("whole", found.whole, found.ranks);
}

// Prints nothing if no contact depends on rounding.
void print_rounding(const RoundingDoubt& doubt) {
  if (doubt.decided.size + doubt.open.size == 0) return;
  fmt::print("\ndigits               {} (gaps are known to {:.2g} of the smaller radius)\n", doubt.digits,
             doubt.uncertainty);
  fmt::print("  contacts by them   {} (beyond the tolerances, within the digits)\n", doubt.decided.size);
  fmt::print(
      "  pairs in doubt     {} ({})\n", doubt.open.size,
      doubt.used ? "apart by at most three times this uncertainty" : "apart by less: the digits are taken as exact");
}

void print_geometry(const Inspection& found, Index dimension, bool periodic) {
  fmt::print("\nsolid fraction       {:.6g} (grain {} over {})\n", found.solid_fraction.box,
             dimension == 2 ? "area" : "volume",
             periodic ? "the box around all grains, or the cell where it repeats itself" : "the box around all grains");
  fmt::print("  in the middle      {:.6g} (in that box at half width{} and half height)\n", found.solid_fraction.middle,
             dimension == 2 ? "" : ", half depth");
  if (found.largest_overlap > ContactDetection{}.overlap_tolerance)
    fmt::print("largest overlap      {:.6g} of the smaller radius\n", found.largest_overlap);
  fmt::print("rattlers             {} (fewer than {} contacts, without other rattlers)\n", found.rattlers, dimension);
  fmt::print("  coordination number without them  {}\n\n",
             std::isnan(found.coordination_without_rattlers)
                 ? "- (every grain is one)"
                 : fmt::format("{:.6g}", found.coordination_without_rattlers));
  Index most = 1;
  for (const SizeClass& one : found.sizes) most = std::max(most, one.grains);
  fmt::print("{:<25}{:>9}\n", "radius, m", "grains");
  for (const SizeClass& one : found.sizes)
    fmt::print("{:<25}{:>9}  {:#<{}}\n", fmt::format("{:.6g} ... {:.6g}", one.from, one.to), one.grains, "",
               (40 * one.grains + most / 2) / most);
}

int run_inspect(const InspectOptions& options) {
  options.limits.limit_memory();
  if (options.histogram == "-") fail("--histogram: expected a file name, met -; standard output is for the report");
  const Case one = options.one.resolve({options.histogram});
  const ResultColumns<GrainSizes>& columns = size_columns(dimension_of(one).value_or(2));
  std::optional<CsvWriter> histogram;
  if (!options.histogram.empty()) histogram.emplace(options.histogram, options.force, headings(columns));
  const Model model = build(with_overlaps_of_motion(one), progress("generate"));
  const Index ranks_up_to = options.ranks ? std::numeric_limits<Index>::max() : ranks_up_to_by_default;
  const Inspection found = inspect(model, ranks_up_to);
  if (histogram) {
    grain_sizes(model, [&](const GrainSizes& sizes) { histogram->write(row(columns, sizes)); });
    histogram->finish();
  }
  print_network(model, found, ranks_up_to);
  if (model.has_geometry()) print_geometry(found, model.problem.dimension, model.network.period.any());
  print_rounding(model.network.rounding);
  return 0;
}

}  // namespace

Action declare_inspect(Command& command) {
  auto options = std::make_shared<InspectOptions>();
  options->one.declare(command);
  command.add("--ranks", options->ranks, "compute ranks however large the network is");
  command.add("--histogram FILE", options->histogram, "also write the sizes of the grains there, as CSV");
  command.add("--force", options->force, "replace an existing output");
  options->limits.declare_memory(command);
  command.footer = R"(Examples:
  nscdd inspect disks12
  nscdd inspect mine.csv --subdomains 3x2
  nscdd inspect deposit --histogram sizes.csv
A case that moves is inspected at its start, without its boundaries; overlaps are accepted up to those
that its simulation accepts.)";
  // The rank of the whole packing takes nearly all of the time and is not shared: MPI rank 0 does the work.
  return [options](const Context& context) {
    const Processes& all = context.machine.processes;
    return all.together([&] { return all.first() ? run_inspect(*options) : 0; });
  };
}

}  // namespace nscdd::app
