// SPDX-License-Identifier: GPL-3.0-or-later
// Records of LMGC90's HDF5 file on the command line.
#include "../support/lmgc90_records.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("record: the page of a contact problem has the contacts of the record that is named, not of the last one") {
  const TemporaryFolder folder;
  const NetworkTexts texts = network_in_plane();
  RecordArrays first = arrays_of(texts.datbox, texts.contacts, {"zqsc0", "rstc0"}), last = first;
  first.step = 0.02;
  last.numbers.resize(last.numbers.size() - 22);
  last.contacts.resize(last.contacts.size() / (first.numbers.size() / 22) * (last.numbers.size() / 22));
  write_run(folder, texts.datbox, {{"ID_1", first}, {"ID_2", last}});
  const Outcome run = run_program(folder / "run", {"report", "lmgc90.h5:ID_1", "--epsilon", "1", "--eta", "inf",
                                                   "--no-optimum", "-o", "page.html"});
  CHECK(run.exit_code == 0);
  CHECK(run.standard_error.starts_with("nscdd: run: "));  // the name of the folder
  CHECK(read_file(folder / "run/page.html").find("the next step with h = 0.02 s\"") != std::string::npos);
  CHECK(run_program(folder / "run", {"solve", "lmgc90.h5:ID_1", "--csv", "t.csv"}).exit_code == 0);
  CHECK(read_file(folder / "run/t.csv").find("\nlmgc90.h5:ID_1,") != std::string::npos);
}
