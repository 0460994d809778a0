// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/io/hdf5.hpp>

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>

namespace nscdd {
namespace {

// An HDF5 identifier closed by its own function. Throws where HDF5 returned none.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closing)(hid_t)) : id_(id), close_(closing) {
    if (id_ < 0) throw Error("HDF5: the file cannot be put together");
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  static void require(herr_t status) {
    if (status < 0) throw Error("HDF5: the file cannot be put together");
  }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

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

std::string write_all(const Provenance& provenance, const std::vector<NamedTable>& tables) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  Handle::require(H5Pset_fapl_core(access, 1 << 20, false));
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, 0);
  const Handle file(H5Fcreate("memory", H5F_ACC_TRUNC, creation, access), H5Fclose);
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  const Handle origin(H5Gcreate2(file, "provenance", H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose);
  for (const auto& [name, text] : provenance) write_text(origin, name, text);
  for (const NamedTable& named : tables) {
    const Handle group(H5Gcreate2(file, named.name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose);
    std::string order;
    for (const Column& column : named.table.columns) order += (order.empty() ? "" : ",") + column.name;
    write_attribute(group, "columns", order);
    for (std::size_t j = 0; j < named.table.columns.size(); ++j) write_column(group, named.table, j);
  }
  Handle::require(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw Error("HDF5: the file cannot be put together");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
    throw Error("HDF5: the file cannot be put together");
  return bytes;
}

}  // namespace

std::string to_hdf5(const Provenance& provenance, const std::vector<NamedTable>& tables) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are thrown, not printed
  return write_all(provenance, tables);
}

}  // namespace nscdd
