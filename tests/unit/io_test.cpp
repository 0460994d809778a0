// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/moving_case.hpp"
#include "../support/problems.hpp"
#include "../support/spoilt.hpp"
#include "files/csv.hpp"
#include "formats/case/case_file.hpp"
#include <nscdd/formats/packing_file.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

CaseSpec parse(const std::string& text) { return parse_case(text, "c.toml"); }

const std::string good =
    "title = \"t\"\n"
    "[packing]\n"
    "generator = \"strip\"\n"
    "grains = 6\n"
    "[contacts]\n"
    "tolerance = 1e-6\n"
    "[masses]\n"
    "density = 2\n"
    "[partition]\n"
    "grid = [3, 2]\n"
    "[[prescribed]]\n"
    "grain = 5\n"
    "velocity = [-1, 0.5]\n";

void refused_case(const std::string& text, const Names& names) {
  CAPTURE(text);
  check_error([&] { parse(text); }, names);
}

const Spoilt spoilt{good, parse};

}  // namespace

TEST_CASE("case file: everything read") {
  const CaseSpec one = parse(good);
  CHECK(one.name == "c");
  CHECK(std::get<TriangularStrip>(std::get<Generator>(one.packing)).grains == 6);
  CHECK((one.contacts.tolerance == 1e-6 && one.masses.density == 2));
  CHECK(std::get<GridPartitioner>(one.partition).grid == std::array<Index, 2>{3, 2});
  REQUIRE(one.prescribed.size() == 1);
  CHECK(one.prescribed[0].velocity == std::array<double, 2>{-1, 0.5});
}

TEST_CASE("case file: written and read back it is the same case") {
  for (const CaseSpec& one : {parse(good), testing::strip(8).spec}) {
    const CaseSpec back = parse_case(to_toml(one), one.name + ".toml");
    CHECK(to_toml(back) == to_toml(one));
  }
  CaseSpec metis = testing::strip(8).spec;
  metis.partition = MetisPartitioner{.metis = 3, .seed = 9};
  CHECK(to_toml(metis).find("loads") == std::string::npos);  // only where there are any
  metis.loads = {{0.1, -2.5e-7}, 1.0 / 3};
  CHECK(parse(to_toml(metis)).loads.compression == metis.loads.compression);
  CHECK(parse(to_toml(metis)).loads.shear == metis.loads.shear);
  CHECK(std::get<MetisPartitioner>(parse(to_toml(metis)).partition).seed == 9);
  metis.title = "two\nlines, a\ttab, \"quotes\" and \\, \x7f";
  CHECK(parse(to_toml(metis)).title == metis.title);
}

TEST_CASE("case file: every error names file, line and key") {
  spoilt("grains = 6", "grains = -3", {"c.toml:4: packing.grains:", ">= 1"});
  spoilt("grains = 6", "grains = 6.5", {"c.toml:4: packing.grains:", "integer"});
  spoilt("grains = 6", "grain = 6", {"c.toml:4: unknown key 'packing.grain'"});
  spoilt("grains = 6", "grain = 6", {"; did you mean grains?"});
  spoilt("\"strip\"", "\"stripe\"", {"; did you mean strip?"});
  spoilt("\"strip\"", "\"lattice\"", {"c.toml:3: packing.generator:", "\"strip\""});
  spoilt("[contacts]", "[contact]", {"c.toml:5: unknown key 'contact'"});
  spoilt("tolerance = 1e-6", "tolerance = \"small\"", {"c.toml:6: contacts.tolerance:", "number"});
  spoilt("density = 2", "density = 0", {"c.toml:8: masses.density"});
  spoilt("density = 2", "density = nan", {"c.toml:8: masses.density"});
  spoilt("density = 2", "model = \"heavy\"", {"c.toml:8: masses.model"});
  spoilt("density = 2", "model = \"density\"", {"masses.density:", "number"});
  spoilt("density = 2", "model = \"unit\"\ndensity = 2", {"masses.density:", "no density"});
  spoilt("grid = [3, 2]", "grid = [3]", {"c.toml:10: partition.grid:", "integers"});
  spoilt("grid = [3, 2]", "grid = [3, 0]", {"c.toml:10: partition.grid"});
  spoilt("grid = [3, 2]", "", {"met neither"});
  spoilt("grid = [3, 2]", "grid = [3, 2]\nmetis = 2", {"met both"});
  spoilt("grain = 5", "grain = \"last\"", {"c.toml:12: prescribed[0].grain:", "integer"});
  spoilt("velocity = [-1, 0.5]", "", {"prescribed[0].velocity:", "met none"});
  spoilt("[-1, 0.5]", "[-1, inf]", {"c.toml:13: prescribed[0].velocity"});
  refused_case(good + "[[prescribed]]\ngrain = 5\nvelocity = [0, 1]\n", {"grain 5 again"});
  spoilt("[packing]", "[packing", {"c.toml:2: not valid TOML"});
  refused_case("[partition]\ngrid = [1, 1]\n", {"[packing]", "met none"});
  refused_case("[packing]\ngenerator = \"strip\"\n", {"[partition]", "met none"});
  refused_case("packing = 3\n", {"c.toml:1: packing:", "[packing]", "met the integer '3'"});
  CHECK_THROWS_WITH_AS(resolve(parse(case_text("a.csv"))), doctest::Contains("c.toml:2: packing.file: a.csv"), Error);
  refused_case(good + good, {"not valid TOML"});
  refused_case("", {"[packing]"});
}

TEST_CASE("study file: a key that its observable does not use is refused") {
  const CaseFinder known = [](const std::string&) { return testing::strip(4).spec; };
  const auto refused = [&](const std::string& observable, const std::string& line, const Names& names) {
    const std::string text =
        "[[table]]\nname = \"t\"\ncases = \"disks4\"\nobservable = \"" + observable + "\"\n" + line + "\n";
    CAPTURE(text);
    check_error([&] { parse_study(text, "s/study.toml", known); }, names);
  };
  refused("spectral_radius", "steps = 3", {"study.toml:5: table[0].steps:", "uses"});
  refused("optimum", "lead_in = \"own\"", {"table[0].lead_in"});
  refused("optimum", "eta = 1", {"table[0].eta"});
  refused("runs", "epsilon = 1", {"table[0].epsilon"});
  refused("grains", "contacts = \"active\"", {"table[0].contacts"});
  refused("links", "epsilon = 1", {"table[0].epsilon"});
  refused("spectral_radius", "seed = 2", {"table[0].seed"});
  refused("links", "scheme = \"schwarz\"", {"table[0].scheme"});
  refused("spectral_radius", "scheme = \"additive\"", {"table[0].scheme", "schwarz"});
  refused("spectral_radius", "scheme = \"schwarz\"\neta = 2", {"study.toml:5: eta: expected none with scheme schwarz"});
  refused("spectral_radius", "gauss_seidel_sweeps = 3\ncertify = true",
          {"study.toml:5: gauss_seidel_sweeps: expected inf with certify"});
}

TEST_CASE("study file: cases that move are judged before anything is run") {
  const CaseFinder moving = [](const std::string&) { return parse_case(testing::moving_case(), "m.toml"); };
  const auto refused = [&](const std::string& observable, const std::string& vary, const Names& names) {
    const std::string text =
        "[[table]]\nname = \"t\"\nobservable = \"" + observable + "\"\ncases = \"m\"\nvary = { " + vary + " }\n";
    CAPTURE(text);
    check_error([&] { parse_study(text, "s/study.toml", moving); }, names);
  };
  refused("predicted_observed", "\"solver.algorithm\" = [\"generic\", \"nlgs\"]",
          {"study.toml:4: case 'm': solver.algorithm:", "met nlgs"});
  refused("predicted_observed", "\"partition.grid\" = [\"1,1\"]", {"two subdomains"});
  refused("runs", "\"solver.criterion\" = [\"gluing\"], \"solver.algorithm\" = [\"nlgs\"]",
          {"study.toml:4: case 'm': solver.criterion:", "solver.algorithm generic"});
  const std::string algorithms = "\"solver.algorithm\" = [\"generic\", \"enriched\"]", eta = "\"solver.eta\" = [1, 2]";
  refused("runs", eta, {"study.toml:5: solver.eta:", "solver.algorithm enriched", "met generic"});
  const auto table = [&](const std::string& vary) {
    return "[[table]]\nname = \"t\"\nobservable = \"runs\"\ncases = \"m\"\n" + vary + "\n";
  };
  CHECK_NOTHROW(parse_study(table("vary = { " + algorithms + ", " + eta + " }"), "s/study.toml", moving));
  CHECK_NOTHROW(parse_study(table("vary_together = { " + algorithms + ", " + eta + " }"), "s/study.toml", moving));
  CHECK_THROWS_WITH_AS(parse_study(table("vary_together = { " + eta + " }"), "s/study.toml", moving),
                       doctest::Contains("study.toml:5: solver.eta: expected solver.algorithm enriched"), Error);
}

TEST_CASE("study file: read, and refused with file, line and key") {
  const CaseFinder known = [](const std::string& name) {
    if (name != "disks4") throw Error("no such case");
    return testing::strip(4).spec;
  };
  const std::string study =
      "title = \"s\"\n"
      "[[table]]\n"
      "name = \"radius\"\n"
      "observable = \"spectral_radius\"\n"
      "cases = [\"disks4\"]\n"
      "epsilon = \"0,1:10:3\"\n"
      "eta = [0.5, inf]\n"
      "gauss_seidel_sweeps = [1, inf]\n"
      "vary = { \"packing.grains\" = [4, 8] }\n";
  const auto parse_one = [&](const std::string& text) { return parse_study(text, "s/study.toml", known); };
  const Study read = parse_one(study);
  CHECK(read.name == "s");
  REQUIRE(read.tables.size() == 1);
  CHECK(read.tables[0].sweep.epsilon.size() == 4);
  CHECK(read.tables[0].sweep.eta == std::vector<double>{0.5, infinity});
  CHECK(read.tables[0].vary[0].values == std::vector<std::string>{"4", "8"});
  const Spoilt refused{study, parse_one};
  refused("spectral_radius\"", "radius\"", {"study.toml:4: table[0].observable:", "spectral_radius"});
  refused("disks4", "disks5", {"study.toml:5: case 'disks5': no such case"});
  refused("0,1:10:3", "-1", {"study.toml:6: epsilon:", ">= 0"});
  refused("[0.5, inf]", "[0.5, true]", {"study.toml:7: table[0].eta:", "text"});
  refused("[4, 8]", "[4, 0]", {"packing.grains:", ">= 1"});
  refused("packing.grains", "packing.rows", {"no such parameter in this case"});
  refused("name = \"radius\"", "name = \"../radius\"", {"study.toml:3: table[0].name"});
  refused("title", "titel", {"study.toml:1: unknown key 'titel'"});
  const std::string last = "vary = { \"packing.grains\" = [4, 8] }\n";
  const auto refused_after = [&](const std::string& line, const Names& names) { refused(last, last + line, names); };
  refused_after("large = true\n", {"a first table that is always run"});
  refused_after("large = 1\n", {"study.toml:10: table[0].large:", "false"});
  refused_after("check_tolerance = -1\n", {"study.toml:10: table[0].check_tolerance: expected"});
  refused_after("column_tolerance = { radius = 1 }\n", {"table[0].column_tolerance.radius:", "column"});
  refused_after("column_tolerance = { residual = \"1\" }\n", {"column_tolerance.residual:", "number"});
  refused_after("vary_together = { \"packing.grains\" = [4, 8] }\n", {"that are not in 'vary_together'"});
  refused_after("vary_together = { \"packing.radius\" = [1], \"partition.grid\" = [\"2,1\", \"3,1\"] }\n",
                {"vary_together:", "1 values", "met 2"});
  refused_after("vary_together = { \"packing.rows\" = [1] }\n", {"no such parameter in this case"});
  const Study more = parse_one(study +
                               "check_tolerance = 1e-6\n"
                               "column_tolerance = { spectral_radius = 1e-4 }\n"
                               "vary_together = { \"packing.radius\" = [1, 2] }\n"
                               "[[table]]\nname = \"more\"\ncases = [\"disks4\"]\nlarge = true\n");
  CHECK(more.tables[0].check_tolerance == 1e-6);
  CHECK(more.tables[0].column_tolerance.at("spectral_radius") == 1e-4);
  CHECK(more.tables[0].vary_together[0].values == std::vector<std::string>{"1", "2"});
  CHECK_FALSE(more.tables[0].large);
  CHECK(more.tables[1].large);
  CHECK(more.tables[1].check_tolerance == 1e-8);
  CHECK_THROWS_WITH_AS(parse_one("title = \"none\"\n"), doctest::Contains("at least one [[table]]"), Error);
}

TEST_CASE("packing file: columns in any order, comments, CRLF, byte order mark") {
  const Packing packing = parse_packing(
      "\xEF\xBB\xBF# a packing\r\nradius, x ,y,mass\r\n\r\n0.5,1,2,3\r\n 0.25 ,-1e-3,+4,1e2\r\n", "p.csv");
  CHECK(packing.x == std::vector<double>{1, -1e-3});
  CHECK(packing.y == std::vector<double>{2, 4});
  CHECK(packing.radius == std::vector<double>{0.5, 0.25});
  CHECK(packing.mass == std::vector<double>{3, 100});
  CHECK(parse_packing("x,y,radius\n1,2,3", "p.csv").mass.empty());
}

TEST_CASE("packing file: every error names file and line") {
  const auto refused = [](const std::string& text, const Names& names) {
    CAPTURE(text);
    check_error([&] { parse_packing(text, "p.csv"); }, names);
  };
  refused("", {"p.csv:", "names"});
  refused("x,y,radius\n", {"p.csv:", "grain"});
  refused("x,y\n1,2\n", {"'radius'"});
  refused("x,y,radius,colour\n1,2,3,4\n", {"met 'colour'"});
  refused("x,y,radius,x\n1,2,3,4\n", {"p.csv:1: column 'x' is named twice"});
  refused("x,y,radius\n1,2,3\n\n1,2\n", {"p.csv:4:", "3 values", "met 2"});
  refused("x,y,radius\n1,2,3,\n", {"p.csv:2:", "3 values", "met 4"});
  refused("x,y,radius\n1,two,3\n", {"p.csv:2: y:", "met 'two'"});
  refused("x,y,radius\n1,2,0\n", {"p.csv:2: radius:", "> 0"});
  refused("x,y,radius\n1,2,-1\n", {"p.csv:2: radius"});
  refused("x,y,radius\nnan,2,1\n", {"p.csv:2: x:", "number"});
  refused("x,y,radius\n1,inf,1\n", {"p.csv:2: y"});
  refused("x,y,radius,mass\n1,2,1,0\n", {"p.csv:2: mass"});
  refused("x,y,radius\n\"1,2,1\n", {"p.csv:2:", "closing quote"});
  refused("x,y,radius\n\"1\"a,2,1\n", {"p.csv:2:", "comma"});
}

TEST_CASE("CSV: quotes as in RFC 4180") {
  const CsvText csv = parse_csv("a,b\n\"x,1\",\"say \"\"no\"\"\"\n,\n", "t.csv");
  REQUIRE(csv.rows.size() == 2);
  CHECK(csv.rows[0] == std::vector<std::string>{"x,1", "say \"no\""});
  CHECK(csv.rows[1] == std::vector<std::string>{"", ""});
  const std::vector<std::string> values{"plain", "a, b", "say \"no\"", "", "\"", "\r", " a "};
  CHECK(csv_values(csv_line({values.begin(), values.end()}), "t.csv") == values);
  const std::vector<std::string> no_comment{"#two", "1"};
  const CsvText read = parse_csv("a,b\n" + csv_line({no_comment.begin(), no_comment.end()}) + "\n", "t.csv");
  REQUIRE(read.rows.size() == 1);
  CHECK(read.rows[0] == no_comment);
}

TEST_CASE("baselines: compared by value, effort left out") {
  const Table table{{{"case", "", ""}, {"radius", "1", ""}, {"iterations", "1", ""}},
                    {{std::string("a"), 0.5, std::int64_t{7}}}};
  CHECK(compare(table, parse_csv("case,radius,iterations\na,0.5000000001,99\n", "b"), 1e-8).empty());
  CHECK(compare(table, parse_csv("case,radius,iterations\na,0.5001,7\n", "b"), 1e-8) ==
        "row 1, column radius: expected 0.5001, met 0.5");
  CHECK_FALSE(compare(table, parse_csv("case,radius,iterations\nb,0.5,7\n", "b"), 1e-8).empty());
  CHECK_FALSE(compare(table, parse_csv("case,radius\na,0.5\n", "b"), 1e-8).empty());
  CHECK_FALSE(compare(table, parse_csv("case,radius,iterations\na,0.5,7\na,0.5,7\n", "b"), 1e-8).empty());
  CHECK_FALSE(compare(table, parse_csv("case,radius,iterations\na,nan,7\n", "b"), 1e-8).empty());
}
