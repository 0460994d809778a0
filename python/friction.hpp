// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/formats/fclib.hpp>

#include <pybind11/pybind11.h>

namespace nscdd::python {

/// A contact problem with what a file says of it, and the local problem that it reduces to.
class ContactProblem {
 public:
  explicit ContactProblem(FclibFile file) : file_(std::make_shared<const FclibFile>(std::move(file))) {}

  const std::shared_ptr<const FclibFile>& file() const { return file_; }
  /// The local problem itself, or what reduces to it, found once. Throws Error as `reduce` does. To be called with the
  /// interpreter lock, which it gives back while it works.
  std::shared_ptr<const LocalFrictionProblem> reduced() const;

 private:
  std::shared_ptr<const FclibFile> file_;
  mutable std::shared_ptr<const LocalFrictionProblem> reduced_;
};

void bind_contact_problems(pybind11::module_& module);

}  // namespace nscdd::python
