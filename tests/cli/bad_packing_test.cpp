// SPDX-License-Identifier: GPL-3.0-or-later
// Malformed packing files: refused with file and line, or with the grains.
#include "session.hpp"

using namespace nscdd::testing;

namespace {

void check_bad(const std::string& text, std::initializer_list<std::string> parts, const std::string& more = "") {
  const Session session;
  session.file("bad.csv", text);
  CAPTURE(text);
  session.check_refused("sweep bad.csv --epsilon 1 --csv out.csv --hdf5 out.h5 " + more, parts);
  session.check_refused("inspect bad.csv " + more, parts);
  session.check_refused("network bad.csv " + more, parts);
  session.check_refused("optimum bad.csv --contacts all " + more, parts);
}

}  // namespace

TEST_CASE("packing file: a missing column") {
  check_bad("x,y\n0,0\n", {"bad.csv:1", "'radius'"});
  check_bad("x,radius,mass\n0,1,1\n", {"bad.csv:1", "'y'"});
  check_bad("# a remark\n\nx,y\n0,0\n", {"bad.csv:3", "'radius'"});
}

TEST_CASE("packing file: an unknown column") {
  check_bad("x,y,radius,colour\n0,0,1,3\n", {"bad.csv:1", "colour", "x, y, radius"});
  check_bad("x,y,Radius\n0,0,1\n", {"bad.csv:1", "Radius"});
  check_bad("x;y;radius\n0;0;1\n", {"bad.csv:1", "x;y;radius"});
  check_bad("0,1,0.5\n1,0,0.5\n", {"bad.csv:1", "'0'"});  // no line of names
}

TEST_CASE("packing file: a column named twice or not at all") {
  check_bad("x,y,radius,x\n0,0,1,0\n", {"bad.csv:1", "'x'", "twice"});
  check_bad("0,0,1\n2,0,1\n", {"bad.csv:1", "'0'", "expected columns x, y, radius"});
  check_bad("x,y,,radius\n0,0,0,1\n", {"bad.csv:1", "column 3"});
}

TEST_CASE("packing file: a row too short or too long") {
  check_bad("x,y,radius\n0,0,1\n5,0\n", {"bad.csv:3", "3 values", "met 2"});
  check_bad("x,y,radius\n0,0,1\n5,0,1,1\n", {"bad.csv:3", "3 values", "met 4"});
  check_bad("x,y,radius\n0,0,1,\n", {"bad.csv:2", "3 values", "met 4"});
}

TEST_CASE("packing file: text for a number") {
  check_bad("x,y,radius\n0,zero,1\n", {"bad.csv:2", "y", "a number", "zero"});
  check_bad("x,y,radius\n0,0,1 m\n", {"bad.csv:2", "radius", "1 m"});
  check_bad("x,y,radius\n0,0,\n", {"bad.csv:2", "radius", "a number"});
  check_bad("x,y,radius\n0,0,0x1p1\n", {"bad.csv:2", "radius", "0x1p1"});
  check_bad("x,y,radius\n0,1e999,1\n", {"bad.csv:2", "y", "1e999"});
  check_bad("x,y,radius\n0,\"0,1\n", {"bad.csv:2", "quote"});
}

TEST_CASE("packing file: NaN or infinite values") {
  check_bad("x,y,radius\nnan,0,1\n", {"bad.csv:2", "x", "finite", "nan"});
  check_bad("x,y,radius\n0,inf,1\n", {"bad.csv:2", "y", "finite", "inf"});
  check_bad("x,y,radius\n0,0,nan\n", {"bad.csv:2", "radius", "finite", "nan"});
  check_bad("x,y,radius\n0,0,1\n9,0,inf\n", {"bad.csv:3", "radius", "finite", "inf"});
  check_bad("x,y,radius,mass\n0,0,1,nan\n", {"bad.csv:2", "mass", "finite", "nan"});
  check_bad("x,y,radius,mass\n0,0,1,-inf\n", {"bad.csv:2", "mass", "finite", "inf"});
}

TEST_CASE("packing file: a negative or zero radius or mass") {
  check_bad("x,y,radius\n0,0,-1\n", {"bad.csv:2", "radius", "> 0", "-1"});
  check_bad("x,y,radius\n0,0,0\n", {"bad.csv:2", "radius", "> 0"});
  check_bad("x,y,radius,mass\n0,0,1,-2\n", {"bad.csv:2", "mass", "> 0", "-2"});
  check_bad("x,y,radius,mass\n0,0,1,0\n", {"bad.csv:2", "mass", "> 0"});
}

TEST_CASE("packing file: empty or only a line of names") {
  check_bad("", {"bad.csv", "empty"});
  check_bad("\n\n# nothing\n", {"bad.csv", "empty"});
  check_bad("x,y,radius\n", {"bad.csv", "at least one grain"});
}

TEST_CASE("packing file: bytes that are no text") {
  std::string bytes = "x,y,radius\n0,0,1";
  bytes.push_back('\0');
  check_bad(bytes + "\n", {"bad.csv:2", "radius"});
  check_bad(
      "\x7f"
      "ELF\x02\x01\n",
      {"bad.csv:1"});
}

TEST_CASE("packing: overlapping grains are named") {
  check_bad("x,y,radius\n0,0,1\n9,9,1\n1.5,0,1\n",
            {"bad.csv: grains 0 and 2", "overlap", "0.5", "contacts.overlap_tolerance, --overlap-tolerance"});
  // one inside the other
  check_bad("x,y,radius\n0,0,5\n1,0,1\n", {"grains 0 and 1", "overlap"});
  // just beyond the tolerance
  check_bad("x,y,radius\n0,0,1\n1.9999,0,1\n", {"grains 0 and 1", "overlap"}, "--overlap-tolerance 1e-5");
}

TEST_CASE("packing: a duplicate grain is named whatever the tolerance") {
  const std::string text = "x,y,radius\n9,0,1\n2,3,1\n5,5,1\n2,3,1\n";
  check_bad(text, {"grains 1 and 3", "(2, 3)"});
  check_bad(text, {"grains 1 and 3"}, "--overlap-tolerance 1");
}

TEST_CASE_FIXTURE(Session, "packing: an accepted overlap is a contact") {
  file("soft.csv", "x,y,radius\n0,0,1\n1.9999,0,1\n");
  const CsvTable links = table("network soft.csv --overlap-tolerance 1e-3 --prescribed 1:-1:0");
  REQUIRE(links.rows.size() == 1);
  CHECK(links.number(0, "gap") < 0);
}

TEST_CASE_FIXTURE(Session, "packing file: what is legal beside plain rows") {
  file("plain.csv", "x,y,radius\n0,0,0.5\n1,0,0.5\n2,0,0.5\n");
  file("fancy.csv",
       "\xEF\xBB\xBF# byte order mark, remarks, blank lines, CRLF, quotes, any order of columns\r\n"
       "\"radius\" , y,x\r\n\r\n0.5,0,0\r\n # inside\r\n\"0.5\", +0 ,1e0\r\n0.5,0,2");
  const std::string options = " --subdomains 2x1 --epsilon 0,1";
  CHECK(table("sweep fancy.csv" + options).text(1, "spectral_radius") ==
        table("sweep plain.csv" + options).text(1, "spectral_radius"));
}
