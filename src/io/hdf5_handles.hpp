// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/error.hpp>

#include <hdf5.h>

#include <string>

namespace nscdd {

/// An HDF5 identifier closed by its own function. Throws where HDF5 returned none.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closing)(hid_t),
         const std::string& failure = "HDF5: the file cannot be put together")
      : id_(id), close_(closing) {
    if (id_ < 0) throw Error(failure);
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

}  // namespace nscdd
