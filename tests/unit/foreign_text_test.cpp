// SPDX-License-Identifier: GPL-3.0-or-later
// Texts as other programs and systems leave them: their line ends, encodings and numbers, in every reader.
#include "core/text.hpp"
#include "files/csv.hpp"
#include "formats/case/case_file.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/lmgc90/datbox.hpp"
#include <nscdd/formats/packing_file.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace std::string_literals;

namespace {

constexpr const char* byte_order_mark = "\xEF\xBB\xBF";

std::string with_ends(const std::string& text, const std::string& end) {
  std::string changed;
  for (const char c : text) changed += c == '\n' ? end : std::string(1, c);
  return changed;
}

// ASCII as UTF-16 or UTF-32 (units of 2 or 4 bytes), the least byte first or last.
std::string widened(const std::string& text, std::size_t unit, bool least_first) {
  std::string wide;
  for (const char c : text) {
    std::string one(unit, '\0');
    one[least_first ? 0 : unit - 1] = c;
    wide += one;
  }
  return wide;
}

// What reads a text, and a text that it reads.
struct Reader {
  const char* name;
  std::string text;
  std::function<std::string(const std::string& text)> read;  // what was found, as a text
};

std::string shown(const Packing& p) {
  std::string text;
  for (const auto* values : {&p.x, &p.y, &p.z, &p.radius, &p.mass})
    for (const double value : *values) text += field_text(value) + " ";
  return text;
}

std::vector<Reader> readers() {
  const auto packing = [](const std::string& text) { return shown(parse_packing(text, "foreign")); };
  const auto datbox = [](const std::string& bodies) {
    const std::string bulk =
        "$behav\n STONE  RIGID                           Umas= 0.2700000D+04\n"
        "$gravy\n                   grv1= 0.0000000D+00  grv2=-0.9810000D+01  grv3= 0.0000000D+00\n";
    return shown(datbox_packing(parse_datbox({bodies, bulk, "", "", "", {}}, "foreign"), DatboxGrains::free));
  };
  return {
      {"CSV", "x,y,radius,mass\n0,0,0.5,1\n# a remark\n1,0,0.5,2\n", packing},
      {"text", "# a remark\n0 0 0.5\n1 0 0.5\n\n2 0 0.5\n", packing},
      {"text in space", "0 0 0 0.5\n1 0 1 0.5\n", packing},
      {"table", "case,value\na,1\nb,2\n",
       [](const std::string& text) {
         const CsvText csv = parse_csv(text, "foreign");
         std::string all;
         for (std::size_t i = 0; i < csv.rows.size(); ++i) all += csv.rows[i][0] + csv.rows[i][1] + ' ';
         return all;
       }},
      {"Siconos", "2\n1\n0\n2\n2\n2 2\n2 1\n1 2\n-1 0.5\n0.3\n",
       [](const std::string& text) {
         const auto local = std::get<LocalFrictionProblem>(siconos_from_text(text, "foreign").problem);
         return field_text(local.w.coeff(0, 1)) + " " + field_text(local.q[1]) + " " + field_text(local.friction[0]);
       }},
      {"TOML",
       "title = \"a\"\n\n# a remark\n[packing]\ngenerator = \"strip\"\ngrains = 8\n\n[partition]\ngrid = [2, 1]\n",
       [](const std::string& text) { return to_toml(parse_case(text, "foreign")); }},
      {"DATBOX",
       "$bdyty\n RBDY2      1\n$blmty\n PLAIN      1  behav  STONE  avrd= 0.2000000D+00  gyrd= 0.1414214D+00\n$nodty\n"
       " NO3xx      1                coo1= 0.1000000D+01  coo2= 0.2000000D+01  coo3= 0.0000000D+00\n$tacty\n"
       " DISKx      1  color  BLEUx  byrd= 0.2000000D+00\n$$$$$$\n",
       datbox}};
}

}  // namespace

TEST_CASE("every reader takes all line ends and a byte order mark") {
  for (const Reader& reader : readers()) {
    CAPTURE(reader.name);
    std::string plain;
    CHECK_NOTHROW(plain = reader.read(reader.text));
    for (const std::string end : {"\r\n", "\r", "\n"})
      for (const std::string begin : {"", byte_order_mark}) {
        CAPTURE(end);
        std::string found;
        CHECK_NOTHROW(found = reader.read(begin + with_ends(reader.text, end)));
        CHECK(found == plain);
      }
  }
}

TEST_CASE("every reader names UTF-16 and UTF-32, with and without a mark") {
  for (const Reader& reader : readers())
    for (const std::size_t unit : {std::size_t{2}, std::size_t{4}})
      for (const bool least_first : {true, false})
        for (const bool marked : {true, false}) {
          INFO("name = ", reader.name, ", unit = ", unit, ", least_first = ", least_first);
          const std::string mark =
              least_first ? "\xFF\xFE"s + std::string(unit - 2, '\0') : std::string(unit - 2, '\0') + "\xFE\xFF"s;
          const std::string text = (marked ? mark : "") + widened(reader.text, unit, least_first);
          const std::string expected = unit == 2 ? "foreign: expected UTF-8, met UTF-16" : "met UTF-32";
          // Siconos and DATBOX name the file of a folder.
          CHECK_THROWS_WITH_AS(reader.read(text), doctest::Contains("expected UTF-8, met UTF-"), Error);
          if (reader.name != "DATBOX"s)
            CHECK_THROWS_WITH_AS(reader.read(text), doctest::Contains(expected.c_str()), Error);
        }
}

TEST_CASE("numbers of Fortran are read wherever a packing or a problem is text") {
  const std::vector<std::pair<const char*, double>> numbers{{"1.0D+00", 1},   {"1.0d0", 1},  {"1D-3", 1e-3},
                                                            {"+2.5D+01", 25}, {"-.5d1", -5}, {"1e3", 1e3},
                                                            {"+7", 7},        {"1.", 1},     {"+inf", infinity}};
  for (const auto& one : numbers) {
    CAPTURE(one.first);
    CHECK(number_of(one.first) == one.second);
  }
  for (const char* text : {"", "D", "1D", "1.0D+", "1.0DD0", "1 D0", "0x1D", "nand", "one", "1.0D+00x", "1,5", "1-2",
                           "--1", "+-1", "1D999"}) {
    CAPTURE(text);
    CHECK(!number_of(text));
  }
  const std::string plain = shown(parse_packing("x,y,radius\n0,0,0.5\n1,0,0.5\n", "p.csv"));
  CHECK(shown(parse_packing("x,y,radius\n0.0D+00,0d0,5.0D-01\n1.0D+00,0,0.5\n", "p.csv")) == plain);
  CHECK(shown(parse_packing("0.0D+00 0 5D-1\n1.0D+00 0 .5d0\n", "p.txt")) == plain);
  const std::string local = "2\n1\n0\n2\n2\n2 2\n2.0D+00 1\n1 2\n-1 0.5D0\n3.0D-01\n";
  CHECK(std::get<LocalFrictionProblem>(siconos_from_text(local, "p.dat").problem).friction[0] == 0.3);
}

TEST_CASE("the number that is none is named, in the first line too") {
  const auto refused = [](const std::string& text, const char* message) {
    CHECK_THROWS_WITH_AS(parse_packing(text, "p"), doctest::Contains(message), Error);
  };
  refused("0 0 1.0D+\n1 0 1\n", "p:1: radius: expected a number, met '1.0D+'");
  refused("0 0.5.5 1\n", "p:1: y: expected a number, met '0.5.5'");
  refused("0 0 1\n1 0 1F+00\n", "p:2: radius: expected a number, met '1F+00'");
  refused("x,y,radius\n0,1.0D+00D,1\n", "p:2: y: expected a number, met '1.0D+00D'");
  refused("0 0 1\r1 zero 1\r", "p:2: y: expected a number, met 'zero'");
}

TEST_CASE("columns of YADE other than x, y, z and r are named") {
  const auto refused = [](const std::string& text, std::initializer_list<const char*> parts) {
    for (const char* part : parts) CHECK_THROWS_WITH_AS(parse_packing(text, "p.txt"), doctest::Contains(part), Error);
  };
  refused("#format x_y_z_r_clumpId\n0 0 0 0.5\n", {"p.txt:2", "met 4 numbers", "x_y_z_r_clumpId"});
  refused("0 0 0 0.5 1\n1 0 0 0.5 1\n", {"p.txt:1", "met 5 numbers", "'#format x_y_z_r_clumpId'"});
  refused("#format x_y_z_r_matId\n0 0 0 0.5 0\n", {"p.txt:2", "met 5 numbers", "x_y_z_r_matId"});
  refused("#format x_y_z_r_attrs\n0 0 0 0.5 0 1 2\n", {"met 7 numbers", "x_y_z_r_attrs"});
  refused("x,y,z,radius,clumpId\n0,0,0,0.5,1\n", {"p.txt:1", "clumpId", "#format x_y_z_r_clumpId"});
  CHECK(parse_packing("#format x_y_z_r\n0 0 0 0.5\n1 0 1 0.5\n", "p.txt").size() == 2);
}

TEST_CASE("clumps of YADE: numbers of bodies, -1 for a free grain") {
  const auto clumps = [](const std::string& lines) {
    return parse_packing("#format  x_y_z_r_clumpId\r\n# remark\r\n" + lines, "p.txt").clump;
  };
  CHECK(clumps("0 0 0 0.5 12\n1 0 1 0.5 -1\n2 0 0 0.5 12\n3 0 0 0.5 0\n4 0 0 0.5 0\n") ==
        std::vector<Index>{12, -1, 12, 0, 0});
  CHECK(clumps("0 0 0 0.5 12\n1 0 1 0.5 3\n2 0 0 0.5 3\n") == std::vector<Index>{-1, 3, 3});
  CHECK(clumps("0 0 0 0.5 12\n1 0 1 0.5 -1\n").empty());  // bodies of one grain
  const auto refused = [&](const std::string& lines, const char* message) {
    CHECK_THROWS_WITH_AS(clumps(lines), doctest::Contains(message), Error);
  };
  refused("0 0 0 0.5 1\n1 0 1 0.5 -2\n", "p.txt:4: clumpId: expected a finite number >= -1, met -2");
  refused("0 0 0 0.5 1\n1 0 1 0.5 1.23457e+06\n", "p.txt:4: clumpId: expected an integer");  // six digits of more
  refused("0 0 0 0.5 1\n1 0 1 0.5\n", "p.txt:4: expected 5 numbers");
  Packing packing{.x = {0, 1}, .y = {0, 0}, .radius = {0.5, 0.5}, .mass = {}};
  packing.clump = {-1, -1};  // as Python may give them: no clump
  CHECK(detect_contacts(packing, {}).contacts.size() == 1);
  packing.clump = {1};
  CHECK_THROWS_WITH_AS(check(packing), doctest::Contains("expected a clump for each of 2 grains"), Error);
}

TEST_CASE("what a message quotes is text, whatever a file holds") {
  CHECK(printable("plain, tab\t and line\n") == "plain, tab\t and line\n");
  CHECK(printable("gr\xC3\xB6\xC3\x9F"
                  "e \xE2\x82\xAC \xF0\x9D\x84\x9E") ==
        "gr\xC3\xB6\xC3\x9F"
        "e \xE2\x82\xAC \xF0\x9D\x84\x9E");
  CHECK(printable("a\0b"s) == "a\\x00b");
  CHECK(printable("\x1B[31mred\x1B[0m\r\x7F\b") == "\\x1B[31mred\\x1B[0m\\x0D\\x7F\\x08");
  // Latin-1, control beyond ASCII, overlong, surrogate, beyond Unicode, cut short.
  CHECK(printable("gr\xF6\xDF"
                  "e") == "gr\\xF6\\xDFe");
  CHECK(printable("\xC2\x9B"
                  "1m") == "\\xC2\\x9B1m");
  CHECK(printable("\xC0\xAF\xE0\x80\xAF\xF0\x80\x80\xAF") == "\\xC0\\xAF\\xE0\\x80\\xAF\\xF0\\x80\\x80\\xAF");
  CHECK(printable("\xED\xA0\x80") == "\\xED\\xA0\\x80");
  CHECK(printable("\xF4\x90\x80\x80") == "\\xF4\\x90\\x80\\x80");
  CHECK(printable("\xE2\x82") == "\\xE2\\x82");
  CHECK(Error("a\x1B"s).what() == "a\\x1B"s);
  CHECK(Error("key\x07"s, "b\0c"s).what() == "key\\x07: b\\x00c"s);
  CHECK_THROWS_WITH_AS(parse_packing("x,y,radius\n0,\x1B[2J,1\n", "p"), "p:2: y: expected a number, met '\\x1B[2J'",
                       Error);
}

TEST_CASE("lines of a text, whatever ends them") {
  const auto lines = [](std::string_view text) {
    std::string all;
    for (TextLines one(text); one.next();) all += std::to_string(one.number()) + ":" + std::string(one.line()) + ";";
    return all;
  };
  CHECK(lines("a\nb\n") == "1:a;2:b;");
  CHECK(lines("a\r\nb") == "1:a;2:b;");
  CHECK(lines("a\r\rb\r") == "1:a;2:;3:b;");
  CHECK(lines("a\rb\nc\r\n") == "1:a\rb;2:c;");  // a carriage return within lines of line feeds ends none
  CHECK(lines("\xEF\xBB\xBF\xEF\xBB\xBF") == "1:\xEF\xBB\xBF;");
  CHECK(lines("") == "");
}
