// SPDX-License-Identifier: GPL-3.0-or-later
// A file of two copies that take turns: what somebody else still has in hand does not change.
#include "../support/run_program.hpp"
#include "files/csv.hpp"
#include "files/output_file.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

using namespace nscdd;

namespace {

// A change that the spare copy of a small file gets a second time sooner than it is copied.
AlternatingFile::Change appended(const std::string& text) {
  return [text](const std::string& path) { std::ofstream(path, std::ios::app) << text; };
}

}  // namespace

TEST_CASE("alternating file: every version has all changes so far, in their order") {
  const testing::TemporaryFolder folder;
  const std::string path = folder / "file";
  AlternatingFile file(path);
  std::string expected(1 << 20, '.');
  file.create([&](const std::string& name) { std::ofstream(name) << expected; });
  for (const char* text : {"a", "b", "c", "d", "e"}) {
    file.change(appended(text));
    expected += text;
    CHECK((read_text(path) == expected));  // in brackets, so that a failure does not print a megabyte
  }
}

TEST_CASE("alternating file: a version with a second name, or in the hands of a reader, stays as it is") {
  const testing::TemporaryFolder folder;
  const std::string path = folder / "file", second = folder / "second";
  // So large that giving the spare copy the last change is faster than copying it anew.
  const std::string large(std::size_t{1} << 25, '.');
  for (const bool linked : {true, false}) {
    CAPTURE(linked);
    AlternatingFile file(path);
    file.create([&](const std::string& name) { std::ofstream(name) << large; });
    file.change(appended("a"));
    int reader = -1;
    if (linked) {
      std::filesystem::create_hard_link(path, second);
    } else {
      reader = ::open(path.c_str(), O_RDONLY);
      REQUIRE(::flock(reader, LOCK_SH) == 0);
    }
    file.change(appended("b"));
    file.change(appended("c"));
    CHECK((read_text(path) == large + "abc"));
    CHECK((read_text(linked ? second : "/proc/self/fd/" + std::to_string(reader)) == large + "a"));
    if (reader >= 0) ::close(reader);
  }
}
