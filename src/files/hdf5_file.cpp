// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_file.hpp"

#include <fmt/format.h>

namespace nscdd::hdf5 {
namespace {

// Properties of a new object that carries no time stamps.
Handle without_times(hid_t property_class) {
  Handle properties(H5Pcreate(property_class), H5Pclose);
  require(H5Pset_obj_track_times(properties, 0));
  return properties;
}

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
  std::string image(bytes);  // the library wants mutable bytes
  require(H5Pset_file_image(access, image.data(), image.size()));
  return H5Fopen("memory", H5F_ACC_RDONLY, access);
}

hid_t open_path(const std::string& path, Access how) {
  const Handle access = file_access();
  if (how == Access::fill) require(H5Pset_file_locking(access, false, true));
  if (how == Access::create || how == Access::fill)
    return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, without_times(H5P_FILE_CREATE), access);
  return H5Fopen(path.c_str(), how == Access::change ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access);
}

Handle text_type(std::size_t length, H5T_str_t padding = H5T_STR_NULLPAD, H5T_cset_t characters = H5T_CSET_UTF8) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, padding);
  H5Tset_cset(type, characters);
  return type;
}

Handle scalar_space() { return Handle(H5Screate(H5S_SCALAR), H5Sclose); }

// Replaces an attribute of that name.
void make_attribute(hid_t object, const char* name, Types types, hid_t space, const void* data) {
  if (H5Aexists(object, name) > 0) require(H5Adelete(object, name));
  const Handle attribute(H5Acreate2(object, name, types.file, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(H5Awrite(attribute, types.memory, data));
}

void make_attribute(hid_t object, const char* name, std::string_view text, H5T_cset_t characters = H5T_CSET_UTF8) {
  const Handle type = text_type(text.size(), H5T_STR_NULLPAD, characters);
  make_attribute(object, name, {type, type}, scalar_space(), text.empty() ? "" : text.data());
}

using Extent = std::array<hsize_t, 2>;  // rows and numbers per row: 1 in one dimension

Handle new_array(const Group& group, const std::string& name, hid_t type, const Extent& extent, const ArrayForm& form) {
  constexpr Extent unlimited{H5S_UNLIMITED, H5S_UNLIMITED};
  const int dimensions = form.rows ? 2 : 1;
  const hsize_t width = std::max<hsize_t>(extent[1], 1);
  const Extent chunk{std::max<hsize_t>(form.chunk / width, 1), width};
  const Handle properties = without_times(H5P_DATASET_CREATE);
  if (form.chunk > 0) require(H5Pset_chunk(properties, dimensions, chunk.data()));
  if (form.compressed) {
    constexpr unsigned level = 4;  // of 9: higher levels take much longer and gain little
    require(H5Pset_shuffle(properties));
    require(H5Pset_deflate(properties, level));
  }
  const Handle space(H5Screate_simple(dimensions, extent.data(), form.chunk > 0 ? unlimited.data() : nullptr),
                     H5Sclose);
  Handle dataset(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
                 fmt::format("{}: cannot be made", group.of(name)));
  for (const auto& [key, text] : form.attributes) make_attribute(dataset, key, text);
  return dataset;
}

}  // namespace

ErrorHandler silence_errors() {
  ErrorHandler before;
  H5Eget_auto2(H5E_DEFAULT, &before.first, &before.second);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return before;
}

void restore_errors(const ErrorHandler& handler) { H5Eset_auto2(H5E_DEFAULT, handler.first, handler.second); }

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
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* all) {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return herr_t{0};
  };
  require(H5Literate(id_, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names), fmt::format("{}: cannot be read", path_));
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

void Group::put_array(const std::string& name, Types types, const void* data, std::size_t size,
                      const ArrayForm& form) const {
  const Extent more = form.rows ? Extent{*form.rows, size / *form.rows} : Extent{size, 1};
  Extent start{0, 0};
  const bool there = has(name);
  const std::string failure = fmt::format("{}: cannot be written", of(name));
  const Handle dataset = there ? Handle(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), H5Dclose, failure)
                               : new_array(*this, name, types.file, more, form);
  if (there && form.append)
    require(H5Sget_simple_extent_dims(Handle(H5Dget_space(dataset), H5Sclose), start.data(), nullptr), failure);
  start[1] = 0;
  const Extent extent{start[0] + more[0], more[1]};
  if (there && form.chunk > 0) require(H5Dset_extent(dataset, extent.data()), failure);
  if (size == 0) return;
  const Handle target(H5Dget_space(dataset), H5Sclose);
  require(H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, more.data(), nullptr), failure);
  const Handle source(H5Screate_simple(form.rows ? 2 : 1, more.data(), nullptr), H5Sclose);
  require(H5Dwrite(dataset, types.memory, source, target, H5P_DEFAULT, data), failure);
}

// Texts are padded with zeros to equal lengths.
void Group::put(const std::string& name, std::span<const std::string> texts, const ArrayForm& form) const {
  std::size_t length = std::max<std::size_t>(form.longest_text, 1);
  if (form.longest_text == 0)
    for (const std::string& text : texts) length = std::max(length, text.size());
  std::string bytes;
  for (std::size_t i = 0; i < texts.size(); ++i) bytes.append(texts[i], 0, length).resize((i + 1) * length);
  const Handle type = text_type(length);
  put_array(name, {type, type}, bytes.data(), texts.size(), form);
}

void Group::put_columns(const Table& table, ArrayForm form) const {
  for (std::size_t j = 0; j < table.columns.size(); ++j) {
    const auto& column = table.columns[j];
    form.attributes = {{"unit", column.unit}, {"description", column.description}};
    const Cell first = table.rows.empty() ? Cell{0.0} : table.rows[0][j];
    std::visit(
        [&]<class Value>(const Value&) {
          std::vector<std::conditional_t<std::is_same_v<Value, bool>, std::int8_t, Value>> values;
          for (const Row& row : table.rows) values.push_back(std::get<Value>(row[j]));
          put(column.name, std::span(std::as_const(values)), form);
        },
        first);
  }
}

// A dataset, because an attribute holds at most 64 KiB.
void Group::put_text(const std::string& name, const std::string& text, bool terminated) const {
  const Handle type = text_type(text.size() + (terminated ? 1 : 0), terminated ? H5T_STR_NULLTERM : H5T_STR_NULLPAD);
  const Handle dataset(
      H5Dcreate2(id_, name.c_str(), type, scalar_space(), H5P_DEFAULT, without_times(H5P_DATASET_CREATE), H5P_DEFAULT),
      H5Dclose, fmt::format("{}: cannot be made", of(name)));
  require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()),
          fmt::format("{}: cannot be written", of(name)));
}

void Group::put_attribute(const std::string& name, std::string_view text, H5T_cset_t characters) const {
  make_attribute(id_, name.c_str(), text, characters);
}

void Group::put_attribute(const std::string& name, std::int64_t number) const {
  make_attribute(id_, name.c_str(), types_of<std::int64_t>(), scalar_space(), &number);
}

void Group::put_attribute(const std::string& name, std::span<const std::int64_t> numbers) const {
  const hsize_t size = numbers.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  make_attribute(id_, name.c_str(), types_of<std::int64_t>(), space, numbers.data());
}

File::File()
    : name_("HDF5"),
      id_(H5Fcreate("memory", H5F_ACC_TRUNC, without_times(H5P_FILE_CREATE), memory_access()), H5Fclose) {}

File::File(std::string_view bytes, const std::string& name, std::string_view expected)
    : name_(name),
      id_(open_bytes(bytes), H5Fclose,
          fmt::format("{}: expected {}, met something else or a damaged one", name, expected)) {}

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
