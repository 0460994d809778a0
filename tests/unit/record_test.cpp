// SPDX-License-Identifier: GPL-3.0-or-later
// Records of LMGC90's HDF5 file against the text files of the same step: equal contact problems and equal states.
#include "formats/lmgc90/record.hpp"

#include "../support/lmgc90_records.hpp"
#include "../support/spoilt.hpp"
#include "files/hdf5_file.hpp"
#include "formats/case/case_file.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"
#include "formats/report/problem_report.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

void check_same(const FclibFile& met, const FclibFile& expected) {
  const auto &p = std::get<GlobalFrictionProblem>(met.problem), &q = std::get<GlobalFrictionProblem>(expected.problem);
  CHECK(p.dimension == q.dimension);
  const auto close = [](const Matrix& a, const Matrix& b) {
    REQUIRE(a.rows() == b.rows());
    REQUIRE(a.cols() == b.cols());
    CHECK((a - b).cwiseAbs().maxCoeff() <= 1e-14 * b.cwiseAbs().maxCoeff());
  };
  close(p.mass, q.mass);
  close(p.h, q.h);
  close(p.f, q.f);
  close(p.w, q.w);
  close(p.friction, q.friction);
  close(met.points, expected.points);
  REQUIRE(met.guesses.size() == 1);
  close(met.guesses[0].v, expected.guesses[0].v);
  close(met.guesses[0].r, expected.guesses[0].r);
}

FclibFile problem_of_texts(const NetworkTexts& texts) {
  const Datbox datbox = parse_datbox(texts.datbox, "box", DatboxShapes::any);
  return contact_problem_of(datbox, parse_vloc_rloc(texts.contacts, "box/Vloc_Rloc.INI", datbox), "box/Vloc_Rloc.INI");
}

}  // namespace

TEST_CASE("record: a contact problem in the plane is that of Vloc_Rloc, with the time step of the record") {
  const TemporaryFolder folder;
  const NetworkTexts texts = network_in_plane();
  RecordArrays arrays = arrays_of(texts.datbox, texts.contacts, {"zqsc0", "rstc0"}), empty = arrays;
  arrays.step = 0.01;
  empty.numbers.clear();
  RecordArrays longer = arrays;
  longer.step = 0.02;
  const std::string file = write_run(folder, texts.datbox, {{"ID_2", empty}, {"ID_9", longer}, {"ID_10", arrays}});
  const FclibFile expected = problem_of_texts(texts);
  check_same(read_contact_problem(file), expected);  // the last one
  check_same(read_contact_problem(file + ":ID_10"), expected);
  const FclibFile slower = read_contact_problem(file + ":ID_9");
  CHECK((slower.guesses[0].r - 2 * expected.guesses[0].r).norm() < 1e-14);
  CHECK(slower.info.title == "contacts of LMGC90 at step 10, time 0.1 s; the next step with h = 0.02 s");
  check_error([&] { read_contact_problem(file + ":ID_2"); }, {"lmgc90.h5:ID_2:", "contacts", "none"});
  check_error([&] { read_contact_problem(file + ":ID_3"); },
              {"lmgc90.h5: Evolution:", "one of its 3 records, ID_2 to ID_10", "ID_3"});
  check_error([&] { read_contact_problem((folder / "no.h5:ID_3").string()); }, {"no.h5: no such file"});
}

TEST_CASE("record: a contact problem in space is that of Vloc_Rloc") {
  const TemporaryFolder folder;
  const NetworkTexts texts = box_on_plane();
  RecordArrays arrays = arrays_of(texts.datbox, texts.contacts, {"iqsc0"});
  arrays.step = 0.005;  // the default of a text of step 0
  check_same(read_contact_problem(write_run(folder, texts.datbox, {{"ID_1", arrays}})), problem_of_texts(texts));
}

TEST_CASE("record: levers of disks, of hollow disks and of clusters are those of Vloc_Rloc") {
  const TemporaryFolder folder;
  DatboxTexts texts = small_datbox();
  texts.bodies = replaced(texts.bodies, "JONCx      1  color  WALLx  ax1 = 3.0000000E+00  ax2 = 5.0000000E-01",
                          "xKSID      1  color  WALLx  byrd= 0.3000000D+01");
  texts.driven.clear();
  texts.initial = "$steps       10              time= 0.1000000D+00\n";
  std::string contacts = texts.initial;
  const auto add = [&](const std::string& kind, const std::string& candidate, const std::string& antagonist) {
    contacts += "$icdan  " + kind +
                "        1\n cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus  iadj\n RBDY2      " +
                candidate + "      1  iqsc1  RBDY2      " + antagonist + R"(  stick     1
                             rlt/H 0.4000000D+01  rln/H 0.1200000D+02  rls/H 0.0000000D+00
                             vlt = 0.1000000D+00  vln = 0.2000000D+00  vls = 0.0000000D+00
                             gapTT 0.5000000D+00
                             n(1)= 0.0000000D+00  n(2)= 0.1000000D+01  n(3)= 0.0000000D+00
                             coo1= 0.1000000D+01  coo2= 0.1750000D+01  coo3= 0.0000000D+00
)";
  };
  add("DKKDx", "1  DISKx", "2  xKSID      1");
  add("DKKDx", "3  DISKb", "2  xKSID      1");
  add("DKDKx", "1  DISKx", "3  DISKb      2");
  RecordArrays arrays = arrays_of(texts, contacts, {"iqsc0", "other", "iqsc1"});
  arrays.step = 0.01;
  const FclibFile expected = problem_of_texts({texts, contacts});
  const std::string run = write_run(folder, texts, {{"ID_1", arrays}});
  check_same(read_contact_problem(run), expected);
  const std::vector<RememberedImpulse> forces = read_contact_forces(run).forces;
  REQUIRE(forces.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) {  // the wall comes after the disk and the cluster
    CHECK(std::pair(forces[k].a, forces[k].b) ==
          std::array{std::pair(0L, 2L), std::pair(0L, 3L), std::pair(1L, 3L)}[k]);
    CHECK(forces[k].impulse == std::array{12.0, -4.0, 0.0});
    CHECK(!forces[k].slid);
  }
  const Matrix h = std::get<GlobalFrictionProblem>(expected.problem).h.toDense();
  REQUIRE(h.rows() == 9);
  CHECK(h(2, 1) == doctest::Approx(0.25));             // -r n x t of the disk
  CHECK(h(5, 1) == doctest::Approx(-3));               // of the hollow disk
  CHECK(h(8, 3) == doctest::Approx(20 - 1.75));        // of the cluster, to the point
  CHECK(h(8, 5) == doctest::Approx(1.75 - 0.5 - 20));  // to its own surface
}

TEST_CASE("record: a contact problem of other contacts than those of the model is not reported") {
  const TemporaryFolder folder;
  const NetworkTexts texts = network_in_plane();
  RecordArrays first = arrays_of(texts.datbox, texts.contacts, {"zqsc0", "rstc0"}), last = first;
  last.numbers.resize(last.numbers.size() - 22);
  last.contacts.resize(last.contacts.size() / (first.numbers.size() / 22) * (last.numbers.size() / 22));
  const std::string file = write_run(folder, texts.datbox, {{"ID_1", first}, {"ID_2", last}});
  const Model model = build(resolve(spec_of_file(file + ":ID_1")));
  check_error([&] { report_problem(model, read_contact_problem(file), "last"); },
              {"last: expected the 2 contacts of the model, met 1"});
}

TEST_CASE("record: the initial state of a case that moves, in place of DOF.INI") {
  for (const DatboxTexts& texts : {small_datbox(), small_datbox_in_space()}) {
    const TemporaryFolder folder;
    const Datbox expected = parse_datbox(texts, "box");
    const std::string file = write_run(folder, texts, {{"ID_1", arrays_of(texts, "", {})}});
    const Datbox met = read_datbox(file + ":ID_1");
    CHECK(met.start == doctest::Approx(expected.start).epsilon(1e-15));
    for (std::size_t k = 0; k < expected.bodies.size(); ++k) {
      const DatboxBody &a = met.bodies[k], &b = expected.bodies[k];
      CHECK((a.position - b.position).norm() < 1e-14 * (1 + b.position.norm()));
      CHECK((a.velocity == b.velocity && a.spin == b.spin));
      CHECK(a.frame == b.frame);
    }
    const CaseSpec moving = spec_of_file(file, true);
    CHECK(moving.name == "run");
    REQUIRE(moving.dynamics.has_value());
    CHECK(resolve(moving).packing.size() == datbox_packing(expected, DatboxGrains::all).size());
    CHECK(std::holds_alternative<ContactProblemFile>(spec_of_file(file, false).packing));
    CHECK(datbox_files(file).front() == file);
  }
}

TEST_CASE("record: what does not fit is refused by file and dataset") {
  const NetworkTexts texts = network_in_plane();
  const auto spoil = [&](const std::function<void(RecordArrays&)>& change, const Names& names) {
    const TemporaryFolder folder;
    RecordArrays arrays = arrays_of(texts.datbox, texts.contacts, {"zqsc0", "rstc0"});
    change(arrays);
    const std::string file = write_run(folder, texts.datbox, {{"ID_4", arrays}});
    check_error([&] { read_contact_problem(file); }, names);
  };
  using Arrays = RecordArrays&;
  const std::string bodies = "lmgc90.h5: Evolution/ID_4/RBDY2", contacts = "lmgc90.h5: Evolution/ID_4/VlocRloc";
  spoil([](Arrays a) { a.space = true; }, {bodies, "a group", "none"});
  spoil([](Arrays a) { a.state.resize(12), a.visible.resize(2); }, {bodies + "/rdata", "3 rows", "met 2"});
  spoil([](Arrays a) { a.state.resize(9); }, {bodies + "/rdata", "6 columns", "met 3"});
  spoil([](Arrays a) { a.visible[2] = 0; }, {bodies + "/idata:3:", "visible"});
  spoil([](Arrays a) { a.numbers[4] = 3; }, {contacts + "/idata:1:", "two bodies RBDY2", "another kind"});
  spoil([](Arrays a) { a.numbers[22 + 7] = 4; }, {contacts + "/idata:2:", "3 bodies of BODIES.DAT", "met 4"});
  spoil([](Arrays a) { a.numbers[7] = 1; }, {contacts + "/idata:1:", "two bodies", "body 1 twice"});
  spoil([](Arrays a) { a.numbers[16] = 0; }, {contacts + "/idata:1:", "2 laws of TACT_BEHAV.DAT", "met 0"});
  spoil([](Arrays a) { a.contacts[8] = 0.5; }, {contacts + "/idata:1:", "a unit vector n", "0.5"});
  spoil([](Arrays a) { a.contacts[13] = not_a_number; }, {contacts + "/idata:2:", "finite numbers"});
  spoil([](Arrays a) { a.step = not_a_number; }, {"lmgc90.h5: Evolution/ID_4/dt", "finite number >= 0"});
  spoil([](Arrays a) { a.contacts.resize(16); }, {contacts + "/rdata", "9 columns", "met 8"});
  const TemporaryFolder folder;
  const std::string file = write_run(folder, texts.datbox, {});
  CHECK_FALSE(record_at(file).has_value());  // no group Evolution
  check_error([&] { read_contact_problem(file + ":ID_1"); }, {"lmgc90.h5: Evolution", "a group", "none"});
  write_file(folder / "run/lmgc90.h5", "text");
  CHECK_FALSE(record_at(file).has_value());
  check_error([&] { read_contact_problem(file + ":ID_1"); }, {"lmgc90.h5", "an HDF5 file of LMGC90"});
}
