// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/hdf5_file.hpp"

#include <type_traits>

/// What reading and writing of HDF5 files share.
namespace nscdd::hdf5 {

/// Throws Error(failure) if HDF5 reports one.
inline void require(herr_t status, const std::string& failure = "HDF5: the file cannot be put together") {
  if (status < 0) throw Error(failure);
}

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

/// Properties of a new object that carries no time stamps.
inline Handle without_times(hid_t property_class) {
  Handle properties(H5Pcreate(property_class), H5Pclose);
  require(H5Pset_obj_track_times(properties, 0));
  return properties;
}

}  // namespace nscdd::hdf5
