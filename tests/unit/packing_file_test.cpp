// SPDX-License-Identifier: GPL-3.0-or-later
// Packings in files: every double comes back bit for bit, and files that hold no packing are refused.
#include "../support/run_program.hpp"
#include "../support/spoilt.hpp"
#include "files/csv.hpp"
#include "files/hdf5.hpp"
#include "files/hdf5_file.hpp"
#include "files/output_file.hpp"
#include "linalg/random.hpp"
#include <nscdd/formats/packing_file.hpp>
#include <nscdd/packing/generator.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Doubles that are hard to print: of any exponent that a packing may have, the smallest, negative zero.
Packing hard_numbers(bool masses, bool space) {
  RandomStream random(11);
  Packing p;
  const auto any = [&] { return (1 + random.uniform()) * std::pow(10.0, 180 * random.uniform() - 90); };
  for (int i = 0; i < 2000; ++i) {
    p.x.push_back(i % 2 == 0 ? any() : -any());
    p.y.push_back(random.uniform());
    p.radius.push_back(any());
    if (masses) p.mass.push_back(any());
    if (space) p.z.push_back(i % 3 == 0 ? any() : -any());
  }
  p.x[0] = -0.0;
  p.y[0] = 5e-324;
  p.radius[0] = 2.2250738585072014e-308;
  p.x[1] = 0.1 + 0.2;
  p.radius[1] = 1e100;
  return p;
}

std::vector<std::uint64_t> bits(const std::vector<double>& values) {
  std::vector<std::uint64_t> all;
  for (const double value : values) all.push_back(std::bit_cast<std::uint64_t>(value));
  return all;
}

std::string written(const Packing& packing, const std::string& name, const Provenance& provenance = {}) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / name).string();
  OutputFile file(path, false);
  file.bytes(packing_bytes(*packing_format(path), packing, provenance));
  file.finish();
  return read_text(path);
}

Packing read_back(const std::string& content, const std::string& name) {
  const testing::TemporaryFolder folder;
  testing::write_file(folder / name, content);
  return read_packing((folder / name).string());
}

// The bytes of an HDF5 file with these columns in the group.
std::string file_of(const std::string& group, const std::vector<std::pair<std::string, std::vector<double>>>& columns) {
  return hdf5::new_file_bytes([&](const hdf5::Group& root) {
    const hdf5::Group all = root.make_group(group);
    for (const auto& [name, values] : columns) all.put<double>(name, values);
  });
}

void refused_packing(const std::string& bytes, const Names& names) {
  check_error([&] { packing_from_hdf5(bytes, "p.h5"); }, names);
}

}  // namespace

TEST_CASE("output file: another file that got the name meanwhile is not replaced without force") {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / "t.csv").string();
  OutputFile file(path, false), forced((folder / "u.csv").string(), true);
  file.bytes("mine"), forced.bytes("mine");
  for (const char* name : {"t.csv", "u.csv"}) testing::write_file(folder / name, "of others");
  check_error([&] { file.finish(); }, {"t.csv", "appeared during the run", "t.csv.partial"});
  CHECK(read_text(path) == "of others");
  CHECK(read_text(path + ".partial") == "mine");
  forced.finish();
  CHECK(read_text((folder / "u.csv").string()) == "mine");
}

TEST_CASE("packing file: written and read back, every double is the same") {
  for (const int kind : {0, 1, 2, 3})
    for (const char* name : {"p.csv", "p.h5", "p.hdf5"}) {
      INFO("name = ", name, ", kind = ", kind);
      const Packing p = hard_numbers(kind % 2 == 1, kind >= 2);
      const Packing back = read_back(written(p, name, {{"program", "a\nb"}}), name);
      CHECK(bits(back.x) == bits(p.x));
      CHECK(bits(back.y) == bits(p.y));
      CHECK(bits(back.radius) == bits(p.radius));
      CHECK(bits(back.mass) == bits(p.mass));
      CHECK(bits(back.z) == bits(p.z));
      CHECK(back.dimension() == (kind >= 2 ? 3 : 2));
    }
}

TEST_CASE("packing file: a column z makes a packing in space, one z for all as well") {
  const Packing sheet = parse_packing("radius,z,y,x\n1,7,0,0\n1,7,0,2\n", "p.csv");
  CHECK(sheet.dimension() == 3);
  CHECK(sheet.z == std::vector<double>{7, 7});
  CHECK(packing_csv(sheet) == "x,y,z,radius\n0,0,7,1\n2,0,7,1\n");
  CHECK_THROWS_WITH_AS(parse_packing("x,y,z,radius\n0,0,0,1\n2,0,1\n", "p.csv"), doctest::Contains("p.csv:3: "), Error);
  check_error([&] { parse_packing("x,y,z,radius\n0,0,inf,1\n", "p.csv"); }, {"p.csv:2: z:", "number"});
}

TEST_CASE("packing file: equal packings give equal bytes, and say where they come from") {
  const Packing p = generate(Deposit{.grains = 300});
  const Provenance origin{{"program", "nscdd 1"}, {"cases", "[packing]\nseed = 7\n"}};
  for (const char* name : {"p.csv", "p.h5"}) CHECK(written(p, name, origin) == written(p, name, origin));
  CHECK(
      written(p, "p.csv", origin).rfind("# program: nscdd 1\n# cases:\n#   [packing]\n#   seed = 7\nx,y,radius\n", 0) ==
      0);
  CHECK(written(p, "p.h5", origin).find("seed = 7") != std::string::npos);
}

TEST_CASE("packing file: formats by the ending of the name") {
  CHECK(packing_format("a/b.csv") == PackingFormat::csv);
  CHECK(packing_format("b.h5") == PackingFormat::hdf5);
  CHECK(packing_format("b.tar.hdf5") == PackingFormat::hdf5);
  for (const char* name : {"b", "b.txt", "b.H5", ".h5", "h5", "b.csv/c"}) CHECK_FALSE(packing_format(name));
}

TEST_CASE("packing file: HDF5 that holds no packing is refused by name") {
  const std::vector<double> two{1, 2}, three{1, 2, 3};
  refused_packing("", {"p.h5:", "HDF5"});
  refused_packing("x,y,radius\n1,2,3\n", {"p.h5:", "HDF5"});
  const std::string good = file_of("packing", {{"x", two}, {"y", two}, {"radius", two}});
  CHECK(packing_from_hdf5(good, "p.h5").size() == 2);
  refused_packing(good.substr(0, good.size() / 2), {"p.h5:", "HDF5"});
  refused_packing(file_of("sweep", {{"x", two}}), {"p.h5: packing:", "met none"});
  refused_packing(file_of("packing", {{"x", two}, {"y", two}}), {"p.h5: packing:", "'radius'", "met none"});
  refused_packing(file_of("packing", {{"x", two}, {"y", two}, {"radius", two}, {"colour", two}}),
                  {"p.h5: packing/colour:", "mass"});
  refused_packing(file_of("packing", {{"x", two}, {"y", three}, {"radius", two}}),
                  {"p.h5: packing/y:", "2 numbers", "met 3"});
  refused_packing(file_of("packing", {{"x", two}, {"y", two}, {"z", three}, {"radius", two}}),
                  {"p.h5: packing/z:", "2 numbers", "met 3"});
  refused_packing(file_of("packing", {{"x", two}, {"y", two}, {"z", {0, not_a_number}}, {"radius", two}}),
                  {"p.h5: packing/z: grain 1:", "number"});
  refused_packing(file_of("packing", {{"x", two}, {"y", two}, {"radius", {1, 0}}}),
                  {"p.h5: packing/radius: grain 1:", "> 0"});
  refused_packing(file_of("packing", {{"x", {0, not_a_number}}, {"y", two}, {"radius", two}}),
                  {"p.h5: packing/x: grain 1:", "number"});
  refused_packing(file_of("packing", {{"x", two}, {"y", two}, {"radius", two}, {"mass", {1, -1}}}),
                  {"p.h5: packing/mass: grain 1"});
  refused_packing(file_of("packing", {{"x", {}}, {"y", {}}, {"radius", {}}}), {"p.h5:", "grain"});
  // a table of texts under the right name
  const Table texts{{{"x", "", "texts"}}, {{std::string("one")}, {std::string("two")}}};
  refused_packing(to_hdf5({}, {{"packing", texts}}), {"p.h5: packing/x:", "numbers"});
}

TEST_CASE("packing file: integers of an HDF5 file are numbers") {
  const Table table{{{"x", "m", ""}, {"y", "m", ""}, {"radius", "m", ""}}, {{std::int64_t{3}, 0.5, std::int64_t{1}}}};
  const Packing p = packing_from_hdf5(to_hdf5({}, {{"packing", table}}), "p.h5");
  CHECK(p.x == std::vector<double>{3});
  CHECK(p.radius == std::vector<double>{1});
}

TEST_CASE("choices take their names alone, and suggest the nearest") {
  Choice<Distribution> value = "lognormal";
  CHECK(value == Distribution::lognormal);
  CHECK(field_text(value) == "\"lognormal\"");
  for (const char* wrong : {"", "uni", "uniform lognormal", "uniforms", "Uniform"})
    CHECK_THROWS_WITH_AS(parse_value(wrong, value, "c.toml:3: packing.distribution"),
                         doctest::Contains("c.toml:3: packing.distribution: expected one of \"uniform\", "
                                           "\"uniform_volume\", \"two_sizes\", \"lognormal\""),
                         Error);
  CHECK_THROWS_WITH_AS(parse_value("twosizes", value, "d"), doctest::Contains("; did you mean two_sizes?"), Error);
  CHECK(value == Distribution::lognormal);
}
