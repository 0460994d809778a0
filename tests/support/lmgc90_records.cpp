// SPDX-License-Identifier: GPL-3.0-or-later
#include "lmgc90_records.hpp"

#include "files/hdf5_file.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"
#include "spoilt.hpp"

namespace nscdd::testing {
namespace {

void append(std::vector<double>& values, std::initializer_list<double> more) { values.insert(values.end(), more); }

void append_three(std::vector<double>& values, const Eigen::Vector3d& v) { append(values, {v[0], v[1], v[2]}); }

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

}  // namespace

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
    const auto from_1 = [](Index k) { return static_cast<std::int32_t>(k + 1); };
    const std::int32_t cd = from_1(one.candidate), an = from_1(one.antagonist);
    const std::int32_t cd_shape = from_1(one.candidate_shape), an_shape = from_1(one.antagonist_shape);
    const auto law = static_cast<std::int32_t>(std::ranges::find(laws, one.law) - laws.begin() + 1);
    const std::int32_t kind = moved.space() ? 2 : 1;
    const std::int32_t id = one.kind == "DKDKx" ? 1 : one.kind == "DKKDx" ? 2 : 7;  // as in mod_parameters.f90
    for (const std::int32_t number :
         {id, 1, cd, an, kind, kind, cd, an, 3, 4, 9, 9, cd_shape, an_shape, 1, 1, law, 0, one.slid ? 6 : 4, 0, 0, 0})
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

NetworkTexts network_in_plane() {
  NetworkTexts texts = square_on_plank();
  texts.datbox.initial = replaced(texts.datbox.initial, "X(2)= 0.0000000D+00", "X(2)= 0.1000000D-01");
  for (std::string* text : {&texts.datbox.tact, &texts.contacts}) *text = replaced(*text, "iqsc0", "zqsc0");
  texts.datbox.tact = replaced(texts.datbox.tact, "IQS_CLB                         fric= 0.5000000D+00",
                               "IQS_DS_CLB                      dfrc= 0.5000000D+00  sfrc= 0.7500000D+00");
  texts.contacts = replaced(texts.contacts, "stick     1", "slibw     1");
  return texts;
}

}  // namespace nscdd::testing
