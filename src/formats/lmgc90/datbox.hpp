// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include "study/case/case.hpp"

#include <filesystem>

/// Input of LMGC90 for rigid bodies in the plane or in space, a folder DATBOX of BODIES.DAT, BULK_BEHAV.DAT,
/// TACT_BEHAV.DAT, DRV_DOF.DAT and DOF.INI; of COMMAND.DAT the time step, theta and periods. Numbers have fixed columns
/// and 7 or 8 digits. Errors name file and line.
namespace nscdd {

struct DatboxPlace {
  std::string file;
  Index line = 0;
};

/// Throws Error with file and line.
template <class... Arguments>
[[noreturn]] void refuse(const DatboxPlace& place, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fail("{}:{}: {}", place.file, place.line, fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// A shape of a body.
struct DatboxContactor {
  /// JONCx, a plank with round ends, or PLANx in space; xKSID, a hollow disk; DNLYC, a hollow cylinder, or CYLND, a
  /// full one, about the third axis of the body. Empty: a disk DISKx or a sphere SPHER (DISKb, SPHEb in a cluster).
  std::string wall = {};
  double radius = 0;                 ///< m, of a disk, sphere or cylinder
  double length = 0, thickness = 0;  ///< m: half the length without round ends, half the thickness of a plank
  double width = 0;                  ///< m, of a plank in space: half its width
  double reach = 0;                  ///< m, of a POLYG or POLYR from its centre to the farthest vertex
  Eigen::Vector3d shift{0, 0, 0};    ///< m, of its centre from that of the body, in the axes of the body
  /// In space: its axes in those of the body.
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  double weight = 0;  ///< m^3, its volume; in the plane its area over pi, m^2. 0: without mass, or not known
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about its centre, along its axes, over mass / weight
  std::string colour = {};
  DatboxPlace place = {};

  bool cylinder() const { return wall == "DNLYC" || wall == "CYLND"; }
};

/// Prescribed velocity of a degree of freedom: [constant + amplitude cos(omega t + phase)] min(1, initial + rate t), or
/// a table of times and velocities (evolution), linear between its rows and beyond its ends.
struct DatboxDrive {
  double constant = 0, amplitude = 0, omega = 0, phase = 0, initial = 0, rate = 0;
  std::vector<std::array<double, 2>> table;  ///< at least two rows, times ascending; empty: the formula
  DatboxPlace place;

  /// Whether it is 0 at all times.
  bool none() const { return constant == 0 && amplitude == 0 && table.empty(); }
};

struct DatboxBody {
  Eigen::Vector3d position{0, 0, 0};  ///< at the beginning, m: x, y, and the angle (rad) or in space z
  Eigen::Vector3d velocity{0, 0, 0};  ///< m/s, and in the plane rad/s
  /// m; the mass is density x pi x average_radius^2, in space density x 4/3 pi x average_radius^3.
  double average_radius = 0, gyration_radius = 0;
  Eigen::Vector3d inertia{0, 0, 0};  ///< in space, over the density, m^5
  /// In space: the initial axes of the body as columns (the third normal to a plank), and its spin along them, rad/s.
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  Eigen::Vector3d spin{0, 0, 0};
  bool own_axes = false;     ///< of several contactors in space: computed principal axes, along which places are
  bool read_axes = false;    ///< DOF.INI has other axes than x, y and z
  double written_digit = 0;  ///< m, half of the last digit of its written place
  std::string bulk = {};     ///< name of its bulk law
  std::vector<DatboxContactor> contactors = {};           ///< at least one
  std::array<std::optional<DatboxDrive>, 6> drives = {};  ///< three in the plane
  std::array<std::optional<DatboxDrive>, 6> forces = {};  ///< N or N m
  DatboxPlace place = {};
  std::string unmodelled = {};  ///< the error about its first shape that no packing has; empty: none

  bool driven() const {
    return std::ranges::any_of(drives, [](const auto& drive) { return drive.has_value(); });
  }
  bool fully_driven(Index dimension) const {
    return std::all_of(drives.begin(), drives.begin() + (dimension == 2 ? 3 : 6), [](auto& one) { return one; });
  }
  Index grains() const { return std::ranges::count(contactors, "", &DatboxContactor::wall); }
  /// The place of the middle of one of its contactors at the beginning, m.
  Eigen::Vector3d place_of(const DatboxContactor& one, bool space) const;
};

/// A contact law: IQS_CLB, GAP_SGR_CLB, VEL_SGR_CLB or RST_CLB, or one of them with a static friction (_DS_CLB, here
/// without _DS), IQS_WET_DS_CLB, COUPLED_DOF, or another one, which contacts must not use.
struct DatboxLaw {
  std::string kind;
  double friction = 0, static_friction = 0;  ///< of contacts that slid in the last step, and of the others
  double restitution = 0, tangential_restitution = 0;
  double cohesion = 0, tangential_cohesion = 0;  ///< N
  double range = 0;                              ///< of cohesion, m
  DatboxPlace place;

  bool wet() const { return kind == "IQS_WET_DS_CLB"; }
  bool bond() const { return kind == "COUPLED_DOF"; }
  bool on_velocity() const { return kind == "RST_CLB" || kind == "VEL_SGR_CLB"; }
};

/// Contactors that see each other, and their law.
struct DatboxSight {
  /// Of candidate and antagonist; contactors are DISKx or SPHER, and those of walls.
  std::array<std::string, 2> contactors, colours;
  std::string law;
  double alert = 0;  ///< m
  DatboxPlace place;
  std::string of(std::size_t k, std::size_t colour) const { return contactors[k] + " " + colours[colour]; }
};

/// Bodies that come one by one: the first of them by its number from 1, and where.
struct DatboxSource {
  Index first = 1;
  GrainSource at;
  DatboxPlace place;
};

/// What COMMAND.DAT says, the command file of older versions; empty where it says nothing.
struct DatboxCommand {
  std::optional<double> step{}, theta{};                     ///< s
  std::optional<double> period_x{}, period_y{};              ///< m
  std::map<std::string, std::string, std::less<>> places{};  ///< as CaseSpec::places
  std::optional<DatboxSource> source{};
};

struct Datbox {
  std::string folder;
  Index dimension = 2;  ///< that of the first body: 2 for RBDY2, 3 for RBDY3
  std::vector<DatboxBody> bodies;
  std::map<std::string, double> density;         ///< kg/m^2 or kg/m^3, by bulk law
  std::optional<std::array<double, 3>> gravity;  ///< m/s^2
  std::map<std::string, DatboxLaw> laws;
  std::vector<DatboxSight> sights;
  DatboxCommand command{};
  double start = 0;                              ///< s, time of DOF.INI and origin of the time of drives
  std::map<std::string, std::string> remarks{};  ///< on data that are not used, see CaseSpec
  std::optional<double> mean_step{};  ///< s, of the steps before DOF.INI: the time step where COMMAND.DAT has none

  bool space() const { return dimension == 3; }
  const char* grain() const { return space() ? "SPHER" : "DISKx"; }
};

/// The text of each file; empty if it does not exist.
struct DatboxTexts {
  std::string bodies, bulk, tact, driven, initial, command{};
  std::function<std::string(const std::string& name)> table{};  ///< the text of a table that DRV_DOF.DAT names
};

/// Which bodies are read.
enum class DatboxShapes {
  modelled,  ///< of the shapes of packings: disks, spheres, planks and cylinders
  any,       ///< of all shapes; DatboxBody::unmodelled has the error that `modelled` throws
};

/// Reads the files by columns, as LMGC90 does. `folder` precedes the names of files in errors. Throws Error for bodies
/// other than RBDY2 or RBDY3, bodies of both, other shapes, several nodes or bulk elements in a body, and for all that
/// LMGC90 could not read or would read as another number.
Datbox parse_datbox(const DatboxTexts& texts, const std::string& folder, DatboxShapes = DatboxShapes::modelled);

/// Whether a path is a folder with BODIES.DAT in it or in DATBOX, or a record, whose folder is that of datbox_beside.
bool holds_datbox(const std::string& path);

/// The folder of such a path.
std::filesystem::path datbox_folder(const std::string& path);

/// The existing files of such a folder.
std::vector<std::string> datbox_files(const std::string& path);

/// The folder of a file that has BODIES.DAT, else its subfolder DATBOX if that has it, else ../DATBOX.
std::string datbox_beside(const std::string& file);

/// Reads such a folder, with the state in `initial`, or if that is empty in the record, or in its DOF.INI. Throws Error
/// as parse_datbox, and for files that cannot be read.
Datbox read_datbox(const std::string& path, DatboxShapes = DatboxShapes::modelled, const std::string& initial = {});

/// Throws Error if its bulk law has none.
double density_of(const Datbox& datbox, const DatboxBody& body);

enum class DatboxGrains {
  all,   ///< of a case that moves: driven grains form boundaries
  free,  ///< of the linear study
};

/// The disks or spheres in the order of the files, with masses and half of the last digit of their places. Throws Error
/// without grains and, for `free`, for free bodies other than full disks and spheres.
Packing datbox_packing(const Datbox& datbox, DatboxGrains which);

/// The packing of a folder as a case with prescribed initial velocities. `moving`: also laws, gravity and boundaries,
/// see boundaries_of_datbox, and time step, theta and periods of COMMAND.DAT. Throws Error as
/// datbox_packing and, if `moving`, for all else that is not modelled (docs/formats.md). A folder with other shapes
/// whose Vloc_Rloc.INI has contacts is a contact problem, unless `moving`.
CaseSpec case_of_datbox(const std::string& path, bool moving);

/// Whether a body is a grain of the packing of a case that moves: free, without forces, one full disk or sphere.
bool is_free_grain(const DatboxBody& body, bool space);

/// Throws Error if the order of its principal axes matters and is in no file. That may be so of a body of several
/// contactors in space without I1 to I3.
void require_known_axes(const DatboxBody& body);

/// All other bodies, with a part for each further shape. `coloured`: they get the colour of their walls, which is one,
/// or else that of their first grain.
std::vector<BoundarySpec> boundaries_of_datbox(const Datbox& datbox, bool coloured);

/// The first rule by which contactors such as "DISKx BLEUx" see each other, colours in either order; null if none does.
const DatboxSight* sight_of(const Datbox& datbox, const std::string& a, const std::string& b);

/// Throws Error at `place` for a law that is not described, and for other laws than those of DatboxLaw.
const DatboxLaw& law_named(const Datbox& datbox, const std::string& name, const DatboxPlace& place);

/// Its laws, gravity and boundaries.
Dynamics datbox_dynamics(const Datbox& datbox);

/// Sets, in default `dynamics`, the interaction, the correction of overlaps, the pairs of colours (colour_of) that have
/// other laws or do not see each other and the colours of grains, if any. Returns the largest distance at which bodies
/// see each other, m. Throws Error if laws differ in their Signorini condition, or if one is not of DatboxLaw.
double set_contact_laws(const Datbox& datbox, Dynamics& dynamics);

/// Kind and colour of a contactor, such as "DISKx BLEUx"; that of disks and spheres of clusters is DISKx or SPHER.
std::string colour_of(const Datbox& datbox, const DatboxContactor& contactor);

}  // namespace nscdd
