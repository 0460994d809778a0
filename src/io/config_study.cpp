// SPDX-License-Identifier: GPL-3.0-or-later
#include "strict_toml.hpp"
#include <nscdd/io/config.hpp>
#include <nscdd/study/values.hpp>

#include <algorithm>
#include <filesystem>

namespace nscdd {
namespace {

std::string plain(const toml::node& node, const StrictTable& section, std::string_view key) {
  if (node.is_string()) return **node.as_string();
  if (node.is_integer()) return fmt::format("{}", **node.as_integer());
  if (node.is_floating_point()) return fmt::format("{}", **node.as_floating_point());
  section.fail(&node, key, "a number or a text", StrictTable::describe(node));
}

// A list written as one SPEC text, one number, or an array of either.
std::vector<std::string> list(StrictTable& section, std::string_view key) {
  const toml::node* found = section.node(key);
  std::vector<std::string> items;
  if (found == nullptr) return items;
  if (const toml::array* array = found->as_array()) {
    for (const toml::node& element : *array) items.push_back(plain(element, section, key));
    if (items.empty()) section.fail(found, key, "at least one value", "an empty array");
  } else {
    items.push_back(plain(*found, section, key));
  }
  return items;
}

// The SPEC of a sweep parameter handed to its parser; errors name file and line.
template <class Values, class Parser>
void read_spec(StrictTable& section, std::string_view key, Values& values, Parser&& parse) {
  const std::vector<std::string> items = list(section, key);
  if (items.empty()) return;
  std::string spec;
  for (const std::string& item : items) spec += (spec.empty() ? "" : ",") + item;
  try {
    values = parse(spec);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", section.location(section.node(key)), error.what()));
  }
}

Observable read_observable(StrictTable& section) {
  std::string name{observables[0].first}, known;
  section.read("observable", name);
  for (std::size_t i = 0; i < observables.size(); ++i) {
    if (observables[i].first == name) return static_cast<Observable>(i);
    known += (known.empty() ? "" : ", ") + std::string(observables[i].first);
  }
  section.fail("observable", "one of " + known, "\"" + name + "\"");
}

void read_vary(StrictTable& table, StudyTable& result) {
  StrictTable section = table.section("vary", false);
  const toml::node* node = table.node("vary");
  if (node == nullptr) return;
  for (const auto& [key, value] : *node->as_table())
    result.vary.push_back({std::string(key.str()), list(section, key.str())});
  for (const Variation& variation : result.vary)
    for (const std::string& value : variation.values)
      for (Case one : result.cases) try {
          override_case(one, variation.parameter, value);
        } catch (const Error& error) {
          throw Error(
              fmt::format("{}: {}", section.location(section.node(variation.parameter)), error.what()));
        }
}

StudyTable read_table(StrictTable section, const CaseReader& read) {
  StudyTable table;
  section.read("name", table.name);
  if (table.name.empty() ||
      table.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") != std::string::npos)
    section.fail("name", "a name of lower-case letters, digits, '-' and '_'", "'" + table.name + "'");
  if (table.name == "provenance")
    section.fail("name", "a name other than that of the group of origins", "'provenance'");
  table.observable = read_observable(section);
  const std::vector<std::string> cases = list(section, "cases");
  if (cases.empty()) section.fail("cases", "at least one case", "none");
  for (const std::string& name : cases) try {
      table.cases.push_back(read(name));
    } catch (const Error& error) {
      throw Error(
          fmt::format("{}: case '{}': {}", section.location(section.node("cases")), name, error.what()));
    }
  read_vary(section, table);
  read_spec(section, "epsilon", table.sweep.epsilon, parse_epsilon);
  read_spec(section, "eta", table.sweep.eta, parse_eta);
  read_spec(section, "relaxation", table.sweep.relaxation, parse_relaxation);
  read_spec(section, "gauss_seidel_sweeps", table.sweep.gauss_seidel_sweeps, parse_sweeps);
  std::string contacts = "all", solver = "auto";
  section.read("contacts", contacts);
  const std::optional<ContactSet> chosen = contact_set(contacts);
  if (!chosen) section.fail("contacts", "\"all\", \"active\" or \"unilateral\"", "\"" + contacts + "\"");
  table.sweep.contacts = *chosen;
  section.read("solver", solver);
  if (!spectral_solver(solver))
    section.fail("solver", "\"auto\", \"dense\", \"arpack\" or \"shift-invert\"", "\"" + solver + "\"");
  table.sweep.spectral.solver = *spectral_solver(solver);
  section.read("certify", table.sweep.spectral.certify);
  Index seed = 1;
  section.read("seed", seed);
  if (seed < 0) section.fail("seed", "an integer >= 0", fmt::format("{}", seed));
  table.seed = static_cast<std::uint64_t>(seed);
  section.finish();
  return table;
}

}  // namespace

Study parse_study(std::string_view text, const std::string& file, const CaseReader& read) {
  const toml::table document = parse_toml(text, file);
  StrictTable root(document, file, "");
  Study study;
  study.name = std::filesystem::absolute(file).lexically_normal().parent_path().filename().string();
  root.read("title", study.title);
  for (const StrictTable& section : root.tables("table")) study.tables.push_back(read_table(section, read));
  root.finish();
  if (study.tables.empty()) throw Error(fmt::format("{}: expected at least one [[table]], met none", file));
  for (const StudyTable& table : study.tables)
    if (std::count_if(study.tables.begin(), study.tables.end(),
                      [&](const StudyTable& other) { return other.name == table.name; }) > 1)
      throw Error(fmt::format("{}: expected each table name once, met '{}' again", file, table.name));
  return study;
}

}  // namespace nscdd
