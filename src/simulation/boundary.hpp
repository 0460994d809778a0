// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/granular_system.hpp"
#include <nscdd/core/choice.hpp>

namespace nscdd {

enum class BoundaryShape {
  wall,      ///< in the plane the straight line through `from` and `to`, grains on its left; in space a plane
  disks,     ///< a row of disks in the plane from `from` to `to`, both ends included
  grains,    ///< grains first ... last of the packing, driven as one rigid body
  cylinder,  ///< about the axis through `from` and `to`, in the plane a circle about `from`
  /// All points within `radius` of the segment from `from` to `to`, or in space of a rectangle, grains all around.
  plank,
};
constexpr auto names_of(BoundaryShape) {
  return std::to_array<std::string_view>({"wall", "disks", "grains", "cylinder", "plank"});
}

/// The side of a cylinder that has the grains.
enum class CylinderSide { inside, outside };
constexpr auto names_of(CylinderSide) { return std::to_array<std::string_view>({"inside", "outside"}); }

/// A boundary as a case file describes it ([[boundary]]).
struct BoundarySpec {
  std::string name;
  bool part = false;  ///< another shape of the boundary of this name, which is before it and has the other keys
  Choice<BoundaryShape> shape = BoundaryShape::wall;
  Index dimension = 0;                               ///< of its vectors: 2, 3, or 0 if it has none
  std::array<double, 3> from{0, 0, 0}, to{1, 0, 0};  ///< m, disks, cylinder, plank, and a wall in the plane
  std::array<double, 3> point{0, 0, 0};              ///< m, of a wall in space; of a plank its middle
  std::array<double, 3> normal{0, 0, 1};             ///< of a wall in space, towards its grains, of any length
  std::array<double, 3> axis{1, 0, 0};               ///< of a plank in space, along its length, across `normal`
  double length = 0, width = 0;  ///< m, of the rectangle of a plank in space, along and across `axis`
  double radius = 0;             ///< m, disks and cylinder; of a plank half its thickness
  Choice<CylinderSide> side = CylinderSide::inside;  ///< of a cylinder
  bool ends = false;               ///< of a cylinder in space with grains outside: `from` and `to` are its flat ends
  double spacing = 0;              ///< m, largest distance of neighbouring centres, disks; 0: they touch (two radii)
  Index first = 0, last = -1;      ///< grains; negative from the end
  std::vector<Index> grains = {};  ///< in place of first ... last where they are not neighbours
  Motion motion;
  Choice<Orientation> orientation = Orientation::turning;  ///< disks and grains
  std::string colour = {};                                 ///< see ContactPairs
  std::optional<FreeBody> body = {};                       ///< if it moves freely along some directions
  std::optional<GrainSource> source = {};                  ///< if it releases its grains

  /// Largest distance of neighbouring centres, m.
  double distance() const { return spacing > 0 ? spacing : 2 * radius; }
  /// The reference point of its motion if a case file has none.
  Place default_centre() const { return shape == BoundaryShape::cylinder ? from : Place{0, 0, 0}; }
};

/// Throws Error naming the boundary if a wall, an axis or a row of disks has no extent or a row has too many disks.
void check(const BoundarySpec& spec);

/// Keys of a function of time in a case file: its constant value, its table, and its oscillations.
struct FunctionKeys {
  const char *linear, *angular, *table, *oscillation;
};
inline constexpr FunctionKeys keys_of_motion{"velocity", "spin", "motion", "oscillation"};
inline constexpr FunctionKeys keys_of_load{"force", "torque", "load", "load_oscillation"};

/// Numbers of the grains of a packing that boundary number `boundary`, of shape grains, has. Throws Error with its key
/// if the packing has no such grains or one is named twice.
std::vector<Index> grains_of(const BoundarySpec& spec, Index boundary, Index grains);

/// The number of disks in a row; 0 for another shape.
Index disks_in(const BoundarySpec& spec);

/// Adds a boundary, the `number`th of a case, to a system whose first `grains` are those of a packing; disks of the
/// boundary come last, with their centres in x and y. Throws Error as scene.
void add_boundary(GranularSystem& system, std::vector<double>& x, std::vector<double>& y, const BoundarySpec& spec,
                  Index number, Index grains);

/// Its lines in a case file.
std::string to_toml(const BoundarySpec& spec);

}  // namespace nscdd
