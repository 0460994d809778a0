// SPDX-License-Identifier: GPL-3.0-or-later
#include "datbox_texts.hpp"

#include "run_program.hpp"

namespace nscdd::testing {
namespace {

std::filesystem::path folder_of(const char* name) { return source_folder() / "tests/data/lmgc90" / name; }

DatboxTexts datbox(const char* name) {
  const auto text = [&](const char* file) { return read_file(folder_of(name) / file); };
  return {.bodies = text("BODIES.DAT"),
          .bulk = text("BULK_BEHAV.DAT"),
          .tact = text("TACT_BEHAV.DAT"),
          .driven = text("DRV_DOF.DAT"),
          .initial = text("DOF.INI")};
}

NetworkTexts network(const char* name) { return {datbox(name), read_file(folder_of(name) / "Vloc_Rloc.INI")}; }

}  // namespace

DatboxTexts small_datbox() { return datbox("disk_and_plank"); }
DatboxTexts small_datbox_in_space() { return datbox("sphere_and_plank"); }
NetworkTexts square_on_plank() { return network("square_on_plank"); }
NetworkTexts box_on_plane() { return network("box_on_plane"); }

}  // namespace nscdd::testing
