// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/settled_cases.hpp"

#include "app/data_files.hpp"
#include "app/progress.hpp"
#include "core/fingerprint.hpp"
#include "files/csv.hpp"
#include "files/output_file.hpp"
#include "formats/case_file.hpp"
#include "simulation/run_simulation.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/version.hpp>
#include <nscdd/formats/packing_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

// An entry of the cache is a packing file (CSV). Its first line is a remark with the fingerprint of all that
// follows, by which damage is noticed. Further remarks tell which case was settled.
constexpr std::string_view mark = "# content ";

std::string entry_text(const Packing& packing, const std::string& resolved) {
  std::string text;
  for (std::size_t begin = 0; begin < resolved.size();) {
    const std::size_t end = std::min(resolved.find('\n', begin), resolved.size());
    text += fmt::format("# {}\n", resolved.substr(begin, end - begin));
    begin = end + 1;
  }
  text += packing_csv(packing);
  return fmt::format("{}{}\n{}", mark, fingerprint(text), text);
}

// None if there is no such entry or it is damaged.
std::optional<Packing> cached(const fs::path& entry) {
  std::error_code ignored;
  if (!fs::is_regular_file(entry, ignored)) return std::nullopt;
  try {
    const std::string text = read_text(entry.string());
    const std::size_t start = text.find('\n') + 1;  // 0 where there is none
    if (text.substr(0, start) != fmt::format("{}{}\n", mark, fingerprint(std::string_view(text).substr(start))))
      return std::nullopt;
    return parse_packing(text, entry.string());
  } catch (const Error&) {
    return std::nullopt;
  }
}

// If the entry cannot be written, the packing will be settled again next time, which costs time alone.
void remember(const fs::path& entry, const std::string& text) {
  std::error_code ignored;
  fs::create_directories(entry.parent_path(), ignored);
  try {
    write_file(entry.string(), text, true);
  } catch (const Error& error) {
    note(fmt::format("{}; this packing will be settled again", error.what()));
  }
}

Packing free_grains(const Simulation& simulation, Index grains) {
  Packing packing;
  for (Index i = 0; i < grains; ++i) {
    if (!simulation.system.free(i)) continue;
    packing.x.push_back(simulation.state.x[at(i)]);
    packing.y.push_back(simulation.state.y[at(i)]);
    packing.radius.push_back(simulation.system.radius[at(i)]);
    packing.mass.push_back(simulation.system.mass[at(i)]);
  }
  return packing;
}

Packing simulate_to_the_end(const Case& one) {
  Progress progress("settle " + one.spec.name, 0, "step");
  const Packing packing = packing_of(one);
  Simulation simulation = simulation_of(one);
  double kinetic = 0;
  RunSinks sinks;
  sinks.step = [&](const Simulation&, const SolvedStep&, const StepReport& report) { kinetic = report.energy.kinetic; };
  sinks.monitor = progress.monitor();
  const RunOutcome outcome = run_simulation(simulation, sinks);
  if (outcome.end == RunEnd::broke_down)
    throw Error(fmt::format("case '{}': cannot be settled: {}", one.spec.name, outcome.reason));
  if (outcome.end == RunEnd::completed && one.spec.dynamics->time.rest_speed > 0)
    note(fmt::format("case '{}': not at rest after {} steps, mean speed {:.3g} m/s", one.spec.name,
                     simulation.state.step, mean_speed(simulation.system, kinetic)));
  return free_grains(simulation, packing.size());
}

std::string canonical(const std::string& path) {
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(path, ignored), ignored).string();
}

// The case file that a case is settled from.
std::string settled_file(const CaseSpec& spec) {
  const std::string& name = std::get<SettledFrom>(spec.packing).name;
  std::error_code ignored;
  const fs::path beside = fs::path(spec.source).parent_path() / name;
  const std::string path = fs::is_regular_file(beside, ignored) ? beside.string() : find_case(name);
  if (fs::path(path).extension() != ".toml")
    throw Error(fmt::format("{}: expected a case file (.toml) to settle, met another", path));
  return path;
}

void add_files(const CaseSpec& spec, std::vector<fs::path>& files) {
  if (!spec.source.empty()) files.push_back(spec.source);
  const fs::path folder = fs::path(spec.source).parent_path();
  if (const auto* file = std::get_if<PackingFile>(&spec.packing)) files.push_back(folder / file->path);
  if (const auto* file = std::get_if<ContactProblemFile>(&spec.packing)) files.push_back(folder / file->path);
  if (!std::holds_alternative<SettledFrom>(spec.packing)) return;
  at_key(spec, "packing.settled", [&] {
    const std::string inner = settled_file(spec);
    std::error_code ignored;
    const bool known = std::any_of(files.begin(), files.end(),
                                   [&](const fs::path& file) { return fs::equivalent(file, inner, ignored); });
    // A case that is settled from itself is refused when it is settled.
    if (!known) add_files(read_case(inner), files);
  });
}

// `open`: the case files that are being resolved, from the one asked for inwards.
Case resolve_nested(const CaseSpec& spec, std::vector<std::string> open);

// The case at rest: its packing, and what it was settled from.
Case settle(const CaseSpec& spec, const std::vector<std::string>& open) {
  const std::string path = settled_file(spec);
  const Case start = resolve_nested(read_case(path), open);
  if (!start.spec.dynamics)
    throw Error(fmt::format("{}: expected a case with a section [dynamics] to settle, met one without", path));
  Case settled{spec};
  settled.settled_from = fmt::format("# case {}\n{}{}", start.spec.name, to_toml(start.spec), start.settled_from);
  if (const auto* file = std::get_if<PackingFile>(&start.spec.packing))
    settled.settled_from +=
        fmt::format("# content of {}: {} {} {} {}\n", file->path, fingerprint(start.packing.x),
                    fingerprint(start.packing.y), fingerprint(start.packing.radius), fingerprint(start.packing.mass));
  const auto cache = cache_folder();
  const std::string key = fingerprint(settled.settled_from + build_fingerprint());
  const fs::path entry = cache ? *cache / fmt::format("{}-{}.csv", start.spec.name, key) : fs::path();
  if (cache)
    if (std::optional<Packing> found = cached(entry)) {
      settled.packing = *std::move(found);
      return settled;
    }
  settled.packing = simulate_to_the_end(start);
  if (cache) remember(entry, entry_text(settled.packing, settled.settled_from));
  return settled;
}

Case resolve_nested(const CaseSpec& spec, std::vector<std::string> open) {
  const std::string full = canonical(spec.source);
  const bool cycle = std::find(open.begin(), open.end(), full) != open.end();
  open.push_back(full);
  if (cycle) {
    std::string chain;
    for (const std::string& each : open) chain += (chain.empty() ? "" : " -> ") + fs::path(each).filename().string();
    throw Error(fmt::format("expected a case that is not settled from itself, met {}", chain));
  }
  if (!std::holds_alternative<SettledFrom>(spec.packing)) return resolve(spec);
  return at_key(spec, "packing.settled", [&] { return settle(spec, open); });
}

}  // namespace

std::optional<fs::path> cache_folder() {
  const auto variable = [](const char* name) -> std::optional<fs::path> {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') return std::nullopt;
    return fs::path(value);
  };
  if (const auto own = variable("NSCDD_CACHE")) return own;
  if (const auto shared = variable("XDG_CACHE_HOME")) return *shared / "nscdd";
  if (const auto home = variable("HOME")) return *home / ".cache" / "nscdd";
  return std::nullopt;
}

Case resolve_settled(const CaseSpec& spec) { return resolve_nested(spec, {}); }

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
        throw Error(
            fmt::format("{}: expected another file than the input {}, which would be lost", output, input.string()));
}

}  // namespace nscdd::app
