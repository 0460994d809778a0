// SPDX-License-Identifier: GPL-3.0-or-later
// Each statement of [ADI12] about Figures 2-7, tested on the tables the figures are drawn from.
#include "../support/studies.hpp"
#include <nscdd/core/fields.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A curve: radius against one abscissa for one case, with some rows selected.
std::map<double, double> curve(
    const Table& table, const std::string& name, const std::string& abscissa,
    const std::function<bool(const Row&)>& keep = [](const Row&) { return true; }) {
  std::map<double, double> points;
  for (const Row& row : table.rows)
    if (std::get<std::string>(row[0]) == name && keep(row))
      points[std::get<double>(row[table.column(abscissa)])] = std::get<double>(row[table.column("spectral_radius")]);
  REQUIRE(points.size() > 5);
  return points;
}

const std::vector<std::string> cases{"disks4", "disks8", "disks12"};

}  // namespace

TEST_CASE("Figures 2-4: grains, links, halves, and both tension and compression") {
  const Study study = read_study("figures-2-3-4");
  const Table links = run(study.tables[0]), grains = run(study.tables[1]);
  const std::map<std::string, std::pair<Index, Index>> sizes{
      {"disks4", {4, 5}}, {"disks8", {8, 13}}, {"disks12", {12, 21}}};
  for (const auto& known : sizes) {
    CAPTURE(known.first);
    Index grain_count = 0, shared = 0, link_count = 0, compressive = 0;
    std::map<std::int64_t, Index> by_subdomain;
    for (const Row& row : grains.rows)
      if (std::get<std::string>(row[0]) == known.first) {
        ++grain_count;
        shared += std::get<std::int64_t>(row[grains.column("multiplicity")]) == 2;
      }
    for (const Row& row : links.rows)
      if (std::get<std::string>(row[0]) == known.first) {
        ++link_count;
        compressive += std::get<double>(row[links.column("impulse")]) > 0;
        ++by_subdomain[std::get<std::int64_t>(row[links.column("subdomain")])];
      }
    CHECK(grain_count == known.second.first);
    CHECK(link_count == known.second.second);
    CHECK(by_subdomain.size() == 2);
    CHECK(shared == 2);  // two half-disks in each subdomain; for 4 disks one whole disk beside them
    CHECK(compressive > 0);
    CHECK(compressive < link_count);  // "some tensions ... because the loss of contact is not taken into account"
  }
}

TEST_CASE("Figure 5: the radius increases when epsilon tends to 0, up to the limit") {
  const Table table = run(read_study("figure-5").tables[0]);
  std::map<std::string, double> limit, one;
  for (const std::string& name : cases) {
    CAPTURE(name);
    const auto points = curve(table, name, "epsilon");
    for (auto next = std::next(points.begin()); next != points.end(); ++next)
      CHECK(next->second < std::prev(next)->second);
    CHECK(points.begin()->first == 0);  // the limit is marked
    CHECK(points.count(1.0) == 1);      // and so is epsilon = 1
    CHECK(points.begin()->second < 1);  // isostatic: B_0 is evaluable and contracts
    limit[name] = points.at(0);
    one[name] = points.at(1.0);
    CHECK(std::next(points.begin())->second == doctest::Approx(limit[name]).epsilon(1e-3));
  }
  CHECK(limit["disks4"] < limit["disks8"]);
  CHECK(limit["disks8"] < limit["disks12"]);
  CHECK(one["disks4"] < one["disks8"]);
  CHECK(one["disks8"] < one["disks12"]);
}

TEST_CASE("Figure 6: zero at eta = epsilon; for epsilon = 0 decreasing with eta, slower for larger examples") {
  const Table table = run(read_study("figure-6").tables[0]);
  const auto with_epsilon = [&](double epsilon) {
    return [&table, epsilon](const Row& row) { return std::get<double>(row[table.column("epsilon")]) == epsilon; };
  };
  std::map<std::string, double> at_tenth;
  for (const std::string& name : cases) {
    CAPTURE(name);
    const auto linear = curve(table, name, "eta", with_epsilon(1));
    REQUIRE(linear.count(1.0) == 1);
    CHECK(linear.at(1.0) == 0);  // one iteration: the two stages are uncoupled
    for (const auto& [eta, radius] : linear)
      if (eta != 1.0) CHECK(radius > 0);
    for (const auto& [eta, radius] : linear)
      if (eta > 1.0 && !std::isinf(eta)) CHECK(radius < linear.at(infinity));  // substantial enhancement

    const auto rigid = curve(table, name, "eta", with_epsilon(0));
    for (auto next = std::next(rigid.begin()); next != rigid.end(); ++next)
      CHECK(next->second > std::prev(next)->second);
    CHECK(rigid.begin()->second > 0);
    const auto tenth =
        std::find_if(rigid.begin(), rigid.end(), [](const auto& p) { return std::abs(p.first - 0.1) < 1e-9; });
    REQUIRE(tenth != rigid.end());
    at_tenth[name] = tenth->second;
    // beyond the paper: zero is reached, linearly with eta
    const auto first = rigid.begin(), decade = std::next(first, 20);
    CHECK(decade->first / first->first == doctest::Approx(10).epsilon(1e-6));
    if (name == "disks4") CHECK(decade->second / first->second == doctest::Approx(10).epsilon(1e-2));
  }
  // "does not seem to be reached, especially when the size of the system increases"
  CHECK(at_tenth["disks4"] < at_tenth["disks8"]);
  CHECK(at_tenth["disks8"] < at_tenth["disks12"]);
}

TEST_CASE("Figure 7: below the generic radius, closer to it as eta grows, above 1 when eta tends to 0") {
  const Table table = run(read_study("figure-7").tables[0]);
  std::map<std::string, double> generic, best_eta, useful_width, best_gain;
  for (const std::string& name : cases) {
    CAPTURE(name);
    auto points = curve(table, name, "eta");
    generic[name] = points.at(infinity);
    points.erase(infinity);
    const auto best = std::min_element(points.begin(), points.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    best_eta[name] = best->first;
    CHECK(best->second < generic[name]);  // "may be smaller than that of the generic algorithm"
    CHECK(points.begin()->second > 1);    // "get larger than 1 when eta tends to zero"
    CHECK(points.rbegin()->second == doctest::Approx(generic[name]).epsilon(1e-2));  // "closer ... when eta increases"
    CHECK(points.rbegin()->second < generic[name]);
    for (auto next = std::next(best); next != points.end(); ++next) CHECK(next->second > std::prev(next)->second);
    // width, in decades, of the range where the gain over the generic algorithm is at least half the best gain
    const double threshold = 0.5 * (best->second + generic[name]);
    double low = infinity, high = 0;
    for (const auto& [eta, radius] : points)
      if (radius <= threshold) {
        low = std::min(low, eta);
        high = std::max(high, eta);
      }
    useful_width[name] = high - low;
  }
  // "greater the number of disks, the more the optimal range of eta is close to zero and reduced"
  CHECK(best_eta["disks12"] < best_eta["disks8"]);
  CHECK(best_eta["disks8"] < best_eta["disks4"]);
  CHECK(useful_width["disks12"] < useful_width["disks8"]);
  CHECK(useful_width["disks8"] < useful_width["disks4"]);
}
