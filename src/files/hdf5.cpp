// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5.hpp"

#include "core/fail.hpp"
#include "files/csv.hpp"
#include "files/hdf5_file.hpp"

namespace nscdd {
namespace hdf5 {
namespace {

// A dataset or an attribute that is read.
struct Source {
  Handle id, type, space;
  std::string unlike;  ///< error text for an unexpected one

  H5T_class_t kind() const { return H5Tget_class(type); }
  std::size_t size() const { return H5Tget_size(type); }
  bool of_numbers(bool whole) const { return kind() == H5T_INTEGER || (!whole && kind() == H5T_FLOAT); }
  bool of_texts() const { return kind() == H5T_STRING && H5Tis_variable_str(type) == 0; }
  int dimensions() const { return H5Sget_simple_extent_ndims(space); }
  hsize_t extent() const { return static_cast<hsize_t>(H5Sget_simple_extent_npoints(space)); }
  void require_that(bool holds) const {
    if (!holds) throw Error(unlike);
  }
};

Source dataset_of(const Group& group, const std::string& name, const std::string& expected) {
  const std::string unlike =
      fmt::format("{}: expected {}, met {}", group.of(name), expected, group.has(name) ? "something else" : "none");
  Handle id(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, unlike);
  Handle type(H5Dget_type(id), H5Tclose, unlike), space(H5Dget_space(id), H5Sclose, unlike);
  return {std::move(id), std::move(type), std::move(space), unlike};
}

void require_readable(hsize_t size, const std::string& name) {
  if (size > 1'000'000'000) fail("{}: expected at most 10^9 elements, met {}", name, size);
}

void read_into(const Source& source, hid_t memory_type, void* data, const std::string& name) {
  if (source.extent() > 0)
    require(H5Dread(source.id, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
            fmt::format("{}: cannot be read", name));
}

template <class Value>
Value only_number(const Group& group, const std::string& name) {
  constexpr bool whole = std::is_integral_v<Value>;
  const Source source = dataset_of(group, name, whole ? "one whole number" : "one number");
  source.require_that(source.of_numbers(whole) && source.extent() == 1);
  Value value = 0;
  read_into(source, types_of<Value>().memory, &value, group.of(name));
  return value;
}

std::string until_zero(std::string_view bytes) { return std::string(bytes.substr(0, bytes.find('\0'))); }

}  // namespace

template <class Value>
std::vector<Value> Group::numbers(const std::string& name, std::optional<Rows> rows) const {
  constexpr bool whole = std::is_integral_v<Value>;
  const Source source = dataset_of(
      *this, name,
      fmt::format("{} of {}numbers", rows ? "an array" : "a one-dimensional dataset", whole ? "whole " : ""));
  source.require_that(source.dimensions() == 1 || (rows && source.dimensions() == 2));
  source.require_that(source.of_numbers(whole));
  hsize_t extent[] = {0, 1}, start[] = {0, 0};
  H5Sget_simple_extent_dims(source.space, extent, nullptr);
  if (rows) {
    if (rows->first < 0 || rows->number < 0 || rows->first > static_cast<Index>(extent[0]) - rows->number)
      fail("{}: expected {} rows from {} on, met an array of {}", of(name), rows->number, rows->first, extent[0]);
    start[0] = at(rows->first);
    extent[0] = at(rows->number);
  }
  require_readable(std::max({extent[0], extent[1], extent[0] * extent[1]}), of(name));  // each, lest the product wraps
  std::vector<Value> values(extent[0] * extent[1]);
  if (values.empty()) return values;
  const std::string failure = fmt::format("{}: cannot be read", of(name));
  const Handle target(H5Screate_simple(source.dimensions(), extent, nullptr), H5Sclose);
  require(H5Sselect_hyperslab(source.space, H5S_SELECT_SET, start, nullptr, extent, nullptr), failure);
  require(H5Dread(source.id, types_of<Value>().memory, target, source.space, H5P_DEFAULT, values.data()), failure);
  return values;
}

Index Group::rows(const std::string& name) const {
  if (!has(name)) return 0;
  const Source source = dataset_of(*this, name, "an array");
  source.require_that(source.dimensions() == 1 || source.dimensions() == 2);
  hsize_t extent[] = {0, 1};
  H5Sget_simple_extent_dims(source.space, extent, nullptr);
  return static_cast<Index>(extent[0]);
}

std::int64_t Group::integer(const std::string& name) const { return only_number<std::int64_t>(*this, name); }

double Group::number(const std::string& name) const { return only_number<double>(*this, name); }

std::string Group::text(const std::string& name) const {
  const Source source = dataset_of(*this, name, "a text");
  source.require_that(source.kind() == H5T_STRING && source.extent() == 1);
  if (H5Tis_variable_str(source.type) > 0) {
    char* text = nullptr;
    read_into(source, source.type, static_cast<void*>(&text), of(name));
    std::string result = text == nullptr ? "" : text;
    H5free_memory(text);
    return result;
  }
  require_readable(source.size(), of(name));
  std::string bytes(source.size(), '\0');
  read_into(source, source.type, bytes.data(), of(name));
  return until_zero(bytes);
}

std::vector<std::string> Group::texts(const std::string& name) const {
  const Source source = dataset_of(*this, name, "a one-dimensional dataset of texts");
  source.require_that(source.dimensions() == 1 && source.of_texts());
  require_readable(source.extent() * source.size(), of(name));
  std::string bytes(source.extent() * source.size(), '\0');
  read_into(source, source.type, bytes.data(), of(name));
  std::vector<std::string> texts;
  for (std::size_t start = 0; start < bytes.size(); start += source.size())
    texts.push_back(until_zero(std::string_view(bytes).substr(start, source.size())));
  return texts;
}

std::string Group::text_attribute(const std::string& name) const {
  const std::string unlike = fmt::format("{}: expected a text in the attribute '{}', met none", path_, name);
  Handle id(H5Aopen(id_, name.c_str(), H5P_DEFAULT), H5Aclose, unlike);
  Handle type(H5Aget_type(id), H5Tclose, unlike), space(H5Aget_space(id), H5Sclose, unlike);
  const Source source{std::move(id), std::move(type), std::move(space), unlike};
  source.require_that(source.of_texts() && source.extent() == 1);
  std::string text(source.size(), '\0');
  require(H5Aread(source.id, source.type, text.data()), unlike);
  return until_zero(text);
}

template std::vector<double> Group::numbers(const std::string&, std::optional<Rows>) const;
template std::vector<std::int64_t> Group::numbers(const std::string&, std::optional<Rows>) const;
template std::vector<std::int32_t> Group::numbers(const std::string&, std::optional<Rows>) const;
template std::vector<std::int8_t> Group::numbers(const std::string&, std::optional<Rows>) const;

}  // namespace hdf5

std::string to_hdf5(const Provenance& provenance, const std::vector<NamedTable>& tables) {
  return hdf5::new_file_bytes([&](const hdf5::Group& root) {
    hdf5::put_provenance(root, provenance);
    for (const auto& [name, table] : tables) {
      const hdf5::Group group = root.make_group(name);
      group.put_attribute("columns", csv_header(table.columns));
      group.put_columns(table);
    }
  });
}

void leave_hdf5_alone_at_exit() { H5dont_atexit(); }

}  // namespace nscdd
