// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "study/linear/inspection.hpp"
#include "study/linear/modes.hpp"
#include "study/linear/values.hpp"

namespace nscdd::app {
namespace {

constexpr std::size_t interfaces_shown = 8;

struct ModesOptions {
  CaseOptions one;
  ModeParameters wanted;
  std::string epsilon, eta = "inf", output;
  bool force = false;
  Limits limits;
};

// `scale`: of relative flexibilities, 1/kg.
ModeParameters parameters(const ModesOptions& options, const Machine& machine, double scale) {
  ModeParameters result = options.wanted;
  result.epsilon = one_value(parse_epsilon(options.epsilon), scale, "--epsilon NUMBER[W]", options.epsilon);
  result.eta = one_value(parse_eta(options.eta), scale, "--eta", options.eta);
  result.spectral = spectra_on(machine, result.spectral);
  check_sweep({.eta = {result.eta}, .spectral = result.spectral, .scheme = result.scheme}, "--");
  return result;
}

void print_spectrum(const Model& model, const ModeParameters& parameters, const Mode& mode) {
  fmt::print("case                 {}\n", model.name);
  fmt::print("interface unknowns   {}{}\n", model.parts.interface_size(),
             model.parts.interface_size() == 0 ? fmt::format(" (empty interface: {})", why_empty(model)) : "");
  fmt::print("epsilon              {} 1/kg\n", field_text(parameters.epsilon));
  fmt::print("eta                  {} 1/kg\n", field_text(parameters.eta));
  const std::string scale = field_text(flexibility_scale(model)) + " 1/kg";
  fmt::print("mean of W_nn         {}\n", model.contacts() == 0 ? "- (no contact)" : scale);
  fmt::print("contacts of Stage 1  {}\n", to_string(parameters.contacts));
  if (parameters.scheme == DecompositionScheme::schwarz) fmt::print("scheme               schwarz\n");
  fmt::print("spectral radius      {}\n", field_text(mode.spectrum.value));
  if (mode.spectrum.unit_multiplicity > 0)
    fmt::print("  without {} unit eigenvalue(s)  {}\n", mode.spectrum.unit_multiplicity,
               field_text(mode.spectrum.subdominant));
  fmt::print("solver               {}\n", mode.spectrum.solver);
}

void print_end(const Mode& mode, const SpectralOptions& options) {
  const bool low = mode.side == SpectrumSide::low;
  fmt::print("mode                 {} end\n", to_string(mode.side));
  fmt::print("  eigenvalue         {}\n", field_text(mode.eigenvalue));
  const std::vector<double>& values = low ? mode.spectrum.low : mode.spectrum.high;
  for (Index k = 1; k < std::max<Index>(options.eigenvalues, 2); ++k)
    fmt::print("  next inwards       {}\n", k < count(values) ? field_text(values[at(k)]) : "not computed");
  if (std::abs(mode.next - mode.eigenvalue) <= std::max(options.tolerance, mode.residual))
    fmt::print("    the same within the tolerance: the mode is one of several\n");
  if (options.certify) {
    const auto& interval = low ? mode.spectrum.interval_min : mode.spectrum.interval_max;
    fmt::print("  certified          {}\n", mode.spectrum.certified
                                                ? fmt::format("{} eigenvalue(s) in [{}, {}], none further out",
                                                              low ? mode.spectrum.within_min : mode.spectrum.within_max,
                                                              field_text(interval[0]), field_text(interval[1]))
                                                : "no");
  }
  fmt::print("  residual           {:.3g}\n", mode.residual);
}

void print_shares(const Mode& mode, std::string_view rows) {
  fmt::print("  spread over        {:.1f} of {} {}\n\n", spread(mode), mode.rows.gluing().size(), rows);
  fmt::print("{:<14}{:>7}{:>12}\n", "subdomains", "rows", "share");
  const auto print = [](const std::string& name, const InterfaceShare& pair) {
    const double percent = 100 * pair.share;
    fmt::print("{:<14}{:>7}{:>10.2f} %\n", name, pair.rows, std::abs(percent) < 0.005 ? 0.0 : percent);
  };
  InterfaceShare rest;
  std::size_t shown = 0;
  for (const InterfaceShare& share : shares_by_interface(mode))
    if (shown++ < interfaces_shown) {
      print(share.first < 0 ? fmt::format("{}", share.second) : fmt::format("{} | {}", share.first, share.second),
            share);
    } else {
      rest.rows += share.rows;
      rest.share += share.share;
    }
  if (rest.rows > 0) print("others", rest);
}

void tell_doubts(const Model& model, const Mode& mode) {
  if (mode.spectrum.solver == "none") {
    note("{}: the interface is empty ({}): there is no mode, the tables have no rows", model.name, why_empty(model));
  } else if (!mode.found() && mode.spectrum.converged) {
    note("every eigenvalue is the same: there is no mode of its own, the tables have no rows");
  } else if (!mode.found()) {
    note("no solver converged: there is no mode, the tables have no rows: {}", mode.spectrum.failure);
  } else if (!mode.converged) {
    note("the mode did not converge: see its residual");
  } else if (!mode.spectrum.converged) {
    note("the ends of the spectrum did not converge: a mode further out may be missed: {}", mode.spectrum.failure);
  }
}

int run_modes(const ModesOptions& options, const Machine& machine) {
  if (options.output.empty() || options.output == "-" || options.output.back() == '/')
    fail("--output: expected a prefix of file names such as slow or results/slow, met '{}'", options.output);
  parameters(options, machine, 1);  // refused before the model is built
  const ThreadLimit limit = options.limits.apply(machine);
  const std::string impulses_name = options.output + "-impulses.csv";
  const std::string velocities_name = options.output + "-velocities.csv";
  const Case what = options.one.resolve({impulses_name, velocities_name});
  const Model model = build(what);
  const ResultColumns<ModeImpulse>& impulse_columns = mode_impulse_columns(model.problem.dimension);
  const ResultColumns<ModeVelocity>& velocity_columns = mode_velocity_columns(model.problem.dimension);
  // Files are opened before the work and named after it: a run that fails leaves none.
  CsvWriter impulses(impulses_name, options.force, headings(impulse_columns));
  CsvWriter velocities(velocities_name, options.force, headings(velocity_columns));
  const ModeParameters wanted = parameters(options, machine, flexibility_scale(model));
  const Mode mode = interface_mode(model, wanted);
  mode_impulses(model, wanted, mode, [&](const ModeImpulse& one) { impulses.write(row(impulse_columns, one)); });
  mode_velocities(model, mode, [&](const ModeVelocity& one) { velocities.write(row(velocity_columns, one)); });
  impulses.finish();
  velocities.finish();
  print_spectrum(model, wanted, mode);
  if (mode.found()) {
    print_end(mode, wanted.spectral);
    print_shares(mode, wanted.scheme == DecompositionScheme::schwarz ? "copies" : "gluing rows");
  }
  tell_doubts(model, mode);
  return 0;
}

}  // namespace

Action declare_modes(Command& command) {
  auto options = std::make_shared<ModesOptions>();
  options->one.declare(command);
  command.required("--epsilon NUMBER[W]", options->epsilon,
                   "flexibility of the linear law, 1/kg, or times the mean of W_nn (0.1W); 0 is the rigid limit");
  command.preset("--eta NUMBER[W]", options->eta,
                 "flexibility Stage 2 sees, 1/kg, or times the mean of W_nn (10W); inf is the generic algorithm");
  declare_contacts(command, options->wanted.contacts);
  declare_scheme(command, options->wanted.scheme);
  command.fields(options->wanted.spectral);
  command.preset("--end", options->wanted.side,
                 "of the spectrum, unit eigenvalues apart: slowest (larger modulus), low or high");
  command.required("--output PREFIX", options->output, "the tables PREFIX-impulses.csv and PREFIX-velocities.csv");
  command.add("--force", options->force, "replace existing outputs");
  options->limits.declare(command);
  command.footer = R"(The mode is the error that the iteration is left with in the end: interface impulses F with
B F = (eigenvalue) F, and the velocities that Stage 1 answers them with. Draw it with
  plots/modes.py PREFIX mode.svg
A contact problem has no places of bodies: its tables have nan there, and no picture.
Examples:
  nscdd modes hexagonal --epsilon 1e-3 --output slow
  nscdd modes mine.csv --subdomains 3x2 --epsilon 1e-3 --eta 0.3 --end low --output low)";
  return [options](const Context& context) { return run_modes(*options, context.machine); };
}

}  // namespace nscdd::app
