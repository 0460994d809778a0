// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/disjoint_sets.hpp"
#include <nscdd/core/fields.hpp>
#include <nscdd/core/table.hpp>
#include <nscdd/packing/packing.hpp>

#include <doctest/doctest.h>

#include <string>

using namespace nscdd;

namespace {

struct Described {
  double length = 1.5;
  Index number = 3;
  Components<Index> grid{1, 2};
  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("length", self.length, Field{.description = "a length", .unit = "m", .above = 0});
    visit("number", self.number, Field{.description = "a number", .minimum = 1, .maximum = 9});
    visit("grid", self.grid, Field{.description = "a grid", .minimum = 1});
  }
};

}  // namespace

TEST_CASE("fields: listed, overridden, bounds kept") {
  Described example;
  const auto listed = describe_fields(example);
  REQUIRE(listed.size() == 3);
  CHECK((listed[0].key == "length" && listed[0].unit == "m"));
  CHECK(listed[0].value == "1.5");
  CHECK(listed[2].value == "[1, 2]");
  CHECK(override_field(example, "length", "2e-3", "x.length"));
  CHECK(example.length == 2e-3);
  CHECK(override_field(example, "grid", "[4, 5]", "x.grid"));
  CHECK(example.grid == Components<Index>{4, 5});
  CHECK(override_field(example, "grid", "6,7", "x.grid"));
  CHECK(example.grid == Components<Index>{6, 7});
  CHECK_FALSE(override_field(example, "width", "1", "x.width"));
  CHECK_THROWS_WITH_AS(override_field(example, "length", "0", "x.length"),
                       "x.length: expected a finite number > 0, met 0", Error);
  CHECK_THROWS_WITH_AS(override_field(example, "number", "10", "x.number"),
                       "x.number: expected a finite number >= 1 and <= 9, met 10", Error);
  CHECK_THROWS_WITH_AS(override_field(example, "length", "nan", "x.length"),
                       "x.length: expected a finite number > 0, met nan", Error);
  CHECK_THROWS_AS(override_field(example, "number", "2.5", "x.number"), Error);
  CHECK_THROWS_AS(override_field(example, "grid", "3", "x.grid"), Error);
}

TEST_CASE("components: two or three, as text and back, bounds kept by each") {
  Components<double> rates;
  CHECK(rates == std::array{0.0, 0.0});
  CHECK(rates.size() == 2);
  for (const auto& [text, expected, written] : std::vector<std::tuple<const char*, Components<double>, const char*>>{
           {"1,-2", {1, -2}, "[1, -2]"},
           {"[1e-3, 2, 0.5]", {1e-3, 2, 0.5}, "[0.001, 2, 0.5]"},
           {" 4 , 5,6 ", {4, 5, 6}, "[4, 5, 6]"}}) {
    parse_value(text, rates, "rates");
    CHECK(rates == expected);
    CHECK(field_text(rates) == written);
  }
  CHECK(Components<double>{1, 2} != Components<double>{1, 2, 0});
  CHECK(Components<double>{1, 2}[2] == 0);
  for (const char* text : {"1", "", "1,2,3,4", "1,,2", "1,2,", "[1,2", "1,two"})
    CHECK_THROWS_WITH_AS(parse_value(text, rates, "rates"), doctest::Contains("rates: expected "), Error);
  CHECK_THROWS_WITH_AS(parse_value("1", rates, "rates"),
                       "rates: expected two numbers 'a,b', or three 'a,b,c' in space, met '1'", Error);
  const Field positive{.minimum = 0};
  check_bounds(Components<double>{1, 2}, positive, "rates");
  CHECK_THROWS_AS(check_bounds(Components<double>{1, 2, -1}, positive, "rates"), Error);
  require_components(Components<Index>{1, 2}, 2, "cells");
  require_components(Components<Index>{1, 2, 3}, 3, "cells");
  CHECK_THROWS_WITH_AS(require_components(Components<Index>{1, 2}, 3, "cells"),
                       "cells: expected three integers for a packing in space, met [1, 2]", Error);
  CHECK_THROWS_WITH_AS(require_components(Components<double>{1, 2, 3}, 2, "rates"),
                       "rates: expected two numbers for a packing in the plane, met [1, 2, 3]", Error);
}

TEST_CASE("numbers: read in full or refused by name") {
  CHECK(parse_number(" 1e-3 ", "n") == 1e-3);
  CHECK(parse_number("+2", "n") == 2);
  CHECK(parse_number("inf", "n") == infinity);
  CHECK(parse_number("1.5D+01", "n") == 15);
  for (const char* text : {"", " ", "1x", "1 2", "--1", "0x10", "1,5", "+-1", "1e999"})
    CHECK_THROWS_AS(parse_number(text, "n"), Error);
  CHECK(parse_integer("-7", "n") == -7);
  for (const char* text : {"1.0", "1e3", "", "99999999999999999999"}) CHECK_THROWS_AS(parse_integer(text, "n"), Error);
}

TEST_CASE("tables: cells as text, columns by name") {
  CHECK(to_text(Cell{0.1}) == "0.1");
  CHECK(to_text(Cell{1.0 / 3}) == "0.3333333333333333");
  CHECK(to_text(Cell{infinity}) == "inf");
  CHECK(to_text(Cell{not_a_number}) == "nan");
  CHECK(to_text(Cell{std::int64_t{-4}}) == "-4");
  CHECK(to_text(Cell{true}) == "true");
  CHECK(to_text(Cell{std::string("a b")}) == "a b");
  const Table table{{{"a", "1", ""}, {"b", "m", ""}}, {}};
  CHECK(table.column("b") == 1);
  CHECK_THROWS_WITH_AS(table.column("c"), "expected a column 'c', met only: a, b", Error);
}

TEST_CASE("versions are told") {
  CHECK(version().find('.') != std::string::npos);
  for (const auto& dependency : dependency_versions()) {
    CAPTURE(dependency.first);
    CHECK(dependency.second.find_first_of("0123456789") != std::string::npos);
  }
}

namespace {

enum class Colour { red, blue };
std::string_view to_string(Colour colour) { return colour == Colour::red ? "red" : "blue"; }

struct Sample {
  Index number = 3;
  double size = 0.5;
  Colour colour = Colour::blue;
  std::string_view label = "a";
  bool odd() const { return number % 2 == 1; }
};

struct Pair {
  Sample first, second;
};

}  // namespace

TEST_CASE("columns with getters: members, functions, enumerations and parts, in the order of the list") {
  const ResultColumns<Sample> columns{
      {"number", "1", "", &Sample::number}, {"size", "m", "its size", &Sample::size},
      {"colour", "", "", &Sample::colour},  {"label", "", "", &Sample::label},
      {"odd", "", "", &Sample::odd},        {"double", "m", "", [](const Sample& s) { return 2 * s.size; }}};
  CHECK(row(columns, {}) == Row{std::int64_t{3}, 0.5, std::string("blue"), std::string("a"), true, 1.0});
  const std::vector<Column> names = headings(columns);
  REQUIRE(names.size() == 6);
  CHECK((names[1].name == "size" && names[1].unit == "m"));
  CHECK(names[1].description == "its size");

  const auto pair = joined<Pair>({columns_of(&Pair::second, columns),
                                  {{"sum", "m", "", [](const Pair& p) { return p.first.size + p.second.size; }}}});
  std::vector<Row> rows;
  const RowSink collect = [&](const Row& cells) { rows.push_back(cells); };
  as_rows(pair, collect)({{}, {4, 0.25, Colour::red, "b"}});
  REQUIRE(rows.size() == 1);
  CHECK(rows[0] == Row{std::int64_t{4}, 0.25, std::string("red"), std::string("b"), false, 0.5, 0.75});
}

TEST_CASE("suggestions: the nearest name, or none that is far") {
  const std::vector<std::string> known{"disks4", "disks8", "disks12", "shear-1k", "eta"};
  CHECK(suggestion("disks9", known) == "; did you mean disks4?");  // the first of equally near ones
  CHECK(suggestion("disk12", known) == "; did you mean disks12?");
  CHECK(suggestion("sheer-1k", known) == "; did you mean shear-1k?");
  CHECK(suggestion("shaer-1k", known) == "; did you mean shear-1k?");  // a swap is one slip, not two
  CHECK(suggestion("ate", known).empty());                             // a swap and a change
  CHECK(suggestion("aet", known).empty());
  CHECK(suggestion("teh", known).empty());
  CHECK(suggestion("eat", known) == "; did you mean eta?");
  CHECK(suggestion("hexagonal", known).empty());
  CHECK(suggestion("", known).empty());
  CHECK(suggestion(std::string(1000, 'd'), known).empty());
  CHECK(suggestion("disks4", {}).empty());
}

TEST_CASE("suggestions: keys of a file and names of a choice") {
  Choice<MassModel> model = "unit";
  CHECK_THROWS_WITH_AS(parse_value("densty", model, "masses.model"),
                       doctest::Contains("met \"densty\"; did you mean density?"), Error);
  CHECK(model == MassModel::unit);
  CHECK(to_string(model) == "unit");
  CHECK(Choice<MassModel>::parse("given", "model") == MassModel::given);
  CHECK_THROWS_AS(Choice<MassModel>::parse("densty", "model"), Error);
}

TEST_CASE("disjoint sets: a join makes two sets one, and says whether they were two") {
  DisjointSets sets(6);
  CHECK(sets.join(0, 1));
  CHECK(sets.join(2, 3));
  CHECK(sets.root(1) != sets.root(2));
  CHECK(sets.join(3, 0));
  CHECK_FALSE(sets.join(1, 2));
  for (const Index i : {1, 2, 3}) CHECK(sets.root(i) == sets.root(0));
  CHECK(sets.root(4) != sets.root(5));
  CHECK(sets.root(4) != sets.root(0));
}
