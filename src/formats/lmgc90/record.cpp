// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/record.hpp"

#include "files/hdf5_file.hpp"
#include "files/output_file.hpp"
#include "formats/lmgc90/datbox_body.hpp"

#include <filesystem>

namespace nscdd {
namespace {

using hdf5::Group;

constexpr std::string_view record_prefix = "ID_";

std::optional<Index> number_of_record(std::string_view name) {
  Index number = 0;
  if (!name.starts_with(record_prefix)) return std::nullopt;
  const auto [end, status] = std::from_chars(name.data() + record_prefix.size(), name.data() + name.size(), number);
  return status == std::errc() && end == name.data() + name.size() ? std::optional(number) : std::nullopt;
}

hdf5::File opened(const std::string& file) {
  return {file, hdf5::Access::read,
          fmt::format("{}: expected an HDF5 file of LMGC90, met something else or a damaged one", file)};
}

Group group_of(const hdf5::File& file, const RecordPlace& place) {
  const Group all = file.root().group("Evolution");
  std::vector<Index> numbers;
  for (const std::string& name : all.members())
    if (const auto number = number_of_record(name)) numbers.push_back(*number);
  std::ranges::sort(numbers);
  if (numbers.empty()) fail("{}: expected records ID_1, ID_2, ..., met none", all.path());
  const Index wanted = place.record.empty() ? numbers.back() : *number_of_record(place.record);
  if (!std::ranges::binary_search(numbers, wanted))
    fail("{}: expected one of its {} records, ID_{} to ID_{}, met {}", all.path(), numbers.size(), numbers.front(),
         numbers.back(), place.record);
  return all.group(fmt::format("{}{}", record_prefix, wanted));
}

// Rows of equal lengths; errors name a row by its number from 1.
template <class Value>
struct RecordRows {
  std::vector<Value> values;
  std::size_t columns = 0;
  std::string dataset;

  RecordRows(const Group& group, const std::string& name, std::size_t least, std::optional<Index> rows)
      : dataset(group.of(name)) {
    const Index number = rows.value_or(group.rows(name));
    if (number != group.rows(name)) fail("{}: expected {} rows, met {}", dataset, number, group.rows(name));
    values = group.numbers<Value>(name, hdf5::Rows{0, number});
    columns = values.size() / std::max<std::size_t>(at(number), 1);
    if (columns < least) fail("{}: expected at least {} columns, met {}", dataset, least, columns);
  }
  Value operator()(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
  Vector3 three(std::size_t row, std::size_t column) const {
    return {(*this)(row, column), (*this)(row, column + 1), (*this)(row, column + 2)};
  }
  DatboxPlace place(std::size_t row) const { return {dataset, static_cast<Index>(row) + 1}; }
};

// Statuses are groups of six, of plain contacts from 2 and then of four kinds of cohesive ones, whose last three slide.
bool slides_in_record(std::int64_t status) { return status >= 2 && status < 32 && (status - 2) % 6 >= 3; }

// One of `number` things, counted from 1.
Index one_of(std::int64_t met, Index number, const DatboxPlace& place, const char* what) {
  if (met < 1 || met > number) refuse(place, "expected one of the {} {}, met {}", number, what, met);
  return met - 1;
}

}  // namespace

void complete_contact(DatboxContact& contact, bool space) {
  const Vector3 n = contact.frame.col(0);
  if (!space) contact.frame.rightCols(2) << Vector3(n[1], -n[0], 0), Vector3::UnitZ();
  const Eigen::Matrix3d rest = contact.frame.transpose() * contact.frame - Eigen::Matrix3d::Identity();
  constexpr double tolerance = 1e-5;  // of numbers with seven digits
  if (rest.cwiseAbs().maxCoeff() < tolerance) return;
  if (!space) refuse(contact.place, "expected a unit vector n, met one of length {}", n.norm());
  refuse(contact.place, "expected orthonormal n, t and s, met products of two that are off by up to {:.2g}",
         rest.cwiseAbs().maxCoeff());
}

std::optional<RecordPlace> record_at(const std::string& path) {
  const std::size_t colon = path.rfind(':');
  if (colon != std::string::npos && number_of_record(std::string_view(path).substr(colon + 1)))
    return RecordPlace{path.substr(0, colon), path.substr(colon + 1)};
  const std::string ending = std::filesystem::path(path).extension().string();
  if (std::ranges::find(hdf5_endings, ending) == hdf5_endings.end() || !is_file(path)) return std::nullopt;
  try {
    if (opened(path).root().has("Evolution")) return RecordPlace{path, ""};
  } catch (const Error&) {  // the reader of another format has the words for it
  }
  return std::nullopt;
}

void read_state(const RecordPlace& place, Datbox& datbox) {
  const hdf5::File file = opened(place.file);
  const Group record = group_of(file, place), bodies = record.group(datbox_body_kind(datbox.dimension));
  const bool space = datbox.space();
  const RecordRows<double> state(bodies, "rdata", space ? 21 : 6, count(datbox.bodies));
  const RecordRows<std::int64_t> visible(bodies, "idata", 1, count(datbox.bodies));
  datbox.start = record.number("TPS");
  if (record.has("dt") && record.number("dt") > 0) datbox.command.step = record.number("dt");
  for (std::size_t k = 0; k < datbox.bodies.size(); ++k) {
    DatboxBody& body = datbox.bodies[k];
    if (visible(k, 0) == 0) refuse(visible.place(k), "expected bodies that are visible, met one that is not");
    for (const std::size_t first :
         space ? std::array<std::size_t, 4>{0, 3, 6, 9} : std::array<std::size_t, 4>{0, 3, 0, 3})
      if (!state.three(k, first).allFinite()) refuse(state.place(k), "expected finite numbers in rdata, met others");
    body.position += state.three(k, 0);
    body.velocity = state.three(k, space ? 6 : 3);
    if (!space) continue;
    body.spin = state.three(k, 9);
    Eigen::Matrix3d axes;
    axes << state.three(k, 12), state.three(k, 15), state.three(k, 18);
    set_axes(body, axes, state.place(k));
  }
}

DatboxNetwork read_network(const RecordPlace& place, const Datbox& datbox) {
  const hdf5::File file = opened(place.file);
  const Group record = group_of(file, place);
  DatboxNetwork network{.step = record.integer("NStep"), .time = record.number("TPS"), .h = record.number("dt")};
  for (const auto& [name, value] : {std::pair("TPS", network.time), std::pair("dt", network.h)})
    if (!(std::isfinite(value) && value >= 0))
      fail("{}: expected a finite number >= 0, met {}", record.of(name), value);
  if (!record.has("VlocRloc")) return network;  // of a step without contacts
  const bool space = datbox.space();
  const std::size_t d = space ? 3 : 2;
  const Group group = record.group("VlocRloc");
  const RecordRows<std::int64_t> whole(group, "idata", 19, std::nullopt);
  const RecordRows<double> real(group, "rdata", space ? 19 : 9, group.rows("idata"));
  std::vector<std::pair<Index, std::string>> laws;  // their lines and names, in the order of TACT_BEHAV.DAT
  for (const auto& [name, law] : datbox.laws) laws.emplace_back(law.place.line, name);
  std::ranges::sort(laws);
  for (std::size_t k = 0; k < at(group.rows("idata")); ++k) {
    DatboxContact& contact = network.contacts.emplace_back();
    contact.place = whole.place(k);
    if (whole(k, 4) != datbox.dimension - 1 || whole(k, 5) != datbox.dimension - 1)  // 1 of RBDY2, 2 of RBDY3
      refuse(contact.place, "expected two bodies {}, met a body of another kind", datbox_body_kind(datbox.dimension));
    contact.kind = whole(k, 0) == 1 ? "DKDKx" : "";
    contact.candidate = one_of(whole(k, 6), count(datbox.bodies), contact.place, "bodies of BODIES.DAT");
    contact.antagonist = one_of(whole(k, 7), count(datbox.bodies), contact.place, "bodies of BODIES.DAT");
    if (contact.within() && datbox.bodies[at(contact.candidate)].contactors.size() == 1)
      refuse(contact.place, "expected two bodies, met body {} twice", contact.candidate + 1);
    contact.candidate_shape = whole(k, 12) - 1;
    contact.antagonist_shape = whole(k, 13) - 1;
    contact.law = laws[at(one_of(whole(k, 16), count(laws), contact.place, "laws of TACT_BEHAV.DAT"))].second;
    contact.slid = slides_in_record(whole(k, 18));
    const auto local = [&](std::size_t first) {  // (t, n) or (t, n, s)
      return Vector3(real(k, first + 1), real(k, first), space ? real(k, first + 2) : 0);
    };
    const auto vector = [&](std::size_t first) {
      return Vector3(real(k, first), real(k, first + 1), space ? real(k, first + 2) : 0);
    };
    contact.force = local(0);
    contact.speed = local(d);
    contact.gap = real(k, 2 * d);
    contact.point = vector(2 * d + 1);
    if (space)
      contact.frame << vector(13), vector(10), vector(16);
    else
      contact.frame << vector(7), Vector3::Zero(), Vector3::Zero();
    if (!std::isfinite(contact.gap + contact.force.sum() + contact.speed.sum() + contact.point.sum()))
      refuse(contact.place, "expected finite numbers in rdata, met others");
    complete_contact(contact, space);
  }
  return network;
}

}  // namespace nscdd
