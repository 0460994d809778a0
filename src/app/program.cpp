// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/program.hpp"

#include "app/options.hpp"
#include "files/hdf5.hpp"
#include <nscdd/core/choice.hpp>

#include <CLI/CLI.hpp>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <new>
#include <system_error>

namespace nscdd::app {
namespace {

// Every verb of the program.
std::vector<Verb> all_verbs() {
  return {
      {"sweep", "spectral radius of the contraction operator over epsilon, eta and more, as CSV", declare_sweep},
      {"run", "run a study: its tables as CSV and HDF5", declare_run},
      {"network", "contact network of a case: links, impulses, active contacts, as CSV", declare_network},
      {"inspect", "counts, interface, ranks, rigid modes and hyperstaticity of a case", declare_inspect},
      {"optimum", "best flexibility eta of the enriched algorithm for a case", declare_optimum},
      {"modes", "where the iteration is slow: impulses and velocities of the slowest mode, as CSV", declare_modes},
      {"simulate", "run a case that moves, step by step: trajectory as HDF5", declare_simulate},
      {"export", "write a run for ParaView, a step of it as a contact problem, or the operators of a case",
       declare_export},
      {"report", "one page to look at a packing or a run: radii, modes, criteria, force chains, as HTML",
       declare_report},
      {"generate", "write the packing of a generator or a case, as CSV or HDF5", declare_generate},
      {"solve", "solve a frictional contact problem of another program (FCLIB, Siconos)", declare_solve},
      {"list", "known cases, studies, generators, partitioners and observables", declare_list},
      {"manual", "write manual pages and the completion of bash into a folder", declare_manual},
  };
}

// Why a text is no value of the option; "" where it is one.
template <class Value>
std::string refusal(const Option& option, const std::string& text) {
  std::string expected;
  if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, Index>) {
    Value number{};
    bool good = CLI::detail::lexical_cast(text, number);
    expected = std::is_same_v<Value, Index> ? "an integer" : "a number";
    if (const auto& bounds = option.bounds) {
      good = good && number >= static_cast<Value>(bounds->first) && number <= static_cast<Value>(bounds->second);
      expected += fmt::format(" from {} to {}", bounds->first, bounds->second);
    }
    if (good) return "";
  } else {
    if (option.words.empty() || std::ranges::find(option.words, text) != option.words.end()) return "";
    expected = fmt::format("one of {}", fmt::join(option.words, ", "));
  }
  return fmt::format("expected {}, met '{}'{}", expected, text, suggestion(text, option.words));
}

// The value that an option takes, of which it may have one or none or many.
template <class Value>
Value value_of(const Value*);
template <class Value>
Value value_of(const std::optional<Value>*);
template <class Value>
Value value_of(const std::vector<Value>*);

void declare_all(CLI::App& command, const Command& described) {
  std::map<const Option*, CLI::Option*> made;
  for (const Option& option : described.options) {
    CLI::Option* one = made[&option] = std::visit(
        [&](auto* target) {
          if constexpr (std::is_same_v<decltype(target), bool*>)
            return command.add_flag(option.names, *target, option.help);
          else
            return command.add_option(option.names, *target, option.help)->check([&option](const std::string& text) {
              return refusal<decltype(value_of(target))>(option, text);
            });
        },
        option.target);
    one->required(option.required);
    // A list takes one value each time it is named: what follows may be another argument.
    if (std::holds_alternative<std::vector<std::string>*>(option.target)) one->allow_extra_args(false);
    if (option.needs != nullptr) one->needs(made.at(option.needs));
    if (option.excludes != nullptr) one->excludes(made.at(option.excludes));
  }
}

// Throws Error for a verb or a long option that does not exist, naming the nearest one.
void check_names(const std::vector<Verb>& verbs, std::span<const char* const> arguments, const Machine& machine) {
  const std::string_view first = arguments.front();
  if (first.starts_with('-')) return;
  const auto verb = std::ranges::find(verbs, first, &Verb::name);
  if (verb == verbs.end()) {
    std::vector<std::string> known;
    for (const Verb& each : verbs) known.push_back(each.name);
    fail("expected a verb ({}), met '{}'{}", fmt::join(known, ", "), first, suggestion(first, known));
  }
  if (!machine.serves(first))
    fail("expected a verb that several processes can share ({}), met '{}': nscdd has it on one",
         fmt::join(machine.verbs, ", "), first);
  const std::vector<std::string> known = verb->command.names();
  for (std::string_view argument : arguments.subspan(1)) {
    if (argument == "--") return;
    argument = argument.substr(0, argument.find('='));
    if (argument.starts_with("--") && std::ranges::find(known, argument) == known.end())
      fail("expected an option of {0} {1}, met '{2}'{3}; '{0} {1} --help' lists them", machine.program, verb->name,
           argument, suggestion(argument, known));
  }
}

// The errors of CLI11 that are left, in the words of the program.
std::string told(const CLI::ParseError& error) {
  const std::string text = error.what();
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
    return fmt::format("expected {}, met none",
                       text.starts_with("A ") ? "a verb" : text.substr(0, text.find(" is req")));
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr && text.find(": ") != std::string::npos)
    return fmt::format("{}: expected {}", text.substr(0, text.find(": ")),
                       text.ends_with(" missing") ? "a value, met none" : "it once, met it again");
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
    return fmt::format("expected no further argument, met '{}'", text.substr(text.rfind(": ") + 2));
  return text;
}

// What a command line asks for: a verb, the targets of whose options are set, or a text to print (help, version).
using Request = std::variant<const Verb*, std::string>;

// Throws Error for a line that does not fit the description, saying what was met and, where a verb or option is
// unknown, the nearest name there is.
Request parse_command_line(const std::vector<Verb>& verbs, int argc, const char* const* argv, const Machine& machine) {
  if (argc <= 1) return short_guide(verbs, machine);
  const auto arguments = std::span(argv, static_cast<std::size_t>(argc)).subspan(1);
  if (arguments.front() == std::string_view("help")) {
    if (arguments.size() == 1) return short_guide(verbs, machine);
    check_names(verbs, arguments.subspan(1), machine);
    const auto verb = std::ranges::find(verbs, std::string_view(arguments[1]), &Verb::name);
    return verb == verbs.end() ? short_guide(verbs, machine) : help_screen(*verb);
  }
  check_names(verbs, arguments, machine);
  CLI::App app("", machine.program);
  app.set_version_flag("--version", machine.program + " " + version());
  app.require_subcommand(1);
  std::vector<CLI::App*> commands;
  for (const Verb& verb : verbs) {
    commands.push_back(app.add_subcommand(verb.name, verb.summary));
    declare_all(*commands.back(), verb.command);
  }
  const auto asked = [&]() -> const Verb* {
    const auto found = std::ranges::find_if(commands, [](const CLI::App* command) { return command->parsed(); });
    return found == commands.end() ? nullptr : &verbs[static_cast<std::size_t>(found - commands.begin())];
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return asked() != nullptr ? help_screen(*asked()) : short_guide(verbs, machine);
  } catch (const CLI::CallForVersion& version) {
    return std::string(version.what()) + "\n";
  } catch (const CLI::ParseError& error) {
    fail("{}; '{} {}--help' says how", told(error), machine.program, asked() != nullptr ? asked()->name + " " : "");
  }
  return asked();
}

// The command line as a shell takes it.
std::string joined(int argc, char** argv, std::string line) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool plain = word.find_first_of(" \t\n\"'`\\$*?;&|<>()[]{}#~!") == word.npos && !word.empty();
    line += plain ? " " : " '";
    for (const char letter : word) line += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    if (!plain) line += "'";
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

int run(int argc, char** argv, const Machine& machine) {
  keep_freed_memory();
  leave_hdf5_alone_at_exit();
  std::vector<Verb> verbs = all_verbs();
  for (Verb& verb : verbs) verb.action = verb.declare(verb.command);
  const Request request = parse_command_line(verbs, argc, argv, machine);
  if (!machine.processes.alone()) {
    const auto* asked = std::get_if<const Verb*>(&request);
    require_same({asked == nullptr ? -1.0 : static_cast<double>(*asked - verbs.data())}, "command line",
                 machine.processes);
  }
  if (const auto* verb = std::get_if<const Verb*>(&request))
    return (*verb)->action({joined(argc, argv, machine.program), verbs, machine});
  fmt::print("{}", std::get<std::string>(request));
  return 0;
}

}  // namespace

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
