// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "study/tables/study.hpp"

#include <sstream>

namespace nscdd::app {
namespace {

constexpr const char* exit_codes =
    "0 done, 1 a check failed, solve did not converge, a run broke down or a curve is not proved, "
    "2 bad input or usage, 130 interrupted";
constexpr std::size_t page_columns = 100, name_columns = 30;

std::string name_and_value(const Option& option) {
  std::string names = option.names;
  if (const auto comma = names.find(','); comma != std::string::npos) names.insert(comma + 1, " ");
  if (option.positional() || option.flag) return names;
  return names + " " + (option.words.empty() ? option.value : "WORD");
}

// In brackets after the help: the accepted words, if the help lacks any, and the default.
std::string remarks(const Option& option) {
  const auto named = [&](const std::string& word) { return option.help.find(word) != std::string::npos; };
  std::string words;
  if (!std::ranges::all_of(option.words, named)) words = fmt::format("{}", fmt::join(option.words, "|"));
  const std::string& initial = option.initial;
  if (words.empty() && initial.empty()) return option.required && !option.positional() ? " (required)" : "";
  return fmt::format(" [{}{}{}]", words, !words.empty() && !initial.empty() ? "; " : "", initial);
}

// Words in lines of at most `width` characters, indented from the second line on.
std::string wrapped(const std::string& text, std::size_t width, std::size_t indent) {
  std::istringstream words(text);
  std::string result;
  std::size_t used = 0;
  for (std::string word; words >> word;) {
    const bool fits = used + 1 + word.size() <= width;
    if (used > 0) result += fits ? " " : "\n" + std::string(indent, ' ');
    result += word;
    used = (used > 0 && fits ? used + 1 : 0) + word.size();
  }
  return result;
}

std::string option_line(const Option& option) {
  const std::string name = name_and_value(option);
  const std::string text = wrapped(option.help.substr(0, option.help.find("; ")) + remarks(option),
                                   page_columns - name_columns, name_columns);
  if (name.size() + 4 <= name_columns) return fmt::format("  {:<{}}{}\n", name, name_columns - 2, text);
  return fmt::format("  {}\n{}{}\n", name, std::string(name_columns, ' '), text);
}

std::string usage(const Verb& verb) {
  std::string line = "nscdd " + verb.name;
  for (const Option& option : verb.command.options)
    if (option.positional() || option.required) line += " " + name_and_value(option);
  return line + " [OPTIONS]";
}

// Escaped for troff: control characters at the beginning of lines, hyphens and backslashes.
std::string troff(const std::string& text) {
  std::string result;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\' || c == '-') result += '\\';
    result += c == '\\' ? 'e' : c;
    line_start = c == '\n';
  }
  return result;
}

std::string page_head(const std::string& name, const std::string& summary) {
  return fmt::format(".TH \"{}\" 1 \"\" \"nscdd {}\" \"nscdd\"\n.SH NAME\n{} \\- {}\n", troff(name), version(),
                     troff(name), troff(summary));
}

// The branch of one verb: the words of its options, its options, and known names.
std::string completion_branch(const Verb& verb) {
  std::string values, names;
  for (const Option& option : verb.command.options) {
    if (!option.words.empty())
      values += fmt::format("        {}) words=\"{}\" ;;\n", option.names, fmt::join(option.words, " "));
    if (option.names == "CASE") names = " $(nscdd list --names cases 2>/dev/null)";
    if (option.names == "STUDY") names = " $(nscdd list --names studies 2>/dev/null)";
  }
  if (!values.empty()) values = fmt::format("      case $previous in\n{}      esac\n", values);
  return fmt::format("    {})\n{}      [ -n \"$words\" ] || words=\"{}{}\"\n      ;;\n", verb.name, values,
                     fmt::join(verb.command.names(), " "), names);
}

// Manual pages in troff, section 1, of the program and of one verb ("nscdd-VERB").
std::string manual_page(const std::vector<Verb>& verbs) {
  std::string page = page_head("nscdd", "convergence study of domain decomposition for nonsmooth contact dynamics");
  page += ".SH SYNOPSIS\n.B nscdd\n.I VERB\n[\\fIOPTIONS\\fR]\n.SH VERBS\n";
  for (const Verb& verb : verbs)
    page += fmt::format(".TP\n.BR nscdd\\-{} (1)\n{}\n", troff(verb.name), troff(verb.summary));
  return page + fmt::format(".SH EXIT STATUS\n{}\n", troff(exit_codes));
}

std::string manual_page(const Verb& verb) {
  std::string page = page_head("nscdd-" + verb.name, verb.summary);
  page += fmt::format(".SH SYNOPSIS\n{}\n.SH OPTIONS\n", troff(usage(verb)));
  for (const Option& option : verb.command.options)
    page += fmt::format(".TP\n.B {}\n{}\n", troff(name_and_value(option)), troff(option.help + remarks(option)));
  page += fmt::format(".SH REMARKS\n.nf\n{}\n.fi\n", troff(verb.command.footer));
  return page + fmt::format(".SH EXIT STATUS\n{}\n.SH SEE ALSO\n.BR nscdd (1)\n", troff(exit_codes));
}

// Completes verbs, options and their words, known cases and studies, and files.
std::string bash_completion(const std::vector<Verb>& verbs) {
  std::string names, branches;
  for (const Verb& verb : verbs) {
    names += verb.name + " ";
    branches += completion_branch(verb);
  }
  return fmt::format(R"(# Completion of nscdd for bash, made by 'nscdd manual'.
_nscdd() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} words=""
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="{}--help --version"
  else
    case ${{COMP_WORDS[1]}} in
{}    esac
  fi
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F _nscdd nscdd
)",
                     names, branches);
}

struct ManualOptions {
  std::string folder;
  bool force = false;
};

int run_manual(const ManualOptions& options, const std::vector<Verb>& verbs) {
  const fs::path folder(options.folder);
  const auto write = [&](const fs::path& name, const std::string& text) {
    const fs::path path = folder / name;
    fs::create_directories(path.parent_path());
    write_file(path.string(), text, options.force);
    fmt::print("{}\n", path.string());
  };
  write("man1/nscdd.1", manual_page(verbs));
  for (const Verb& verb : verbs) write(fmt::format("man1/nscdd-{}.1", verb.name), manual_page(verb));
  write("bash-completion/nscdd", bash_completion(verbs));
  return 0;
}

}  // namespace

std::string short_guide(const std::vector<Verb>& verbs, const Machine& machine) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 4> examples{
      {{"sweep disks4 --epsilon 0,1 --csv -", "spectral radii of the 4 disks of the paper"},
       {"inspect mine.csv --subdomains 3x2", "your own packing: columns x,y,radius[,mass]"},
       {"run figure-5", "a figure of the paper, as a table"},
       {"simulate shear-1k --steps 20 -o twenty.h5", "grains that move, with friction"}}};
  std::string text = fmt::format("{} {}: how fast does domain decomposition converge on granular media?\n\nExamples:\n",
                                 machine.program, version());
  for (const auto& [line, what] : examples)
    if (machine.serves(line.substr(0, line.find(' '))))
      text += fmt::format("  {} {:<44}{}\n", machine.program, line, what);
  text += "\nVerbs:\n";
  for (const Verb& verb : verbs)
    if (machine.serves(verb.name)) text += fmt::format("  {:<10}{}\n", verb.name, verb.summary);
  return text + fmt::format(R"(
'{} VERB --help' has the options and examples of a verb, 'nscdd list' the known cases, studies and
parameters, 'man nscdd' the manual.
Exit codes: {}
)",
                            machine.program, exit_codes);
}

std::string help_screen(const Verb& verb) {
  std::string text = fmt::format("{}\nUsage: {}\n\n", verb.summary, usage(verb));
  for (const Option& option : verb.command.options) text += option_line(option);
  text += fmt::format("  {:<{}}this help; 'man nscdd-{}' has more\n", "-h, --help", name_columns - 2, verb.name);
  return text + "\n" + verb.command.footer + "\n";
}

Action declare_manual(Command& command) {
  auto options = std::make_shared<ManualOptions>();
  command.required("FOLDER", options->folder, "receives man1/*.1 and bash-completion/nscdd");
  command.add("--force", options->force, "replace existing files");
  command.footer = R"(An installation has these files in their places already.
Examples:
  nscdd manual pages)";
  return [options](const Context& context) { return run_manual(*options, context.verbs); };
}

}  // namespace nscdd::app
