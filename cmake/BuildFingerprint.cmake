# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DSOURCE=folder -DSETTINGS=text -DOUTPUT=file -P BuildFingerprint.cmake
# A source file with a fingerprint of every header and source of the program, of the compiler and of its settings:
# what tells two builds of one version apart. Names are relative and sorted, so that it does not depend on places.
file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/include/*.hpp ${SOURCE}/src/*.hpp ${SOURCE}/src/*.cpp
     ${SOURCE}/src/*.in)
list(SORT files)
set(all "${SETTINGS}\n")
foreach(file ${files})
  file(SHA256 ${SOURCE}/${file} hash)
  string(APPEND all "${file} ${hash}\n")
endforeach()
string(SHA256 fingerprint "${all}")
string(SUBSTRING ${fingerprint} 0 16 fingerprint)
file(WRITE ${OUTPUT} "#include <nscdd/core/table.hpp>
namespace nscdd {
std::string build_fingerprint() { return \"${fingerprint}\"; }
}  // namespace nscdd
")
