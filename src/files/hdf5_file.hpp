// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/hdf5.hpp"
#include <nscdd/core/error.hpp>

#include <hdf5.h>

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The C interface of HDF5 as this program uses it: files on disk or in memory, groups, arrays of numbers,
/// texts. Whatever fails throws Error. Files carry no time stamps, so that equal content gives equal bytes.
namespace nscdd::hdf5 {

/// While this object lives, HDF5 prints no error messages of its own. Afterwards the error handler is the one
/// that the process had before.
class QuietErrors {
 public:
  QuietErrors();
  ~QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t handler_ = nullptr;
  void* data_ = nullptr;
};

/// An HDF5 identifier, closed by its own function. Throws Error(failure) if HDF5 returned none.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closing)(hid_t), const std::string& failure = "HDF5: the file cannot be put together");
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  ~Handle();
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Elements per chunk of an array that may change its size; 0 for an array of fixed size.
using Chunk = std::int64_t;

/// Texts that describe an array, such as {{"unit", "m"}}: written when the array is made.
using Attributes = std::initializer_list<std::pair<const char*, std::string_view>>;

/// A group of an open file. Errors name its members as "run.h5: last/contacts".
class Group {
 public:
  Group(hid_t parent, const std::string& name, std::string path);

  operator hid_t() const { return id_; }
  const std::string& path() const { return path_; }
  std::string of(const std::string& member) const;  ///< name of a member in error messages
  bool has(const std::string& name) const;
  std::vector<std::string> members() const;  ///< in the order of the alphabet

  /// Reading. Every function throws Error for a member that is missing, is something else or is damaged.
  Group group(const std::string& name) const;
  /// A one-dimensional array of numbers; of whole numbers if `Value` is an integer type (std::int8_t,
  /// std::int32_t, std::int64_t), else floating-point numbers or whole ones.
  template <class Value>
  std::vector<Value> numbers(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  std::string text(const std::string& name) const;
  std::vector<std::string> texts(const std::string& name) const;  ///< a one-dimensional array of them
  H5T_class_t kind(const std::string& name) const;                ///< of the elements of an array
  std::size_t element_size(const std::string& name) const;        ///< bytes
  std::string text_attribute(const std::string& name, const std::string& member = ".") const;
  double number_attribute(const std::string& name) const;

  /// Writing. A group or array that exists is taken again; an array with chunks is then resized.
  Group make_group(const std::string& name) const;
  template <class Value>
  void put(const std::string& name, std::span<const Value> values, Attributes attributes = {}, Chunk chunk = 0) const;
  void put_texts(const std::string& name, std::span<const std::string> texts, Attributes attributes) const;
  /// Behind the end of an array with chunks; texts are cut after `longest` bytes.
  template <class Value>
  void append(const std::string& name, std::span<const Value> values, Attributes attributes, Chunk chunk) const;
  void append_texts(const std::string& name, std::span<const std::string> texts, std::size_t longest,
                    Attributes attributes, Chunk chunk) const;
  void put_text(const std::string& name, const std::string& text) const;
  /// The same with a zero at its end, for readers that take the bytes as a string of C.
  void put_terminated_text(const std::string& name, const std::string& text) const;
  void put_attribute(const std::string& name, std::string_view text) const;
  void put_attribute(const std::string& name, double value) const;
  void remove(const std::string& name) const;

 private:
  void put_text_bytes(const std::string& name, hid_t type, const std::string& bytes) const;
  void append_bytes(const std::string& name, hid_t file_type, hid_t memory_type, std::size_t size, const void* data,
                    Attributes attributes, Chunk chunk) const;
  std::string path_;
  Handle id_;
};

enum class Access { create, change, read };

/// An open file. It is closed, with everything in it, at the end of the object's life.
class File {
 public:
  File();                                                                    ///< new, in memory
  File(std::string_view bytes, const std::string& name);                     ///< given by its bytes, for reading
  File(const std::string& path, Access access, const std::string& failure);  ///< on disk

  Group root() const { return {id_, "/", name_}; }
  std::string bytes() const;  ///< of a file in memory
  void flush() const;         ///< throws Error if the system cannot write the file

 private:
  QuietErrors quiet_;  // before the file is opened, after it is closed
  std::string name_;
  Handle id_;
};

/// The bytes of a new file that `fill(root)` puts its groups into.
template <class Fill>
std::string new_file_bytes(Fill&& fill) {
  const File file;
  fill(file.root());
  return file.bytes();
}

/// Texts in the group `provenance`.
void put_provenance(const Group& root, const Provenance& provenance);
Provenance provenance_of(const Group& root);  ///< in the order of the alphabet

}  // namespace nscdd::hdf5
