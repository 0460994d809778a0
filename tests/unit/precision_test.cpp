// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of packings whose numbers are rounded, against those of the exact lattices, every pair of which is tried.
#include "packing/precision.hpp"

#include "../support/small_packings.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr double touching = 2e-9;  // gaps of exact lattices, over the smaller radius

// How a program writes a number, or how another one has changed it.
struct Writer {
  const char* name;
  double (*write)(double value, int digits);
  std::vector<int> digits;
};

double printed(const char* format, double value, int digits) {
  char text[400];
  std::snprintf(text, sizeof text, format, digits, value);
  return std::strtod(text, nullptr);
}
double decimals(double value, int digits) { return printed("%.*f", value, digits); }
double significant(double value, int digits) { return printed("%.*g", value, digits); }
double scientific(double value, int digits) { return printed("%.*e", value, digits); }
double millimetres(double value, int digits) { return decimals(1e3 * value, digits) * 1e-3; }
double single(double value, int) { return static_cast<float>(value); }
double single_of_printed(double value, int digits) { return static_cast<float>(significant(value, digits)); }
double exact(double value, int) { return value; }

const std::vector<Writer> writers{{"%f", decimals, {3, 4, 5, 6, 7, 8, 10, 12}},
                                  {"%g", significant, {3, 4, 5, 6, 7, 8, 10, 12, 14, 15, 16}},
                                  {"%e", scientific, {2, 4, 6, 9}},
                                  {"mm", millimetres, {4, 6}},
                                  {"float", single, {0}},
                                  {"float of %g", single_of_printed, {5, 6}},
                                  {"double", exact, {0}}};

Packing triangular(Index columns, Index rows, double r) {
  Packing p;
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i) {
      p.x.push_back(r * static_cast<double>(2 * i + j % 2));
      p.y.push_back(r * std::numbers::sqrt3 * static_cast<double>(j));
      p.radius.push_back(r);
    }
  return p;
}
Packing turned(Packing p, double angle) {
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    const double x = p.x[i], y = p.y[i];
    p.x[i] = std::cos(angle) * x - std::sin(angle) * y;
    p.y[i] = std::sin(angle) * x + std::cos(angle) * y;
  }
  return p;
}
Packing face_centred(Index cells, double r) {
  Packing p;
  const double h = std::numbers::sqrt2 * r;
  for (Index i = 0; i < 2 * cells; ++i)
    for (Index j = 0; j < 2 * cells; ++j)
      for (Index k = 0; k < 2 * cells; ++k)
        if ((i + j + k) % 2 == 0) {
          p.x.push_back(h * static_cast<double>(i));
          p.y.push_back(h * static_cast<double>(j));
          p.z.push_back(h * static_cast<double>(k));
          p.radius.push_back(r);
        }
  return p;
}

struct Written {
  Packing packing;
  double off = 0;  // the largest change of a number, in radii
};
Written written(Packing p, double offset, const Writer& writer, int digits) {
  const double r = p.radius[0];
  Written result;
  const auto write = [&](double value) {
    const double changed = writer.write(value, digits);
    result.off = std::max({result.off, std::abs(changed - value) / r, std::abs(value) * 1e-16 / r});
    return changed;
  };
  for (auto* values : {&p.x, &p.y, &p.z})
    for (double& value : *values) value = write(value + offset);
  for (double& radius : p.radius) radius = std::max(write(radius), 1e-3 * r);
  result.packing = std::move(p);
  return result;
}

// As "%.6f" prints it.
Packing rounded(Packing p, int digits = 6) { return written(std::move(p), 0, writers[0], digits).packing; }

}  // namespace

TEST_CASE("rounded lattices have the contacts of the exact ones, however they are written and wherever they lie") {
  Index tried = 0, told = 0;
  for (const double r : {0.5, 1.0, 1.0 / 3, 5e-4, 0.0123, 250.0})
    for (const Packing& lattice :
         {triangular(8, 8, r), turned(triangular(6, 6, r), 0.3), face_centred(2, r), turned(face_centred(2, r), 1.1)}) {
      const auto expected = touching_pairs(lattice, touching);
      for (const double offset : {0.0, 1.0, 1e3, 1e5, 1e6, 1e7})
        for (const Writer& writer : writers)
          for (const int digits : writer.digits) {
            const Written one = written(lattice, offset, writer, digits);
            // Numbers that were changed after they were rounded show their digits only as long as a double has them.
            const bool lost = std::string_view(writer.name) == "mm" && offset >= 1e5;
            if (one.off > 0.004 || lost) continue;
            INFO("r = ", r, ", offset = ", offset, ", writer = ", writer.name, ", digits = ", digits);
            ContactNetwork network;
            CHECK_NOTHROW(network = detect_contacts(one.packing));
            ++tried;
            if (!network.rounding
                     .used) {  // coarse digits that leave no overlap: gaps that may be meant, every one told
              CHECK(one.off > 1e-5);
              CHECK(network.size() + network.rounding.open.size == count(expected));
              ++told;
              continue;
            }
            CHECK((pairs_of(network) == expected));
            CHECK((network.rounding.open.size == 0 && network.rounding.one_sided.size == 0));
          }
    }
  CHECK(tried > 1500);
  CHECK(told < tried / 50);
}

TEST_CASE("the digits of numbers are told from the numbers") {
  const auto text = [](const Packing& p) { return precision_of(p).text(); };
  const Packing lattice = turned(triangular(6, 6, 1.0 / 3), 0.2);
  const auto as = [&](std::size_t writer, int digits) { return written(lattice, 0, writers[writer], digits).packing; };
  CHECK(text(lattice) == "double precision");
  CHECK(text(as(0, 6)) == "6 decimals");
  CHECK(text(as(0, 3)) == "3 decimals");
  CHECK(text(as(1, 6)) == "6 significant digits");
  CHECK(text(as(2, 6)) == "7 significant digits");
  CHECK(text(as(3, 3)) == "6 decimals");
  CHECK(text(as(4, 0)) == "single precision");
  CHECK(text(as(5, 5)) == "5 significant digits");
  CHECK(text({{0, 1, 2}, {0, 0, 0}, {0.5, 0.5, 0.5}, {}}) == "0 decimals");
  // One in twenty may be longer: somebody has added a grain.
  Packing mixed = as(0, 6);
  mixed.x[3] = 1.0 / 3;
  CHECK(text(mixed) == "6 decimals");
}

TEST_CASE("numbers of few digits are exact unless their gaps show rounding") {
  const auto contacts = [](const Packing& p) { return detect_contacts(p).size(); };
  CHECK(contacts({{0, 1, 2}, {0, 0, 0}, {0.5, 0.5, 0.5}, {}}) == 2);
  CHECK(contacts({{0, 1.1, 2.2}, {0, 0, 0}, {0.5, 0.5, 0.5}, {}}) == 0);
  CHECK(contacts({{0, 1.01, 2.01}, {0, 0, 0}, {0.5, 0.5, 0.5}, {}}) == 1);
  CHECK(contacts({{0, 1.001}, {0, 0}, {0.5, 0.5}, {}}) == 0);
  CHECK(contacts({{0, 1.001, 2.002, 3.003}, {0, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {}}) == 0);
  CHECK(contacts({{0, 1.0001, 2.0002, 3.0003}, {0, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {}}) == 0);
  CHECK(contacts({{0, 1, 0, 1}, {0, 0, 1.1, 1.1}, {0.5, 0.5, 0.5, 0.5}, {}}) == 2);
  CHECK(contacts({{0, 2.5}, {0, 0}, {1.5, 1}, {}}) == 1);
  CHECK_THROWS_AS(contacts({{0, 1.9999}, {0, 0}, {1, 1}, {}}), Error);
  CHECK_THROWS_AS(contacts({{0, 0.9, 1.8, 2.7}, {0, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {}}), Error);
  // A gap that the last digit may have made is named.
  const RoundingDoubt doubt = detect_contacts({{0, 1.001, 5}, {0, 0, 5}, {0.5, 0.5, 0.5}, {}}).rounding;
  CHECK(!doubt.used);
  CHECK(doubt.open.size == 1);
  CHECK((doubt.open.first == std::vector<std::array<Index, 2>>{{0, 1}}));
}

TEST_CASE("gaps that are meant stay apart, whatever the digits of the radii") {
  const auto square = [](Index columns, Index rows, double pitch_x, double pitch_y, double radius) {
    Packing p;
    for (Index i = 0; i < columns; ++i)
      for (Index j = 0; j < rows; ++j) {
        p.x.push_back(decimals(pitch_x * static_cast<double>(i), 6));
        p.y.push_back(decimals(pitch_y * static_cast<double>(j), 6));
        p.radius.push_back(radius);
      }
    return p;
  };
  CHECK(detect_contacts(square(8, 8, 0.26, 0.26, 0.125)).size() == 0);
  CHECK(detect_contacts(square(8, 8, 0.0026, 0.0026, 0.00125)).size() == 0);
  CHECK(detect_contacts(square(8, 8, 0.52, 0.52, 0.255)).size() == 0);
  CHECK(detect_contacts(square(8, 8, 0.51, 0.52, 0.25)).size() == 0);
  CHECK(detect_contacts({{0, 1.001, 2.003, 3.004, 4.006, 5.007}, {0, 0, 0, 0, 0, 0}, std::vector<double>(6, 0.5), {}})
            .size() == 0);
  // Four grains whose numbers have more digits than the others are known as well as these digits say.
  Packing beside = square(20, 20, 0.25, 0.25, 0.125);
  const double above = beside.y.back() + 0.25;
  for (Index i = 0; i < 4; ++i) {
    beside.x.push_back(0.25 * static_cast<double>(i));
    beside.y.push_back(above + 0.005432109876543 + 1e-3 * std::sqrt(static_cast<double>(i)));
    beside.radius.push_back(0.125);
  }
  CHECK(detect_contacts(beside).size() == 760);  // those of the lattice; the four differ in height
}

TEST_CASE("doubles that are precise enough change nothing") {
  for (const Packing& p : {triangular(8, 8, 0.5), turned(triangular(5, 7, 0.02), 0.4), face_centred(2, 3)}) {
    const ContactNetwork network = detect_contacts(p);
    CHECK((pairs_of(network) == touching_pairs(p, touching)));
    CHECK((network.rounding.decided.size == 0 && network.rounding.open.size == 0));
    CHECK(rounding_remarks(network, "p").empty());
  }
}

TEST_CASE("what rounding decides and leaves open is counted and named") {
  const Packing lattice = triangular(8, 8, 0.5);
  const ContactNetwork network = detect_contacts(rounded(lattice));
  const RoundingDoubt& doubt = network.rounding;
  CHECK(network.size() == 161);
  Index beyond = 0;
  for (const Contact& contact : network.contacts) beyond += std::abs(contact.gap) > 0.5e-7;
  CHECK(beyond > 50);
  CHECK(doubt.decided.size == beyond);
  CHECK(doubt.decided.first.size() == 3);
  CHECK(doubt.used);
  CHECK(!doubt.ambiguous());
  CHECK(doubt.uncertainty > 1e-6);
  CHECK(doubt.uncertainty < 1e-5);
  REQUIRE(rounding_remarks(network, "p").size() == 1);
  CHECK(rounding_remarks(network, "p")[0].starts_with("p: coordinates with 6 decimals"));

  // Rows that are apart by twice the uncertainty do not touch, and nobody can tell.
  Packing apart = lattice;
  for (double& y : apart.y) y *= 1 + 0.8e-5;
  const ContactNetwork open = detect_contacts(rounded(apart));
  CHECK(open.size() == 8 * 7);
  CHECK(open.rounding.ambiguous());
  CHECK(open.rounding.open.size == 161 - 8 * 7);
  REQUIRE(rounding_remarks(open, "p").size() == 1);
  CHECK(rounding_remarks(open, "p")[0].starts_with("warning: p: the contacts are ambiguous"));
  // Ten times as far they are clearly apart.
  for (double& y : apart.y) y *= 1 + 1e-4;
  CHECK(rounding_remarks(detect_contacts(rounded(apart)), "p").empty());
}

TEST_CASE("an overlap tolerance that leaves gaps of the same size apart is told") {
  // Rounded, and then scaled: the digits show nothing any more.
  Packing scaled = rounded(triangular(8, 8, 0.5));
  for (auto* values : {&scaled.x, &scaled.y, &scaled.radius})
    for (double& value : *values) value /= 0.37;
  CHECK(precision_of(scaled).text() == "double precision");
  CHECK_THROWS_WITH_AS(detect_contacts(scaled), doctest::Contains("raise contacts.tolerance (--tolerance) as well"),
                       Error);
  const ContactNetwork half = detect_contacts(scaled, {.tolerance = 1e-7, .overlap_tolerance = 1e-5});
  CHECK(half.size() < 161);
  CHECK(half.size() + half.rounding.one_sided.size == 161);
  REQUIRE(rounding_remarks(half, "p").size() == 1);
  CHECK(rounding_remarks(half, "p")[0].find("--tolerance") != std::string::npos);
  const ContactNetwork both = detect_contacts(scaled, {.tolerance = 1e-5, .overlap_tolerance = 1e-5});
  CHECK((pairs_of(both) == touching_pairs(triangular(8, 8, 0.5), touching)));
  CHECK(rounding_remarks(both, "p").empty());
  // The same with gaps that are no hairlines.
  const double scale = 1 / 0.37, half_width = 0.5 * scale;
  const Packing chain{
      {0, 0.995 * scale, 1.996 * scale, 3 * scale}, {0, 0, 0, 0}, {half_width, half_width, half_width, half_width}, {}};
  const RoundingDoubt some = detect_contacts(chain, {.tolerance = 1e-7, .overlap_tolerance = 0.02}).rounding;
  CHECK(some.overlap == doctest::Approx(0.01));
  CHECK((some.one_sided.first == std::vector<std::array<Index, 2>>{{1, 2}, {2, 3}}));  // apart by 0.002 and 0.008 radii
  // Hairline gaps alone are told, too: here the radii were rounded down.
  Packing shrunk = triangular(8, 8, 1.0 / 3);
  for (double& radius : shrunk.radius) radius = 0.3333333 * (1 + 1e-15);
  CHECK(detect_contacts(shrunk).rounding.one_sided.size == 161);
}

TEST_CASE("coordinates that cannot tell a tenth of a radius are refused, with the way out") {
  Packing row;  // grains of 1 mm far from the origin: a float there is worth 0.5 mm, a double at 10^13 m 2 mm
  for (Index i = 0; i < 8; ++i) {
    row.x.push_back(static_cast<float>(5000 + 1e-3 * static_cast<double>(i)));
    row.y.push_back(0);
    row.radius.push_back(5e-4);
  }
  CHECK_THROWS_WITH_AS(
      detect_contacts(row),
      doctest::Contains("expected coordinates that resolve gaps to 0.1 of the smaller radius, met single"), Error);
  for (Index i = 0; i < 8; ++i) row.x[at(i)] = 1e13 + 1.3e-3 * static_cast<double>(i);
  CHECK_THROWS_AS(detect_contacts(row), Error);
}
