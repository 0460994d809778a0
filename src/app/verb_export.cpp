// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/trajectory_export.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

#include <memory>

namespace nscdd::app {
namespace {

struct Options {
  std::string trajectory, folder, steps, output;
  std::optional<Index> step, subdomain;
  bool local = false, force = false;
  Context context;
};

int run(const Options& options) {
  if (options.folder.empty() == !options.step)
    throw Error(
        fmt::format("export: expected either --vtk FOLDER or --fclib STEP, met {}", options.step ? "both" : "neither"));
  if (!options.folder.empty())
    return export_vtk({options.trajectory, options.folder,
                       options.steps.empty() ? StepRange{} : parse_step_range(options.steps), options.force});
  if (options.output.empty()) throw Error("--fclib: expected -o FILE.hdf5 with it, met none");
  return export_fclib(
      {options.trajectory, options.output, *options.step, options.subdomain, options.local, options.force},
      options.context);
}

}  // namespace

StepRange parse_step_range(const std::string& text) {
  std::vector<Index> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    numbers.push_back(parse_integer(text.substr(begin, end - begin), "--steps"));
    begin = end + 1;
  }
  const StepRange range{numbers[0], numbers.size() > 1 ? numbers[1] : numbers[0], numbers.size() > 2 ? numbers[2] : 1};
  if (numbers.size() > 3 || range.first < 0 || range.last < range.first || range.stride < 1)
    throw Error(fmt::format("--steps: expected A, A:B or A:B:K with 0 <= A <= B and K >= 1, met '{}'", text));
  return range;
}

std::string step_ranges_text(const std::vector<Index>& steps) {
  std::string text;
  for (std::size_t i = 0; i < steps.size();) {
    // A range reaches as far as neighbours are equally far apart. Two steps are not a range yet.
    std::size_t last = i;
    while (last + 1 < steps.size() && steps[last + 1] - steps[last] == steps[i + 1] - steps[i]) ++last;
    if (last < i + 2) last = i;
    if (!text.empty()) text += ", ";
    text += fmt::format("{}", steps[i]);
    if (last > i) text += fmt::format(":{}", steps[last]);
    if (last > i && steps[i + 1] - steps[i] > 1) text += fmt::format(":{}", steps[i + 1] - steps[i]);
    i = last + 1;
  }
  return text;
}

std::function<int()> declare_export(Command& command, const Context& context) {
  auto options = std::make_shared<Options>();
  options->context = context;
  command.add_option("RUN", options->trajectory, "trajectory of nscdd simulate, .h5 or .hdf5")->required();
  auto* vtk = command.add_option("--vtk", options->folder,
                                 "write the kept steps there for ParaView: a .vtp file each and a .pvd "
                                 "collection");
  command.add_option("--steps", options->steps, "of --vtk: A, A:B or A:B:K, steps A, A + K, ... up to B that are kept")
      ->needs(vtk);
  auto* fclib =
      command.add_option("--fclib", options->step, "write the contact problem of that step, from 1, as HDF5 of FCLIB");
  fclib->excludes(vtk);
  command.add_option("-o,--output", options->output, "file of --fclib")->needs(fclib);
  command
      .add_option("--subdomain", options->subdomain,
                  "of --fclib: the part of that subdomain, interface impulses as loads")
      ->needs(fclib);
  command.add_flag("--local", options->local, "of --fclib: W and q instead of M, H, f and w")->needs(fclib);
  command.add_flag("--force", options->force, "replace existing outputs");
  command.footer(
      "A step can be written as a contact problem where the state before it is kept; its solution is that of "
      "the\nrun where the step itself is kept.\n"
      "Examples:\n"
      "  nscdd simulate shear-1k --steps 5 --subdomains 2x1 --algorithm generic -o run.h5\n"
      "  nscdd export run.h5 --vtk pictures --steps 0:5\n"
      "  nscdd export run.h5 --fclib 5 -o problem.hdf5\n"
      "  nscdd export run.h5 --fclib 5 --subdomain 1 --local -o part.hdf5\n"
      "  nscdd solve problem.hdf5 --tolerance 1e-6");
  return [options] { return run(*options); };
}

}  // namespace nscdd::app
