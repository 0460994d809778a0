// SPDX-License-Identifier: GPL-3.0-or-later
#include "error_handler.hpp"

#include <hdf5.h>

namespace nscdd::testing {
namespace {

herr_t silent(hid_t, void*) { return 0; }

}  // namespace

bool keeps_error_handler(const std::function<void()>& work) {
  H5E_auto2_t before = nullptr, after = nullptr;
  void *data_before = nullptr, *data_after = nullptr;
  int mine = 0;
  H5Eget_auto2(H5E_DEFAULT, &before, &data_before);
  H5Eset_auto2(H5E_DEFAULT, silent, &mine);
  work();
  H5Eget_auto2(H5E_DEFAULT, &after, &data_after);
  H5Eset_auto2(H5E_DEFAULT, before, data_before);
  return after == silent && data_after == &mine;
}

}  // namespace nscdd::testing
