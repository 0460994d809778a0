// SPDX-License-Identifier: GPL-3.0-or-later
#include "session.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace nscdd::testing {
namespace {

// The files that differ, rather than all bytes of all files.
std::string difference(const std::map<std::string, std::string>& before,
                       const std::map<std::string, std::string>& after) {
  std::string names;
  for (const auto& [name, content] : after) {
    const auto found = before.find(name);
    if (found == before.end()) {
      names += "new: " + name + "\n";
    } else if (found->second != content) {
      names += "changed: " + name + "\n";
    }
  }
  for (const auto& [name, content] : before)
    if (after.count(name) == 0) names += "gone: " + name + "\n";
  return names;
}

}  // namespace

std::vector<std::string> words(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> all;
  for (std::string word; stream >> word;) all.push_back(word);
  return all;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

int run_script(const std::string& script, const Texts& arguments, const std::string& output) {
  std::string command =
      "OPENBLAS_NUM_THREADS=1 /usr/bin/python3 -B '" + (source_folder() / "tests" / script).string() + "'";
  for (const std::string& argument : arguments) command += " '" + argument + "'";
  if (!output.empty()) command += " > '" + output + "'";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

Outcome Session::run(const std::string& line, const RunOptions& options) const { return run(words(line), options); }

Outcome Session::ended(int exit_code, const std::string& line, std::initializer_list<std::string> said,
                       const RunOptions& options) const {
  const Outcome outcome = run(line, options);
  INFO("line = ", line, ", outcome.standard_error = ", outcome.standard_error);
  CHECK(outcome.exit_code == exit_code);
  for (const std::string& part : said) CHECK_MESSAGE(contains(outcome.standard_error, part), part);
  return outcome;
}

std::string Session::answer(const Texts& arguments) const {
  const Outcome outcome = run(arguments);
  CHECK(outcome.standard_error == "");
  REQUIRE(outcome.exit_code == 0);
  return outcome.standard_output;
}

std::string Session::answer(const std::string& line) const { return answer(words(line)); }

std::string Session::remarked(const std::string& line, const std::string& part) const {
  const Outcome outcome = ended(0, line);
  CHECK(times(outcome.standard_error, part) == 1);
  CHECK(times(outcome.standard_error, "\n") == 1);
  REQUIRE(outcome.exit_code == 0);
  return outcome.standard_output;
}

void Session::check_refused(const Texts& arguments, std::initializer_list<std::string> parts,
                            const RunOptions& options) const {
  const auto before = content_of(folder.path());
  const Outcome outcome = run(arguments, options);
  std::string line;
  for (const std::string& word : arguments) line += " " + word;
  CAPTURE(line);
  CHECK(outcome.exit_code == 2);
  CHECK(outcome.standard_output == "");
  // remarks ("nscdd: ...") may come before it
  const std::string message = outcome.standard_error.substr(
      std::min(("\n" + outcome.standard_error).find("\nnscdd: error: "), outcome.standard_error.size()));
  CAPTURE(outcome.standard_error);
  CHECK(message != "");
  for (const std::string& part : parts) CHECK_MESSAGE(contains(message, part), part);
  CHECK(difference(before, content_of(folder.path())) == "");
}

void Session::check_refused(const std::string& line, std::initializer_list<std::string> parts,
                            const RunOptions& options) const {
  check_refused(words(line), parts, options);
}

std::string row_of_three() { return "x,y,radius\n0,0,0.5\n1,0,0.5\n2,0,0.5\n9,9,0.5\n"; }

std::string value(const std::string& report, const std::string& name) {
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind(name + " ", 0) == 0) {
      std::istringstream rest(line.substr(name.size()));
      std::string first;
      rest >> first;
      return first;
    }
  return "";
}

}  // namespace nscdd::testing
