// SPDX-License-Identifier: GPL-3.0-or-later
// Records of LMGC90's HDF5 file against the text files of the same step: equal contact problems and equal states.
#include "formats/lmgc90/record.hpp"

#include "../support/datbox_texts.hpp"
#include "../support/network_texts.hpp"
#include "../support/run_program.hpp"
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

// The arrays of a record in the layout of format 0.2.
struct RecordArrays {
  bool space = false;
  double time = 0, step = 0;
  std::vector<double> state = {}, contacts = {};
  std::vector<std::int32_t> visible = {}, numbers = {};
};

void append(std::vector<double>& values, std::initializer_list<double> more) { values.insert(values.end(), more); }

void append_three(std::vector<double>& values, const Eigen::Vector3d& v) { append(values, {v[0], v[1], v[2]}); }

// The state and the contacts that the text files have. Laws are numbered by `laws`.
RecordArrays arrays_of(const DatboxTexts& texts, const std::string& contacts, const std::vector<std::string>& laws) {
  DatboxTexts still = texts;
  still.initial.clear();
  const Datbox moved = parse_datbox(texts, "box", DatboxShapes::any),
               start = parse_datbox(still, "box", DatboxShapes::any);
  RecordArrays arrays{.space = moved.space(), .time = moved.start};
  for (std::size_t k = 0; k < moved.bodies.size(); ++k) {
    const DatboxBody& body = moved.bodies[k];
    append_three(arrays.state, body.position - start.bodies[k].position);
    if (moved.space()) append(arrays.state, {0, 0, 0});
    append_three(arrays.state, body.velocity);
    if (moved.space()) append_three(arrays.state, body.spin);
    for (Index axis = 0; moved.space() && axis < 3; ++axis) append_three(arrays.state, body.frame.col(axis));
    arrays.visible.push_back(1);
  }
  const DatboxNetwork network = parse_vloc_rloc(contacts, "Vloc_Rloc.INI", moved);
  for (const DatboxContact& one : network.contacts) {
    const auto cd = static_cast<std::int32_t>(one.candidate + 1), an = static_cast<std::int32_t>(one.antagonist + 1);
    const auto law = static_cast<std::int32_t>(std::ranges::find(laws, one.law) - laws.begin() + 1);
    const std::int32_t kind = moved.space() ? 2 : 1;
    const std::int32_t id = one.kind == "DKDKx" ? 1 : one.kind == "DKKDx" ? 2 : 7;  // as in mod_parameters.f90
    for (const std::int32_t number :
         {id, 1, cd, an, kind, kind, cd, an, 3, 4, 1, 1, 1, 1, 1, 1, law, 0, one.slid ? 6 : 4, 0, 0, 0})
      arrays.numbers.push_back(number);
    const auto n_second = [&](const Eigen::Vector3d& v) {  // (t, n), or (t, n, s)
      append(arrays.contacts, {v[1], v[0]});
      if (moved.space()) arrays.contacts.push_back(v[2]);
    };
    const auto vector = [&](const Eigen::Vector3d& v) {
      arrays.contacts.insert(arrays.contacts.end(), v.begin(), v.begin() + moved.dimension);
    };
    n_second(one.force);
    n_second(one.speed);
    arrays.contacts.push_back(one.gap);
    vector(one.point);
    if (moved.space()) vector(one.frame.col(1));
    vector(one.frame.col(0));
    if (moved.space()) vector(one.frame.col(2));
    arrays.contacts.push_back(1e9);  // data of laws
  }
  return arrays;
}

template <class Value>
void put_rows(const hdf5::Group& group, const char* name, const std::vector<Value>& values, std::size_t rows) {
  group.put<Value>(name, values, {.rows = rows});
}

void write_record(const hdf5::Group& root, const std::string& name, const RecordArrays& arrays) {
  const hdf5::Group record = root.make_group("Evolution").make_group(name);
  const std::int32_t number = 10;
  record.put<std::int32_t>("NStep", std::span(&number, 1));
  record.put<double>("TPS", std::span(&arrays.time, 1));
  record.put<double>("dt", std::span(&arrays.step, 1));
  const hdf5::Group bodies = record.make_group(arrays.space ? "RBDY3" : "RBDY2");
  put_rows(bodies, "rdata", arrays.state, arrays.visible.size());
  put_rows(bodies, "idata", arrays.visible, arrays.visible.size());
  if (arrays.numbers.empty()) return;
  const hdf5::Group contacts = record.make_group("VlocRloc");
  put_rows(contacts, "idata", arrays.numbers, arrays.numbers.size() / 22);
  put_rows(contacts, "rdata", arrays.contacts, arrays.numbers.size() / 22);
}

// DATBOX with another state in its DOF.INI, and lmgc90.h5 with these records beside it.
std::string write_run(const TemporaryFolder& folder, const DatboxTexts& texts,
                      const std::vector<std::pair<std::string, RecordArrays>>& records) {
  write_file(folder / "run/DATBOX/BODIES.DAT", texts.bodies);
  write_file(folder / "run/DATBOX/BULK_BEHAV.DAT", texts.bulk);
  write_file(folder / "run/DATBOX/TACT_BEHAV.DAT", texts.tact);
  write_file(folder / "run/DATBOX/DRV_DOF.DAT", texts.driven);
  write_file(folder / "run/DATBOX/DOF.INI", "$steps        0              time= 0.9000000D+01\n");
  write_file(folder / "run/lmgc90.h5", hdf5::new_file_bytes([&](const hdf5::Group& root) {
               for (const auto& [name, arrays] : records) write_record(root, name, arrays);
             }));
  return (folder / "run/lmgc90.h5").string();
}

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

// The square has moved by 1 cm; laws in an order that is not that of their names.
NetworkTexts network_in_plane() {
  NetworkTexts texts = square_on_plank();
  texts.datbox.initial = replaced(texts.datbox.initial, "X(2)= 0.0000000D+00", "X(2)= 0.1000000D-01");
  for (std::string* text : {&texts.datbox.tact, &texts.contacts}) *text = replaced(*text, "iqsc0", "zqsc0");
  texts.datbox.tact = replaced(texts.datbox.tact, "IQS_CLB                         fric= 0.5000000D+00",
                               "IQS_DS_CLB                      dfrc= 0.5000000D+00  sfrc= 0.7500000D+00");
  texts.contacts = replaced(texts.contacts, "stick     1", "slibw     1");
  return texts;
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
                candidate + "      1  iqsc1  RBDY2      " + antagonist + R"(      1  stick     1
                             rlt/H 0.4000000D+01  rln/H 0.1200000D+02  rls/H 0.0000000D+00
                             vlt = 0.1000000D+00  vln = 0.2000000D+00  vls = 0.0000000D+00
                             gapTT 0.5000000D+00
                             n(1)= 0.0000000D+00  n(2)= 0.1000000D+01  n(3)= 0.0000000D+00
                             coo1= 0.1000000D+01  coo2= 0.1750000D+01  coo3= 0.0000000D+00
)";
  };
  add("DKKDx", "1  DISKx", "2  xKSID");
  add("DKKDx", "3  DISKb", "2  xKSID");
  add("DKDKx", "1  DISKx", "3  DISKb");
  RecordArrays arrays = arrays_of(texts, contacts, {"iqsc0", "other", "iqsc1"});
  arrays.step = 0.01;
  const FclibFile expected = problem_of_texts({texts, contacts});
  check_same(read_contact_problem(write_run(folder, texts, {{"ID_1", arrays}})), expected);
  const Matrix h = std::get<GlobalFrictionProblem>(expected.problem).h.toDense();
  REQUIRE(h.rows() == 9);
  CHECK(h(2, 1) == doctest::Approx(0.25));             // -r n x t of the disk
  CHECK(h(5, 1) == doctest::Approx(-3));               // of the hollow disk
  CHECK(h(8, 3) == doctest::Approx(20 - 1.75));        // of the cluster, to the point
  CHECK(h(8, 5) == doctest::Approx(1.75 - 0.5 - 20));  // to its own surface
}

TEST_CASE("record: the page of a contact problem has the contacts of the record that is named, not of the last one") {
  const TemporaryFolder folder;
  const NetworkTexts texts = network_in_plane();
  RecordArrays first = arrays_of(texts.datbox, texts.contacts, {"zqsc0", "rstc0"}), last = first;
  first.step = 0.02;
  last.numbers.resize(last.numbers.size() - 22);
  last.contacts.resize(last.contacts.size() / (first.numbers.size() / 22) * (last.numbers.size() / 22));
  const std::string file = write_run(folder, texts.datbox, {{"ID_1", first}, {"ID_2", last}});
  const Outcome run = run_program(folder / "run", {"report", "lmgc90.h5:ID_1", "--epsilon", "1", "--eta", "inf",
                                                   "--no-optimum", "-o", "page.html"});
  CHECK(run.exit_code == 0);
  CHECK(run.standard_error.starts_with("nscdd: run: "));  // the name of the folder
  CHECK(read_file(folder / "run/page.html").find("the next step with h = 0.02 s\"") != std::string::npos);
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
      CHECK(a.velocity == b.velocity);
      CHECK(a.spin == b.spin);
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
  spoil([](Arrays a) { a.contacts[8] = 0.5; }, {contacts + "/idata:1:", "unit vectors n", "0.5"});
  spoil([](Arrays a) { a.contacts.resize(16); }, {contacts + "/rdata", "9 columns", "met 8"});
  const TemporaryFolder folder;
  const std::string file = write_run(folder, texts.datbox, {});
  CHECK_FALSE(record_at(file).has_value());  // no group Evolution
  check_error([&] { read_contact_problem(file + ":ID_1"); }, {"lmgc90.h5: Evolution", "a group", "none"});
  write_file(folder / "run/lmgc90.h5", "text");
  CHECK_FALSE(record_at(file).has_value());
  check_error([&] { read_contact_problem(file + ":ID_1"); }, {"lmgc90.h5", "an HDF5 file of LMGC90"});
}
