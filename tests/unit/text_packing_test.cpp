// SPDX-License-Identifier: GPL-3.0-or-later
// Packings of YADE and ESyS-Particle: lines "x y r" and "x y z r".

#include "../support/run_program.hpp"
#include "../support/spoilt.hpp"
#include <nscdd/formats/packing_file.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

using Values = std::vector<double>;

void refused_text_packing(const std::string& text, const Names& names) {
  REQUIRE(is_text_packing(text));
  check_error([&] { parse_packing(text, "p.txt"); }, names);
}

}  // namespace

TEST_CASE("text packing: lines of three numbers, and of four with one z") {
  const Packing plane = parse_packing("#format x_y_r\n\n 0 1\t0.5\r\n# between\n+2 -1e-3 .25 \n", "p.txt");
  CHECK(plane.x == Values{0, 2});
  CHECK(plane.y == Values{1, -1e-3});
  CHECK(plane.radius == Values{0.5, 0.25});
  CHECK(plane.mass.empty());
  const Packing sheet = parse_packing("0 1 7 0.5\n2 3 7.0 0.1", "p.txt");
  CHECK(sheet.x == Values{0, 2});
  CHECK(sheet.y == Values{1, 3});
  CHECK(sheet.radius == Values{0.5, 0.1});
  CHECK(sheet.dimension() == 2);
  CHECK(parse_packing("0 1 7 0.5", "p.txt").dimension() == 2);
}

TEST_CASE("text packing: spheres in space where z differs") {
  const Packing space = parse_packing("# x y z r\n0 1 7 0.5\n2 3 -7e-1 0.1\n4 5 7 0.2\n", "p.txt");
  CHECK(space.dimension() == 3);
  CHECK(space.x == Values{0, 2, 4});
  CHECK(space.y == Values{1, 3, 5});
  CHECK(space.z == Values{7, -0.7, 7});
  CHECK(space.radius == Values{0.5, 0.1, 0.2});
  CHECK(parse_packing("0 0 0 1\n2 0 4.9e-324 1\n", "p.txt").dimension() == 3);
}

TEST_CASE("text packing: told from CSV by the first line that says something") {
  for (const char* text : {"x,y,radius\n1,2,3\n", "x y radius\n1 2 3\n", "# 1 2 3\nx,y,radius\n1,2,3\n", "1,2,3\n", "",
                           "# 1 2 3\n", "12\n", "1 2 3,\n", "2\n4\n0\n"})
    CHECK_FALSE(is_text_packing(text));
  for (const char* text : {"1 2 3\n", "\n#\n1\t2 3 4",
                           "\xef\xbb\xbf"
                           "1 2 3",
                           "1 2", "1 2 3 4 5"})
    CHECK(is_text_packing(text));
  CHECK(parse_packing("x,y,radius\n1,2,3\n", "p.csv").x == Values{1});
}

TEST_CASE("text packing: read from a file, whatever its ending but those of HDF5") {
  const TemporaryFolder folder;
  for (const char* name : {"p.txt", "p.csv", "p.dat", "p"}) {
    write_file(folder / name, "0 0 1\n2 0 1\n");
    CHECK(read_packing((folder / name).string()).size() == 2);
  }
}

TEST_CASE("text packing: what is none is refused with its line") {
  refused_text_packing("0 0 0 1\n2 0 up 1\n", {"p.txt:2: z:", "met 'up'"});
  refused_text_packing("0 0 0 1\n2 0 0 0\n", {"p.txt:2: radius: expected"});
  refused_text_packing("# a\n0 0\n", {"p.txt:2:", "'x y radius'", "met 2 numbers"});
  refused_text_packing("0 0 0 1 7\n", {"met 5 numbers"});
  refused_text_packing("0 0 1\n\n0 0 0 1\n", {"p.txt:3:", "3 numbers", "met 4"});
  refused_text_packing("0 0 1\n0 0 one\n", {"p.txt:2: radius:", "met 'one'"});
  refused_text_packing("0 0 0\n", {"p.txt:1: radius: expected"});
  refused_text_packing("0 0 -1\n", {"p.txt:1: radius: expected"});
  refused_text_packing("0 nan 1\n", {"p.txt:1: y: expected"});
  refused_text_packing("0 0 inf 1\n", {"p.txt:1: z: expected"});
  refused_text_packing("1e200 0 1\n", {"p.txt:1: x: expected"});
}
