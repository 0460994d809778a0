// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/shared_work.hpp"

#include "core/memory.hpp"

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

}  // namespace

void Limits::declare_threads(Command& command) {
  command.preset("--threads", threads, "threads at the most, 0 for all; results do not depend on it",
                 {.description = "", .minimum = 0, .maximum = 4096});
}

void Limits::declare_memory(Command& command) {
  command.add("--memory-limit", gibibytes,
              "memory the run may take, GiB; a run that needs more is refused; by default 90 % of what is available",
              {.description = "", .minimum = 0, .minimum_excluded = true});
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
  command.preset("--contacts", contacts,
                 "contacts of Stage 1: all, active, or unilateral; active: in compression in the linear rigid problem; "
                 "unilateral: carrying in the frictionless unilateral problem");
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

}  // namespace nscdd::app
