// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/progress.hpp"
#include "app/verbs.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/version.hpp>

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <sstream>
#include <system_error>

namespace {

using namespace nscdd::app;

// Every verb of the program.
constexpr std::array<Verb, 11> verbs{{
    {"sweep", "spectral radius of the contraction operator over epsilon, eta and more, as CSV",
     declare_sweep},
    {"run", "run a study: its tables as CSV and HDF5", declare_run},
    {"network", "contact network of a case: links, impulses, active contacts, as CSV", declare_network},
    {"inspect", "counts, interface, ranks, rigid modes and hyperstaticity of a case", declare_inspect},
    {"optimum", "best flexibility eta of the enriched algorithm for a case", declare_optimum},
    {"modes", "where the iteration is slow: impulses and velocities of the slowest mode, as CSV",
     declare_modes},
    {"simulate", "run a case that moves, step by step: trajectory as HDF5", declare_simulate},
    {"export", "write a trajectory for ParaView, or a step of it as a contact problem (FCLIB file)",
     declare_export},
    {"generate", "write the packing of a generator or a case, as CSV or HDF5", declare_generate},
    {"solve", "solve a frictional contact problem of another program (FCLIB file)", declare_solve},
    {"list", "known cases, studies, generators, partitioners and observables", declare_list},
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
  CLI::App app(
      "nscdd: convergence study, and simulation, of domain decomposition for nonsmooth contact dynamics",
      "nscdd");
  app.set_version_flag("--version", "nscdd " + nscdd::version());
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  nscdd sweep disks4 --epsilon 0,1 --csv -\n"
      "  nscdd optimum disks8\n"
      "  nscdd run figure-5\n"
      "  nscdd simulate shear-1k --steps 20 -o twenty.h5\n"
      "Exit codes: 0 done, 1 a check failed, 2 bad input or usage, 130 interrupted. 'nscdd VERB --help' has "
      "the options.");
  const Context context{joined(argc, argv)};
  std::array<std::function<int()>, verbs.size()> actions;
  std::array<CLI::App*, verbs.size()> commands{};
  for (std::size_t i = 0; i < verbs.size(); ++i) {
    commands[i] = app.add_subcommand(verbs[i].name, verbs[i].summary);
    actions[i] = verbs[i].declare(*commands[i], context);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream help, ignored;
    if (app.exit(error, help, ignored) != 0)
      throw nscdd::Error(fmt::format("{}; 'nscdd --help' and 'nscdd VERB --help' say how", error.what()));
    fmt::print("{}", help.str());
    return 0;
  }
  for (std::size_t i = 0; i < verbs.size(); ++i)
    if (commands[i]->parsed()) return actions[i]();
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int exit_code = run(argc, argv);
    if (std::fflush(stdout) != 0)
      throw nscdd::Error(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
    return exit_code;
  } catch (const nscdd::Error& error) {
    note(fmt::format("error: {}", error.what()));
  } catch (const std::bad_alloc&) {
    note("error: not enough memory for a problem of this size");
  } catch (const std::system_error& error) {
    note(fmt::format("error: {}", error.what()));
  }
  return 2;
}
