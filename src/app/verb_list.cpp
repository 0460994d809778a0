// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "study/tables/study.hpp"

namespace nscdd::app {
namespace {

template <class Parameters>
void print_fields(const std::string& section) {
  for (const FieldDescription& field : describe_fields(Parameters{}))
    fmt::print("      {:<44} {} [{}{}{}]\n", section + field.key + " = " + field.value, field.description,
               field.words.empty() ? field.type : fmt::format("{}", fmt::join(field.words, ", ")),
               field.unit == "1" ? "" : ", ", field.unit == "1" ? "" : field.unit);
}

template <class... Alternatives>
void print_alternatives(const std::variant<Alternatives...>&, const std::string& section) {
  const auto print = [&]<class Alternative>(const Alternative&) {
    fmt::print("  {:<16}{}\n", Alternative::name, Alternative::summary);
    print_fields<Alternative>(section);
  };
  (print(Alternatives{}), ...);
}

int print_names(const std::string& indent, const std::string& kind) {
  for (const std::string& name : known_names(kind)) fmt::print("{}{}\n", indent, name);
  return 0;
}

int list() {
  fmt::print("Cases\n");
  print_names("  ", "cases");
  fmt::print("Studies\n");
  print_names("  ", "studies");
  fmt::print("Generators of packings, [packing] generator = \"...\"\n");
  print_alternatives(Generator{}, "packing.");
  fmt::print("Partitioners, [partition]\n");
  print_alternatives(Partitioner{}, "partition.");
  fmt::print("Contact detection, [contacts]\n");
  print_fields<ContactDetection>("contacts.");
  fmt::print("Loads on every grain, [loads]\n");
  print_fields<Loads>("loads.");
  fmt::print("Cases that move: [interaction], [dynamics], [solver]\n");
  print_fields<Interaction>("interaction.");
  print_fields<TimeStepping>("dynamics.");
  print_fields<StepSolver>("solver.");
  fmt::print("Observables of a study, observable = \"...\"\n");
  for (const Observable* one : observables::all) fmt::print("  {:<22}{}\n", one->name, one->summary);
  return 0;
}

}  // namespace

Action declare_list(Command& command) {
  auto names = std::make_shared<std::string>();
  command.add("--names", *names, "only the names of those, one a line: cases or studies").words = {"cases", "studies"};
  command.footer = R"(Examples:
  nscdd list
  nscdd list --names cases)";
  return [names](const Context&) { return names->empty() ? list() : print_names("", *names); };
}

}  // namespace nscdd::app
