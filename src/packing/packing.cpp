// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "packing/grain_grid.hpp"
#include "packing/precision.hpp"

#include <numbers>

namespace nscdd {
namespace {

void require_positive(const std::vector<double>& values, const char* name) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) || values[i] <= 0)
      fail("grain {}: expected a finite {} > 0, met {}", i, name, values[i]);
}

std::string place(const Packing& p, Index grain) {
  const auto [x, y, z] = p.centre(grain);
  return p.z.empty() ? fmt::format("({}, {})", x, y) : fmt::format("({}, {}, {})", x, y, z);
}

// From the centre of a grain to that of another, in a periodic cell to its nearest image, m.
std::array<double, 3> apart(const Packing& p, const Period& period, Index i, Index j) {
  return period.shortest({p.x[at(j)] - p.x[at(i)], p.y[at(j)] - p.y[at(i)], p.z.empty() ? 0 : p.z[at(j)] - p.z[at(i)]});
}

Contact pair_geometry(const Packing& p, const Period& period, Index i, Index j) {
  const auto [dx, dy, dz] = apart(p, period, i, j);
  const double distance = p.z.empty() ? std::hypot(dx, dy) : std::hypot(dx, dy, dz);
  Contact contact{.a = i, .b = j};
  contact.gap = distance - (p.radius[at(i)] + p.radius[at(j)]);
  const auto [x, y, z] = p.centre(i);
  contact.midpoint = {x + 0.5 * dx, y + 0.5 * dy, z + 0.5 * dz};
  if (distance > 0) contact.normal = {dx / distance, dy / distance, dz / distance};
  return contact;
}

std::string described(const Packing& p, Index grain) {
  return fmt::format("{} of radius {}", place(p, grain), p.radius[at(grain)]);
}

// In radii: rounding is never assumed to be coarser; pairs further apart are not reported.
constexpr double coarsest = 0.1, worth_naming = 0.05;
// Coarser digits count as rounded if they leave both overlaps and gaps, or so many overlaps.
constexpr Index pairs_that_show = 3;
constexpr Index sample = 3;  // pairs reported by name

// Sorts the near pairs of a packing into contacts and others, by the tolerances and by the precision of its digits.
class NearPairs {
 public:
  NearPairs(const Packing& packing, const ContactDetection& detection)
      : p_(packing), detection_(detection), precision_(precision_of(packing)) {}

  // Near pairs: gaps up to that many times the smaller radius.
  double reach() const {
    const double rounding = std::min(coarsest, largest_uncertainty(precision_, p_));
    return std::max({detection_.tolerance, std::min(detection_.overlap_tolerance, coarsest), 3 * rounding, hairline});
  }

  void add(const Contact& contact) {
    const auto [i, j] = bodies(contact);
    if (p_.centre(i) == p_.centre(j))
      fail("grains {} and {} have the same centre: {} and {}", i, j, described(p_, i), described(p_, j));
    const double smaller = std::min(p_.radius[at(contact.a)], p_.radius[at(contact.b)]);
    const bool apart = contact.gap > detection_.tolerance * smaller;
    const bool overlaps = -contact.gap > detection_.overlap_tolerance * smaller;
    if (apart || overlaps) return add_beyond(contact, smaller, overlaps);
    keep(contact);
    doubt_.overlap = std::max(doubt_.overlap, -contact.gap / smaller);
  }

  ContactNetwork network() {
    doubt_.digits = precision_.text();
    settle(sure_, true);
    settle(coarse_, shows_rounding());
    settle(exact_, false);
    std::erase_if(apart_, [](const Near& near) { return near.gap <= 3 * near.uncertainty; });
    const Index hairs = std::ranges::count_if(apart_, [](const Near& near) { return near.gap <= hairline; });
    const double least = hairs > pairs_that_show && 100 * hairs > count(contacts_) ? hairline : 0;
    std::erase_if(apart_, [&](const Near& near) { return near.gap > std::max(doubt_.overlap, least); });
    for (const Near& near : apart_) note(doubt_.one_sided, near.contact);
    // The order of search depends on the grid.
    return {.contacts = sorted_by_bodies(contacts_, p_.size()),
            .grains = p_.size(),
            .dimension = p_.dimension(),
            .rounding = std::move(doubt_)};
  }

 private:
  struct Near {
    Contact contact;
    double gap, uncertainty;  // times the smaller radius
  };

  void add_beyond(const Contact& contact, double smaller, bool overlaps) {
    const Uncertainty of_gap = gap_uncertainty(precision_, p_, contact);
    const double certain = of_gap.certain / smaller, decimal = of_gap.decimal / smaller;
    if (certain > coarsest && std::abs(contact.gap) <= 3 * of_gap.certain) refuse_coarse(contact, certain);
    const bool surely = decimal <= surely_rounded || std::abs(contact.gap) <= of_gap.certain;
    const bool maybe = surely || decimal <= coarsest;
    const Near near{contact, contact.gap / smaller,
                    std::min(surely && decimal > surely_rounded ? certain : std::max(certain, decimal), coarsest)};
    const bool within = std::abs(near.gap) <= near.uncertainty;
    if (overlaps && !(maybe && within)) refuse_overlap(near);
    if (near.gap <= 3 * near.uncertainty) (surely ? sure_ : maybe ? coarse_ : exact_).push_back(near);
    if (maybe && within) ++(near.gap < 0 ? overlaps_ : gaps_);
    const double worth_a_word = std::max(hairline, std::min(detection_.overlap_tolerance, coarsest));
    if (!overlaps && !within && near.gap <= worth_a_word) apart_.push_back(near);
  }

  // Overlaps are due to rounding. Gaps only may be intended.
  bool shows_rounding() const { return overlaps_ >= pairs_that_show || (overlaps_ > 0 && gaps_ > 0); }

  void keep(const Contact& contact) {
    // The most edges of a plane graph, and about as many as a dense bed of equal spheres has.
    if (contacts_.empty()) contacts_.reserve(at(3 * p_.size()));
    contacts_.push_back(contact);
  }

  // Pairs beyond the tolerances, with rounded and with exact numbers.
  void settle(const std::vector<Near>& pairs, bool rounded) {
    if (!rounded)
      if (const Near* first = first_overlap(pairs)) refuse_overlap(*first);
    for (const Near& near : pairs) {
      doubt_.uncertainty = std::max(doubt_.uncertainty, near.uncertainty);
      if (!rounded && !(near.gap <= std::min(near.uncertainty, worth_naming))) continue;
      const bool touches = rounded && near.gap <= near.uncertainty;
      if (touches) keep(near.contact);
      note(touches ? doubt_.decided : doubt_.open, near.contact);
      doubt_.used = doubt_.used && rounded;
    }
  }

  static const Near* first_overlap(const std::vector<Near>& pairs) {
    const Near* first = nullptr;
    for (const Near& near : pairs)
      if (near.gap < 0 && (first == nullptr || bodies(near.contact) < bodies(first->contact))) first = &near;
    return first;
  }
  static std::array<Index, 2> bodies(const Contact& contact) { return {contact.a, contact.b}; }

  static void note(PairSample& pairs, const Contact& contact) {
    ++pairs.size;
    pairs.first.push_back(bodies(contact));
    std::ranges::sort(pairs.first);
    pairs.first.resize(std::min(pairs.first.size(), at(sample)));
  }

  [[noreturn]] void refuse_coarse(const Contact& contact, double worth) const {
    const auto [i, j] = bodies(contact);
    const char* format = p_.half_digit > 0               ? "the digits of its file"
                         : precision_.coordinates.single ? "single precision"
                                                         : "double precision";
    fail(
        "grains {} and {}: expected coordinates that resolve gaps to {} of the smaller radius, met {}, by which this "
        "gap is resolved to {:.2g} of it: {} and {}; move the origin nearer to the grains, or write more digits",
        i, j, coarsest, format, worth, described(p_, i), described(p_, j));
  }
  [[noreturn]] void refuse_overlap(const Near& near) const {
    const auto [i, j] = bodies(near.contact);
    const double smaller = std::min(p_.radius[at(i)], p_.radius[at(j)]);
    fail(
        "grains {} and {} overlap by {} m, more than the {} m allowed (contacts.overlap_tolerance, "
        "--overlap-tolerance): {} and {}; by their digits ({}) this gap is known to {:.2g} m; where coordinates are "
        "rounded more coarsely than they are written, raise contacts.tolerance (--tolerance) as well: gaps of that "
        "size then count as contacts, too",
        i, j, -near.contact.gap, detection_.overlap_tolerance * smaller, described(p_, i), described(p_, j),
        precision_.text(), gap_uncertainty(precision_, p_, near.contact).largest());
  }

  const Packing& p_;
  const ContactDetection& detection_;
  Precision precision_;
  std::vector<Contact> contacts_;
  // Pairs beyond the tolerances, by whether rounding is certain, possible, or absent; the others.
  std::vector<Near> sure_, coarse_, exact_, apart_;
  Index overlaps_ = 0, gaps_ = 0;  // numbers of those that may be rounding
  RoundingDoubt doubt_;
};

}  // namespace

void check(const Packing& packing) {
  if (packing.size() == 0) throw Error("packing: expected at least one grain, met none");
  for (const auto& [what, met] : {std::pair("y", count(packing.y)), std::pair("radius", count(packing.radius))})
    if (met != packing.size()) fail("packing: expected a {} for each of {} grains, met {}", what, packing.size(), met);
  for (const auto& [what, met] : {std::pair("mass", count(packing.mass)), std::pair("z", count(packing.z)),
                                  std::pair("clump", count(packing.clump))})
    if (met != 0 && met != packing.size())
      fail("packing: expected a {} for each of {} grains or for none, met {}", what, packing.size(), met);
  for (Index i = 0; i < packing.size(); ++i)
    if (std::ranges::any_of(packing.centre(i), [](double one) { return !std::isfinite(one); }))
      fail("grain {}: expected finite coordinates, met {}", i, place(packing, i));
  require_positive(packing.radius, "radius");
  require_positive(packing.mass, "mass");
}

Packing with_masses(Packing packing, const Masses& masses) {
  const MassModel model = masses.model.value_or(packing.mass.empty() ? MassModel::unit : MassModel::given);
  if (model == MassModel::given && packing.mass.empty())
    throw Error("masses: expected a packing with masses (a 'mass' column) for model \"given\", met none");
  if (model != MassModel::given) packing.mass.assign(packing.radius.size(), 1.0);
  if (model == MassModel::density)
    std::ranges::transform(packing.radius, packing.mass.begin(), [&](double r) {
      return masses.density * std::numbers::pi * r * r * (packing.z.empty() ? 1 : 4 * r / 3);
    });
  check(packing);
  return packing;
}

void check(const Period& period, const std::vector<double>& radius, double reach) {
  if (!period.any() || radius.empty()) return;
  constexpr double margin = 1e-6;  // at two diameters two grains touch across both ends of the cell
  const double least = (4 + 2 * reach) * std::ranges::max(radius);
  for (const auto& [key, length] : {std::pair("contacts.period_x", period.x), std::pair("contacts.period_y", period.y)})
    if (length != 0 && !(length > least * (1 + margin) && std::isfinite(length)))
      throw Error(key, fmt::format("expected 0 or more than two diameters of the largest grain, {} m, met {} m", least,
                                   length));
}

ContactNetwork detect_contacts(const Packing& packing, const ContactDetection& detection) {
  if (packing.size() == 0) return {.contacts = {}, .grains = 0, .dimension = packing.dimension()};
  if (std::ranges::any_of(packing.clump, [](Index number) { return number >= 0; }))
    throw Error(
        "expected free grains, met clumps: only cases that move have them (nscdd simulate); without their numbers the "
        "members are free grains");
  require_bounds(detection, "contacts");
  NearPairs pairs(packing, detection);
  // r_i + r_j + tolerance min(r_i, r_j) is at most stretch (r_i + r_j).
  const double stretch = 1 + 0.5 * pairs.reach();
  const Period period = detection.period();
  check(period, packing.radius, pairs.reach());
  for_each_near_pair({packing.x, packing.y, packing.z}, packing.radius, period, stretch, 0, [&](Index i, Index j) {
    const double distance = stretch * (packing.radius[at(i)] + packing.radius[at(j)]);
    // Most pairs end here, without a root; the margin is wide for rounding.
    const auto [dx, dy, dz] = apart(packing, period, i, j);
    if (dx * dx + dy * dy + dz * dz > 1.000001 * distance * distance) return;
    pairs.add(pair_geometry(packing, period, i, j));
  });
  ContactNetwork network = pairs.network();
  network.period = period;
  return network;
}

std::vector<Index> contact_counts(const ContactNetwork& network) {
  std::vector<Index> counts(at(network.grains), 0);
  for (const Contact& contact : network.contacts) {
    ++counts[at(contact.a)];
    ++counts[at(contact.b)];
  }
  return counts;
}

}  // namespace nscdd
