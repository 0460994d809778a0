// SPDX-License-Identifier: GPL-3.0-or-later
#include "session.hpp"

#include <doctest/doctest.h>

#include <algorithm>
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

std::string answer(const Session& session, const std::vector<std::string>& arguments) {
  const Outcome outcome = session.run(arguments);
  CHECK(outcome.standard_error == "");
  REQUIRE(outcome.exit_code == 0);
  return outcome.standard_output;
}

std::string answer(const Session& session, const std::string& line) { return answer(session, words(line)); }

CsvTable table(const Session& session, const std::string& line) {
  return read_table(answer(session, line + " --csv -"));
}

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

std::string remarked(const Session& session, const std::string& line, const std::string& part) {
  const Outcome outcome = session.run(words(line));
  CAPTURE(line);
  CAPTURE(outcome.standard_error);
  CHECK(times(outcome.standard_error, part) == 1);
  CHECK(times(outcome.standard_error, "\n") == 1);
  REQUIRE(outcome.exit_code == 0);
  return outcome.standard_output;
}

void check_refused(const Session& session, const std::vector<std::string>& arguments,
                   std::initializer_list<std::string> parts, const RunOptions& options) {
  const auto before = content_of(session.folder.path());
  const Outcome outcome = session.run(arguments, options);
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
  for (const std::string& part : parts) {
    CAPTURE(part);
    CHECK(message.find(part) != std::string::npos);
  }
  CHECK(difference(before, content_of(session.folder.path())) == "");
}

void check_refused(const Session& session, const std::string& line, std::initializer_list<std::string> parts,
                   const RunOptions& options) {
  check_refused(session, words(line), parts, options);
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
