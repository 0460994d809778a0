// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/csv.hpp"
#include "formats/lmgc90/datbox.hpp"
#include "formats/lmgc90/fixed_columns.hpp"

#include <filesystem>
#include <numbers>
#include <set>

namespace nscdd {
namespace {

// Half of the seventh digit of a number as it is written: 0.1234567D+01.
double half_digit(double value) {
  return value == 0 ? 0 : 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - 7);
}

double positive(const FixedColumns& lines, std::size_t first, std::string_view what) {
  const double value = lines.number(first, what);
  if (!(value > 0)) lines.refuse(fmt::format("{}: expected a number above 0", what), fmt::format("{}", value));
  return value;
}

const char* body_kind(Index dimension) { return dimension == 2 ? "RBDY2" : "RBDY3"; }

// Three numbers of a line, called such as coo1, coo2, coo3.
std::array<double, 3> three(const FixedColumns& lines, const char* name, bool blank = false) {
  const auto one = [&](std::size_t column, int number) {
    return lines.number(column, fmt::format("{}{}", name, number), blank);
  };
  return {one(35, 1), one(56, 2), one(77, 3)};
}

Eigen::Vector3d column(const FixedColumns& lines, const char* name) {
  const auto [x, y, z] = three(lines, name);
  return {x, y, z};
}

void read_bulk_element(FixedColumns& lines, DatboxBody& body, Index dimension) {
  if (lines.text(2, 6) != "PLAIN") lines.refuse("expected the bulk element PLAIN", lines.text(2, 6));
  body.bulk = lines.text(23, 27);
  body.average_radius = lines.number(35, "avrd", true);
  if (dimension == 2) body.gyration_radius = lines.number(56, "gyrd", true);
}

void read_node(FixedColumns& lines, DatboxBody& body, Index dimension) {
  const char* kind = dimension == 2 ? "NO3xx" : "NO6xx";
  if (lines.text(2, 6) != kind)
    lines.refuse(fmt::format("expected the node {} of a rigid body", kind), lines.text(2, 6));
  body.position = {lines.number(35, "coo1"), lines.number(56, "coo2"), lines.number(77, "coo3", dimension == 2)};
  body.written_digit = std::max(half_digit(body.position[0]), half_digit(body.position[1]));
  if (dimension == 3) body.written_digit = std::max(body.written_digit, half_digit(body.position[2]));
}

// The axes of a body may lie askew by their seven digits, and no more.
void require_frame(const DatboxBody& body, const DatboxPlace& place) {
  const Eigen::Matrix3d rest = body.frame.transpose() * body.frame - Eigen::Matrix3d::Identity();
  if (!(rest.cwiseAbs().maxCoeff() < 1e-5) || !(body.frame.determinant() > 0))
    fail("{}:{}: expected three axes of a body that are unit, orthogonal and right-handed, met others", place.file,
         place.line);
}

// "localframe" behind a PLANx: its axes, and how far its centre is from the node.
void read_frame(FixedColumns& lines, DatboxBody& body) {
  const DatboxPlace place = lines.place();
  Index k = 0;
  for (const char* name : {"alp", "bet", "gam"}) {
    lines.require_next("the axes of the frame");
    body.frame.col(k++) = column(lines, name);
  }
  require_frame(body, place);
  lines.require_next("the shift of the frame");
  const std::array<double, 3> shift = three(lines, "coo");
  for (std::size_t i = 0; i < 3; ++i) body.position[i] += shift[i];
}

DatboxContactor read_contactor_in_space(FixedColumns& lines) {
  const std::string kind(lines.text(2, 6));
  DatboxContactor contactor{.colour = std::string(lines.text(23, 27)), .place = lines.place()};
  if (kind == "PLANx") {
    contactor.plank = true;
    contactor.length = positive(lines, 35, "axe1");
    contactor.width = positive(lines, 56, "axe2");
    contactor.thickness = positive(lines, 77, "axe3");
  } else if (kind == "SPHER") {
    contactor.radius = positive(lines, 35, "byrd");
  } else {
    lines.refuse("expected contactors SPHER or PLANx: other shapes are not modelled", kind);
  }
  return contactor;
}

DatboxContactor read_contactor(FixedColumns& lines) {
  const std::string kind(lines.text(2, 6));
  DatboxContactor contactor{.colour = std::string(lines.text(23, 27)), .place = lines.place()};
  if (kind == "JONCx") {
    contactor.plank = true;
    contactor.length = positive(lines, 35, "ax1");
    contactor.thickness = positive(lines, 56, "ax2");
  } else if (kind == "DISKx" || kind == "DISKb") {
    contactor.radius = positive(lines, 35, "byrd");
    if (kind == "DISKb") {
      lines.require_next("a line with the place of the disk DISKb");
      contactor.shift = {lines.number(35, "coo1"), lines.number(56, "coo2")};
    }
  } else {
    lines.refuse("expected contactors DISKx, DISKb or JONCx: other shapes are not modelled", kind);
  }
  return contactor;
}

// LMGC90 works out what BODIES.DAT leaves at 0: the centre of a body of several contactors, weighted by their areas,
// and its radii. A plank is never free here, so that its own radii have no effect.
void complete(DatboxBody& body, Index dimension) {
  if (dimension == 3) {
    const double radius = body.contactors[0].radius, volume = 4.0 / 3 * std::numbers::pi * radius * radius * radius;
    if (body.average_radius == 0) body.average_radius = radius;
    if (body.inertia == std::array<double, 3>{}) body.inertia.fill(0.4 * radius * radius * volume);
    return;
  }
  if (body.contactors.size() > 1 && body.position == std::array<double, 3>{}) {
    double area = 0;
    std::array<double, 2> centre{};
    for (const DatboxContactor& one : body.contactors) {
      area += one.radius * one.radius;
      for (std::size_t k = 0; k < 2; ++k) centre[k] += one.radius * one.radius * one.shift[k];
    }
    for (std::size_t k = 0; k < 2; ++k) body.position[k] = centre[k] / area;
    for (DatboxContactor& one : body.contactors)
      for (std::size_t k = 0; k < 2; ++k) one.shift[k] -= body.position[k];
  }
  if (body.contactors.size() == 1 && (body.average_radius == 0 || body.gyration_radius == 0)) {
    body.average_radius = body.contactors[0].radius;
    body.gyration_radius = body.contactors[0].radius / std::numbers::sqrt2;
  }
}

// What stands on one line, but for the inertia of a body in space, the rest of its node and the frame of a plank.
void read_line(FixedColumns& lines, const std::string& section, Index dimension, std::map<std::string, int>& met,
               DatboxBody& body) {
  const bool space = dimension == 3, again = ++met[section] > 1;
  if (section == "$blmty" && !again)
    read_bulk_element(lines, body, dimension);
  else if (section == "$blmty" && space && met[section] == 2 && lines.text(30, 31) == "I1")
    body.inertia = three(lines, "I");
  else if (section == "$nodty" && !again)
    read_node(lines, body, dimension);
  else if (section == "$nodty" && space && met[section] == 2)
    return;  // coo4 to coo6, which LMGC90 sets to 0
  else if (section == "$tacty" && space && again && lines.text(30, 39) == "localframe" && body.plank())
    read_frame(lines, body);
  else if (section == "$tacty")
    body.contactors.push_back(space ? read_contactor_in_space(lines) : read_contactor(lines));
  else
    lines.refuse(fmt::format("section {}: expected one line", section), "another");
}

// The first body says the dimension. LMGC90 does not read the number of a body here: it counts.
DatboxBody read_body(FixedColumns& lines, Index& dimension, bool first) {
  lines.require_next("a body");
  DatboxBody body;
  body.place = body.velocity_place = lines.place();
  if (first && lines.text(2, 6) == "RBDY3") dimension = 3;
  if (lines.text(2, 6) != body_kind(dimension))
    lines.refuse(first ? "expected rigid bodies (RBDY2 in the plane, RBDY3 in space)"
                       : fmt::format("expected {} as the bodies before", body_kind(dimension)),
                 lines.text(2, 6));
  std::map<std::string, int> seen;  // lines of each section
  lines.next();
  while (lines.section() && !lines.key().empty() && lines.key() != "$$$$$$" && lines.key() != "$bdyty") {
    const std::string section(lines.key());
    while (lines.next() && !lines.section()) read_line(lines, section, dimension, seen, body);
  }
  const auto refuse = [&](std::string_view expected, std::string_view met) {
    fail("{}:{}: {}, met {}", body.place.file, body.place.line, expected, met);
  };
  if (lines.key() != "$$$$$$") refuse("expected a body that ends with $$$$$$", "one that does not");
  if (seen["$blmty"] == 0 || seen["$nodty"] == 0)
    refuse("expected a body with a bulk element and a node", "one without");
  if (body.contactors.empty()) refuse("expected a body with a contactor", "one without");
  if (dimension == 3 && body.contactors.size() > 1)
    refuse("expected a body in space with one contactor",
           fmt::format("one with {}: not modelled", body.contactors.size()));
  if (body.contactors.size() > 1)
    for (const DatboxContactor& one : body.contactors)
      if (one.plank) refuse("expected a plank JONCx alone in its body", "one with other contactors");
  complete(body, dimension);
  return body;
}

// The body that a record of DRV_DOF.DAT or DOF.INI is about, by its number from 1. `met`: the numbers of the file so
// far.
DatboxBody& numbered_body(FixedColumns& lines, Datbox& datbox, std::set<Index>& met) {
  std::vector<DatboxBody>& bodies = datbox.bodies;
  const char* kind = body_kind(datbox.dimension);
  lines.require_next("a body");
  if (lines.text(2, 6) != kind) lines.refuse(fmt::format("expected {}", kind), lines.text(2, 6));
  const Index number = lines.integer(9, 15, "number of the body");
  if (number < 1 || number > count(bodies))
    lines.refuse(fmt::format("expected one of the {} bodies of BODIES.DAT", bodies.size()), std::to_string(number));
  if (!met.insert(number).second) lines.refuse("expected each body once", fmt::format("body {} again", number));
  return bodies[at(number - 1)];
}

// "evolution NAME": a file beside DRV_DOF.DAT, of a time and a velocity in each line, in words.
void read_table(const FixedColumns& lines, const DatboxTexts& texts, const std::string& folder, DatboxDrive& drive) {
  const std::string name(lines.text(25, 64));
  if (name.empty() || std::filesystem::path(name).filename() != name || name == "." || name == "..")
    lines.refuse("evolution: expected the name of a file beside DRV_DOF.DAT in columns 25 to 64", "'" + name + "'");
  if (!texts.table) lines.refuse("evolution: expected a file", "'" + name + "', which cannot be read here");
  const std::string text = texts.table(name);
  const DatboxPlace file{(std::filesystem::path(folder) / name).string(), 0};
  FixedColumns rows(text, file.file);
  constexpr std::size_t whole = 1'000'000;
  while (rows.next()) {
    std::array<double, 2> row{};
    std::string_view rest = rows.text(1, whole);
    for (double& value : row) {
      const auto end = std::min(rest.find_first_of(" \t,"), rest.size());
      value = rows.number_in(rest.substr(0, end), "a time and a velocity");
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t,", end), rest.size()));
    }
    if (!drive.table.empty() && !(row[0] > drive.table.back()[0]))
      rows.refuse("expected times that ascend", fmt::format("{}", row[0]));
    drive.table.push_back(row);
  }
  if (drive.table.size() < 2) fail("{}: expected at least two rows, met {}", file.file, drive.table.size());
}

void read_drives(FixedColumns lines, Datbox& datbox, const DatboxTexts& texts, const std::string& folder) {
  const Index most = datbox.dimension == 2 ? 3 : 6;
  std::set<Index> met;
  while (lines.find("$bdyty")) {
    DatboxBody& body = numbered_body(lines, datbox, met);
    while (lines.next() && lines.key() != "$$$$$$") {
      if (lines.section() || lines.text(2, 3) == "NO") continue;
      const std::string_view kind = lines.text(2, 6);
      if (kind != "vlocy" && kind != "force") lines.refuse("expected vlocy or force", kind);
      if (kind == "force") {
        body.force = lines.place();
        continue;
      }
      const Index dof = lines.integer(9, 13, "degree of freedom");
      if (dof < 1 || dof > most)
        lines.refuse(fmt::format("expected a degree of freedom 1, 2 {}", most == 3 ? "or 3" : "... 6"),
                     std::to_string(dof));
      DatboxDrive& drive = body.drives[at(dof - 1)].emplace();
      drive.place = lines.place();
      if (lines.text(15, 23) == "evolution") {
        read_table(lines, texts, folder, drive);
        continue;
      }
      for (const auto& [value, column, name] : {std::tuple(&DatboxDrive::constant, 15, "CT"),
                                                {&DatboxDrive::amplitude, 30, "AMP"},
                                                {&DatboxDrive::omega, 45, "OMEGA"},
                                                {&DatboxDrive::phase, 60, "PHI"},
                                                {&DatboxDrive::initial, 75, "RAMPI"},
                                                {&DatboxDrive::rate, 90, "RAMP"}})
        drive.*value = lines.number(static_cast<std::size_t>(column), name);
    }
  }
}

void read_initial(FixedColumns lines, Datbox& datbox) {
  std::set<Index> met;
  while (lines.next()) {
    if (lines.key() == "$steps") datbox.start = lines.number(35, "time");
    if (lines.key() != "$bdyty") continue;
    DatboxBody& body = numbered_body(lines, datbox, met);
    const bool space = datbox.dimension == 3;
    while (lines.next() && lines.key() != "$nodty")
      if (lines.key() == "$bdyty" || lines.key() == "$$$$$$") break;
    if (lines.key() != "$nodty") lines.refuse("expected a section $nodty of the body", "none");
    lines.require_next("displacements X");
    const std::array<double, 3> moved{lines.number(35, "X(1)"), lines.number(56, "X(2)"), lines.number(77, "X(3)")};
    for (std::size_t k = 0; k < 3; ++k) body.position[k] += moved[k];
    const double digit = std::max(half_digit(moved[0]), half_digit(moved[1]));
    body.written_digit += space ? std::max(digit, half_digit(moved[2])) : digit;
    if (space) lines.require_next("displacements X(4) to X(6)");  // which LMGC90 has at 0
    lines.require_next("velocities V");
    body.velocity = {lines.number(35, "V(1)"), lines.number(56, "V(2)"), lines.number(77, "V(3)")};
    body.velocity_place = lines.place();
    if (!space) continue;
    lines.require_next("velocities V(4) to V(6)");
    body.spin = {lines.number(35, "V(4)"), lines.number(56, "V(5)"), lines.number(77, "V(6)")};
    for (Index k = 0; k < 3; ++k) {
      lines.require_next("the axes of the body");
      body.frame.col(k) = column(lines, "axis ");
    }
    require_frame(body, lines.place());
  }
}

void read_bulk(FixedColumns lines, Datbox& datbox) {
  while (lines.next()) {
    const std::string section(lines.key());
    if (section == "$gravy") {
      lines.require_next("the acceleration of gravity");
      datbox.gravity = {lines.number(25, "grv1"), lines.number(46, "grv2"),
                        datbox.dimension == 3 ? lines.number(67, "grv3") : 0};
    } else if (section == "$behav") {
      lines.require_next("a bulk law");
      if (lines.text(9, 38) == "RIGID") datbox.density[std::string(lines.text(2, 6))] = positive(lines, 46, "Umas");
    }
  }
}

DatboxLaw read_law(FixedColumns& lines) {
  DatboxLaw law{.kind = std::string(lines.text(9, 38)), .place = lines.place()};
  if (law.kind == "IQS_CLB") {
    law.friction = lines.number(46, "fric");
  } else if (law.kind == "RST_CLB") {
    law.restitution = lines.number(46, "rstn");
    law.tangential_restitution = lines.number(67, "rstt");
    lines.require_next("the friction of RST_CLB");
    law.friction = lines.number(46, "fric");
  }
  return law;
}

void read_tact(FixedColumns lines, Datbox& datbox) {
  while (lines.next()) {
    const std::string section(lines.key());
    if (section == "$behav") {
      lines.require_next("a contact law");
      const std::string name(lines.text(2, 6));
      if (datbox.laws.contains(name)) lines.refuse("expected each law once", fmt::format("'{}' again", name));
      datbox.laws.emplace(name, read_law(lines));
    } else if (section == "$seety") {
      lines.require_next("the names of columns");
      lines.require_next("two contactors and their law");
      datbox.sights.push_back({{std::string(lines.text(9, 13)), std::string(lines.text(37, 41))},
                               {std::string(lines.text(16, 20)), std::string(lines.text(44, 48))},
                               std::string(lines.text(23, 27)),
                               lines.number(55, "alert"),
                               lines.place()});
    }
  }
}

std::filesystem::path datbox_folder(const std::string& path) {
  const std::filesystem::path folder(path);
  std::error_code ignored;
  return std::filesystem::is_regular_file(folder / "BODIES.DAT", ignored) ? folder : folder / "DATBOX";
}

}  // namespace

Datbox parse_datbox(const DatboxTexts& texts, const std::string& folder) {
  const auto lines = [&](const std::string& text, const char* name) {
    return FixedColumns(text, (std::filesystem::path(folder) / name).string());
  };
  Datbox datbox;
  datbox.folder = folder;
  for (FixedColumns bodies = lines(texts.bodies, "BODIES.DAT"); bodies.find("$bdyty");)
    datbox.bodies.push_back(read_body(bodies, datbox.dimension, datbox.bodies.empty()));
  read_drives(lines(texts.driven, "DRV_DOF.DAT"), datbox, texts, folder);
  read_initial(lines(texts.initial, "DOF.INI"), datbox);
  read_bulk(lines(texts.bulk, "BULK_BEHAV.DAT"), datbox);
  read_tact(lines(texts.tact, "TACT_BEHAV.DAT"), datbox);
  return datbox;
}

bool holds_datbox(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) &&
         std::filesystem::is_regular_file(datbox_folder(path) / "BODIES.DAT", ignored);
}

std::vector<std::string> datbox_files(const std::string& path) {
  std::vector<std::string> files;
  for (const char* name : {"BODIES.DAT", "BULK_BEHAV.DAT", "TACT_BEHAV.DAT", "DRV_DOF.DAT", "DOF.INI"}) {
    const std::filesystem::path file = datbox_folder(path) / name;
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) files.push_back(file.string());
  }
  return files;
}

Datbox read_datbox(const std::string& path) {
  const std::filesystem::path folder = datbox_folder(path);
  const auto text = [&](const char* name, bool required) {
    const std::filesystem::path file = folder / name;
    std::error_code ignored;
    return required || std::filesystem::exists(file, ignored) ? read_text(file.string()) : std::string();
  };
  return parse_datbox({text("BODIES.DAT", true), text("BULK_BEHAV.DAT", true), text("TACT_BEHAV.DAT", false),
                       text("DRV_DOF.DAT", false), text("DOF.INI", false),
                       [&](const std::string& name) { return text(name.c_str(), true); }},
                      folder.string());
}

}  // namespace nscdd
