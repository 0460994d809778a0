// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "core/text.hpp"
#include "files/csv.hpp"
#include "formats/case/case_file.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/lmgc90/datbox.hpp"
#include "formats/packing/text_packing.hpp"
#include <nscdd/formats/packing_file.hpp>

#include <filesystem>

namespace nscdd {

CaseSpec spec_of_file(const std::string& path, bool moving) {
  if (holds_datbox(path)) return case_of_datbox(path, moving);
  const std::filesystem::path extension = std::filesystem::path(path).extension();
  if (extension == ".toml") return read_case(path);
  CaseSpec spec;
  spec.name = std::filesystem::path(path).stem().string();
  const auto format = packing_format(path);
  if (!format) {
    // What other programs write as text: a packing, whatever its ending, or a contact problem.
    const bool siconos = has_siconos_name(path);
    const std::string text = siconos || extension == ".txt" ? read_text(path) : "";
    require_utf8(text, path);
    if (is_text_packing(text))
      spec.packing = PackingFile{path};
    else if (siconos)
      spec.packing = ContactProblemFile{path};
    else
      fail(
          "{}: expected a case file (.toml), a packing file (.csv, .h5 or .hdf5, or .txt with lines 'x y radius'), a "
          "folder with BODIES.DAT or a contact problem (.hdf5 or .dat)",
          path);
    return spec;
  }
  if (*format == PackingFormat::hdf5 && holds_fclib(read_text(path), path))
    spec.packing = ContactProblemFile{path};
  else
    spec.packing = PackingFile{path};
  return spec;
}

}  // namespace nscdd
