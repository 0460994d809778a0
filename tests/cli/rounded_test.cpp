// SPDX-License-Identifier: GPL-3.0-or-later
// Packings whose numbers are coarser than their contacts, and texts of other systems, as a user meets them.
#include "session.hpp"

#include <cstdio>
#include <numbers>

using namespace nscdd::testing;

namespace {

// 64 disks of a triangular lattice with 161 contacts, each number as it is written by `text`.
template <class Text>
std::string rounded_lattice(double radius, double offset, const std::string& separator, const std::string& begin,
                            Text&& text) {
  std::string lines = begin;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i)
      lines += text(offset + radius * (2 * i + j % 2)) + separator + text(offset + radius * std::numbers::sqrt3 * j) +
               separator + text(radius) + "\n";
  return lines;
}
std::string printed(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}
std::string in_full(double value) { return printed("%.17g", value); }
std::string six_digits(double value) { return printed("%g", value); }

std::string rounded() { return rounded_lattice(0.5, 0, ",", "x,y,radius\n", six_digits); }
std::string exact() { return rounded_lattice(0.5, 0, ",", "x,y,radius\n", in_full); }

}  // namespace

TEST_CASE_FIXTURE(Session, "a rounded packing has contacts and radii of the exact one; every verb says so once") {
  file("rounded.csv", rounded());
  file("exact.csv", exact());
  const std::string remark = "nscdd: rounded: coordinates with 6 significant digits resolve gaps to";
  const std::string sweep = " --subdomains 2x2 --epsilon 0,1 --csv -";
  const CsvTable found = read_table(remarked("sweep rounded.csv" + sweep, remark));
  const CsvTable expected = read_table(answer("sweep exact.csv" + sweep));
  REQUIRE(found.rows.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(found.number(k, "contacts") == 161);
    for (const char* name : {"spectral_radius", "subdominant_radius"})
      CHECK(found.number(k, name) == doctest::Approx(expected.number(k, name)).epsilon(1e-5));
  }
  // To six digits, by the lattice with each of its numbers in full.
  CHECK(found.number(0, "subdominant_radius") == doctest::Approx(0.923022).epsilon(1e-6));
  CHECK(found.number(1, "spectral_radius") == doctest::Approx(0.824949).epsilon(1e-6));
  const std::string cut = " rounded.csv --subdomains 2x2";
  remarked("optimum --contacts all" + cut, remark);
  remarked("modes" + cut + " --epsilon 1 --output modes", remark);
  remarked("network" + cut + " --csv links.csv --prescribed 0:1:0", remark);
  remarked("report" + cut + " -o page.html", remark);
  remarked("export" + cut + " --epsilon 1 --operators ops", remark);
  const std::string report = remarked("inspect" + cut, remark);
  CHECK(value(report, "contacts") == "161");
  CHECK(contains(report, "digits               6 significant digits"));
  CHECK(value(report, "  pairs in doubt") == "0");
  CHECK(!contains(answer("inspect exact.csv"), "digits"));
}

TEST_CASE_FIXTURE(Session, "text and HDF5 files, cases and studies know the digits of their packing") {
  file("rounded.txt", rounded_lattice(0.5, 0, " ", "# six digits\n", six_digits));
  file("rounded.toml", case_text("rounded.txt", "2, 1"));
  const std::string remark = "coordinates with 6 significant digits resolve gaps to";
  CHECK(value(remarked("inspect rounded.txt", remark), "contacts") == "161");
  CHECK(value(remarked("inspect rounded.toml", remark), "contacts") == "161");
  answer("generate rounded.toml -o rounded.h5");
  CHECK(value(remarked("inspect rounded.h5", remark), "contacts") == "161");
  file("work/study.toml",
       "title = \"rounded\"\n[[table]]\nname = \"one\"\ncases = [\"rounded.toml\"]\nepsilon = \"1\"\n"
       "[[table]]\nname = \"two\"\ncases = [\"rounded.toml\"]\nobservable = \"grains\"\n");
  file("work/rounded.toml", case_text("../rounded.txt", "2, 1"));
  const Outcome run = ended(0, "run work --output results");
  CHECK(times(run.standard_error, remark) == 1);
}

TEST_CASE_FIXTURE(Session, "grains of a millimetre in the coordinates of a map have all contacts") {
  file("far.csv", rounded_lattice(0.001, 1e6, ",", "x,y,radius\n", in_full));
  CHECK(value(remarked("inspect far.csv", "coordinates with double precision resolve gaps to"), "contacts") == "161");
  // Contacts on the lines of a grid lie in the same subdomains as near the origin.
  file("near.csv", rounded_lattice(0.001, 0, ",", "x,y,radius\n", in_full));
  for (const char* grid : {"2x2", "3x3", "4x2", "5x1"}) {
    CAPTURE(grid);
    const std::string options = std::string(" --epsilon 1 --csv - --subdomains ") + grid;
    const CsvTable far = read_table(remarked("sweep far.csv" + options, "double precision")),
                   near = read_table(answer("sweep near.csv" + options));
    CHECK(far.text(0, "interface_dofs") == near.text(0, "interface_dofs"));
    CHECK(far.number(0, "spectral_radius") == doctest::Approx(near.number(0, "spectral_radius")).epsilon(1e-6));
  }
  file("map.csv", rounded_lattice(0.001, 1e6, ",", "x,y,radius\n", [](double v) { return printed("%.7f", v); }));
  CHECK(value(remarked("inspect map.csv", "coordinates with 7 decimals"), "contacts") == "161");
}

TEST_CASE_FIXTURE(Session, "an ambiguous packing is told apart, and tolerances that lose contacts are named") {
  const auto stretched = [](double value) { return printed("%.6f", value * (1 + 2e-5)); };
  file("open.csv", rounded_lattice(0.5, 0, ",", "x,y,radius\n",
                                   [&](double value) { return value == 0.5 ? std::string("0.5") : stretched(value); }));
  remarked("inspect open.csv", "nscdd: warning: open: ");
  // Rounded, then turned into other units: the digits show nothing.
  file("scaled.csv", rounded_lattice(0.5, 0, ",", "x,y,radius\n",
                                     [](double value) { return in_full(std::stod(six_digits(value)) / 0.37); }));
  check_refused("inspect scaled.csv",
                {"contacts.overlap_tolerance", "--overlap-tolerance", "contacts.tolerance", "--tolerance"});
  remarked("inspect scaled.csv --overlap-tolerance 1e-5", "and do not touch, although others overlap by up to");
  CHECK(value(answer("inspect scaled.csv --overlap-tolerance 1e-5 --tolerance 1e-5"), "contacts") == "161");
}

TEST_CASE_FIXTURE(Session, "texts of other systems: line ends, encodings, and nothing that a terminal obeys") {
  file("mac.csv", "x,y,radius\r0,0,0.5\r1.0D+00,0,0.5\r");
  CHECK(value(answer("inspect mac.csv"), "contacts") == "1");
  file("mac.txt", "0 0 0.5\r1.0D+00 0 5D-1\r");
  CHECK(value(answer("inspect mac.txt"), "contacts") == "1");
  file("mac.toml", "[packing]\rfile = \"mac.csv\"\r[partition]\rgrid = [1, 1]\r");
  CHECK(value(answer("inspect mac.toml"), "contacts") == "1");
  std::string wide = "\xFF\xFE";
  for (const char c : std::string("x,y,radius\n0,0,1\n")) (wide += c) += '\0';
  for (const char* name : {"wide.csv", "wide.txt", "wide.dat", "wide.toml"}) {
    file(name, wide);
    check_refused(std::string("inspect ") + name, {name, "expected UTF-8, met UTF-16"});
  }
  file("bad.csv", "x,y,radius\n0,\x1B[31m" + std::string(1, '\0') + ",1\n");
  const Outcome bad = ended(2, "inspect bad.csv");
  CHECK(bad.standard_error == "nscdd: error: packing.file: bad.csv:2: y: expected a number, met '\\x1B[31m\\x00'\n");
  file("clumps.txt", "#format x_y_z_r_clumpId\n0 0 0 0.5 1\n1 0 0 0.5 1\n");
  check_refused("inspect clumps.txt", {"clumps.txt", "expected free grains, met clumps", "nscdd simulate"});
  for (const char* output : {"new.csv", "new.h5", "-"})
    check_refused(std::string("generate clumps.txt -o ") + output,
                  {"clumps.txt: expected free grains, met clumps, which have no column in CSV and HDF5"});
}
