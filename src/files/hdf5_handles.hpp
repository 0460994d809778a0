// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/error.hpp>

#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The C interface of HDF5 as the files of `io` use it. Files are put together, and taken apart, in memory;
/// whatever fails throws Error.
namespace nscdd::hdf5 {

/// An HDF5 identifier closed by its own function. Throws Error(failure) where HDF5 returned none.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closing)(hid_t),
         const std::string& failure = "HDF5: the file cannot be put together");
  ~Handle();
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  static void require(herr_t status);

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// The bytes of a new file that `fill` writes into. No time stamps: equal content gives equal bytes.
std::string file_bytes(const std::function<void(hid_t file)>& fill);

/// A file given by its bytes, for reading. Throws Error naming `name` for bytes that are no HDF5 file.
Handle open_bytes(std::string_view bytes, const std::string& name);

Handle text_type(std::size_t length);
Handle new_group(hid_t parent, const std::string& name);
void write_attribute(hid_t object, const std::string& name, const std::string& text);
void write_text(hid_t group, const std::string& name, const std::string& text);

/// The same with a zero at its end, for readers that take the bytes as a string of C.
void write_terminated_text(hid_t group, const std::string& name, const std::string& text);

/// A new one-dimensional dataset; `type` is that of the data and of the file.
Handle write_dataset(hid_t group, const std::string& name, hid_t type, std::size_t size, const void* data);
void write_numbers(hid_t group, const std::string& name, std::span<const double> values);
void write_integers(hid_t group, const std::string& name, std::span<const int> values);  ///< 32 bits

bool has(hid_t group, const std::string& name);

/// A member group; `path` is its own, as errors say it ("file: fclib_local/W").
Handle open_group(hid_t parent, const std::string& name, const std::string& path);

/// One-dimensional datasets of numbers, floating point or integer; of whole numbers; a single whole number; a
/// text. `path` as before. Throw Error for a dataset that is missing, something else or damaged.
std::vector<double> read_numbers(hid_t group, const std::string& name, const std::string& path);
std::vector<std::int64_t> read_integers(hid_t group, const std::string& name, const std::string& path);
std::int64_t read_integer(hid_t group, const std::string& name, const std::string& path);
std::string read_text(hid_t group, const std::string& name, const std::string& path);

/// Names of the members of a group, in the order of the alphabet.
std::vector<std::string> members(hid_t group, const std::string& path);

}  // namespace nscdd::hdf5
