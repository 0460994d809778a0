// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/export_steps.hpp"
#include "app/shared_work.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/report/report_page.hpp"
#include "study/linear/values.hpp"

namespace nscdd::app {
namespace {

constexpr Index most_grains = 300'000;  // that a browser draws at once; some 80 bytes each on the page
constexpr double bytes_of_steps = 8e6;  // default size of the steps of a run on a page

constexpr const char* nothing_written = "{}: interrupted; nothing was written";

struct ReportOptions {
  CaseOptions one;
  SweepParameters sweep;
  std::string epsilon = "0,1e-3:1e3:7W", eta = "1e-3:1e3:25W,inf", output, steps, convergence;
  std::vector<std::string> contacts;
  bool no_optimum = false, force = false;
  Limits limits;
};

// Options of runs, and of runs and packings. All others are of packings.
constexpr std::array<std::string_view, 2> of_runs{"--steps", "--convergence"};
constexpr std::array<std::string_view, 3> of_both{"CASE", "-o,--output", "--force"};

PackingReportParameters parameters(const ReportOptions& options, const Machine& machine) {
  PackingReportParameters result;
  SweepParameters& sweep = result.sweep = options.sweep;
  sweep.spectral = spectra_on(machine, sweep.spectral);
  std::tie(sweep.epsilon, sweep.relative_epsilon) = parse_epsilon(options.epsilon);
  std::tie(sweep.eta, sweep.relative_eta) = parse_eta(options.eta);
  if (sweep.schwarz() && options.eta == ReportOptions{}.eta) std::tie(sweep.eta, sweep.relative_eta) = parse_eta("inf");
  check_sweep(sweep, "--");
  for (auto* of_slider : {&sweep.epsilon, &sweep.eta}) sort_unique(*of_slider);
  for (const std::string& name : options.contacts)
    result.contact_sets.push_back(Choice<ContactSet>::parse(name, "--contacts"));
  sort_unique(result.contact_sets);
  result.optima = !options.no_optimum && !sweep.schwarz();  // the best eta
  return result;
}

void require_drawable(const std::string& name, Index disks, std::string_view what) {
  if (disks > most_grains)
    fail("{}: expected at most {} {}, which a page can still show, met {}", name, most_grains, what, disks);
}

void write(const std::string& path, const std::string& page, bool force, const std::string& what) {
  write_file(path, page, force);
  fmt::print("{}: {}, {:.3g} MB\n", path, what, 1e-6 * static_cast<double>(page.size()));
}

void note_doubts(const PackingReport& report) {
  Index open = 0;
  for (const RadiusGrid& grid : report.grids)
    for (const SweepResult& point : grid.points)
      if (!point.radius.converged && open++ == 0)
        note("epsilon = {}, eta = {}: not converged: {}", point.point.epsilon, point.point.eta, point.radius.failure);
  if (open > 0) note("{} point(s) did not converge: the page says at which", open);
}

int report_of_packing(const ReportOptions& options, const Context& context) {
  const ThreadLimit limit = options.limits.apply(context.machine);
  PackingReportParameters wanted = parameters(options, context.machine);
  const Case one = options.one.resolve({options.output});
  require_writable(options.output, options.force);
  const Model model = build(one, progress("generate"));
  if (wanted.contact_sets.empty()) wanted.contact_sets = contact_sets_of(model);
  std::optional<ProblemReport> problem;
  if (!model.has_geometry()) {
    const std::string& name = std::get<ContactProblemFile>(one.spec.packing).path;  // with :ID_k of a record
    const std::string path = (std::filesystem::path(one.spec.source).parent_path() / name).string();
    problem = report_problem(model, read_contact_problem(path), path);
  }
  const std::string_view bodies = problem ? "bodies" : "grains";
  require_drawable(model.name, model.grains(), bodies);
  Interruption interruption;
  const auto report = report_packing(model, wanted, interruption.watch("report " + model.name, 0, "spectrum"));
  if (!report || interruption.stopped()) return interrupted(nothing_written, options.output);
  if (model.parts.interface_size() == 0)
    note("{}: the interface is empty ({}): nothing to contract, radius 0", model.name, why_empty(model));
  note_doubts(*report);
  Index modes = 0;
  for (const RadiusGrid& grid : report->grids) modes += count(grid.modes);
  write(options.output,
        packing_page(model, *report, problem ? &*problem : nullptr,
                     {model.name, context.command_line, to_toml(one.spec), libraries()}),
        options.force,
        fmt::format("{} {}, {} radii, {} modes", model.grains(), bodies,
                    count(report->grids) * point_count(wanted.sweep), modes));
  return 0;
}

int report_of_run(const ReportOptions& options, const Context& context) {
  const std::string& path = options.one.name;
  require_no_input({options.output}, {path, options.convergence});
  require_writable(options.output, options.force);
  const GranularSystem system = read_trajectory_header(path).system;
  require_drawable(path, system.grains(), system.dimension == 3 ? "spheres" : "disks");
  std::vector<Series> iterations;
  if (!options.convergence.empty()) iterations = read_iterations(options.convergence, path);
  const std::vector<Index> asked = chosen_steps(path, options.steps);
  const std::vector<Index> steps = options.steps.empty() ? steps_to_draw(path, asked, bytes_of_steps) : asked;
  Interruption interruption;
  auto report = report_run(path, steps,
                           interruption.watch("report " + std::filesystem::path(path).filename().string(), 0, "step"));
  if (!report || interruption.stopped()) return interrupted(nothing_written, options.output);
  report->iterations = std::move(iterations);
  write(options.output, run_page(*report, {report->name, context.command_line, report->header.case_text, libraries()}),
        options.force,
        fmt::format("{} of {} steps drawn, {} {}", steps.size(), count(report->status) + 1,
                    report->header.system.grains(), report->header.system.dimension == 3 ? "spheres" : "disks"));
  return 0;
}

int run_report(const ReportOptions& options, const Command& command, const Context& context) {
  if (!options.output.ends_with(".html") && !options.output.ends_with(".htm"))
    fail("{}: expected a name that ends in .html, met another", options.output);
  const bool trajectory = holds_trajectory(options.one.name);
  const auto is_of = [](const auto& names, const Option& option) {
    return std::ranges::count(names, option.names) > 0;
  };
  for (const Option& option : command.options)
    if (option.given && !is_of(of_both, option) && is_of(of_runs, option) != trajectory)
      fail("{}: expected {} as CASE with it, met {}{}", option.names,
           trajectory ? "a packing or contact problem" : "the trajectory of a run (.h5)",
           trajectory ? "the trajectory " : "", options.one.name);
  return trajectory ? report_of_run(options, context) : report_of_packing(options, context);
}

}  // namespace

Action declare_report(Command& command) {
  auto options = std::make_shared<ReportOptions>();
  options->one.declare(command);
  command.options.front().help.insert(0, "trajectory of nscdd simulate (.h5), or ");
  command.required("-o,--output FILE", options->output, "the page, .html");
  command.add("--force", options->force, "replace an existing page");
  command.add("--epsilon SPEC", options->epsilon,
              fmt::format("flexibilities of the law on the page ({}), as in nscdd sweep", options->epsilon));
  command.add("--eta SPEC", options->eta,
              fmt::format("flexibilities of Stage 2 on the page ({}), as in nscdd sweep", options->eta));
  command
      .add("--contacts", options->contacts,
           "contacts of Stage 1: all, active, unilateral or frozen; may be given again; by default all, and with a "
           "load active too")
      .words = all_names<ContactSet>();
  declare_scheme(command, options->sweep.scheme);
  command.fields(options->sweep.spectral, {"eigenvalues"});
  command.named("--certify").help += "; the page shows the intervals";
  command.add("--no-optimum", options->no_optimum, "leave out the best eta, which takes some 130 spectra per epsilon");
  command.add("--steps A[:B[:K]]", options->steps,
              "of a run: the kept steps to draw; by default as many as take 8 MB, at least 2, evenly spread");
  command.add("--convergence FILE", options->convergence, "of a run: the table of nscdd simulate --convergence");
  options->limits.declare(command);
  command.footer =
      R"(One page that a browser opens without a network. Of a packing: its grains, subdomains, active contacts and
slowest modes, and the radius over all pairs of epsilon and eta. That takes the time of a sweep over these
pairs and of nscdd optimum; modes are kept up to 4 MB. Of a contact problem with M and H: the same with its
ranks, W and guesses, and a picture if the file has the points of its contacts. Of a run: criteria, force
chains and energies.
Examples:
  nscdd report disks12 -o disks12.html
  nscdd report mine.csv --subdomains 2x1 --epsilon 0,1e-2:1e2:3W --eta 1e-2:1e2:9W,inf -o mine.html
  nscdd simulate shear-1k --steps 5 -o shear5.h5 --convergence shear5.csv
  nscdd report shear5.h5 --convergence shear5.csv -o shear5.html)";
  return [options, &command](const Context& context) { return run_report(*options, command, context); };
}

}  // namespace nscdd::app
