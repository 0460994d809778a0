// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_types.hpp"

#include <fmt/format.h>

namespace nscdd::hdf5 {
namespace {

constexpr hsize_t largest_dataset = 1'000'000'000;

// A dataset or an attribute that is read.
struct Source {
  Handle id, type, space;
  std::string unlike;  ///< what the error says if it is not as expected

  H5T_class_t kind() const { return H5Tget_class(type); }
  void require_that(bool holds) const {
    if (!holds) throw Error(unlike);
  }
  hsize_t extent() const { return static_cast<hsize_t>(H5Sget_simple_extent_npoints(space)); }
};

Source dataset_of(const Group& group, const std::string& name, const std::string& expected) {
  const std::string unlike =
      fmt::format("{}: expected {}, met {}", group.of(name), expected, group.has(name) ? "something else" : "none");
  const Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, unlike);
  if (H5Iget_type(object) != H5I_DATASET) throw Error(unlike);
  Handle id(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, unlike);
  Handle type(H5Dget_type(id), H5Tclose, unlike), space(H5Dget_space(id), H5Sclose, unlike);
  return {std::move(id), std::move(type), std::move(space), unlike};
}

Source array_of(const Group& group, const std::string& name, const std::string& expected) {
  Source source = dataset_of(group, name, expected);
  source.require_that(H5Sget_simple_extent_ndims(source.space) == 1);
  if (source.extent() > largest_dataset)
    throw Error(fmt::format("{}: expected at most 10^9 elements, met {}", group.of(name), source.extent()));
  return source;
}

Source attribute_of(const Group& group, const std::string& member, const std::string& name,
                    const std::string& expected) {
  const std::string unlike =
      fmt::format("{}: expected {} in the attribute '{}', met none", group.path(), expected, name);
  Handle id(H5Aopen_by_name(group, member.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose, unlike);
  Handle type(H5Aget_type(id), H5Tclose, unlike), space(H5Aget_space(id), H5Sclose, unlike);
  return {std::move(id), std::move(type), std::move(space), unlike};
}

void read_into(const Source& source, hid_t memory_type, void* data, const std::string& name) {
  if (source.extent() > 0)
    require(H5Dread(source.id, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
            fmt::format("{}: cannot be read", name));
}

std::string until_zero(std::string_view bytes) { return std::string(bytes.substr(0, bytes.find('\0'))); }

}  // namespace

template <class Value>
std::vector<Value> Group::numbers(const std::string& name) const {
  constexpr bool whole = std::is_integral_v<Value>;
  const Source source = array_of(
      *this, name, whole ? "a one-dimensional dataset of whole numbers" : "a one-dimensional dataset of numbers");
  source.require_that(source.kind() == H5T_INTEGER || (!whole && source.kind() == H5T_FLOAT));
  std::vector<Value> values(source.extent());
  read_into(source, types_of<Value>().memory, values.data(), of(name));
  return values;
}

std::int64_t Group::integer(const std::string& name) const {
  const Source source = dataset_of(*this, name, "one whole number");
  source.require_that(source.kind() == H5T_INTEGER && source.extent() == 1);
  std::int64_t value = 0;
  read_into(source, H5T_NATIVE_INT64, &value, of(name));
  return value;
}

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
  const std::size_t size = H5Tget_size(source.type);
  source.require_that(size <= largest_dataset);
  std::string bytes(size, '\0');
  read_into(source, source.type, bytes.data(), of(name));
  return until_zero(bytes);
}

std::vector<std::string> Group::texts(const std::string& name) const {
  const Source source = array_of(*this, name, "a one-dimensional dataset of texts");
  source.require_that(source.kind() == H5T_STRING && H5Tis_variable_str(source.type) == 0);
  const std::size_t length = H5Tget_size(source.type);
  source.require_that(length * source.extent() <= largest_dataset);
  std::string bytes(length * source.extent(), '\0');
  read_into(source, source.type, bytes.data(), of(name));
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < source.extent(); ++i)
    texts.push_back(until_zero(std::string_view(bytes).substr(i * length, length)));
  return texts;
}

H5T_class_t Group::kind(const std::string& name) const { return array_of(*this, name, "an array").kind(); }

std::size_t Group::element_size(const std::string& name) const {
  return H5Tget_size(array_of(*this, name, "an array").type);
}

std::string Group::text_attribute(const std::string& name, const std::string& member) const {
  const Source source = attribute_of(*this, member, name, "a text");
  source.require_that(source.kind() == H5T_STRING && H5Tis_variable_str(source.type) == 0 && source.extent() == 1);
  std::string text(H5Tget_size(source.type), '\0');
  require(H5Aread(source.id, source.type, text.data()), source.unlike);
  return until_zero(text);
}

double Group::number_attribute(const std::string& name) const {
  const Source source = attribute_of(*this, ".", name, "a number");
  source.require_that((source.kind() == H5T_FLOAT || source.kind() == H5T_INTEGER) && source.extent() == 1);
  double value = 0;
  require(H5Aread(source.id, H5T_NATIVE_DOUBLE, &value), source.unlike);
  return value;
}

template std::vector<double> Group::numbers(const std::string&) const;
template std::vector<std::int64_t> Group::numbers(const std::string&) const;
template std::vector<std::int32_t> Group::numbers(const std::string&) const;
template std::vector<std::int8_t> Group::numbers(const std::string&) const;

}  // namespace nscdd::hdf5
