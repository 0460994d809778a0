// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/settled_cases.hpp"

#include "app/simulate_output.hpp"
#include "formats/case/case_file.hpp"
#include "formats/lmgc90/record.hpp"
#include "study/linear/inspection.hpp"
#include <nscdd/formats/packing_file.hpp>

#include <cstdlib>
#include <set>

namespace nscdd::app {
namespace {

std::optional<fs::path> named_folder(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr || *value == '\0' ? std::nullopt : std::optional<fs::path>(value);
}

std::vector<fs::path> data_folders() {
  std::vector<fs::path> folders{"."};
  if (const auto named = named_folder("NSCDD_DATA")) folders.push_back(*named);
  std::error_code status;
  const fs::path program = fs::read_symlink("/proc/self/exe", status);
  if (!status) {
    const fs::path folder = program.parent_path();
    folders.push_back(folder.parent_path().parent_path());        // build/<preset>/nscdd of a source tree
    folders.push_back(folder.parent_path() / "share" / "nscdd");  // bin/nscdd of an installation
  }
  return folders;
}

// The file of that name in a data folder; none if the name is a path.
std::optional<fs::path> known_file(const std::string& name, const fs::path& file) {
  if (name.find('/') != std::string::npos) return std::nullopt;
  for (const fs::path& folder : data_folders())
    if (is_file(folder / file)) return (folder / file).lexically_normal();
  return std::nullopt;
}

std::string name_list(const std::vector<std::string>& names) {
  return names.empty() ? "none; NSCDD_DATA names the folder that holds them"
                       : fmt::format("{}", fmt::join(names, ", "));
}

std::optional<fs::path> cache_folder() {
  if (const auto own = named_folder("NSCDD_CACHE")) return own;
  if (const auto shared = named_folder("XDG_CACHE_HOME")) return *shared / "nscdd";
  if (const auto home = named_folder("HOME")) return *home / ".cache" / "nscdd";
  return std::nullopt;
}

// A cache entry is a packing file (CSV). Its first line holds the fingerprint of all that follows, which reveals
// damage. Further remarks hold the case that was settled.
constexpr std::string_view mark = "# content ";

// Marks what is said of a packing whenever it is used.
constexpr std::string_view remark_mark = "# remark: ";

struct Settled {
  Packing packing;
  std::vector<std::string> remarks = {};
};

std::string entry_text(const Settled& settled, const std::string& resolved) {
  std::string text;
  for (const std::string& remark : settled.remarks) text += fmt::format("{}{}\n", remark_mark, remark);
  for (TextLines lines(resolved); lines.next();) text += fmt::format("# {}\n", lines.line());
  text += packing_csv(settled.packing);
  return fmt::format("{}{}\n{}", mark, fingerprint(text), text);
}

// None if the entry is missing or damaged.
std::optional<Settled> cached(const fs::path& entry) {
  if (!is_file(entry)) return std::nullopt;
  try {
    const std::string text = read_text(entry.string());
    const std::size_t start = text.find('\n') + 1;  // 0 where there is none
    if (text.substr(0, start) != fmt::format("{}{}\n", mark, fingerprint(std::string_view(text).substr(start))))
      return std::nullopt;
    Settled found{parse_packing(text, entry.string())};
    for (TextLines lines(text); lines.next();)
      if (lines.line().starts_with(remark_mark)) found.remarks.emplace_back(lines.line().substr(remark_mark.size()));
    return found;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void remember(const fs::path& entry, const std::string& text) {
  std::error_code ignored;
  fs::create_directories(entry.parent_path(), ignored);
  try {
    write_file(entry.string(), text, true);
  } catch (const Error& error) {
    note("{}; this packing will be settled again", error.what());
  }
}

Settled simulate_to_the_end(const Case& one) {
  const Packing packing = packing_of(one);
  Simulation simulation = simulation_of(one);
  if (!simulation.system.free_bodies.empty())
    fail(
        "case '{}': expected free grains and driven boundaries of a case to settle, met bodies with free directions: "
        "a packing has no bodies",
        one.spec.name);
  RunTotals totals;
  RunSinks sinks;
  sinks.step = [&](const Simulation&, const AnySolvedStep&, const StepReport& report) { totals.add(report); };
  sinks.monitor = progress("settle " + one.spec.name, 0, "step");
  const RunOutcome outcome = run_simulation(simulation, sinks);
  if (failed(outcome.end)) fail("case '{}': cannot be settled: {}", one.spec.name, outcome.reason);
  Settled settled{free_grains(simulation.system, simulation.state, packing.size())};
  if (outcome.end == RunEnd::completed && one.spec.dynamics->time.rest_speed > 0)
    settled.remarks.push_back(fmt::format("case '{}': not at rest after {} steps, mean speed {:.3g} m/s", one.spec.name,
                                          simulation.state.step, totals.last.mean_speed));
  if (const std::string words = lack_of_room(totals); !words.empty())
    settled.remarks.push_back(fmt::format("case '{}': {}", one.spec.name, words));
  return settled;
}

std::string settled_file(const CaseSpec& spec) {
  const std::string& name = std::get<SettledFrom>(spec.packing).name;
  const fs::path beside = fs::path(spec.source).parent_path() / name;
  const std::string path = is_file(beside) ? beside.string() : find_case(name);
  if (fs::path(path).extension() != ".toml") fail("{}: expected a case file (.toml) to settle, met another", path);
  return path;
}

void add_files(const CaseSpec& spec, std::vector<fs::path>& files) {
  if (!spec.source.empty()) files.push_back(spec.source);
  const fs::path folder = fs::path(spec.source).parent_path();
  if (const auto* file = std::get_if<PackingFile>(&spec.packing)) {
    const std::string path = (folder / file->path).string();
    if (holds_datbox(path))
      std::ranges::copy(datbox_files(path), std::back_inserter(files));
    else
      files.push_back(path);
    if (!file->forces.empty())
      std::ranges::copy(datbox_files((folder / file->forces).string()), std::back_inserter(files));
  }
  if (const auto* file = std::get_if<ContactProblemFile>(&spec.packing)) {
    const std::string path = (folder / file->path).string();
    const auto record = record_at(path);
    files.emplace_back(record ? record->file : path);
  }
  if (!std::holds_alternative<SettledFrom>(spec.packing)) return;
  at_key(spec, "packing.settled", [&] {
    const std::string inner = settled_file(spec);
    std::error_code ignored;
    for (const fs::path& file : files)  // resolve_nested refuses a case that is settled from itself
      if (fs::equivalent(file, inner, ignored)) return;
    add_files(read_case(inner), files);
  });
}

// `open`: the case files being resolved, outermost first.
Case resolve_nested(const CaseSpec& spec, std::vector<fs::path> open);

Case settle(const CaseSpec& spec, const std::vector<fs::path>& open) {
  const std::string path = settled_file(spec);
  const Case start = resolve_nested(read_case(path), open);
  if (!start.spec.dynamics) fail("{}: expected a case with a section [dynamics] to settle, met one without", path);
  Case settled{spec};
  settled.settled_from = fmt::format("# case {}\n{}{}", start.spec.name, to_toml(start.spec), start.settled_from);
  if (const auto* file = std::get_if<PackingFile>(&start.spec.packing)) {
    settled.settled_from +=
        fmt::format("# content of {}: {} {} {} {}{}\n", file->path, fingerprint(start.packing.x),
                    fingerprint(start.packing.y), fingerprint(start.packing.radius), fingerprint(start.packing.mass),
                    start.packing.z.empty() ? "" : " " + fingerprint(start.packing.z));
    if (!file->forces.empty())
      settled.settled_from += fmt::format("# content of {}: {}\n", file->forces, fingerprint_of_forces(start));
  }
  const auto cache = cache_folder();
  const std::string key = fingerprint(settled.settled_from + build_fingerprint());
  const fs::path entry = cache ? *cache / fmt::format("{}-{}.csv", start.spec.name, key) : fs::path();
  std::optional<Settled> found = cached(entry);
  if (!found) {
    found = simulate_to_the_end(start);
    if (cache) remember(entry, entry_text(*found, settled.settled_from));
  }
  for (const std::string& remark : found->remarks) note("{}", remark);
  settled.packing = std::move(found->packing);
  return settled;
}

Case resolve_nested(const CaseSpec& spec, std::vector<fs::path> open) {
  std::error_code ignored;
  const fs::path full = fs::weakly_canonical(fs::absolute(spec.source, ignored), ignored);
  const bool cycle = std::ranges::find(open, full) != open.end();
  open.push_back(full);
  if (cycle) {
    std::vector<std::string> chain;
    for (const fs::path& each : open) chain.push_back(each.filename().string());
    fail("expected a case that is not settled from itself, met {}", fmt::join(chain, " -> "));
  }
  if (!std::holds_alternative<SettledFrom>(spec.packing)) return resolve(spec);
  return at_key(spec, "packing.settled", [&] { return settle(spec, open); });
}

}  // namespace

std::vector<std::string> known_names(const std::string& kind) {
  std::set<std::string> names;
  std::error_code ignored;
  for (const fs::path& folder : data_folders())
    for (const auto& entry : fs::directory_iterator(folder / kind, ignored)) {
      const fs::path& path = entry.path();
      if (kind == "cases" && path.extension() == ".toml") names.insert(path.stem().string());
      if (kind == "studies" && is_file(path / "study.toml")) names.insert(path.filename().string());
    }
  return {names.begin(), names.end()};
}

std::string find_case(const std::string& name) {
  if (holds_trajectory(name))
    fail(
        "{}: expected a case, met a trajectory: nscdd report draws it, nscdd export --fclib STEP writes the contact "
        "problem of a step",
        name);
  if (is_there(name) || record_at(name)) return name;
  if (const auto file = known_file(name, fs::path("cases") / (name + ".toml"))) return file->string();
  const std::vector<std::string> known = known_names("cases");
  fail(
      "case '{}': expected a case file (.toml), a packing file (.csv, .h5 or .txt), a folder of LMGC90, a contact "
      "problem or one of the known cases ({}), met no such file{}",
      name, name_list(known), suggestion(name, known));
}

std::string find_study(const std::string& name) {
  const fs::path path(name);
  if (is_file(path / "study.toml")) return name;
  if (path.filename() == "study.toml" && is_file(path))
    return path.has_parent_path() ? path.parent_path().string() : ".";
  if (const auto file = known_file(name, fs::path("studies") / name / "study.toml"))
    return file->parent_path().string();
  const std::vector<std::string> known = known_names("studies");
  fail("study '{}': expected a folder with a study.toml or one of the known studies ({}), met none{}", name,
       name_list(known), suggestion(name, known));
}

Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs) {
  require_no_input(outputs, files_behind(spec));
  for (const auto& [parameter, remark] : spec.remarks) note("{}: {}", spec.name, remark);
  Case one = resolve_nested(spec, {});
  one.remark = [told = std::make_shared<std::set<std::string>>()](const std::string& remark) {
    if (told->insert(remark).second) note("{}", remark);  // a study makes many models of one packing
  };
  one.made = [partitioner = spec.partition, tell = one.remark](const Model& model) {
    std::ranges::for_each(remarks_on(model, partitioner), tell);
  };
  return one;
}

std::vector<fs::path> files_behind(const CaseSpec& spec) {
  std::vector<fs::path> files;
  add_files(spec, files);
  return files;
}

void require_no_input(const std::vector<std::string>& outputs, const std::vector<fs::path>& inputs) {
  std::error_code ignored;
  for (const std::string& output : outputs)
    for (const fs::path& input : inputs)
      if (!output.empty() && !is_stream(output) && fs::equivalent(output, input, ignored))
        fail("{}: expected another file than the input {}, which would be lost", output, input.string());
}

}  // namespace nscdd::app
