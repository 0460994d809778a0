// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/shared_work.hpp"

#include "core/memory.hpp"

#include <sys/resource.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace nscdd::app {
namespace {

// A fingerprint of the model, compared across ranks.
std::vector<double> features(const Model& model) {
  double places = 0;
  for (Index c = 0; c < model.problem.contacts(); ++c)
    places += static_cast<double>(model.partition.subdomain_of_contact[at(c)] * (c % 1009 + 1));
  return {static_cast<double>(model.grains()),
          static_cast<double>(model.problem.contacts()),
          static_cast<double>(model.partition.subdomains),
          static_cast<double>(model.parts.interface_size()),
          model.problem.inertia.norm(),
          model.problem.contacts() == 0 ? 0.0 : model.problem.h.norm(),
          places};
}

struct ProcessCounts {
  Index process = 0;
  WorkCount work;
  double seconds = 0, memory = 0;
};

ResultColumns<ProcessCounts> count_columns() {
  const ResultColumns<WorkCount> of_work{
      {"messages", "1", "sent to one other rank", &WorkCount::messages},
      {"message_bytes", "B", "bytes of these messages", &WorkCount::message_bytes},
      {"sums", "1", "exchanges in which all ranks take part", &WorkCount::sums},
      {"sum_bytes", "B", "contributed by this rank to these exchanges", &WorkCount::sum_bytes},
      {"contact_updates", "1", "of single contacts, in sweeps of Algorithm 1", &WorkCount::contact_updates},
      {"flops", "1", "operations of factorisations and of solves with them", &WorkCount::flops},
      {"path_flops", "1", "on the critical path over all ranks", &WorkCount::path_flops}};
  return joined<ProcessCounts>({{{"process", "", "rank, from 0", &ProcessCounts::process}},
                                columns_of(&ProcessCounts::work, of_work),
                                {{"seconds", "s", "from the first work to the last", &ProcessCounts::seconds},
                                 {"memory", "B", "largest resident set of the process", &ProcessCounts::memory}}});
}

}  // namespace

void Limits::declare_threads(Command& command) {
  command.preset("--threads", threads, "threads at the most, 0 for all; results do not depend on it",
                 {.minimum = 0, .maximum = 4096});
}

void Limits::declare_memory(Command& command) {
  command.add("--memory-limit", gibibytes,
              "memory the run may take, GiB; a run that needs more is refused; by default 90 % of what is available",
              {.above = 0});
}

void Limits::declare(Command& command) {
  declare_threads(command);
  declare_memory(command);
}

void Limits::limit_memory(Index processes) const {
  if (gibibytes) nscdd::limit_memory(*gibibytes * gibibyte / static_cast<double>(processes));
  require_memory(smallest_checked_need, "the work itself");
}

ThreadLimit Limits::limit_threads(const Machine& machine) const {
  return ThreadLimit(threads > 0 ? threads : machine.threads);
}

ThreadLimit Limits::apply(const Machine& machine) const {
  limit_memory(machine.processes_here);
  return limit_threads(machine);
}

void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, -1);  // never
  mallopt(M_TOP_PAD, 64 << 20);
#endif
}

void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

void declare_contacts(Command& command, Choice<ContactSet>& contacts) {
  command.preset(
      "--contacts", contacts,
      "contacts of Stage 1: all, active, unilateral, or frozen; active: in compression in the linear rigid problem; "
      "unilateral: carrying in the frictionless unilateral problem; frozen: of a contact problem, in its solution with "
      "friction, sticking contacts and the normals of sliding ones");
}

void declare_scheme(Command& command, Choice<DecompositionScheme>& scheme) {
  command.preset("--scheme", scheme,
                 "coupling of subdomains: nscdd, or schwarz; schwarz: block Jacobi with whole masses (ddm_type 0 of "
                 "LMGC90), without eta");
}

SpectralOptions spectra_on(const Machine& machine, SpectralOptions options) {
  check(options, "--");
  if (options.solver == SpectralSolver::arpack) require_one_process(machine, "--solver arpack");
  if (options.solver == SpectralSolver::slepc && !machine.slepc)
    fail("--solver: expected auto, dense, arpack or shift-invert with {}, met slepc, which nscdd-mpi has",
         machine.program);
  options.inertia = machine.inertia;
  options.slepc = machine.slepc;
  return options;
}

Model shared_model(const Case& one, const Machine& machine, ContactSet contacts) {
  const Processes& all = machine.processes;
  return all.together([&] {
    Model whole = all.together([&] { return cut_up(one, all); });
    require_same(features(whole), one.spec.name, all);
    Model own = share_of(std::move(whole), all);
    if (!all.alone()) {
      if (contacts == ContactSet::all && own.parts.interface_size() > 0)  // why_empty reads H
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
      fail("{}: expected the same case and options on all ranks, met others on rank {}", name, k / numbers.size());
}

void require_one_process(const Machine& machine, std::string_view what) {
  if (!machine.processes.alone())
    fail("{}: expected a single rank, met {}: run it with nscdd", what, machine.processes.size);
}

SharedTable::SharedTable(const Machine& machine, const std::string& path, const TableWork& work, Reopening how)
    : path_(machine.processes.first() ? path : "/dev/null") {
  const Reopening own = machine.processes.first() ? how : Reopening{};
  kept_ = machine.processes.together([&] { return table_.emplace(path_, work, own).kept(); });
  kept_ = machine.processes.sum(kept_);
}

void CountsTable::declare(Command& command, std::string& path) {
  command.add("--counts FILE", path,
              "also a table of what each process did; its messages, bytes, operations, seconds and memory, - for "
              "standard output");
}

CountsTable::CountsTable(const std::string& path, bool force, const Machine& machine)
    : processes_(machine.processes), wanted_(!path.empty()) {
  processes_.together([&] {
    if (wanted_ && processes_.first()) csv_.emplace(path, force, headings(count_columns()));
    return true;
  });
}

void CountsTable::finish() {
  if (!wanted_) return;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const ProcessCounts own{processes_.rank, *processes_.counts, seconds() - begun_,
                          1024.0 * static_cast<double>(usage.ru_maxrss)};
  const std::vector<ProcessCounts> all = processes_.gather_each(own);
  if (!csv_) return;
  for (const ProcessCounts& one : all) csv_->write(row(count_columns(), one));
  csv_->finish();
}

void declare_reopening(Command& command, Reopening& how) {
  command.add("--force", how.force, "replace existing outputs");
  command.add(
      "--resume", how.resume,
      "go on with the rows of an interrupted run; of the same case, options and program: what is missing is computed");
}

bool nothing_to_resume(const std::string& csv, const std::string& hdf5, const TableWork& work, Reopening how,
                       const Machine& machine) {
  const Processes& all = machine.processes;
  if (csv.empty() && how.resume) fail("--resume: expected --csv FILE with it, met none");
  return all.any(all.together([&] {
    if (!all.first() || !how.resume || how.force || !is_complete(csv)) return false;
    if (!hdf5.empty() && !std::filesystem::exists(hdf5))
      fail(
          "{}: expected rows to resume, met a complete table, and nothing tells what work it came from: {} cannot be "
          "made of it; --force computes both again",
          csv, hdf5);
    require_rows_of(work, csv);
    note("{}: already complete, nothing to resume; of a complete table only the rows it should have are compared", csv);
    return true;
  }));
}

int leave(ResumableTable& table, const std::string& path) {
  table.leave();
  const auto total = table.total();
  return interrupted("{}: interrupted after {}{} rows{}", name_of_output(path), table.rows(),
                     total ? fmt::format(" of {}", *total) : "",
                     table.resumable() && total ? "; --resume continues" : "");
}

}  // namespace nscdd::app
