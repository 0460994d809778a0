// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/progress.hpp"
#include "app/verbs.hpp"
#include "files/hdf5.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>
#include <vector>

namespace {

using namespace nscdd::app;

// Every verb of the program.
constexpr std::array<Verb, 12> verbs{{
    {"sweep", "spectral radius of the contraction operator over epsilon, eta and more, as CSV", declare_sweep},
    {"run", "run a study: its tables as CSV and HDF5", declare_run},
    {"network", "contact network of a case: links, impulses, active contacts, as CSV", declare_network},
    {"inspect", "counts, interface, ranks, rigid modes and hyperstaticity of a case", declare_inspect},
    {"optimum", "best flexibility eta of the enriched algorithm for a case", declare_optimum},
    {"modes", "where the iteration is slow: impulses and velocities of the slowest mode, as CSV", declare_modes},
    {"simulate", "run a case that moves, step by step: trajectory as HDF5", declare_simulate},
    {"export", "write a trajectory for ParaView, or a step of it as a contact problem (FCLIB file)", declare_export},
    {"generate", "write the packing of a generator or a case, as CSV or HDF5", declare_generate},
    {"solve", "solve a frictional contact problem of another program (FCLIB file)", declare_solve},
    {"list", "known cases, studies, generators, partitioners and observables", declare_list},
    {"manual", "write manual pages and the completion of bash into a folder", declare_manual},
}};

std::string joined(int argc, char** argv) {
  std::string line = "nscdd";
  for (int i = 1; i < argc; ++i) {
    const bool plain = std::strpbrk(argv[i], " \t\"'\\$*?;&|<>()") == nullptr && argv[i][0] != '\0';
    line += plain ? fmt::format(" {}", argv[i]) : fmt::format(" '{}'", argv[i]);
  }
  return line;
}

// One factor follows another of the same size: memory given back in between comes as fresh pages, which took
// a seventh of the time at 10^6 grains. Blocks up to 32 MiB, the largest size that is allowed here, are kept.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, -1);  // never
  mallopt(M_TOP_PAD, 64 << 20);
#endif
}

int run(int argc, char** argv) {
  keep_freed_memory();
  nscdd::leave_hdf5_alone_at_exit();
  std::vector<DescribedVerb> described;
  described.reserve(verbs.size());  // the options that a verb declares stay where they are
  const Context context{joined(argc, argv), &described};
  std::vector<Action> actions;
  for (const Verb& verb : verbs) {
    described.push_back({verb.name, verb.summary, {}});
    actions.push_back(verb.declare(described.back().command));
  }
  const Request request = parse_command_line(described, argc, argv);
  if (const auto* number = std::get_if<std::size_t>(&request)) return actions[*number](context);
  fmt::print("{}", std::get<std::string>(request));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int exit_code = run(argc, argv);
    if (std::fflush(stdout) != 0)
      throw nscdd::Error(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
    return exit_code;
  } catch (const nscdd::Error& error) {
    note("error: {}", error.what());
  } catch (const std::bad_alloc&) {
    note("error: not enough memory for a problem of this size");
  } catch (const std::system_error& error) {
    note("error: {}", error.what());
  }
  return 2;
}
