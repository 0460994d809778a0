// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/fclib_files.hpp"
#include "../support/spoilt.hpp"
#include "files/hdf5.hpp"
#include <nscdd/formats/fclib.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

bool same_solution(const FclibSolution& a, const FclibSolution& b) {
  return same_bits(a.v, b.v) && same_bits(a.u, b.u) && same_bits(a.r, b.r);
}

void refused_problem(const std::string& bytes, const Names& names) {
  check_error([&] { fclib_from_hdf5(bytes, "p.hdf5"); }, names);
}

// A global problem of five bodies as FCLIB would write it, with changes.
std::string changed(const std::function<void(RawFclib&)>& change) {
  RawFclib raw = raw_global(random_bodies_problem(3, 5, 4));
  change(raw);
  return raw.bytes();
}

}  // namespace

TEST_CASE("what is written reads back bit for bit, local and global") {
  FclibFile file;
  const GlobalFrictionProblem global = random_bodies_problem(1, 6, 5);
  file.problem = global;
  file.info = {"a title", std::nullopt, "\xCF\x81 < 1"};
  file.solution =
      FclibSolution{Vector::LinSpaced(18, -0.1, 1.0 / 3), Vector::Constant(10, -0.0), Vector::Constant(10, 5e-324)};
  file.guesses = {*file.solution, *file.solution};
  file.guesses[1].r[3] = 1e300;
  SUBCASE("global") {
    const FclibFile back = fclib_from_hdf5(to_hdf5(file), "p.hdf5");
    CHECK(same_bits(std::get<GlobalFrictionProblem>(back.problem), global));
    CHECK(back.contacts() == 5);
    CHECK(back.info.title == "a title");
    CHECK_FALSE(back.info.description);
    CHECK(back.info.math_info == "\xCF\x81 < 1");
    REQUIRE(back.solution);
    CHECK(same_solution(*back.solution, *file.solution));
    REQUIRE(back.guesses.size() == 2);
    CHECK(same_solution(back.guesses[1], file.guesses[1]));
    CHECK(to_hdf5(back) == to_hdf5(file));
  }
  SUBCASE("local, without solution, guesses and texts") {
    const LocalFrictionProblem local = reduce(global);
    const FclibFile back = fclib_from_hdf5(to_hdf5(FclibFile{local, {}, {}, {}}), "p.hdf5");
    CHECK(same_bits(std::get<LocalFrictionProblem>(back.problem), local));
    CHECK_FALSE(back.solution);
    CHECK(back.guesses.empty());
  }
  SUBCASE("provenance is left alone") {
    CHECK(fclib_from_hdf5(to_hdf5(file, {{"program", "nscdd"}}), "p.hdf5").contacts() == 5);
  }
}

TEST_CASE("matrices by columns, by rows and as triplets are the same problem") {
  const GlobalFrictionProblem global = random_bodies_problem(2, 5, 4);
  for (const Storage storage : {Storage::columns, Storage::rows, Storage::triplets, Storage::csparse_triplets}) {
    const FclibFile file = fclib_from_hdf5(raw_global(global, storage).bytes(), "p.hdf5");
    CHECK(same_bits(std::get<GlobalFrictionProblem>(file.problem), global));
  }
}

TEST_CASE("entries of a matrix that are given in parts add up") {
  const GlobalFrictionProblem global = random_bodies_problem(2, 5, 4);
  RawFclib raw = raw_global(global, Storage::triplets);
  std::vector<double>& x = raw.numbers.at("fclib_global/H/x");
  x[0] /= 2;
  x.push_back(x[0]);
  for (const std::string name : {"p", "i"}) {
    std::vector<int>& indices = raw.integers.at("fclib_global/H/" + name);
    indices.push_back(indices[0]);
  }
  for (const std::string name : {"nz", "nzmax"}) ++raw.integers.at("fclib_global/H/" + name)[0];
  CHECK(same_bits(std::get<GlobalFrictionProblem>(fclib_from_hdf5(raw.bytes(), "p.hdf5").problem).h, global.h));
}

TEST_CASE("problems in space read back bit for bit, and their bodies have six rows") {
  FclibFile file;
  const GlobalFrictionProblem global = random_spheres_problem(1, 6, 9);
  const LocalFrictionProblem local = reduce(global);
  file.problem = global;
  file.solution =
      FclibSolution{Vector::LinSpaced(36, -0.1, 1.0 / 3), Vector::Constant(27, -0.0), Vector::Constant(27, 5e-324)};
  const FclibFile back = fclib_from_hdf5(to_hdf5(file), "p.hdf5");
  CHECK(back.dimension() == 3);
  CHECK(back.contacts() == 9);
  CHECK(same_solution(*back.solution, *file.solution));
  CHECK(same_bits(std::get<GlobalFrictionProblem>(back.problem), global));
  file.problem = local;
  file.solution->v = {};
  const FclibFile of_contacts = fclib_from_hdf5(to_hdf5(file), "p.hdf5");
  CHECK(same_bits(std::get<LocalFrictionProblem>(of_contacts.problem), local));
  for (const Storage storage : {Storage::rows, Storage::triplets}) {
    const FclibFile raw = fclib_from_hdf5(raw_local(local, storage).bytes(), "p.hdf5");
    CHECK(Matrix(std::get<LocalFrictionProblem>(raw.problem).w) == Matrix(local.w));
  }
  const ReferenceProblem reference = reference_problem(global);
  CHECK((reference.dimension == 3 && reference.dofs_per_grain == 6));
  CHECK(reference.columns_per_contact == 3);
  CHECK(reference.grains() == 6);
  GlobalFrictionProblem odd = random_spheres_problem(1, 2, 3);
  odd.mass.conservativeResize(9, 9);
  odd.h.conservativeResize(9, 9);
  odd.f.conservativeResize(9);
  CHECK_THROWS_WITH_AS(reference_problem(odd, "p"), doctest::Contains("expected six rows per body"), Error);
}

TEST_CASE("problems of another kind are named and refused") {
  refused_problem(changed([](RawFclib& raw) { raw.integers["fclib_global/spacedim"] = {3}; }),
                  {"p.hdf5: fclib_global/H/n:", "met 8 columns"});
  refused_problem(changed([](RawFclib& raw) { raw.integers["fclib_global/spacedim"] = {7}; }),
                  {"fclib_global/spacedim:", "2 or 3", "met 7"});
  refused_problem(changed([](RawFclib& raw) { raw.integers["fclib_global/G/m"] = {15}; }),
                  {"not supported: a global problem with equality constraints (G) (4 contacts, spacedim 2)"});
  refused_problem(changed([](RawFclib& raw) { raw.move("fclib_global", "fclib_global_rolling"); }),
                  {"p.hdf5: fclib_global_rolling: not supported: rolling friction"});
  refused_problem(changed([](RawFclib& raw) { raw.move("fclib_global", "else"); }), {"fclib_local", "met none"});
  refused_problem(changed([](RawFclib& raw) { raw.integers["fclib_local/spacedim"] = {2}; }),
                  {"met fclib_local and fclib_global"});
  RawFclib local = raw_local(reduce(random_bodies_problem(3, 5, 4)));
  local.integers["fclib_local/V/m"] = {1};
  refused_problem(local.bytes(), {"not supported: a local problem with equality constraints (V)"});
}

TEST_CASE("damaged files are refused, saying where") {
  refused_problem("", {"p.hdf5:", "HDF5", "met something else or a damaged one"});
  const std::string good = changed([](RawFclib&) {});
  CHECK_NOTHROW(fclib_from_hdf5(good, "p.hdf5"));
  for (const std::size_t size : {good.size() / 8, good.size() / 2, good.size() - 1})
    CHECK_THROWS_AS(fclib_from_hdf5(good.substr(0, size), "p.hdf5"), Error);
  const auto without = [](const std::string& name) {
    return changed([&](RawFclib& raw) { raw.remove("fclib_global/" + name); });
  };
  refused_problem(without("M"), {"p.hdf5: fclib_global/M:", "met none"});
  refused_problem(without("vectors"), {"fclib_global/vectors:", "met none"});
  refused_problem(without("vectors/mu"), {"fclib_global/vectors/mu:", "met none"});
  refused_problem(without("spacedim"), {"fclib_global/spacedim:", "met none"});
  refused_problem(without("H/i"), {"fclib_global/H/i:", "met none"});
}

TEST_CASE("wrong lengths and indices out of range are refused, saying where") {
  const auto numbers = [](const std::string& name, const std::function<void(std::vector<double>&)>& change) {
    return changed([&](RawFclib& raw) { change(raw.numbers.at("fclib_global/" + name)); });
  };
  const auto integers = [](const std::string& name, const std::function<void(std::vector<int>&)>& change) {
    return changed([&](RawFclib& raw) { change(raw.integers.at("fclib_global/" + name)); });
  };
  refused_problem(numbers("vectors/f", [](auto& f) { f.pop_back(); }),
                  {"fclib_global/vectors/f:", "15 numbers", "met 14"});
  refused_problem(numbers("vectors/mu", [](auto& mu) { mu.push_back(0); }),
                  {"fclib_global/vectors/mu:", "4 numbers", "met 5"});
  refused_problem(numbers("H/x", [](auto& x) { x.pop_back(); }), {"fclib_global/H/x: expected"});
  refused_problem(numbers("H/x", [](auto& x) { x[2] = not_a_number; }), {"fclib_global: H:", "met nan"});
  refused_problem(numbers("vectors/mu", [](auto& mu) { mu[1] = -1; }), {"from 0 to 10000", "met -1 for contact 1"});
  refused_problem(integers("H/i", [](auto& i) { i[3] = 15; }), {"fclib_global/H/i:", "0..14", "met 15 at position 3"});
  refused_problem(integers("H/i", [](auto& i) { i[0] = -1; }), {"fclib_global/H/i:", "0..14", "met -1 at position 0"});
  refused_problem(integers("H/p", [](auto& p) { p[1] = 1000; }), {"fclib_global/H/p:", "ascend"});
  refused_problem(integers("H/p", [](auto& p) { p[0] = 1; }), {"fclib_global/H/p:", "0 at position 0", "met 1"});
  refused_problem(integers("H/p", [](auto& p) { p.pop_back(); }), {"fclib_global/H/p:", "9 numbers", "met 8"});
  refused_problem(integers("H/nz", [](auto& nz) { nz[0] = -3; }), {"fclib_global/H/nz:", "-1"});
  refused_problem(integers("H/n", [](auto& n) { n[0] = 7; }), {"fclib_global/H/n:", "met 7"});
  refused_problem(integers("M/m", [](auto& m) { m[0] = -15; }), {"fclib_global/M/m:", "from 0"});
  refused_problem(integers("M/m", [](auto& m) { m[0] = 2'000'000'000; }),
                  {"fclib_global/vectors/f:", "2000000000 numbers"});
}

TEST_CASE("whether a file holds a problem") {
  CHECK(holds_fclib(changed([](RawFclib&) {}), "p.hdf5"));
  CHECK_FALSE(holds_fclib(to_hdf5({}, std::vector<NamedTable>{{"packing", {}}}), "p.hdf5"));
  CHECK_THROWS_AS(holds_fclib("nothing", "p.hdf5"), Error);
}
