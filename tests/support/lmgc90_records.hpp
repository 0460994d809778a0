// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "datbox_texts.hpp"
#include "run_program.hpp"

/// Records of LMGC90's HDF5 file with what its text files have.
namespace nscdd::testing {

/// The arrays of a record in the layout of format 0.2.
struct RecordArrays {
  bool space = false;
  double time = 0, step = 0;
  std::vector<double> state = {}, contacts = {};
  std::vector<std::int32_t> visible = {}, numbers = {};
};

/// The state and the contacts that the text files have. Laws are numbered by `laws`.
RecordArrays arrays_of(const DatboxTexts& texts, const std::string& contacts, const std::vector<std::string>& laws);

/// Writes a subfolder `run` with lmgc90.h5, which has these records, and DATBOX, whose DOF.INI has another state.
/// Returns the path of lmgc90.h5.
std::string write_run(const TemporaryFolder& folder, const DatboxTexts& texts,
                      const std::vector<std::pair<std::string, RecordArrays>>& records);

/// A square that has moved by 1 cm; laws in an order that is not that of their names.
NetworkTexts network_in_plane();

}  // namespace nscdd::testing
