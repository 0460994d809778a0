// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/options.hpp"
#include "app/step_range.hpp"
#include "files/output_file.hpp"
#include "formats/report/report_page.hpp"
#include "linalg/threads.hpp"
#include "study/linear/values.hpp"

#include <set>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

constexpr Index most_grains = 300'000;  // that a browser draws at once; the page takes some 80 bytes for each
constexpr double bytes_of_steps = 8e6;  // that the steps of a run take on a page where --steps says nothing

struct Options {
  CaseOptions one;
  SpectralCommandOptions spectral;
  std::string epsilon, eta, output, steps, convergence;
  std::vector<std::string> contacts;
  bool no_optimum = false, force = false;
  Index threads = 0;
  MemoryLimit memory;
};

constexpr const char *epsilon_by_default = "0,1e-3:1e3:7W", *eta_by_default = "1e-3:1e3:25W,inf";

void require_html_name(const std::string& path) {
  if (!path.ends_with(".html") && !path.ends_with(".htm"))
    fail("{}: expected a name that ends in .html, met another", path);
}

// Sliders go up, and have no place twice.
FlexibilityValues ascending(FlexibilityValues values) {
  std::ranges::sort(values.first);
  values.first.erase(std::unique(values.first.begin(), values.first.end()), values.first.end());
  return values;
}

PackingReportParameters parameters(const Options& options, const Machine& machine) {
  PackingReportParameters result;
  SweepParameters& sweep = result.sweep;
  sweep.spectral = options.spectral.spectral();
  sweep.spectral.inertia = machine.inertia;
  std::tie(sweep.epsilon, sweep.relative_epsilon) =
      ascending(parse_epsilon(options.epsilon.empty() ? epsilon_by_default : options.epsilon));
  std::tie(sweep.eta, sweep.relative_eta) = ascending(parse_eta(options.eta.empty() ? eta_by_default : options.eta));
  std::set<ContactSet> sets;
  for (const std::string& name : options.contacts) sets.insert(Choice<ContactSet>::parse(name, "--contacts"));
  result.contact_sets.assign(sets.begin(), sets.end());
  result.optima = !options.no_optimum;
  return result;
}

void require_drawable(const std::string& name, Index disks, std::string_view what) {
  if (disks > most_grains)
    fail("{}: expected at most {} {}, which a page can still show, met {}", name, most_grains, what, disks);
}

void check(const Model& model, const PackingReportParameters& wanted, const MemoryLimit& memory) {
  require_geometry(model, "report");
  require_drawable(model.name, model.grains(), "grains");
  memory.require(link_need(model, ContactSet::active));
  for (const ContactSet contacts : wanted.contact_sets) {
    SweepParameters sweep = wanted.sweep;
    sweep.contacts = contacts;
    memory.require(sweep_need(model, sweep));
  }
}

// Writes the page in one piece, says what it is, and how large.
void write(const std::string& path, const std::string& page, bool force, const std::string& what) {
  write_file(path, page, force);
  fmt::print("{}: {}, {:.3g} MB\n", path, what, 1e-6 * static_cast<double>(page.size()));
}

int nothing_written(const std::string& path) {
  note("{}: interrupted; nothing was written", path);
  return interrupted_exit_code;
}

void note_doubts(const PackingReport& report) {
  Index open = 0;
  for (const RadiusGrid& grid : report.grids)
    for (const SweepResult& point : grid.points)
      if (!point.radius.converged && open++ == 0)
        note("epsilon = {}, eta = {}: not converged: {}", point.point.epsilon, point.point.eta, point.radius.failure);
  if (open > 0) note("{} point(s) did not converge: the page says at which", open);
}

std::string libraries() {
  std::string text;
  for (const auto& [name, number] : dependency_versions()) text += fmt::format("{} {}\n", name, number);
  return text;
}

int report_of_packing(const Options& options, const Context& context) {
  if (!options.steps.empty() || !options.convergence.empty())
    fail("{}: expected the trajectory of a run (.h5) as CASE with it, met {}",
         options.steps.empty() ? "--convergence" : "--steps", options.one.name);
  PackingReportParameters wanted = parameters(options, context.machine);
  require_shared(wanted.sweep.spectral, context.machine);
  const Case one = options.one.resolve({options.output});
  require_writable(options.output, options.force);
  const ThreadLimit limit(options.threads);
  const Model model = build(one, progress("generate"));
  if (wanted.contact_sets.empty()) wanted.contact_sets = contact_sets_of(model);
  check(model, wanted, options.memory);
  Interruption interruption;
  const auto report = report_packing(model, wanted, interruption.watch("report " + model.name, 0, "spectrum"));
  if (!report || interruption.stopped()) return nothing_written(options.output);
  if (model.parts.interface_size() == 0)
    note("{}: the interface is empty ({}): nothing to contract, radius 0", model.name, why_empty(model));
  note_doubts(*report);
  Index modes = 0;
  for (const RadiusGrid& grid : report->grids) modes += count(grid.modes);
  write(options.output,
        packing_page(model, *report, {model.name, context.command_line, to_toml(one.spec), libraries()}), options.force,
        fmt::format("{} grains, {} radii, {} modes", model.grains(), count(report->grids) * point_count(wanted.sweep),
                    modes));
  return 0;
}

// Options that say something of a packing alone.
void require_none_of_packing(const Options& options) {
  const CaseOptions& one = options.one;
  const Options unasked;
  for (const auto& [name, given] :
       {std::pair("--subdomains", !one.subdomains.empty()),
        {"--prescribed", !one.prescribed.empty()},
        {"--set", !one.settings.empty()},
        {"--density", one.density.has_value()},
        {"--tolerance", one.tolerance.has_value()},
        {"--overlap-tolerance", one.overlap_tolerance.has_value()},
        {"--epsilon", !options.epsilon.empty()},
        {"--eta", !options.eta.empty()},
        {"--contacts", !options.contacts.empty()},
        {"--solver", options.spectral.solver != unasked.spectral.solver},
        {"--residual-tolerance", options.spectral.options.tolerance != unasked.spectral.options.tolerance},
        {"--certify", options.spectral.options.certify},
        {"--no-optimum", options.no_optimum},
        {"--threads", options.threads != unasked.threads},
        {"--memory-limit", options.memory.gibibytes.has_value()}})
    if (given) fail("{}: expected a packing as CASE with it, met the trajectory {}", name, one.name);
}

int report_of_run(const Options& options, const Context& context) {
  require_none_of_packing(options);
  const std::string& path = options.one.name;
  require_no_input({options.output}, {path, options.convergence});
  require_writable(options.output, options.force);
  const GranularSystem system = read_trajectory_header(path).system;
  require_drawable(path, system.disks(), system.dimension == 3 ? "spheres" : "disks");
  std::vector<Series> iterations;
  if (!options.convergence.empty()) iterations = read_iterations(options.convergence, path);
  const std::vector<Index> asked = chosen_steps(path, parse_step_range(options.steps));
  const std::vector<Index> steps = options.steps.empty() ? steps_to_draw(path, asked, bytes_of_steps) : asked;
  Interruption interruption;
  auto report = report_run(path, steps, interruption.watch("report " + fs::path(path).filename().string(), 0, "step"));
  if (!report || interruption.stopped()) return nothing_written(options.output);
  report->iterations = std::move(iterations);
  write(options.output, run_page(*report, {report->name, context.command_line, report->header.case_text, libraries()}),
        options.force,
        fmt::format("{} of {} steps drawn, {} {}", steps.size(), count(report->status) + 1,
                    report->header.system.disks(), report->header.system.dimension == 3 ? "spheres" : "disks"));
  return 0;
}

int run(const Options& options, const Context& context) {
  require_html_name(options.output);
  return holds_trajectory(options.one.name) ? report_of_run(options, context) : report_of_packing(options, context);
}

}  // namespace

Action declare_report(Command& command) {
  auto options = std::make_shared<Options>();
  options->one.declare(command, false);
  command.options.front().help.insert(0, "trajectory of nscdd simulate (.h5), or ");
  command.required("-o,--output FILE", options->output, "the page, .html");
  command.add("--force", options->force, "replace an existing page");
  command.add("--epsilon SPEC", options->epsilon,
              fmt::format("flexibilities of the law on the page ({}), as in nscdd sweep", epsilon_by_default));
  command.add("--eta SPEC", options->eta,
              fmt::format("flexibilities of Stage 2 on the page ({}), as in nscdd sweep", eta_by_default));
  command
      .add("--contacts", options->contacts,
           "contacts of Stage 1: all, active or unilateral, may be given again; by default all, and with a load active "
           "too")
      .words = all_names<ContactSet>();
  options->spectral.declare_solver(command);
  command.add("--certify", options->spectral.options.certify,
              "prove by inertia counts that no eigenvalue was missed; the page shows the intervals");
  command.add("--no-optimum", options->no_optimum, "leave out the best eta, which takes some 130 spectra per epsilon");
  command.add("--steps A[:B[:K]]", options->steps,
              "of a run: the kept steps to draw; by default as many as take 8 MB, at least 2, evenly spread");
  command.add("--convergence FILE", options->convergence, "of a run: the table of nscdd simulate --convergence");
  declare_threads(command, options->threads);
  options->memory.declare(command);
  command.footer =
      R"(One page that a browser opens without a network. Of a packing: its grains, subdomains, active contacts and
slowest modes, and the radius over all pairs of epsilon and eta. That takes the time of a sweep over these
pairs and of nscdd optimum; modes are kept up to 4 MB. Of a run: criteria, force chains and energies.
Examples:
  nscdd report disks12 -o disks12.html
  nscdd report mine.csv --subdomains 2x1 --epsilon 0,1e-2:1e2:3W --eta 1e-2:1e2:9W,inf -o mine.html
  nscdd simulate shear-1k --steps 5 -o shear5.h5 --convergence shear5.csv
  nscdd report shear5.h5 --convergence shear5.csv -o shear5.html)";
  return [options](const Context& context) { return run(*options, context); };
}

}  // namespace nscdd::app
