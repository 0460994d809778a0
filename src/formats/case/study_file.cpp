// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "files/strict_toml.hpp"
#include "formats/case/case_file.hpp"
#include "study/linear/values.hpp"
#include "study/moving/solver_trial.hpp"

#include <filesystem>

namespace nscdd {
namespace {

std::string plain(const toml::node& node, const StrictTable& section, std::string_view key) {
  if (node.is_string()) return **node.as_string();
  if (node.is_integer()) return fmt::format("{}", **node.as_integer());
  if (node.is_floating_point()) return fmt::format("{}", **node.as_floating_point());
  section.fail(&node, key, "a number or a text", StrictTable::describe(node));
}

// One SPEC text, one number, or an array of either.
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

// Parses the SPEC of a sweep parameter, if there is one; errors name file and line.
void read_spec(StrictTable& section, std::string_view key, auto parse, auto&& target) {
  const std::vector<std::string> items = list(section, key);
  if (!items.empty()) section.located(key, [&] { target = parse(fmt::format("{}", fmt::join(items, ","))); });
}

const Observable* read_observable(StrictTable& section) {
  std::string name(StudyTable{}.observable->name);
  std::vector<std::string> known;
  section.read("observable", name);
  for (const Observable* one : observables::all) {
    if (one->name == name) return one;
    known.emplace_back(one->name);
  }
  section.fail("observable", fmt::format("one of {}", fmt::join(known, ", ")),
               "\"" + name + "\"" + suggestion(name, known));
}

// The parameters in the table `name`. Each value is tried on every case, for errors with file and line.
std::vector<Variation> read_variations(StrictTable& table, std::string_view name, const std::vector<Case>& cases) {
  StrictTable section = table.section(name, false);
  const toml::node* node = table.node(name);
  std::vector<Variation> variations;
  if (node == nullptr) return variations;
  for (const auto& [key, value] : *node->as_table())
    variations.push_back({std::string(key.str()), list(section, key.str())});
  for (const Variation& variation : variations)
    for (const std::string& value : variation.values)
      for (Case one : cases)
        section.located(variation.parameter, [&] { override_case(one.spec, variation.parameter, value); });
  return variations;
}

void read_vary(StrictTable& table, StudyTable& result) {
  result.vary_together = read_variations(table, "vary_together", result.cases);
  result.vary = read_variations(table, "vary", result.cases);
  for (const Variation& variation : result.vary_together)
    if (variation.values.size() != result.vary_together[0].values.size())
      table.fail("vary_together",
                 fmt::format("{} values of '{}', as of '{}'", result.vary_together[0].values.size(),
                             variation.parameter, result.vary_together[0].parameter),
                 fmt::format("{}", variation.values.size()));
  for (const Variation& variation : result.vary)
    if (std::ranges::count(result.vary_together, variation.parameter, &Variation::parameter) > 0)
      table.fail("vary", "parameters that are not in 'vary_together'", "'" + variation.parameter + "'");
}

void read_tolerances(StrictTable& table, StudyTable& result) {
  constexpr Field not_negative{.minimum = 0};
  table.read("check_tolerance", result.check_tolerance, not_negative);
  StrictTable section = table.section("column_tolerance", false);
  const toml::node* node = table.node("column_tolerance");
  if (node == nullptr) return;
  const std::vector<Column> columns = study_columns(result);
  for (const auto& [key, value] : *node->as_table()) {
    const std::string name(key.str());
    if (std::ranges::count(columns, name, &Column::name) == 0)
      section.fail(&value, name, "a column of the table", "another name");
    section.read(name, result.column_tolerance[name], not_negative);
  }
}

void read_steps(StrictTable& section, StudyTable& table) {
  const std::vector<std::string> items = list(section, "steps");
  if (items.empty()) return;
  table.steps.clear();
  const std::string where = section.location(section.node("steps")) + ": steps";
  const auto least = static_cast<double>(table.observable->first_step);
  for (const std::string& item : items) {
    table.steps.push_back(parse_integer(item, where));
    check_bounds(table.steps.back(), Field{.minimum = least, .maximum = 1e9}, where);
  }
}

// Throws Error for a key that the observable does not use.
void require_uses(const StrictTable& section, const Observable& observable) {
  for (const Observable* other : observables::all)
    for (const std::string_view key : other->keys)
      if (section.has(key) && !observable.uses(key)) {
        std::vector<std::string_view> using_it;
        for (const Observable* one : observables::all)
          if (one->uses(key)) using_it.push_back(one->name);
        section.fail(key, fmt::format("an observable that uses this key ({})", fmt::join(using_it, ", ")),
                     fmt::format("\"{}\"", observable.name));
      }
}

// Throws Error for a varied parameter without effect in all combinations.
void require_effects(const StrictTable& section, const std::string& key, const std::vector<Variation>& variations,
                     const StudyTable& table) {
  for (const Variation& variation : variations) {
    std::optional<Dynamics> dynamics;
    bool effective = false;
    for (Index number = 0; number < varied_case_count(table) && !effective; ++number) {
      dynamics = varied_case(table, number).one.spec.dynamics;
      effective = has_effect(*dynamics, variation.parameter);
    }
    if (!effective) section.located(key, [&] { require_effect(*dynamics, variation.parameter, variation.parameter); });
  }
}

// Checks cases that move before they are settled and run.
void check_moving(StrictTable& section, const StudyTable& table) {
  if (!table.observable->moving) return;
  for (Index number = 0; number < varied_case_count(table); ++number) {
    const CaseSpec one = varied_case(table, number).one.spec;
    const auto check = [&] {
      check_dynamics(one);
      if (table.observable->check != nullptr) table.observable->check(one);
    };
    section.located("cases", check, fmt::format("case '{}': ", one.name));
  }
  require_effects(section, "vary", table.vary, table);
  require_effects(section, "vary_together", table.vary_together, table);
}

void read_coarse(StrictTable& section, CoarseParameters& coarse) {
  const auto names = [&section](const std::string& key, auto& all) {
    using Enum = typename std::decay_t<decltype(all)>::value_type;
    read_spec(
        section, key, [&](std::string_view spec) { return parse_names<Enum>(spec, key); }, all);
  };
  names("preconditioner", coarse.preconditioners);
  names("scaling", coarse.scalings);
  names("coarse_space", coarse.spaces);
  if (section.has("kappa")) section.read("kappa", coarse.kappa.emplace());
  if (section.has("threshold")) section.read("threshold", coarse.threshold.emplace());
  section.read("counts", coarse.counts);
  section.located("coarse_space", [&] { check_coarse(coarse); });
}

StudyTable read_table(StrictTable section, const CaseFinder& find) {
  StudyTable table;
  section.read("name", table.name);
  if (table.name.empty() || table.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") != std::string::npos)
    section.fail("name", "a name of lower-case letters, digits, '-' and '_'", "'" + table.name + "'");
  if (table.name == "provenance")
    section.fail("name", "a name other than that of the group of origins", "'provenance'");
  table.observable = read_observable(section);
  require_uses(section, *table.observable);
  section.read("large", table.large);
  const std::vector<std::string> cases = list(section, "cases");
  if (cases.empty()) section.fail("cases", "at least one case", "none");
  for (const std::string& name : cases)
    table.cases.push_back({section.located(
        "cases", [&] { return find(name); }, fmt::format("case '{}': ", name))});
  read_vary(section, table);
  check_moving(section, table);
  SweepParameters& sweep = table.sweep;
  read_spec(section, "epsilon", parse_epsilon, std::tie(sweep.epsilon, sweep.relative_epsilon));
  read_spec(section, "eta", parse_eta, std::tie(sweep.eta, sweep.relative_eta));
  read_spec(section, "relaxation", parse_relaxation, sweep.relaxation);
  read_spec(section, "gauss_seidel_sweeps", parse_sweeps, sweep.gauss_seidel_sweeps);
  section.read("contacts", sweep.contacts);
  read_coarse(section, table.coarse);
  section.read("scheme", sweep.scheme);
  SpectralOptions::fields(sweep.spectral, [&](std::string_view key, auto& value, const Field& field) {
    if (table.observable->uses(key)) section.read(key, value, field);
  });
  section.located("certify", [&] { check(sweep.spectral); });
  section.located(sweep.schwarz() ? "scheme" : "gauss_seidel_sweeps", [&] { check_sweep(sweep); });
  Index seed = 1;
  section.read("seed", seed);
  if (seed < 0) section.fail("seed", "an integer >= 0", fmt::format("{}", seed));
  table.seed = static_cast<std::uint64_t>(seed);
  read_steps(section, table);
  if (table.observable->own_solver) table.lead_in = LeadInSolver::own;
  section.read("lead_in", table.lead_in);
  if (table.observable->own_solver && table.lead_in != LeadInSolver::own)
    section.fail("lead_in", "\"own\", as runs always are", "\"plain\"");
  if (const std::vector<std::string> names = list(section, "contact_solvers"); !names.empty()) {
    table.contact_solvers = names;
    section.located("contact_solvers", [&] { contact_solvers_named(names, "contact_solvers"); });
  }
  section.read("baseline", table.baseline);
  section.read("check_relative", table.check_relative);
  read_tolerances(section, table);
  section.finish();
  return table;
}

}  // namespace

Study parse_study(std::string_view text, const std::string& file, const CaseFinder& find) {
  const toml::table document = parse_toml(text, file);
  StrictTable root(document, file, "");
  Study study;
  study.name = std::filesystem::absolute(file).lexically_normal().parent_path().filename().string();
  root.read("title", study.title);
  for (const StrictTable& section : root.tables("table")) study.tables.push_back(read_table(section, find));
  root.finish();
  if (study.tables.empty()) fail("{}: expected at least one [[table]], met none", file);
  if (study.tables[0].large) fail("{}: expected a first table that is always run, met large = true", file);
  for (const StudyTable& table : study.tables)
    if (std::ranges::count(study.tables, table.name, &StudyTable::name) > 1)
      fail("{}: expected each table name once, met '{}' again", file, table.name);
  return study;
}

}  // namespace nscdd
