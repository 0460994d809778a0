// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/process_guard.hpp"
#include <nscdd/core/table.hpp>

#include <hdf5.h>

/// Wrapper of the C interface of HDF5: files on disk or in memory, groups, arrays of numbers, texts. Failures throw
/// Error. Without time stamps, equal content gives equal bytes.
namespace nscdd::hdf5 {

using ErrorHandler = std::pair<H5E_auto2_t, void*>;  ///< with its data
ErrorHandler silence_errors();                       ///< returns the previous handler of HDF5
void restore_errors(const ErrorHandler& handler);
/// Silences the error messages of HDF5 for its lifetime.
using QuietErrors = ProcessGuard<silence_errors, restore_errors>;

inline constexpr const char* incomplete = "HDF5: the file cannot be put together";

/// Throws Error(failure) if HDF5 reports one.
inline void require(herr_t status, const std::string& failure = incomplete) {
  if (status < 0) throw Error(failure);
}

/// An HDF5 identifier, closed by its own function. Throws Error(failure) if HDF5 returned none.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closing)(hid_t), const std::string& failure = incomplete);
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  ~Handle();
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Types of a number in memory and in a file.
struct Types {
  hid_t memory, file;
};
template <class Value>
Types types_of() {
  if constexpr (std::is_same_v<Value, double>) return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
  if constexpr (std::is_same_v<Value, std::int64_t>) return {H5T_NATIVE_INT64, H5T_STD_I64LE};
  if constexpr (std::is_same_v<Value, std::int32_t>) return {H5T_NATIVE_INT32, H5T_STD_I32LE};
  if constexpr (std::is_same_v<Value, std::int8_t>) return {H5T_NATIVE_INT8, H5T_STD_I8LE};
}

/// Options for writing an array.
struct ArrayForm {
  /// Attributes, such as {{"unit", "m"}}, written when the array is created.
  std::vector<std::pair<const char*, std::string_view>> attributes{};
  std::size_t chunk = 0;              ///< elements per chunk of a resizable array; 0: fixed size
  bool append = false;                ///< to the existing array, instead of replacing it
  std::optional<std::size_t> rows{};  ///< of a two-dimensional array
  std::size_t longest_text = 0;       ///< bytes at which texts are cut; 0: no limit
  bool compressed = false;            ///< shuffled and deflated, chunk by chunk; only with chunks
};

/// Part of an array: of a two-dimensional one, whole rows.
struct Rows {
  Index first = 0, number = 1;
};

/// A group of an open file. Errors name its members as "run.h5: last/contacts".
class Group {
 public:
  Group(hid_t parent, const std::string& name, std::string path);

  operator hid_t() const { return id_; }
  const std::string& path() const { return path_; }
  std::string of(const std::string& member) const;  ///< name of a member in error messages
  bool has(const std::string& name) const;
  std::vector<std::string> members() const;  ///< sorted

  /// Reading. Throws Error for a member that is missing, of another kind or damaged.
  Group group(const std::string& name) const;
  /// A one-dimensional array of numbers, or some rows of an array of one or two dimensions. An integer type `Value`
  /// (std::int8_t, std::int32_t, std::int64_t) requires integers; double reads both kinds.
  template <class Value>
  std::vector<Value> numbers(const std::string& name, std::optional<Rows> rows = std::nullopt) const;
  Index rows(const std::string& name) const;  ///< of an array; 0 if there is none
  std::int64_t integer(const std::string& name) const;
  double number(const std::string& name) const;
  std::string text(const std::string& name) const;
  std::vector<std::string> texts(const std::string& name) const;  ///< a one-dimensional array
  std::string text_attribute(const std::string& name) const;

  /// Writing. An existing group or array is reused; an array with chunks is then resized.
  Group make_group(const std::string& name) const;
  template <class Value>
  void put(const std::string& name, std::span<const Value> values, const ArrayForm& form = {}) const {
    put_array(name, types_of<Value>(), values.data(), values.size(), form);
  }
  void put(const std::string& name, std::span<const std::string> texts, const ArrayForm& form) const;
  /// The columns of a table, with their units and descriptions.
  void put_columns(const Table& table, ArrayForm form = {}) const;
  /// `terminated`: with a zero at its end, for readers of C strings.
  void put_text(const std::string& name, const std::string& text, bool terminated = false) const;
  /// `characters`: H5T_CSET_ASCII for readers without UTF-8.
  void put_attribute(const std::string& name, std::string_view text, H5T_cset_t characters = H5T_CSET_UTF8) const;
  void put_attribute(const std::string& name, std::int64_t number) const;
  void put_attribute(const std::string& name, std::span<const std::int64_t> numbers) const;
  void remove(const std::string& name) const;

 private:
  void put_array(const std::string& name, Types types, const void* data, std::size_t size, const ArrayForm& form) const;
  std::string path_;
  Handle id_;
};

enum class Access {
  create,
  change,
  read,
  fill,  ///< create anew in a file that the caller has locked
};

/// An open file, closed with everything in it by the destructor.
class File {
 public:
  File();  ///< new, in memory
  /// Given by its bytes, for reading. `expected`: what the error names for anything else.
  File(std::string_view bytes, const std::string& name, std::string_view expected = "an HDF5 file");
  File(const std::string& path, Access access, const std::string& failure);  ///< on disk

  Group root() const { return {id_, "/", name_}; }
  std::string bytes() const;  ///< of a file in memory
  void flush() const;         ///< throws Error if the system cannot write the file

 private:
  QuietErrors quiet_;  // before the file is opened, after it is closed
  std::string name_;
  Handle id_;
};

/// The bytes of a new file that `fill(root)` fills.
std::string new_file_bytes(auto&& fill) {
  const File file;
  fill(file.root());
  return file.bytes();
}

/// Texts in the group `provenance`.
void put_provenance(const Group& root, const Provenance& provenance);
Provenance provenance_of(const Group& root);  ///< sorted by name

}  // namespace nscdd::hdf5
