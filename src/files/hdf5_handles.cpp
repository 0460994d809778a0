// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_handles.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace nscdd::hdf5 {
namespace {

constexpr hsize_t largest_dataset = 1'000'000'000;

// A dataset, opened, with what is known of it.
struct Dataset {
  Handle id, type, space;

  Dataset(hid_t group, const std::string& name, const std::string& met)
      : id(open(group, name, met), H5Dclose, met),
        type(H5Dget_type(id), H5Tclose, met),
        space(H5Dget_space(id), H5Sclose, met) {}

  static hid_t open(hid_t group, const std::string& name, const std::string& met) {
    const Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, met);
    if (H5Iget_type(object) != H5I_DATASET) throw Error(met);
    return H5Dopen2(group, name.c_str(), H5P_DEFAULT);
  }
};

std::string missing_or_else(hid_t group, const std::string& name, const std::string& path,
                            const std::string& expected) {
  return fmt::format("{}: expected {}, met {}", path, expected, has(group, name) ? "something else" : "none");
}

hsize_t extent_of(const Dataset& dataset, const std::string& path) {
  hsize_t extent = 0;
  H5Sget_simple_extent_dims(dataset.space, &extent, nullptr);
  if (extent > largest_dataset)
    throw Error(fmt::format("{}: expected at most 10^9 numbers, met {}", path, extent));
  return extent;
}

void read_into(const Dataset& dataset, hid_t memory_type, std::size_t size, void* data,
               const std::string& path) {
  if (size > 0 && H5Dread(dataset.id, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
    throw Error(fmt::format("{}: cannot be read", path));
}

// A text of any length (an attribute holds 64 KiB at the most).
void write_text_bytes(hid_t group, const std::string& name, hid_t type, const std::string& bytes) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  const Handle dataset(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                       H5Dclose);
  Handle::require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()));
}

}  // namespace

Handle::Handle(hid_t id, herr_t (*closing)(hid_t), const std::string& failure) : id_(id), close_(closing) {
  if (id_ < 0) throw Error(failure);
}

Handle::~Handle() {
  if (id_ >= 0) close_(id_);
}

void Handle::require(herr_t status) {
  if (status < 0) throw Error("HDF5: the file cannot be put together");
}

std::string file_bytes(const std::function<void(hid_t file)>& fill) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are thrown, not printed
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  Handle::require(H5Pset_fapl_core(access, 1 << 20, false));
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, 0);
  const Handle file(H5Fcreate("memory", H5F_ACC_TRUNC, creation, access), H5Fclose);
  fill(file);
  Handle::require(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw Error("HDF5: the file cannot be put together");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
    throw Error("HDF5: the file cannot be put together");
  return bytes;
}

Handle open_bytes(std::string_view bytes, const std::string& name) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are thrown, not printed
  const std::string no_file =
      fmt::format("{}: expected an HDF5 file, met something else or a damaged one", name);
  if (bytes.empty()) throw Error(no_file);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, no_file);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  Handle::require(H5Pset_fapl_core(access, 1 << 20, false));
  std::string image(bytes);  // the library asks for bytes that may be written to
  Handle::require(H5Pset_file_image(access, image.data(), image.size()));
  return Handle(H5Fopen("memory", H5F_ACC_RDONLY, access), H5Fclose, no_file);
}

Handle text_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return Handle(H5Tcopy(type), H5Tclose);
}

Handle new_group(hid_t parent, const std::string& name) {
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  return Handle(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose);
}

void write_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  Handle::require(H5Awrite(attribute, type, padded.data()));
}

void write_text(hid_t group, const std::string& name, const std::string& text) {
  write_text_bytes(group, name, text_type(text.size()), text.empty() ? std::string(1, '\0') : text);
}

void write_terminated_text(hid_t group, const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size() + 1);
  H5Tset_strpad(type, H5T_STR_NULLTERM);
  write_text_bytes(group, name, type, text + '\0');
}

Handle write_dataset(hid_t group, const std::string& name, hid_t type, std::size_t size, const void* data) {
  const hsize_t extent = size;
  const Handle space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  const hid_t dataset = H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  if (dataset >= 0 && size > 0) Handle::require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
  return Handle(dataset, H5Dclose);
}

void write_numbers(hid_t group, const std::string& name, std::span<const double> values) {
  const Handle written = write_dataset(group, name, H5T_IEEE_F64LE, values.size(), values.data());
}

void write_integers(hid_t group, const std::string& name, std::span<const int> values) {
  static_assert(sizeof(int) == 4);
  const Handle written = write_dataset(group, name, H5T_STD_I32LE, values.size(), values.data());
}

bool has(hid_t group, const std::string& name) { return H5Lexists(group, name.c_str(), H5P_DEFAULT) > 0; }

Handle open_group(hid_t parent, const std::string& name, const std::string& path) {
  return Handle(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose,
                missing_or_else(parent, name, path, "a group"));
}

std::vector<double> read_numbers(hid_t group, const std::string& name, const std::string& path) {
  const std::string met = missing_or_else(group, name, path, "a one-dimensional dataset of numbers");
  const Dataset dataset(group, name, met);
  const H5T_class_t kind = H5Tget_class(dataset.type);
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Sget_simple_extent_ndims(dataset.space) != 1)
    throw Error(met);
  std::vector<double> values(extent_of(dataset, path));
  read_into(dataset, H5T_NATIVE_DOUBLE, values.size(), values.data(), path);
  return values;
}

std::vector<std::int64_t> read_integers(hid_t group, const std::string& name, const std::string& path) {
  const std::string met = missing_or_else(group, name, path, "a one-dimensional dataset of whole numbers");
  const Dataset dataset(group, name, met);
  if (H5Tget_class(dataset.type) != H5T_INTEGER || H5Sget_simple_extent_ndims(dataset.space) != 1)
    throw Error(met);
  std::vector<std::int64_t> values(extent_of(dataset, path));
  read_into(dataset, H5T_NATIVE_INT64, values.size(), values.data(), path);
  return values;
}

std::int64_t read_integer(hid_t group, const std::string& name, const std::string& path) {
  const std::string met = missing_or_else(group, name, path, "one whole number");
  const Dataset dataset(group, name, met);
  if (H5Tget_class(dataset.type) != H5T_INTEGER || H5Sget_simple_extent_npoints(dataset.space) != 1)
    throw Error(met);
  std::int64_t value = 0;
  read_into(dataset, H5T_NATIVE_INT64, 1, &value, path);
  return value;
}

std::string read_text(hid_t group, const std::string& name, const std::string& path) {
  const std::string met = missing_or_else(group, name, path, "a text");
  const Dataset dataset(group, name, met);
  if (H5Tget_class(dataset.type) != H5T_STRING || H5Sget_simple_extent_npoints(dataset.space) != 1)
    throw Error(met);
  if (H5Tis_variable_str(dataset.type) > 0) {
    char* text = nullptr;
    read_into(dataset, dataset.type, 1, static_cast<void*>(&text), path);
    std::string result = text == nullptr ? "" : text;
    H5free_memory(text);
    return result;
  }
  std::string text(H5Tget_size(dataset.type), '\0');
  read_into(dataset, dataset.type, text.size(), text.data(), path);
  return text.substr(0, text.find('\0'));
}

std::vector<std::string> members(hid_t group, const std::string& path) {
  const std::string damaged = fmt::format("{}: cannot be read", path);
  H5G_info_t content{};
  if (H5Gget_info(group, &content) < 0) throw Error(damaged);
  std::vector<std::string> names;
  for (hsize_t i = 0; i < content.nlinks; ++i) {
    const ssize_t length =
        H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (length < 0) throw Error(damaged);
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    name.pop_back();
    names.push_back(name);
  }
  return names;
}

}  // namespace nscdd::hdf5
