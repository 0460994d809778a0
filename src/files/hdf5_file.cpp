// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace nscdd::hdf5 {
namespace {

Handle file_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  require(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG));
  return access;
}

Handle memory_access() {
  Handle access = file_access();
  require(H5Pset_fapl_core(access, 1 << 20, false));
  return access;
}

hid_t open_bytes(std::string_view bytes) {
  if (bytes.empty()) return -1;
  const Handle access = memory_access();
  std::string image(bytes);  // the library asks for bytes that may be written to
  require(H5Pset_file_image(access, image.data(), image.size()));
  return H5Fopen("memory", H5F_ACC_RDONLY, access);
}

hid_t open_path(const std::string& path, Access how) {
  const Handle access = file_access();
  if (how == Access::create) return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, without_times(H5P_FILE_CREATE), access);
  return H5Fopen(path.c_str(), how == Access::change ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access);
}

}  // namespace

ErrorHandler silence_errors() {
  ErrorHandler before;
  H5Eget_auto2(H5E_DEFAULT, &before.function, &before.data);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return before;
}

void restore_errors(const ErrorHandler& handler) { H5Eset_auto2(H5E_DEFAULT, handler.function, handler.data); }

Handle without_times(hid_t property_class) {
  Handle properties(H5Pcreate(property_class), H5Pclose);
  require(H5Pset_obj_track_times(properties, 0));
  return properties;
}

Handle::Handle(hid_t id, herr_t (*closing)(hid_t), const std::string& failure) : id_(id), close_(closing) {
  if (id_ < 0) throw Error(failure);
}

Handle::~Handle() {
  if (id_ >= 0) close_(id_);
}

Group::Group(hid_t parent, const std::string& name, std::string path)
    : path_(std::move(path)),
      id_(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose,
          fmt::format("{}: expected a group, met {}", path_,
                      H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0 ? "something else" : "none")) {}

std::string Group::of(const std::string& member) const {
  return fmt::format("{}{}{}", path_, path_.find(": ") == std::string::npos ? ": " : "/", member);
}

bool Group::has(const std::string& name) const { return H5Lexists(id_, name.c_str(), H5P_DEFAULT) > 0; }

std::vector<std::string> Group::members() const {
  const std::string damaged = fmt::format("{}: cannot be read", path_);
  H5G_info_t content{};
  require(H5Gget_info(id_, &content), damaged);
  std::vector<std::string> names;
  for (hsize_t i = 0; i < content.nlinks; ++i) {
    const auto read = [&](char* name, std::size_t size) {
      return H5Lget_name_by_idx(id_, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, size, H5P_DEFAULT);
    };
    const ssize_t length = read(nullptr, 0);
    if (length < 0) throw Error(damaged);
    std::string name(static_cast<std::size_t>(length), '\0');
    read(name.data(), name.size() + 1);
    names.push_back(std::move(name));
  }
  return names;
}

Group Group::group(const std::string& name) const { return {id_, name, of(name)}; }

Group Group::make_group(const std::string& name) const {
  if (!has(name))
    const Handle made(H5Gcreate2(id_, name.c_str(), H5P_DEFAULT, without_times(H5P_GROUP_CREATE), H5P_DEFAULT),
                      H5Gclose, fmt::format("{}: cannot be made", of(name)));
  return group(name);
}

void Group::remove(const std::string& name) const { H5Ldelete(id_, name.c_str(), H5P_DEFAULT); }

File::File()
    : name_("HDF5"),
      id_(H5Fcreate("memory", H5F_ACC_TRUNC, without_times(H5P_FILE_CREATE), memory_access()), H5Fclose) {}

File::File(std::string_view bytes, const std::string& name)
    : name_(name),
      id_(open_bytes(bytes), H5Fclose,
          fmt::format("{}: expected an HDF5 file, met something else or a damaged one", name)) {}

File::File(const std::string& path, Access access, const std::string& failure)
    : name_(path), id_(open_path(path, access), H5Fclose, failure) {}

void File::flush() const {
  require(H5Fflush(id_, H5F_SCOPE_GLOBAL), fmt::format("{}: cannot be written: no room left, or not permitted", name_));
}

std::string File::bytes() const {
  flush();
  const ssize_t size = H5Fget_file_image(id_, nullptr, 0);
  std::string bytes(static_cast<std::size_t>(std::max<ssize_t>(size, 0)), '\0');
  if (size < 0 || H5Fget_file_image(id_, bytes.data(), bytes.size()) != size) throw Error(incomplete);
  return bytes;
}

void put_provenance(const Group& root, const Provenance& provenance) {
  const Group origin = root.make_group("provenance");
  for (const auto& [name, text] : provenance) origin.put_text(name, text);
}

Provenance provenance_of(const Group& root) {
  const Group origin = root.group("provenance");
  Provenance provenance;
  for (const std::string& name : origin.members()) provenance.emplace_back(name, origin.text(name));
  return provenance;
}

}  // namespace nscdd::hdf5
