// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/manual.hpp"

#include <nscdd/core/version.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace nscdd::app {
namespace {

constexpr std::string_view exit_codes =
    "0 done, 1 a check failed or a computation did not converge, 2 bad input or usage, 130 interrupted";
constexpr std::size_t columns = 100, name_columns = 30;

// What stands for the value of an option.
std::string placeholder(const Option& option) {
  struct Name {
    std::string operator()(const std::string*) const { return "TEXT"; }
    std::string operator()(const std::optional<std::string>*) const { return "TEXT"; }
    std::string operator()(const std::vector<std::string>*) const { return "TEXT"; }
    std::string operator()(const double*) const { return "NUMBER"; }
    std::string operator()(const std::optional<double>*) const { return "NUMBER"; }
    std::string operator()(const Index*) const { return "N"; }
    std::string operator()(const std::optional<Index>*) const { return "N"; }
    std::string operator()(const bool*) const { return ""; }
  };
  if (!option.words().empty()) return "WORD";
  return std::visit(Name{}, option.target());
}

std::string name_and_value(const Option& option) {
  std::string names = option.names();
  if (const auto comma = names.find(','); comma != std::string::npos) names.insert(comma + 1, " ");
  return option.positional() || option.flag() ? names : names + " " + placeholder(option);
}

std::string default_text(const Option& option) {
  struct Text {
    std::string operator()(const std::string* value) const { return *value; }
    std::string operator()(const double* value) const { return fmt::format("{}", *value); }
    std::string operator()(const Index* value) const { return fmt::format("{}", *value); }
    std::string operator()(const void*) const { return ""; }  // flags, lists and options that may be absent
  };
  return option.has_default() ? std::visit(Text{}, option.target()) : "";
}

// In brackets behind the help: the words it admits where the help does not name them, and the default.
std::string remarks(const Option& option) {
  std::string words;
  for (const std::string& word : option.words())
    if (option.help().find(word) == std::string::npos) words = fmt::format("{}", fmt::join(option.words(), "|"));
  const std::string initial = default_text(option);
  if (words.empty() && initial.empty()) return option.is_required() && !option.positional() ? " (required)" : "";
  return fmt::format(" [{}{}{}]", words, !words.empty() && !initial.empty() ? "; " : "", initial);
}

std::string first_part(const std::string& help) { return help.substr(0, help.find("; ")); }

// Words set in lines of at most `width` characters, each line after the first behind `indent` blanks.
std::string wrapped(const std::string& text, std::size_t width, std::size_t indent) {
  std::istringstream words(text);
  std::string result;
  std::size_t used = 0;
  for (std::string word; words >> word;) {
    if (used > 0 && used + 1 + word.size() > width) {
      result += "\n" + std::string(indent, ' ');
      used = 0;
    }
    result += (used > 0 ? " " : "") + word;
    used += (used > 0 ? 1 : 0) + word.size();
  }
  return result;
}

std::string option_line(const Option& option) {
  const std::string name = name_and_value(option);
  const std::string text = wrapped(first_part(option.help()) + remarks(option), columns - name_columns, name_columns);
  if (name.size() + 4 <= name_columns) return fmt::format("  {:<{}}{}\n", name, name_columns - 2, text);
  return fmt::format("  {}\n{}{}\n", name, std::string(name_columns, ' '), text);
}

std::string usage(const DescribedVerb& verb) {
  std::string line = "nscdd " + verb.name;
  for (const Option& option : verb.command.options())
    if (option.positional()) line += " " + option.names();
  for (const Option& option : verb.command.options())
    if (!option.positional() && option.is_required()) line += " " + name_and_value(option);
  return line + " [OPTIONS]";
}

// Text as troff takes it: no line begins with a control character, hyphens and backslashes stand for
// themselves.
std::string troff(const std::string& text) {
  std::string result;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
    line_start = c == '\n';
  }
  return result;
}

std::string page_head(const std::string& name, const std::string& summary) {
  return fmt::format(".TH \"{}\" 1 \"\" \"nscdd {}\" \"nscdd\"\n.SH NAME\n{} \\- {}\n", troff(name), version(),
                     troff(name), troff(summary));
}

std::string literal_block(const std::string& text) { return fmt::format(".nf\n{}\n.fi\n", troff(text)); }

std::string quoted_words(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

std::vector<std::string> option_names(const Command& command) {
  std::vector<std::string> all{"--help"};
  for (const Option& option : command.options()) {
    if (option.positional()) continue;
    std::istringstream names(option.names());
    for (std::string name; std::getline(names, name, ',');) all.push_back(name);
  }
  return all;
}

// The branch of one verb: what may follow an option with words, and what else there is.
std::string completion_branch(const DescribedVerb& verb) {
  std::string values, names;
  for (const Option& option : verb.command.options()) {
    if (!option.words().empty())
      values += fmt::format("        {}) words=\"{}\" ;;\n", option.names(), quoted_words(option.words()));
    if (option.names() == "CASE") names = " $(nscdd list --names cases 2>/dev/null)";
    if (option.names() == "STUDY") names = " $(nscdd list --names studies 2>/dev/null)";
  }
  if (!values.empty()) values = fmt::format("      case $previous in\n{}      esac\n", values);
  return fmt::format("    {})\n{}      [ -n \"$words\" ] || words=\"{}{}\"\n      ;;\n", verb.name, values,
                     quoted_words(option_names(verb.command)), names);
}

}  // namespace

std::string short_guide(const std::vector<DescribedVerb>& verbs) {
  std::string text = fmt::format(
      "nscdd {}: how fast does domain decomposition converge on granular media?\n\nExamples:\n"
      "  nscdd sweep disks4 --epsilon 0,1 --csv -          spectral radii of the 4 disks of the paper\n"
      "  nscdd inspect mine.csv --subdomains 3x2           your own packing: columns x,y,radius[,mass]\n"
      "  nscdd run figure-5                                a figure of the paper, as a table\n"
      "  nscdd simulate shear-1k --steps 20 -o twenty.h5   grains that move, with friction\n\nVerbs:\n",
      version());
  for (const DescribedVerb& verb : verbs) text += fmt::format("  {:<10}{}\n", verb.name, verb.summary);
  return text +
         "\n'nscdd VERB --help' has the options and examples of a verb, 'nscdd list' the known cases, "
         "studies "
         "and\nparameters, 'man nscdd' the manual.\nExit codes: " +
         std::string(exit_codes) + "\n";
}

std::string help_screen(const DescribedVerb& verb) {
  std::string text = fmt::format("{}\nUsage: {}\n\n", verb.summary, usage(verb));
  for (const Option& option : verb.command.options()) text += option_line(option);
  text += fmt::format("  {:<{}}this help; 'man nscdd-{}' has more\n", "-h, --help", name_columns - 2, verb.name);
  return text + "\n" + verb.command.footer() + "\n";
}

std::string manual_page(const std::vector<DescribedVerb>& verbs) {
  std::string page = page_head("nscdd", "convergence study of domain decomposition for nonsmooth contact dynamics");
  page += ".SH SYNOPSIS\n.B nscdd\n.I VERB\n[\\fIOPTIONS\\fR]\n.SH VERBS\n";
  for (const DescribedVerb& verb : verbs)
    page += fmt::format(".TP\n.BR nscdd\\-{} (1)\n{}\n", troff(verb.name), troff(verb.summary));
  return page + fmt::format(".SH EXIT STATUS\n{}\n", troff(std::string(exit_codes)));
}

std::string manual_page(const DescribedVerb& verb) {
  std::string page = page_head("nscdd-" + verb.name, verb.summary);
  page += fmt::format(".SH SYNOPSIS\n{}\n.SH OPTIONS\n", troff(usage(verb)));
  for (const Option& option : verb.command.options())
    page += fmt::format(".TP\n.B {}\n{}\n", troff(name_and_value(option)), troff(option.help() + remarks(option)));
  page += fmt::format(".SH REMARKS\n{}", literal_block(verb.command.footer()));
  return page + fmt::format(".SH EXIT STATUS\n{}\n.SH SEE ALSO\n.BR nscdd (1)\n", troff(std::string(exit_codes)));
}

std::string bash_completion(const std::vector<DescribedVerb>& verbs) {
  std::string names, branches;
  for (const DescribedVerb& verb : verbs) {
    names += (names.empty() ? "" : " ") + verb.name;
    branches += completion_branch(verb);
  }
  return fmt::format(
      "# Completion of nscdd for bash, made by 'nscdd manual'.\n"
      "_nscdd() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} words=\"\"\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    words=\"{} --help --version\"\n"
      "  else\n"
      "    case ${{COMP_WORDS[1]}} in\n{}    esac\n"
      "  fi\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "}}\n"
      "complete -o default -F _nscdd nscdd\n",
      names, branches);
}

}  // namespace nscdd::app
