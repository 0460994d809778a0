// SPDX-License-Identifier: GPL-3.0-or-later
// COMMAND.DAT of LMGC90: keys before a colon, each with its value on the next line.
#include "../support/datbox_texts.hpp"

#include <doctest/doctest.h>

using namespace nscdd;

namespace {

DatboxCommand command_of(const std::string& text, const std::string& bodies = {}) {
  DatboxTexts texts;
  texts.command = text;
  texts.bodies = bodies;
  return parse_datbox(texts, "box").command;
}

}  // namespace

TEST_CASE("COMMAND.DAT: time step, theta and periods, the first of each; comments are skipped") {
  const DatboxCommand command = command_of(
      "#COMMAND.DAT                  :\n# TIME STEP                   :\n# 7.D-03\nTIME STEP                     :\n"
      "1.D-03                        :\n#\nTHETA                         :\n#\n0.5D0    :\n"
      "PERIODIC CONDITION            :\n25.00\nTIME STEP                     :\n2.D-03\n");
  CHECK((command.step == 1e-3 && command.theta == 0.5));
  CHECK(command.period_x == 25);
  CHECK(!command.period_y);
  const DatboxCommand empty = command_of("");
  CHECK((!empty.step && !empty.period_x));
}

TEST_CASE("COMMAND.DAT: periods of spheres are along x and y; a source point has a first body, a distance, a place") {
  const std::string sphere = testing::small_datbox_in_space().bodies;
  const DatboxCommand command = command_of("XPERIODIC CONDITION :\n0.2  :\nYPERIODIC CONDITION :\n0.3\n", sphere);
  CHECK((command.period_x == 0.2 && command.period_y == 0.3));
  CHECK(!command_of("PERIODIC CONDITION :\n0.2\n", sphere).period_x);
  const auto source = command_of("FD INIT SOURCE POINT :\n2  :\n0.15D-01 :\n0.1 0.2  0.02 :\n", sphere).source;
  REQUIRE(source);
  CHECK(source->first == 2);
  CHECK(source->at.distance == 0.015);
  CHECK(source->at.point == Place{0.1, 0.2, 0.02});
}

TEST_CASE("COMMAND.DAT: values that are none, or out of range, are refused by file and line") {
  for (const auto& [text, words] :
       {std::pair("TIME STEP :\nsmall\n", "box/COMMAND.DAT:2: expected TIME STEP, met 'small'"),
        {"\nTIME STEP :\n-1.D-03 :\n", "COMMAND.DAT:3: TIME STEP: expected a number > 0"},
        {"THETA :\n0.3\n", "COMMAND.DAT:2: THETA: expected a number in 0.5..1, met 0.3"},
        {"TIME STEP :\n", "expected the value of TIME STEP, met the end of the file"},
        {"INIT SOURCE POINT :\n0\n", "COMMAND.DAT:2: expected the number of a body, met 0"},
        {"INIT SOURCE POINT :\n1\n0.0\n", "COMMAND.DAT:3: expected a distance > 0, met 0.0"},
        {"INIT SOURCE POINT :\n1\n1.0\n1.0\n", "COMMAND.DAT:4: expected 2 coordinates, met 1.0"},
        {"INIT SOURCE POINT :\n1\n", "expected the distance of a source point, met the end of the file"}})
    CHECK_THROWS_WITH_AS(command_of(text), doctest::Contains(words), Error);
}
