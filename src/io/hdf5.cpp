// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5_handles.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/io/hdf5.hpp>

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>

namespace nscdd {
namespace {

Handle text_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return Handle(H5Tcopy(type), H5Tclose);
}

void write_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  Handle::require(H5Awrite(attribute, type, padded.data()));
}

// A text of any length (an attribute holds 64 KiB at the most).
void write_text(hid_t group, const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  const Handle dataset(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                       H5Dclose);
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  Handle::require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()));
}

// One dataset with its bytes; `memory` is also the type in the file.
void write_dataset(hid_t group, const Column& column, hid_t type, std::size_t rows, const void* data) {
  const hsize_t extent = rows;
  const Handle space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  const Handle dataset(
      H5Dcreate2(group, column.name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
  if (rows > 0) Handle::require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
  write_attribute(dataset, "unit", column.unit);
  write_attribute(dataset, "description", column.description);
}

template <class Value>
std::vector<Value> gather(const Table& table, std::size_t j) {
  std::vector<Value> values;
  for (const Row& row : table.rows) values.push_back(std::get<Value>(row[j]));
  return values;
}

void write_column(hid_t group, const Table& table, std::size_t j) {
  const Column& column = table.columns[j];
  const std::size_t rows = table.rows.size();
  if (rows == 0 || std::holds_alternative<double>(table.rows[0][j])) {
    write_dataset(group, column, H5T_IEEE_F64LE, rows, gather<double>(table, j).data());
  } else if (std::holds_alternative<std::int64_t>(table.rows[0][j])) {
    write_dataset(group, column, H5T_STD_I64LE, rows, gather<std::int64_t>(table, j).data());
  } else if (std::holds_alternative<bool>(table.rows[0][j])) {
    std::vector<signed char> flags;
    for (const bool flag : gather<bool>(table, j)) flags.push_back(flag ? 1 : 0);
    write_dataset(group, column, H5T_STD_I8LE, rows, flags.data());
  } else {
    const auto texts = gather<std::string>(table, j);
    std::size_t length = 1;
    for (const std::string& text : texts) length = std::max(length, text.size());
    std::string bytes;
    for (const std::string& text : texts) {
      bytes += text;
      bytes.append(length - text.size(), '\0');
    }
    write_dataset(group, column, text_type(length), rows, bytes.data());
  }
}

Handle new_group(hid_t file, const std::string& name) {
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  return Handle(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose);
}

std::string joined_names(const std::vector<Column>& columns) {
  std::string order;
  for (const Column& column : columns) order += (order.empty() ? "" : ",") + column.name;
  return order;
}

// The bytes of a file that `fill` writes its groups into.
template <class Fill>
std::string write_all(const Provenance& provenance, Fill&& fill) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are thrown, not printed
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  Handle::require(H5Pset_fapl_core(access, 1 << 20, false));
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, 0);
  const Handle file(H5Fcreate("memory", H5F_ACC_TRUNC, creation, access), H5Fclose);
  const Handle origin = new_group(file, "provenance");
  for (const auto& [name, text] : provenance) write_text(origin, name, text);
  fill(file);
  Handle::require(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw Error("HDF5: the file cannot be put together");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
    throw Error("HDF5: the file cannot be put together");
  return bytes;
}

// The numbers of one dataset; `path` says which, for errors.
std::vector<double> read_numbers(hid_t group, const std::string& dataset_name, const std::string& path) {
  const std::string met =
      fmt::format("{}: expected a one-dimensional dataset of numbers, met something else", path);
  const Handle object(H5Oopen(group, dataset_name.c_str(), H5P_DEFAULT), H5Oclose, met);
  if (H5Iget_type(object) != H5I_DATASET) throw Error(met);
  const Handle dataset(H5Dopen2(group, dataset_name.c_str(), H5P_DEFAULT), H5Dclose, met);
  const Handle type(H5Dget_type(dataset), H5Tclose, met);
  const Handle space(H5Dget_space(dataset), H5Sclose, met);
  const H5T_class_t kind = H5Tget_class(type);
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Sget_simple_extent_ndims(space) != 1) throw Error(met);
  hsize_t extent = 0;
  H5Sget_simple_extent_dims(space, &extent, nullptr);
  if (extent > 1'000'000'000)
    throw Error(fmt::format("{}: expected at most 10^9 numbers, met {}", path, extent));
  std::vector<double> values(extent);
  if (extent > 0 && H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw Error(fmt::format("{}: cannot be read", path));
  return values;
}

}  // namespace

std::string to_hdf5(const Provenance& provenance, const std::vector<NamedTable>& tables) {
  return write_all(provenance, [&](hid_t file) {
    for (const NamedTable& named : tables) {
      const std::vector<Column>& columns = named.table.columns;
      const Handle group = new_group(file, named.name);
      write_attribute(group, "columns", joined_names(columns));
      for (std::size_t j = 0; j < columns.size(); ++j) write_column(group, named.table, j);
    }
  });
}

std::string to_hdf5(const Provenance& provenance, const std::string& name,
                    const std::vector<NumberColumn>& columns) {
  return write_all(provenance, [&](hid_t file) {
    const Handle group = new_group(file, name);
    std::vector<Column> headings;
    for (const NumberColumn& column : columns) headings.push_back(column.heading);
    write_attribute(group, "columns", joined_names(headings));
    for (const NumberColumn& column : columns)
      write_dataset(group, column.heading, H5T_IEEE_F64LE, column.values.size(), column.values.data());
  });
}

std::map<std::string, std::vector<double>> numbers_from_hdf5(std::string_view bytes, const std::string& name,
                                                             const std::string& group_name) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are thrown, not printed
  const std::string no_file =
      fmt::format("{}: expected an HDF5 file, met something else or a damaged one", name);
  if (bytes.empty()) throw Error(no_file);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, no_file);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  Handle::require(H5Pset_fapl_core(access, 1 << 20, false));
  std::string image(bytes);  // the library asks for bytes that may be written to
  Handle::require(H5Pset_file_image(access, image.data(), image.size()));
  const Handle file(H5Fopen("memory", H5F_ACC_RDONLY, access), H5Fclose, no_file);
  const Handle group(H5Gopen2(file, group_name.c_str(), H5P_DEFAULT), H5Gclose,
                     fmt::format("{}: expected a group '{}', met none", name, group_name));
  H5G_info_t content{};
  Handle::require(H5Gget_info(group, &content));
  std::map<std::string, std::vector<double>> columns;
  for (hsize_t i = 0; i < content.nlinks; ++i) {
    const ssize_t length =
        H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (length < 0) throw Error(no_file);
    std::string member(static_cast<std::size_t>(length) + 1, '\0');
    H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, member.data(), member.size(), H5P_DEFAULT);
    member.pop_back();
    columns[member] = read_numbers(group, member, fmt::format("{}: {}/{}", name, group_name, member));
  }
  return columns;
}

}  // namespace nscdd
