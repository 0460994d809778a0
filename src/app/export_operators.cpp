// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export_operators.hpp"

#include "app/shared_work.hpp"
#include "formats/matrices/operators_file.hpp"
#include "linalg/threads.hpp"
#include "study/linear/inspection.hpp"
#include "study/linear/values.hpp"

namespace nscdd::app {
namespace {

// `scale`: of relative flexibilities, 1/kg
OperatorParameters parameters(const OperatorsOptions& options, double scale) {
  OperatorParameters result{.dense = !options.sparse_only};
  if (options.sparse_only) return result;
  if (options.epsilon.empty())
    fail("--epsilon: expected the flexibility behind S with --operators, or --sparse-only to leave S, P and B out");
  result.epsilon = one_value(parse_epsilon(options.epsilon), scale, "--epsilon NUMBER[W]", options.epsilon);
  result.eta = one_value(parse_eta(options.eta), scale, "--eta", options.eta);
  result.relaxation = options.relaxation;
  return result;
}

void print_report(const OperatorsOptions& options, const Model& model, const OperatorParameters& wanted,
                  Index operators) {
  const std::string manifest = (std::filesystem::path(options.folder) / OperatorsFolder::manifest_name).string();
  fmt::print("{}: {} operators of {}, {} interface unknowns", manifest, operators, model.name,
             model.parts.interface_size());
  if (wanted.dense) fmt::print(", epsilon {} 1/kg, eta {} 1/kg", field_text(wanted.epsilon), field_text(wanted.eta));
  fmt::print("\n");
}

}  // namespace

Option& declare_operators(Command& command, OperatorsOptions& options) {
  Option& operators = command.add("--operators FOLDER", options.folder,
                                  "write M, H, W, S, P, B and more there, as Matrix Market and HDF5");
  const std::size_t first = command.options.size();
  options.one.declare_options(command);
  Option& sparse = command.add("--sparse-only", options.sparse_only, "leave the dense S, P and B out");
  command.add("--epsilon NUMBER[W]", options.epsilon,
              "flexibility of the linear law, 1/kg, or times the mean of W_nn (0.1W); 0 is the rigid limit");
  command.preset("--eta NUMBER[W]", options.eta,
                 "flexibility Stage 2 sees, 1/kg, or times the mean of W_nn (10W); inf is the generic algorithm");
  command.preset("--relaxation", options.relaxation, "omega of B = I - omega P^-1 S",
                 {.description = "", .minimum = 0, .minimum_excluded = true});
  declare_contacts(command, options.contacts);
  declare_threads(command, options.threads);
  options.memory.declare(command);
  for (std::size_t k = first; k < command.options.size(); ++k) {
    Option& option = command.options[k];
    option.needs = &operators;
    if (option.names == "--epsilon" || option.names == "--eta" || option.names == "--relaxation")
      option.excludes = &sparse;
  }
  return operators;
}

int export_operators(const OperatorsOptions& options, bool force, const Context& context) {
  parameters(options, 1);  // refused before the model is built
  options.memory.apply();
  const std::filesystem::path path(options.folder);
  const Case what = options.one.resolve(
      {(path / OperatorsFolder::manifest_name).string(), (path / OperatorsFolder::hdf5_name).string()});
  OperatorsFolder folder(options.folder, force, "nscdd " + version());
  const ThreadLimit limit(options.threads);
  const Model model = build(what);
  const OperatorParameters wanted = parameters(options, flexibility_scale(model));
  const Selection selection = select(model, options.contacts);
  if (!selection.certain) note("{}: the impulses behind the contacts of Stage 1 were not found to 1e-8", model.name);
  if (model.parts.interface_size() == 0)
    note("{}: the interface is empty ({}): there are no operators of it", model.name, why_empty(model));
  Index operators = 0;
  Interruption interruption;
  const auto add = [&](const CaseOperator& one) {
    folder.add(one);
    ++operators;
  };
  if (!case_operators(model, selection, wanted, add, interruption.watch("B", 0, "column"))) {
    note("{}: interrupted; nothing is left there", options.folder);
    return interrupted_exit_code;
  }
  OperatorsHead head{selection.of_case, model.problem.dofs_per_grain, {}};
  if (wanted.dense) head.dense = wanted;
  folder.finish(head, provenance(context, {what}));
  print_report(options, model, wanted, operators);
  return 0;
}

}  // namespace nscdd::app
