# SPDX-License-Identifier: GPL-3.0-or-later
# Writes a source file with the texts of the page of `nscdd report`, as raw strings.
#   cmake -DFOLDER=src/formats/report/page -DPROGRAM=a.js,b.js -DOUTPUT=page_parts.cpp -P EmbedPage.cmake
function(raw_string file result)
  file(READ "${FOLDER}/${file}" text)
  string(LENGTH "${text}" bytes)
  if(bytes GREATER 65000)  # compilers need not take longer ones than 65 536
    message(FATAL_ERROR "${file}: expected at most 65000 bytes, met ${bytes}")
  endif()
  set(${result} "R\"embedded(${text})embedded\"" PARENT_SCOPE)
endfunction()

raw_string(page.html page)
raw_string(page.css style)
string(REPLACE "," ";" files "${PROGRAM}")
set(program "")
foreach(file IN LISTS files)
  raw_string("${file}" text)
  string(APPEND program "${text},\n")
endforeach()
file(WRITE "${OUTPUT}" "#include <span>
#include <string_view>
namespace nscdd::page::parts {
extern constinit const std::string_view page = ${page};
extern constinit const std::string_view style = ${style};
namespace {
constexpr std::string_view files[] = {
${program}};
}  // namespace
extern constinit const std::span<const std::string_view> program = files;
}  // namespace nscdd::page::parts
")
