// SPDX-License-Identifier: GPL-3.0-or-later
// Malformed case files: refused with file, line and key.
#include "session.hpp"

using namespace nscdd::testing;

namespace {

// A sound case; each test spoils one line of it.
const std::string sound =
    "title = \"sound\"\n"        // 1
    "[packing]\n"                // 2
    "generator = \"strip\"\n"    // 3
    "grains = 4\n"               // 4
    "radius = 0.5\n"             // 5
    "[contacts]\n"               // 6
    "tolerance = 1e-7\n"         // 7
    "[masses]\n"                 // 8
    "model = \"density\"\n"      // 9
    "density = 2.5\n"            // 10
    "[partition]\n"              // 11
    "grid = [2, 1]\n"            // 12
    "[[prescribed]]\n"           // 13
    "grain = 3\n"                // 14
    "velocity = [-1.0, 0.0]\n";  // 15

void check_spoilt(const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
  const Session session;
  session.file("bad.toml", replaced(sound, from, to));
  CAPTURE(to);
  session.check_refused("sweep bad.toml --epsilon 1 --csv out.csv --hdf5 out.h5", parts);
  session.check_refused("inspect bad.toml", parts);
  session.check_refused("network bad.toml", parts);
  session.check_refused("optimum bad.toml", parts);
}

}  // namespace

TEST_CASE_FIXTURE(Session, "case file: the sound one is accepted") {
  file("sound.toml", sound);
  CHECK(table("sweep sound.toml --epsilon 1").text(0, "case") == "sound");
}

TEST_CASE("case file: broken syntax") {
  check_spoilt("grains = 4", "grains = = 4", {"bad.toml:4", "not valid TOML"});
  check_spoilt("[contacts]", "[contacts", {"bad.toml:6", "not valid TOML"});
  check_spoilt("title = \"sound\"", "title = \"sound", {"bad.toml:1", "not valid TOML"});
  check_spoilt("radius = 0.5", "grains = 5", {"bad.toml:5", "not valid TOML"});
  check_spoilt("sound", "\xff\xfe", {"bad.toml:1", "not valid TOML"});
}

TEST_CASE("case file: an unknown key") {
  check_spoilt("grains = 4", "grain_count = 4", {"bad.toml:4", "packing.grain_count", "grains"});
  check_spoilt("tolerance", "tolerence", {"bad.toml:7", "contacts.tolerence", "tolerance"});
  check_spoilt("title", "titel", {"bad.toml:1", "titel", "title"});
  check_spoilt("density = 2.5", "density = 2.5\nbeauty = 1", {"bad.toml:11", "masses.beauty"});
  check_spoilt("grid = [2, 1]", "grid = [2, 1]\nseed = 1", {"bad.toml:13", "partition.seed"});
  check_spoilt("grain = 3", "grain = 3\nturn = 1", {"bad.toml:15", "prescribed", "turn"});
}

TEST_CASE("case file: an unknown section") {
  check_spoilt("[contacts]\ntolerance = 1e-7", "[contact]\ntolerance = 1e-7", {"bad.toml:6", "contact", "contacts"});
}

TEST_CASE("case file: a value of the wrong type") {
  check_spoilt("grains = 4", "grains = \"four\"", {"bad.toml:4", "packing.grains", "integer", "four"});
  check_spoilt("grains = 4", "grains = 4.5", {"bad.toml:4", "packing.grains", "integer", "4.5"});
  check_spoilt("radius = 0.5", "radius = true", {"bad.toml:5", "packing.radius", "number", "true"});
  check_spoilt("radius = 0.5", "radius = 1979-05-27", {"bad.toml:5", "packing.radius", "number"});
  check_spoilt("\"sound\"", "7", {"bad.toml:1", "title", "text", "7"});
  check_spoilt("\"strip\"", "[\"strip\"]", {"bad.toml:3", "packing.generator", "text"});
  check_spoilt("[2, 1]", "2", {"bad.toml:12", "partition.grid", "two integers"});
  check_spoilt("[2, 1]", "[2, 1, 1]", {"bad.toml:12", "partition.grid", "two integers"});
  check_spoilt("[2, 1]", "[2.0, 1]", {"bad.toml:12", "partition.grid", "integer"});
  check_spoilt("[-1.0, 0.0]", "[-1.0]", {"bad.toml:15", "velocity", "two numbers"});
  check_spoilt("[[prescribed]]", "[prescribed]", {"bad.toml:13", "prescribed", "[[prescribed]]"});
  check_spoilt("[contacts]\ntolerance = 1e-7", "[[contacts]]\ntolerance = 1e-7", {"bad.toml:6", "contacts", "section"});
}

TEST_CASE("case file: a missing section or value") {
  check_spoilt("[packing]\ngenerator = \"strip\"\ngrains = 4\nradius = 0.5\n", "", {"bad.toml", "[packing]"});
  check_spoilt("[partition]\ngrid = [2, 1]\n", "", {"bad.toml", "[partition]"});
  check_spoilt("generator = \"strip\"\ngrains = 4\nradius = 0.5\n", "", {"bad.toml:2", "packing", "generator", "file"});
  check_spoilt("grid = [2, 1]\n", "", {"bad.toml:11", "partition", "grid", "metis"});
  check_spoilt("density = 2.5\n", "", {"bad.toml", "masses.density"});
  check_spoilt("grain = 3\n", "", {"bad.toml:13", "grain"});
  check_spoilt("velocity = [-1.0, 0.0]\n", "", {"bad.toml:13", "velocity"});
}

TEST_CASE("case file: a value out of bounds") {
  check_spoilt("grains = 4", "grains = 0", {"bad.toml:4", "packing.grains", ">= 1", "met 0"});
  check_spoilt("grains = 4", "grains = 99999999999", {"bad.toml:4", "packing.grains"});
  check_spoilt("radius = 0.5", "radius = 0", {"bad.toml:5", "packing.radius", "> 0"});
  check_spoilt("radius = 0.5", "radius = nan", {"bad.toml:5", "packing.radius", "finite", "nan"});
  check_spoilt("radius = 0.5", "radius = inf", {"bad.toml:5", "packing.radius", "finite", "inf"});
  check_spoilt("tolerance = 1e-7", "tolerance = -1e-7", {"bad.toml:7", "contacts.tolerance", ">= 0"});
  check_spoilt("density = 2.5", "density = -2.5", {"bad.toml:10", "masses.density", "> 0"});
  check_spoilt("[2, 1]", "[0, 1]", {"bad.toml:12", "partition.grid", ">= 1"});
  check_spoilt("[2, 1]", "[100000, 100000]", {"partition.grid", "100000 x 100000"});
  check_spoilt("grid = [2, 1]", "metis = 0", {"bad.toml:12", "partition.metis", ">= 1"});
  check_spoilt("[-1.0, 0.0]", "[nan, 0.0]", {"bad.toml:15", "velocity", "finite"});
  check_spoilt("grain = 3", "grain = 4", {"grain 4"});
  check_spoilt("grain = 3", "grain = -5", {"grain -5"});
}

TEST_CASE("case file: loads that make no sense") {
  const auto loads = [](const std::string& line, std::initializer_list<std::string> parts) {
    check_spoilt("[partition]", "[loads]\n" + line + "\n[partition]", parts);
  };
  loads("compression = 1.0", {"bad.toml:12", "loads.compression", "two numbers"});
  loads("compression = [1.0]", {"bad.toml:12", "loads.compression", "two numbers"});
  loads("compression = [1.0, nan]", {"bad.toml:12", "loads.compression", "finite"});
  loads("shear = inf", {"bad.toml:12", "loads.shear", "finite"});
  loads("shear = \"much\"", {"bad.toml:12", "loads.shear", "number"});
  loads("gravity = 9.81", {"bad.toml:12", "loads.gravity", "compression, shear"});
}

TEST_CASE("case file: an unknown word") {
  check_spoilt("\"strip\"", "\"cubes\"", {"bad.toml:3", "packing.generator", "strip", "hexagonal", "cubes"});
  check_spoilt("\"density\"", "\"heavy\"", {"bad.toml:9", "masses.model", "heavy"});
}

TEST_CASE("case file: values that contradict each other") {
  check_spoilt("grains = 4", "file = \"a.csv\"", {"bad.toml", "packing", "both"});
  check_spoilt("grid = [2, 1]", "grid = [2, 1]\nmetis = 2", {"bad.toml", "partition", "both"});
  check_spoilt("model = \"density\"", "model = \"unit\"", {"bad.toml:10", "masses.density"});
  check_spoilt("model = \"density\"\ndensity = 2.5", "model = \"given\"", {"masses", "given"});
  check_spoilt("[-1.0, 0.0]\n", "[-1.0, 0.0]\n[[prescribed]]\ngrain = 3\nvelocity = [1, 0]\n", {"grain 3"});
  check_spoilt("[-1.0, 0.0]\n", "[-1.0, 0.0]\n[[prescribed]]\ngrain = -1\nvelocity = [1, 0]\n", {"grain"});
}

TEST_CASE_FIXTURE(Session, "case file: an empty one") {
  file("empty.toml", "");
  check_refused("inspect empty.toml", {"empty.toml", "[packing]"});
}

TEST_CASE_FIXTURE(Session, "case file: its packing file is missing or malformed") {
  file("cases/one.toml", case_text("grains.csv"));
  check_refused("inspect cases/one.toml", {"cases/one.toml:2", "packing.file", "grains.csv"});
  file("cases/grains.csv", "x,y,radius\n0,0,-1\n");
  check_refused("inspect cases/one.toml", {"cases/one.toml:2", "grains.csv:2", "radius"});
  file("cases/grains.csv", "x,y,radius\n0,0,1\n");  // beside the case, not where the program runs
  answer("inspect cases/one.toml");
}

TEST_CASE_FIXTURE(Session, "case: none of that name") {
  check_refused("inspect disks5", {"disks5", "disks4", "disks12"});
  check_refused("inspect missing.toml", {"missing.toml"});
  check_refused(std::vector<std::string>{"inspect", ""}, {"CASE", "empty text"});
  check_refused("inspect .", {".toml", ".csv"});
  file("packing.txt", row_of_three());
  check_refused("inspect packing.txt", {"packing.txt", ".toml", ".csv"});
  std::filesystem::create_directory(folder / "folder.toml");
  check_refused("inspect folder.toml", {"folder.toml", "folder"});
}
