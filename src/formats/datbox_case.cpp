// SPDX-License-Identifier: GPL-3.0-or-later
// What a DATBOX describes, in the terms of this program.
#include "core/fail.hpp"
#include "formats/datbox.hpp"

#include <filesystem>
#include <numbers>
#include <set>

namespace nscdd {
namespace {

template <class... Arguments>
[[noreturn]] void refuse(const DatboxPlace& place, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fail("{}:{}: {}", place.file, place.line, fmt::format(format, std::forward<Arguments>(arguments)...));
}

// A full disk has the radius of gyration R / sqrt(2). Some files have it to three digits.
void require_full_disk(const DatboxBody& body) {
  constexpr double tolerance = 1e-3;
  const double radius = body.contactors[0].radius, expected = radius / std::numbers::sqrt2;
  if (body.contactors.size() > 1)
    refuse(body.place, "expected free bodies of one disk, met one of {}: free clusters are not modelled",
           body.contactors.size());
  if (std::abs(body.gyration_radius - expected) > tolerance * expected)
    refuse(body.place, "gyrd: expected that of a full disk, {}, met {}: other inertias are not modelled", expected,
           body.gyration_radius);
}

double density_of(const Datbox& datbox, const DatboxBody& body) {
  const auto found = datbox.density.find(body.bulk);
  if (found == datbox.density.end())
    refuse(body.place, "bulk law '{}': expected a law RIGID of that name in BULK_BEHAV.DAT, met none", body.bulk);
  return found->second;
}

std::array<double, 2> place_of(const DatboxBody& body, const DatboxContactor& disk) {
  const double c = std::cos(body.position[2]), s = std::sin(body.position[2]);
  return {body.position[0] + c * disk.shift[0] - s * disk.shift[1],
          body.position[1] + s * disk.shift[0] + c * disk.shift[1]};
}

// Calls `visit(body, disk, number)` for every grain of the packing.
template <class Visit>
void for_each_disk(const Datbox& datbox, DatboxDisks which, Visit visit) {
  Index number = 0;
  for (const DatboxBody& body : datbox.bodies)
    for (const DatboxContactor& contactor : body.contactors)
      if (!contactor.plank && (which == DatboxDisks::all || !body.driven())) visit(body, contactor, number++);
}

// [CT + AMP cos(PHI)] min(1, RAMPI + RAMP t) at the time t of the run. A motion is linear between its times.
struct Ramp {
  double full = 0, initial = 1, rate = 0;

  double at(double t) const { return full * std::min(1.0, initial + rate * t); }
  /// When it is at its full height; 0 if it is so from the beginning.
  double end() const { return rate > 0 && initial < 1 ? (1 - initial) / rate : 0; }
};

Ramp ramp_of(const DatboxDrive& drive, double start) {
  if (drive.table) refuse(drive.place, "expected a formula, met a table (evolution): motions by tables are not read");
  if (drive.amplitude != 0 && drive.omega != 0)
    refuse(drive.place, "expected AMP or OMEGA 0, met {} and {}: motions are linear in time here", drive.amplitude,
           drive.omega);
  if (drive.rate < 0) refuse(drive.place, "RAMP: expected 0 or more, met {}", drive.rate);
  return {drive.constant + drive.amplitude * std::cos(drive.phase), drive.initial + drive.rate * start, drive.rate};
}

Motion motion_of(const DatboxBody& body, double start) {
  std::array<Ramp, 3> ramps;
  std::set<double> times{0};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!body.drives[k])
      refuse(body.place, "expected a body that is free or driven in all of vlocy 1, 2 and 3, met one without {}",
             k + 1);
    ramps[k] = ramp_of(*body.drives[k], start);
    if (ramps[k].full != 0) times.insert(ramps[k].end());
  }
  Motion motion{.centre = {body.position[0], body.position[1]}, .time = {}, .velocity = {}};
  for (const double t : times) {
    motion.time.push_back(t);
    motion.velocity.push_back({ramps[0].at(t), ramps[1].at(t), ramps[2].at(t)});
  }
  return motion;
}

// The line along that face of a plank which all free disks are in front of.
void set_wall(const Datbox& datbox, const DatboxBody& body, BoundarySpec& wall) {
  const DatboxContactor& plank = body.contactors[0];
  const std::array<double, 2> along{std::cos(body.position[2]), std::sin(body.position[2])};
  Index above = 0, below = 0;
  for_each_disk(datbox, DatboxDisks::free, [&](const DatboxBody& other, const DatboxContactor&, Index) {
    const double height =
        along[0] * (other.position[1] - body.position[1]) - along[1] * (other.position[0] - body.position[0]);
    ++(height > 0 ? above : below);
  });
  if (above > 0 && below > 0)
    refuse(body.place,
           "expected a plank JONCx with all free disks on one side, met {} above and {} below it: walls are straight "
           "lines without ends here",
           above, below);
  const double side = below > 0 ? -1 : 1;
  const std::array<double, 2> foot{body.position[0] - side * plank.thickness * along[1],
                                   body.position[1] + side * plank.thickness * along[0]};
  for (std::size_t k = 0; k < 2; ++k) {
    wall.from[k] = foot[k] - side * plank.length * along[k];
    wall.to[k] = foot[k] + side * plank.length * along[k];
  }
}

std::vector<BoundarySpec> boundaries_of(const Datbox& datbox) {
  std::vector<BoundarySpec> boundaries;
  Index grains = 0;
  for (std::size_t k = 0; k < datbox.bodies.size(); ++k) {
    const DatboxBody& body = datbox.bodies[k];
    if (body.force)
      refuse(*body.force, "expected velocities (vlocy), met a force: bodies driven by forces are not modelled");
    if (body.plank() && !body.driven())
      refuse(body.place, "expected a plank JONCx that is driven, met a free one: planks are walls here");
    if (body.driven()) {
      BoundarySpec boundary;
      boundary.name = fmt::format("body {}", k + 1);
      boundary.motion = motion_of(body, datbox.start);
      if (body.plank()) {
        set_wall(datbox, body, boundary);
      } else {
        boundary.shape = BoundaryShape::grains;
        boundary.first = grains;
        boundary.last = grains + count(body.contactors) - 1;
      }
      boundaries.push_back(std::move(boundary));
    }
    if (!body.plank()) grains += count(body.contactors);
  }
  return boundaries;
}

// Who may touch whom: the colours of free disks, and the contactors and colours of what is driven.
using Colour = std::pair<std::string, std::string>;  // DISKx or JONCx, and its colour
struct Colours {
  std::map<Colour, Index> free;  // with the number of disks
  std::set<Colour> driven;
};

Colours colours_of(const Datbox& datbox) {
  Colours colours;
  for (const DatboxBody& body : datbox.bodies)
    for (const DatboxContactor& one : body.contactors) {
      const Colour colour{one.plank ? "JONCx" : "DISKx", one.colour};
      if (body.driven())
        colours.driven.insert(colour);
      else
        ++colours.free[colour];
    }
  return colours;
}

const DatboxSight& sight_of(const Datbox& datbox, const Colour& a, const Colour& b) {
  for (const DatboxSight& sight : datbox.sights) {
    const Colour candidate{sight.contactors[0], sight.colours[0]}, antagonist{sight.contactors[1], sight.colours[1]};
    if ((candidate == a && antagonist == b) || (candidate == b && antagonist == a)) return sight;
  }
  fail(
      "{}/TACT_BEHAV.DAT: expected a $seety for {} {} and {} {}, met none: all free disks touch each other and what is "
      "driven here",
      datbox.folder, a.first, a.second, b.first, b.second);
}

const DatboxLaw& law_of(const Datbox& datbox, const DatboxSight& sight) {
  const auto found = datbox.laws.find(sight.law);
  if (found == datbox.laws.end()) refuse(sight.place, "expected a law that is described, met '{}'", sight.law);
  const DatboxLaw& law = found->second;
  if (law.kind != "IQS_CLB" && law.kind != "RST_CLB")
    refuse(law.place, "expected law IQS_CLB or RST_CLB, met {}: others are not modelled", law.kind);
  if (law.kind == "RST_CLB" && !(law.restitution > 0))
    refuse(law.place, "rstn: expected a restitution above 0, or law IQS_CLB, met {}", law.restitution);
  return law;
}

// All contacts of one kind have one law here, and all contacts one restitution.
class Laws {
 public:
  void add(const DatboxSight& sight, const DatboxLaw& law, bool driven) {
    const DatboxLaw*& same = driven ? driven_ : free_;
    if (same == nullptr) same = &law;
    if (same->friction != law.friction)
      refuse(sight.place, "expected one friction between {}, {} as before, met {}",
             driven ? "free disks and driven bodies" : "free disks", same->friction, law.friction);
    const DatboxLaw& any = free_ != nullptr ? *free_ : *driven_;
    if (any.restitution != law.restitution || any.tangential_restitution != law.tangential_restitution)
      refuse(sight.place, "expected one restitution for all contacts, {} and {} as before, met {} and {}",
             any.restitution, any.tangential_restitution, law.restitution, law.tangential_restitution);
    alert_ = std::max(alert_, sight.alert);
  }
  Interaction interaction() const {
    const DatboxLaw none, &free = free_ != nullptr ? *free_ : driven_ != nullptr ? *driven_ : none;
    Interaction result;
    result.friction = free.friction;
    if (driven_ != nullptr && driven_->friction != free.friction) result.boundary_friction = driven_->friction;
    result.restitution = free.restitution;
    result.tangential_restitution = free.tangential_restitution;
    return result;
  }
  double alert() const { return alert_; }

 private:
  const DatboxLaw *free_ = nullptr, *driven_ = nullptr;
  double alert_ = 0;
};

Laws laws_of(const Datbox& datbox) {
  const Colours colours = colours_of(datbox);
  Laws laws;
  const auto add = [&](const Colour& a, const Colour& b, bool driven) {
    const DatboxSight& sight = sight_of(datbox, a, b);
    laws.add(sight, law_of(datbox, sight), driven);
  };
  for (auto a = colours.free.begin(); a != colours.free.end(); ++a) {
    for (auto b = a; b != colours.free.end(); ++b)
      if (a != b || a->second > 1) add(a->first, b->first, false);
    for (const Colour& driven : colours.driven) add(a->first, driven, true);
  }
  return laws;
}

double smallest_radius(const Packing& packing) { return *std::ranges::min_element(packing.radius); }

// What moves at the beginning, in the numbers of the packing. The linear study has no spins.
std::vector<PrescribedVelocity> moving_grains(const Datbox& datbox, DatboxDisks which) {
  std::vector<PrescribedVelocity> moving;
  for_each_disk(datbox, which, [&](const DatboxBody& body, const DatboxContactor&, Index number) {
    if (body.driven()) return;
    const auto& [vx, vy, spin] = body.velocity;
    if (spin != 0 && which == DatboxDisks::all)
      refuse(body.velocity_place, "V(3): expected disks that do not spin at the beginning, met {}", spin);
    if (vx != 0 || vy != 0) moving.push_back({number, {vx, vy}});
  });
  return moving;
}

// Without the slash that a shell adds.
std::string trimmed(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

std::string datbox_name(const std::string& path) {
  std::filesystem::path folder = std::filesystem::path(trimmed(path)).lexically_normal();
  if (folder.filename() == "DATBOX" && folder.has_parent_path()) folder = folder.parent_path();
  return folder.filename().string();
}

}  // namespace

Packing datbox_packing(const Datbox& datbox, DatboxDisks which) {
  Packing packing;
  for_each_disk(datbox, which, [&](const DatboxBody& body, const DatboxContactor& disk, Index) {
    if (!body.driven()) require_full_disk(body);
    const std::array<double, 2> place = place_of(body, disk);
    packing.x.push_back(place[0]);
    packing.y.push_back(place[1]);
    packing.radius.push_back(disk.radius);
    const double size = body.driven() ? disk.radius : body.average_radius;  // a driven mass has no effect
    packing.mass.push_back(density_of(datbox, body) * std::numbers::pi * size * size);
  });
  if (packing.size() == 0) fail("{}/BODIES.DAT: expected at least one disk, met none", datbox.folder);
  check(packing);
  return packing;
}

double gap_uncertainty(const Datbox& datbox) {
  double digit = 0, smallest = infinity;
  for_each_disk(datbox, DatboxDisks::free, [&](const DatboxBody& body, const DatboxContactor& disk, Index) {
    digit = std::max(digit, body.written_digit);
    smallest = std::min(smallest, disk.radius);
  });
  // Two places that are each off by `digit` along x and y, and two radii, which are smaller numbers.
  const double relative = (2 * std::numbers::sqrt2 + 2) * digit / smallest;
  if (!(relative > 0) || !std::isfinite(relative)) return relative > 0 ? relative : 0;
  const double unit = std::pow(10.0, std::floor(std::log10(relative)));
  return std::ceil(relative / unit) * unit;
}

Dynamics datbox_dynamics(const Datbox& datbox) {
  const Packing packing = datbox_packing(datbox, DatboxDisks::all);
  Dynamics dynamics;
  dynamics.boundaries = boundaries_of(datbox);
  const Laws laws = laws_of(datbox);
  dynamics.interaction = laws.interaction();
  dynamics.time.gravity = datbox.gravity;
  dynamics.time.alert = std::min(10.0, laws.alert() / smallest_radius(packing));
  if (dynamics.interaction.restitution == 0) dynamics.time.penetration_correction = 0;  // as IQS_CLB has it
  return dynamics;
}

CaseSpec case_of_datbox(const std::string& path, bool moving) {
  const Datbox datbox = read_datbox(path);
  CaseSpec spec;
  spec.name = datbox_name(path);
  spec.packing = PackingFile{trimmed(path)};
  const double uncertainty = gap_uncertainty(datbox);
  spec.contacts.tolerance = std::min(1.0, std::max(spec.contacts.tolerance, uncertainty));
  spec.contacts.overlap_tolerance = std::min(1.0, std::max(spec.contacts.overlap_tolerance, uncertainty));
  spec.prescribed = moving_grains(datbox, moving ? DatboxDisks::all : DatboxDisks::free);
  if (moving) spec.dynamics = datbox_dynamics(datbox);
  return spec;
}

}  // namespace nscdd
