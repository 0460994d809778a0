// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/options.hpp"

#include "formats/case/case_file.hpp"
#include "study/linear/values.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <fstream>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

constexpr double gibibyte = 1024.0 * 1024.0 * 1024.0;
constexpr double usable_share = 0.9;  // of what is available, because the need is only estimated

double system_available() {
  std::ifstream stream("/proc/meminfo");
  std::string key, unit;
  for (double kibibytes = 0; stream >> key >> kibibytes; std::getline(stream, unit))
    if (key == "MemAvailable:") return 1024 * kibibytes;
  return infinity;
}

// The number in a file of a control group; infinite if the file is missing or says "max".
double number_in(const fs::path& file) {
  std::ifstream stream(file);
  double value = 0;
  return stream >> value ? value : infinity;
}

// What a group, and every group that it lies in, leave of their limits.
double left_in(const fs::path& root, fs::path group, const char* limit_name, const char* usage_name) {
  for (double left = infinity;; group = group.parent_path()) {
    const fs::path folder = root / group;
    const double limit = number_in(folder / limit_name), usage = number_in(folder / usage_name);
    if (limit < infinity && usage < infinity) left = std::min(left, std::max(limit - usage, 0.0));
    if (group.empty()) return left;
  }
}

double control_groups_available() {
  std::ifstream stream("/proc/self/cgroup");  // lines "number:controllers:/path", "0::/path" for version 2
  double left = infinity;
  for (std::string line; std::getline(stream, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const fs::path group = fs::path(line.substr(second + 1)).relative_path();
    if (controllers.empty()) left = std::min(left, left_in("/sys/fs/cgroup", group, "memory.max", "memory.current"));
    if (controllers == "memory")
      left = std::min(left, left_in("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes", "memory.usage_in_bytes"));
  }
  return left;
}

// Bytes that a new run can take without swapping: MemAvailable of /proc/meminfo, and what the control groups
// that the program is in leave of their limits; infinite where the system tells neither.
double available_bytes() { return std::min(system_available(), control_groups_available()); }

PrescribedVelocity parse_prescribed(const std::string& text) {
  const std::string what = "--prescribed";
  const std::vector<std::string_view> parts = split(text, ':');
  if (parts.size() != 3 && parts.size() != 4)
    fail("{}: expected GRAIN:VX:VY such as 3:-1:0, or GRAIN:VX:VY:VZ in space, met '{}'", what, text);
  const auto component = [&](std::size_t k) { return parse_number(parts[k], what); };
  PrescribedVelocity velocity{parse_integer(parts[0], what), {component(1), component(2)}};
  if (parts.size() == 4) velocity.velocity = {component(1), component(2), component(3)};
  check_bounds(velocity.velocity, Field{.description = ""}, what);
  return velocity;
}

// Numbers that two cases hardly have in common.
std::vector<double> features(const Model& model) {
  double places = 0;
  for (Index c = 0; c < model.problem.contacts(); ++c)
    places += static_cast<double>(model.partition.subdomain_of_contact[at(c)] * (c % 1009 + 1));
  return {static_cast<double>(model.grains()),
          static_cast<double>(model.problem.contacts()),
          static_cast<double>(model.partition.subdomains),
          static_cast<double>(model.parts.interface_size()),
          model.problem.inertia.norm(),
          model.problem.h.norm(),
          places};
}

}  // namespace

CaseSpec find_spec(const std::string& name) { return spec_of_file(find_case(name)); }

void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos) fail("--set: expected KEY=VALUE such as packing.grains=16, met '{}'", setting);
    override_case(spec, setting.substr(0, equals), setting.substr(equals + 1));
  }
}

void CaseOptions::declare(Command& command, bool contact_problems) {
  command.required("CASE", name,
                   fmt::format("case or packing file{}, or a known case; case files end in .toml, packing files in "
                               ".csv or .h5 with x,y,radius[,mass], or in .txt with lines x y radius, or are a folder "
                               "DATBOX of LMGC90{}",
                               contact_problems ? ", contact problem" : "",
                               contact_problems ? ", contact problems of FCLIB in .hdf5, of Siconos in .dat" : ""));
  declare_options(command);
}

void CaseOptions::declare_options(Command& command) {
  command.add("--subdomains PARTITION", subdomains, "partition: NXxNY[xNZ] for a regular grid, metis:N for METIS");
  command.add("--prescribed GRAIN:VX:VY", prescribed,
              "arriving velocity of a grain, m/s (grains from 0, -1 the last); in space GRAIN:VX:VY:VZ");
  command.add("--density", density, "masses = density x area, kg/m^2, or in space x volume, kg/m^3");
  command.add("--tolerance", tolerance, "contact where gap <= tolerance x smaller radius (1e-7)");
  command.add("--overlap-tolerance", overlap_tolerance, "overlap accepted, times smaller radius (1e-7)");
  command.add("--set KEY=VALUE", settings, "a parameter of the case, such as packing.grains=16");
}

void set_partition(CaseSpec& spec, const std::string& subdomains) {
  spec.partition = parse_partitioner(subdomains, "--subdomains");
  std::erase_if(spec.lines, [](const auto& line) { return line.first.starts_with("partition"); });
}

Case CaseOptions::resolve(const std::vector<std::string>& outputs) const {
  CaseSpec spec = find_spec(name);
  if (!subdomains.empty()) set_partition(spec, subdomains);
  if (!prescribed.empty()) {
    spec.prescribed.clear();
    std::erase_if(spec.lines, [](const auto& line) { return line.first.starts_with("prescribed"); });
  }
  for (const std::string& text : prescribed) {
    const PrescribedVelocity velocity = parse_prescribed(text);
    for (const PrescribedVelocity& other : spec.prescribed)
      if (other.grain == velocity.grain)
        fail("--prescribed: expected each grain once, met grain {} again", velocity.grain);
    spec.prescribed.push_back(velocity);
  }
  if (density) override_case(spec, "masses.density", field_text(*density));
  if (tolerance) override_case(spec, "contacts.tolerance", field_text(*tolerance));
  if (overlap_tolerance) override_case(spec, "contacts.overlap_tolerance", field_text(*overlap_tolerance));
  apply_settings(spec, settings);
  return resolve_case(spec, outputs);
}

void SpectralCommandOptions::declare(Command& command, const std::string& default_contacts) {
  contacts = default_contacts;
  command
      .preset("--contacts", contacts,
              "contacts of Stage 1: all, active, or unilateral; active: in compression in the linear rigid "
              "problem; unilateral: carrying in the frictionless unilateral problem")
      .words = all_names<ContactSet>();
  declare_solver(command);
}

void SpectralCommandOptions::declare_solver(Command& command) {
  command
      .preset("--solver", solver,
              "auto, dense, arpack, shift-invert, or slepc; auto: dense for small interfaces, else shift-invert; "
              "arpack: matrix-free Lanczos; slepc: Krylov-Schur of SLEPc, by nscdd-mpi")
      .words = all_names<SpectralSolver>();
  command.preset("--residual-tolerance", options.tolerance, "largest residual that counts as converged");
}

ContactSet SpectralCommandOptions::contact_set() const { return Choice<ContactSet>::parse(contacts, "--contacts"); }

SpectralOptions SpectralCommandOptions::spectral() const {
  const Field positive{.description = "", .minimum = 0, .minimum_excluded = true};
  check_bounds(options.tolerance, positive, "--residual-tolerance");
  check_bounds(options.eigenvalues, Field{.description = "", .minimum = 1, .maximum = 100}, "--eigenvalues");
  SpectralOptions all = options;
  all.solver = Choice<SpectralSolver>::parse(solver, "--solver");
  const bool ends_alone = all.solver == SpectralSolver::arpack || all.solver == SpectralSolver::slepc;
  if (ends_alone && (all.certify || all.eigenvalues > 1))
    fail("--solver: expected auto, dense or shift-invert with --certify or --eigenvalues, met {}", solver);
  return all;
}

void declare_threads(Command& command, Index& threads) {
  command.preset("--threads", threads, "threads at the most, 0 for all; results do not depend on it").bounds = {0,
                                                                                                                4096};
}

void MemoryLimit::declare(Command& command) {
  command.add("--memory-limit", gibibytes,
              "memory the run may take, GiB; a run that is estimated to need more is refused; by default 90 % of what "
              "is available");
}

void MemoryLimit::require(const MemoryNeed& need) const {
  if (gibibytes)
    check_bounds(*gibibytes, Field{.description = "", .minimum = 0, .minimum_excluded = true}, "--memory-limit");
  const double limit = gibibytes ? *gibibytes * gibibyte : usable_share * available_bytes();
  if (need.bytes <= limit) return;
  fail(
      "case {}: expected to fit into {:.3g} GiB of memory ({}), met an estimated need of {:.3g} GiB for {}; {}, or a "
      "larger --memory-limit may help",
      need.name, limit / gibibyte, gibibytes ? "--memory-limit" : "90 % of what is available", need.bytes / gibibyte,
      need.what, need.advice);
}

void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

Model shared_model(const Case& one, const Machine& machine, ContactSet contacts,
                   const std::function<void(const Model&)>& check) {
  const Processes& all = machine.processes;
  return all.together([&] {
    Model whole = all.together([&] {
      Model built = cut_up(one, all);
      check(built);
      return built;
    });
    require_same(features(whole), one.spec.name, all);
    Model own = share_of(std::move(whole), all);
    if (!all.alone()) {
      if (contacts == ContactSet::all && own.parts.interface_size() > 0)  // an empty interface is explained by H
        own.problem.h = SparseMatrix(own.problem.h.rows(), own.problem.h.cols());
      give_back_freed_memory();
    }
    return own;
  });
}

void require_same(const std::vector<double>& numbers, const std::string& name, const Processes& processes) {
  const std::vector<double> of_all = processes.gather(numbers);
  for (std::size_t k = 0; k < of_all.size(); ++k)
    if (of_all[k] != of_all[k % numbers.size()])
      fail("{}: expected the same case and options in all processes, met others in process {}", name,
           k / numbers.size());
}

void require_one_process(const Machine& machine, std::string_view what) {
  if (!machine.processes.alone()) fail("{}: expected one process, met {}: nscdd has it", what, machine.processes.size);
}

void require_shared(const SpectralOptions& spectral, const Machine& machine) {
  if (spectral.solver == SpectralSolver::arpack) require_one_process(machine, "--solver arpack");
  if (spectral.solver == SpectralSolver::slepc && !machine.slepc)
    fail("--solver: expected auto, dense, arpack or shift-invert with {}, met slepc, which nscdd-mpi has",
         machine.program);
}

void MemoryLimit::require(MemoryNeed need, const Machine& machine) const {
  need.bytes *= static_cast<double>(machine.processes_here) / static_cast<double>(machine.processes.size);
  require(need);
}

Provenance provenance(const Context& context, const std::vector<Case>& cases) {
  std::string libraries, resolved;
  for (const auto& [name, version] : dependency_versions()) libraries += fmt::format("{} {}\n", name, version);
  for (const Case& one : cases) {
    resolved += fmt::format("# case {}\n{}\n", one.spec.name, to_toml(one.spec));
    if (!one.settled_from.empty()) resolved += one.settled_from + "\n";
  }
  return {{"program", "nscdd " + version()},
          {"libraries", libraries},
          {"command_line", context.command_line},
          {"cases", resolved}};
}

}  // namespace nscdd::app
