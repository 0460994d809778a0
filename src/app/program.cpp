// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/shared_work.hpp"
#include "files/hdf5.hpp"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>

namespace nscdd::app {
namespace {

std::vector<Verb> all_verbs() {
  return {
      {"sweep", "spectral radius of the contraction operator over epsilon, eta and more, as CSV", declare_sweep},
      {"run", "run a study: its tables as CSV and HDF5", declare_run},
      {"network", "contact network of a case: links, impulses, active contacts, as CSV", declare_network},
      {"inspect", "counts, interface, ranks, rigid modes and hyperstaticity of a case", declare_inspect},
      {"optimum", "best flexibility eta of the enriched algorithm for a case", declare_optimum},
      {"coarse", "condition numbers of the interface problem, and the coarse space that it needs", declare_coarse},
      {"modes", "where the iteration is slow: impulses and velocities of the slowest mode, as CSV", declare_modes},
      {"simulate", "run a case that moves, step by step: trajectory as HDF5", declare_simulate},
      {"export", "write a run for ParaView, a step of it as a contact problem, or the operators of a case",
       declare_export},
      {"report", "one page about a packing, contact problem or run: radii, modes, criteria, force chains, as HTML",
       declare_report},
      {"generate", "write the packing of a generator or a case, as CSV or HDF5", declare_generate},
      {"solve", "solve a frictional contact problem of another program (FCLIB, Siconos, LMGC90)", declare_solve},
      {"list", "known cases, studies, generators, partitioners and observables", declare_list},
      {"manual", "write manual pages and the completion of bash into a folder", declare_manual},
  };
}

// Throws Error for an unknown verb, with the nearest name, and for one that this program does not serve.
Verb& verb_named(std::vector<Verb>& verbs, std::string_view name, const Machine& machine) {
  const auto verb = std::ranges::find(verbs, name, &Verb::name);
  if (verb == verbs.end()) {
    std::vector<std::string> known;
    for (const Verb& each : verbs) known.push_back(each.name);
    fail("expected a verb ({}), met '{}'{}", fmt::join(known, ", "), name, suggestion(name, known));
  }
  if (!machine.serves(name))
    fail("expected a verb that several ranks can share ({}), met '{}': run it with nscdd on a single rank",
         fmt::join(machine.verbs, ", "), name);
  return *verb;
}

bool asks_for_help(std::string_view argument) { return argument == "--help" || argument == "-h"; }

// A verb whose options are set, or a text to print (help, version).
using Request = std::variant<const Verb*, std::string>;

// Throws Error for a line that does not fit the description, with the nearest name for an unknown verb or option.
Request parse_command_line(std::vector<Verb>& verbs, std::span<const char* const> arguments, const Machine& machine) {
  if (arguments.empty() || asks_for_help(arguments.front())) return short_guide(verbs, machine);
  const std::string_view first = arguments.front();
  if (first == "--version") return fmt::format("{} {}\n", machine.program, version());
  if (first == "help")
    return arguments.size() == 1 ? short_guide(verbs, machine) : help_screen(verb_named(verbs, arguments[1], machine));
  Verb& verb = verb_named(verbs, first, machine);
  if (std::ranges::any_of(arguments.subspan(1), asks_for_help)) return help_screen(verb);
  try {
    parse(verb.command, arguments.subspan(1));
  } catch (const Error& error) {
    fail("{}; '{} {} --help' says how", error.what(), machine.program, verb.name);
  }
  return &verb;
}

// The command line, quoted for a shell.
std::string command_line(int argc, char** argv, std::string line) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool plain = word.find_first_of(" \t\n\"'`\\$*?;&|<>()[]{}#~!") == word.npos && !word.empty();
    line += plain ? " " : " '";
    for (const char letter : word) line += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    if (!plain) line += "'";
  }
  return line;
}

int run(int argc, char** argv, const Machine& machine) {
  keep_freed_memory();
  leave_hdf5_alone_at_exit();
  std::vector<Verb> verbs = all_verbs();
  for (Verb& verb : verbs) verb.action = verb.declare(verb.command);
  const auto arguments = std::span<const char* const>(argv, static_cast<std::size_t>(argc)).subspan(argc > 0 ? 1 : 0);
  const Request request = parse_command_line(verbs, arguments, machine);
  const auto* verb = std::get_if<const Verb*>(&request);
  if (!machine.processes.alone())
    require_same({verb == nullptr ? -1.0 : static_cast<double>(*verb - verbs.data())}, "command line",
                 machine.processes);
  if (verb != nullptr) return (*verb)->action({command_line(argc, argv, machine.program), verbs, machine});
  fmt::print("{}", std::get<std::string>(request));
  return 0;
}

}  // namespace

void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) ::open("/dev/null", O_RDONLY);
}

Outcome run_program(int argc, char** argv, const Machine& machine) {
  try {
    const int code = run(argc, argv, machine);
    if (std::fflush(stdout) != 0) fail("standard output: cannot be written: {}", std::strerror(errno));
    return {code, ""};
  } catch (const FailedElsewhere&) {
    return {2, ""};
  } catch (const Error& error) {
    return {2, error.what()};
  } catch (const std::bad_alloc&) {
    return {2, "not enough memory for a problem of this size"};
  } catch (const std::system_error& error) {
    return {2, error.what()};
  }
}

}  // namespace nscdd::app
