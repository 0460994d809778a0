// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace nscdd {
namespace {

struct Types {
  hid_t memory, file;
};
Types types_of(const double&) { return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE}; }
Types types_of(const std::int64_t&) { return {H5T_NATIVE_INT64, H5T_STD_I64LE}; }
Types types_of(const std::int32_t&) { return {H5T_NATIVE_INT32, H5T_STD_I32LE}; }
Types types_of(const std::int8_t&) { return {H5T_NATIVE_INT8, H5T_STD_I8LE}; }

void require(herr_t status, const std::string& name) {
  if (status < 0) throw Error(fmt::format("HDF5: {} cannot be written", name));
}

Handle text_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return Handle(H5Tcopy(type), H5Tclose);
}

// Without time stamps: equal content gives equal bytes.
Handle new_dataset(hid_t group, const std::string& name, hid_t type, hsize_t extent, Chunk chunk) {
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  const hsize_t unlimited = H5S_UNLIMITED, size = static_cast<hsize_t>(chunk);
  if (chunk > 0) require(H5Pset_chunk(properties, 1, &size), name);
  const Handle space(H5Screate_simple(1, &extent, chunk > 0 ? &unlimited : nullptr), H5Sclose);
  return Handle(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                fmt::format("HDF5: {} cannot be made", name));
}

Handle open_dataset(hid_t group, const std::string& name) {
  return Handle(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose,
                fmt::format("HDF5: {} cannot be opened", name));
}

void append(hid_t dataset, const std::string& name, hid_t memory_type, const void* value) {
  hsize_t extent = 0;
  {
    const Handle space(H5Dget_space(dataset), H5Sclose);
    H5Sget_simple_extent_dims(space, &extent, nullptr);
  }
  const hsize_t longer = extent + 1, one = 1;
  require(H5Dset_extent(dataset, &longer), name);
  const Handle target(H5Dget_space(dataset), H5Sclose);
  require(H5Sselect_hyperslab(target, H5S_SELECT_SET, &extent, nullptr, &one, nullptr), name);
  const Handle source(H5Screate_simple(1, &one, nullptr), H5Sclose);
  require(H5Dwrite(dataset, memory_type, source, target, H5P_DEFAULT, value), name);
}

}  // namespace

void prepare_hdf5() {
  H5dont_atexit();  // has its effect where the library has not been used yet
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Handle open_hdf5(const std::string& path, bool change, const std::string& failure) {
  prepare_hdf5();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  return Handle(H5Fopen(path.c_str(), change ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access), H5Fclose, failure);
}

bool has_link(hid_t parent, const std::string& name) {
  return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0;
}

Handle member_group(hid_t parent, const std::string& name, const std::string& file) {
  return Handle(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose,
                fmt::format("{}: expected a group '{}', met none", file, name));
}

Handle open_or_make_group(hid_t parent, const std::string& name) {
  const std::string failure = fmt::format("HDF5: the group {} cannot be made", name);
  if (has_link(parent, name)) return Handle(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, failure);
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  return Handle(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose, failure);
}

template <class Value>
void put_array(hid_t group, const std::string& name, std::span<const Value> values, const std::string& unit,
               Chunk chunk) {
  const Types types = types_of(Value{});
  const hsize_t extent = values.size();
  const bool there = has_link(group, name);
  const Handle dataset =
      there ? open_dataset(group, name) : new_dataset(group, name, types.file, extent, chunk);
  if (!there) put_attribute(dataset, "unit", unit);
  if (there && chunk > 0) require(H5Dset_extent(dataset, &extent), name);
  if (extent == 0) return;
  const Handle space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
  require(H5Dwrite(dataset, types.memory, space, H5S_ALL, H5P_DEFAULT, values.data()), name);
}

template <class Value>
void append_to_array(hid_t group, const std::string& name, const Value& value, const std::string& unit,
                     const std::string& description, Chunk chunk) {
  const Types types = types_of(value);
  const bool there = has_link(group, name);
  const Handle dataset = there ? open_dataset(group, name) : new_dataset(group, name, types.file, 0, chunk);
  if (!there) {
    put_attribute(dataset, "unit", unit);
    put_attribute(dataset, "description", description);
  }
  append(dataset, name, types.memory, &value);
}

void append_to_texts(hid_t group, const std::string& name, const std::string& text, std::size_t longest,
                     const std::string& description, Chunk chunk) {
  const Handle type = text_type(longest);
  const bool there = has_link(group, name);
  const Handle dataset = there ? open_dataset(group, name) : new_dataset(group, name, type, 0, chunk);
  if (!there) {
    put_attribute(dataset, "unit", "");
    put_attribute(dataset, "description", description);
  }
  std::string padded = text.substr(0, longest);
  padded.resize(longest, '\0');
  append(dataset, name, type, padded.data());
}

template <class Value>
std::vector<Value> get_array(hid_t group, const std::string& name, const std::string& file) {
  const std::string met = fmt::format("{}: expected an array of numbers '{}', met none", file, name);
  const Handle dataset(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, met);
  const Handle type(H5Dget_type(dataset), H5Tclose, met);
  const Handle space(H5Dget_space(dataset), H5Sclose, met);
  const H5T_class_t kind = H5Tget_class(type);
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Sget_simple_extent_ndims(space) != 1) throw Error(met);
  hsize_t extent = 0;
  H5Sget_simple_extent_dims(space, &extent, nullptr);
  if (extent > 1'000'000'000)
    throw Error(fmt::format("{}: expected at most 10^9 numbers in '{}', met {}", file, name, extent));
  std::vector<Value> values(extent);
  if (extent > 0 &&
      H5Dread(dataset, types_of(Value{}).memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw Error(fmt::format("{}: '{}' cannot be read", file, name));
  return values;
}

void put_text(hid_t group, const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  const Handle dataset(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                       H5Dclose, fmt::format("HDF5: {} cannot be made", name));
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), name);
}

std::string get_text(hid_t group, const std::string& name, const std::string& file) {
  const std::string met = fmt::format("{}: expected a text '{}', met none", file, name);
  const Handle dataset(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, met);
  const Handle type(H5Dget_type(dataset), H5Tclose, met);
  const Handle space(H5Dget_space(dataset), H5Sclose, met);
  const std::size_t size = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 ||
      H5Sget_simple_extent_npoints(space) != 1 || size > 1'000'000'000)
    throw Error(met);
  std::string text(size, '\0');
  if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) throw Error(met);
  return text.substr(0, text.find('\0'));
}

void put_attribute(hid_t object, const std::string& name, const std::string& text) {
  if (H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
  const Handle type = text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  require(H5Awrite(attribute, type, padded.data()), name);
}

void put_attribute(hid_t object, const std::string& name, double value) {
  if (H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  require(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value), name);
}

std::string get_text_attribute(hid_t object, const std::string& name, const std::string& file) {
  const std::string met = fmt::format("{}: expected a text in the attribute '{}', met none", file, name);
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, met);
  const Handle type(H5Aget_type(attribute), H5Tclose, met);
  const Handle space(H5Aget_space(attribute), H5Sclose, met);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 ||
      H5Sget_simple_extent_npoints(space) != 1)
    throw Error(met);
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, text.data()) < 0) throw Error(met);
  return text.substr(0, text.find('\0'));
}

double get_number(hid_t object, const std::string& name, const std::string& file) {
  const std::string met = fmt::format("{}: expected a number in the attribute '{}', met none", file, name);
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, met);
  const Handle space(H5Aget_space(attribute), H5Sclose, met);
  const Handle type(H5Aget_type(attribute), H5Tclose, met);
  double value = 0;
  const H5T_class_t kind = H5Tget_class(type);
  if (H5Sget_simple_extent_npoints(space) != 1 || (kind != H5T_FLOAT && kind != H5T_INTEGER) ||
      H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0)
    throw Error(met);
  return value;
}

template void put_array(hid_t, const std::string&, std::span<const double>, const std::string&, Chunk);
template void append_to_array(hid_t, const std::string&, const double&, const std::string&,
                              const std::string&, Chunk);
template std::vector<double> get_array(hid_t, const std::string&, const std::string&);
template void put_array(hid_t, const std::string&, std::span<const std::int64_t>, const std::string&, Chunk);
template void append_to_array(hid_t, const std::string&, const std::int64_t&, const std::string&,
                              const std::string&, Chunk);
template std::vector<std::int64_t> get_array(hid_t, const std::string&, const std::string&);
template void put_array(hid_t, const std::string&, std::span<const std::int32_t>, const std::string&, Chunk);
template void append_to_array(hid_t, const std::string&, const std::int32_t&, const std::string&,
                              const std::string&, Chunk);
template std::vector<std::int32_t> get_array(hid_t, const std::string&, const std::string&);
template void put_array(hid_t, const std::string&, std::span<const std::int8_t>, const std::string&, Chunk);
template void append_to_array(hid_t, const std::string&, const std::int8_t&, const std::string&,
                              const std::string&, Chunk);
template std::vector<std::int8_t> get_array(hid_t, const std::string&, const std::string&);

}  // namespace nscdd
