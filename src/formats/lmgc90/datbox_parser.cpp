// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/csv.hpp"
#include "formats/lmgc90/datbox_body.hpp"
#include "formats/lmgc90/record.hpp"

#include <set>

namespace nscdd {
namespace {

// The body of a record of DRV_DOF.DAT or DOF.INI, by its number from 1. `met`: the numbers so far.
DatboxBody& numbered_body(FixedColumns& lines, Datbox& datbox, std::set<Index>& met) {
  std::vector<DatboxBody>& bodies = datbox.bodies;
  const char* kind = datbox_body_kind(datbox.dimension);
  lines.require_next("a body");
  if (lines.text(2, 6) != kind) lines.refuse(fmt::format("expected {}", kind), lines.text(2, 6));
  const Index number = lines.integer(9, 15, "number of the body");
  if (number < 1 || number > count(bodies))
    lines.refuse(fmt::format("expected one of the {} bodies of BODIES.DAT", bodies.size()), std::to_string(number));
  if (!met.insert(number).second) lines.refuse("expected each body once", fmt::format("body {} again", number));
  return bodies[at(number - 1)];
}

// "evolution NAME": a file beside DRV_DOF.DAT with a time and a velocity in each line, not in fixed columns.
void read_table(const FixedColumns& lines, const DatboxTexts& texts, const std::string& folder, DatboxDrive& drive) {
  const std::string name(lines.text(25, 64));
  if (name.empty() || fs::path(name).filename() != name || name == "." || name == "..")
    lines.refuse("evolution: expected the name of a file beside DRV_DOF.DAT in columns 25 to 64", "'" + name + "'");
  if (!texts.table) lines.refuse("evolution: expected a file", "'" + name + "', which cannot be read here");
  const std::string text = texts.table(name);
  const std::string file = (fs::path(folder) / name).string();
  FixedColumns rows(text, file);
  while (rows.next()) {
    std::array<double, 2> row{};
    std::string_view rest = rows.line();
    for (double& value : row) {
      const auto end = std::min(rest.find_first_of(" \t,"), rest.size());
      value = rows.number_in(rest.substr(0, end), "a time and a velocity");
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t,", end), rest.size()));
    }
    if (!drive.table.empty() && !(row[0] > drive.table.back()[0]))
      rows.refuse("expected times that ascend", fmt::format("{}", row[0]));
    drive.table.push_back(row);
  }
  if (drive.table.size() < 2) fail("{}: expected at least two rows, met {}", file, drive.table.size());
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
      const Index dof = lines.integer(9, 13, "degree of freedom");
      if (dof < 1 || dof > most)
        lines.refuse(fmt::format("expected a degree of freedom 1, 2 {}", most == 3 ? "or 3" : "... 6"),
                     std::to_string(dof));
      auto& slot = (kind == "force" ? body.forces : body.drives)[at(dof - 1)];
      if (slot) lines.refuse("expected each degree of freedom of a body once", fmt::format("{} {} again", kind, dof));
      DatboxDrive& drive = slot.emplace();
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
        if (column <= 30 || drive.constant != 0 || drive.amplitude != 0)  // else the rest has no effect
          drive.*value = lines.number(static_cast<std::size_t>(column), name);
    }
  }
}

void read_initial(FixedColumns lines, Datbox& datbox) {
  std::set<Index> met;
  while (lines.next()) {
    if (lines.key() == "$steps") {
      datbox.start = lines.number(35, "time");
      const Index steps = lines.integer(7, 16, "$steps");
      if (steps > 0 && datbox.start > 0) datbox.mean_step = datbox.start / static_cast<double>(steps);
    }
    if (lines.key() != "$bdyty") continue;
    DatboxBody& body = numbered_body(lines, datbox, met);
    while (lines.next() && lines.key() != "$nodty")
      if (lines.key() == "$bdyty" || lines.key() == "$$$$$$") break;
    if (lines.key() != "$nodty") lines.refuse("expected a section $nodty of the body", "none");
    lines.require_next("displacements X");
    const Eigen::Vector3d moved = lines.three_numbers("X({})");
    body.position += moved;
    body.written_digit += half_digit(moved, datbox.dimension);
    if (datbox.space()) lines.require_next("displacements X(4) to X(6)");  // always 0 in LMGC90
    lines.require_next("velocities V");
    body.velocity = lines.three_numbers("V({})");
    if (!datbox.space()) continue;
    lines.require_next("velocities V(4) to V(6)");
    body.spin = {lines.number(35, "V(4)"), lines.number(56, "V(5)"), lines.number(77, "V(6)")};
    Eigen::Matrix3d axes;
    for (Index k = 0; k < 3; ++k) {
      lines.require_next("the axes of the body");
      axes.col(k) = lines.three_numbers("axis {}");
    }
    set_axes(body, axes, lines.place());
  }
}

void read_bulk(FixedColumns lines, Datbox& datbox) {
  std::set<std::string> met;  // LMGC90 takes the first of two
  const auto require_first = [&](const std::string& name, std::string_view expected) {
    if (!met.insert(name).second) lines.refuse(expected, fmt::format("'{}' again", name));
  };
  while (lines.next()) {
    const std::string section(lines.key());
    if (section == "$gravy") {
      require_first("$gravy", "expected gravity once");
      lines.require_next("the acceleration of gravity");
      datbox.gravity = {lines.number(25, "grv1"), lines.number(46, "grv2"),
                        datbox.space() ? lines.number(67, "grv3") : 0};
    } else if (section == "$behav") {
      lines.require_next("a bulk law");
      const std::string name(lines.text(2, 6));
      require_first(name, "expected each bulk law once");
      const std::string kind(lines.text(9, 38));
      if (!kind.ends_with("RIGID")) continue;
      datbox.density[name] = lines.positive_number(46, "Umas");
      if (kind != "RIGID")
        datbox.remarks[name] = fmt::format("BULK_BEHAV.DAT: of {} '{}' only the density is used", kind, name);
    }
  }
}

// Laws that have a twin X_DS_CLB with a static friction.
constexpr std::array<std::string_view, 4> laws_without_cohesion{"IQS_CLB", "GAP_SGR_CLB", "VEL_SGR_CLB", "RST_CLB"};

DatboxLaw read_law(FixedColumns& lines) {
  constexpr double largest_friction = 100, largest_force = 1e100;  // as in [interaction]
  DatboxLaw law{.kind = std::string(lines.text(9, 38)), .place = lines.place()};
  std::string twin = law.kind;
  if (const std::size_t found = twin.find("_DS_CLB"); found != std::string::npos) twin.erase(found, 3);
  const bool plain = std::ranges::count(laws_without_cohesion, twin) > 0;
  const auto read_frictions = [&](bool two) {  // older files call two of them dyfr and stfr
    law.friction = lines.number_within(46, two ? "dfrc" : "fric", largest_friction);
    law.static_friction = two ? lines.number_within(67, "sfrc", largest_friction) : law.friction;
  };
  if (plain) {
    const bool two = twin != std::exchange(law.kind, twin);
    if (law.kind == "RST_CLB") {
      law.restitution = lines.number_within(46, "rstn", 1);
      law.tangential_restitution = lines.number_within(67, "rstt", 1);
      lines.require_next("the friction of RST_CLB");
    }
    read_frictions(two);
  } else if (law.wet() && lines.text(62, 65) == "coht") {  // others have the three lines of another version
    law.cohesion = lines.number_within(46, "cohn", largest_force);
    law.tangential_cohesion = lines.number_within(67, "coht", largest_force);
    lines.require_next("the range of IQS_WET_DS_CLB");
    law.range = lines.number_within(46, "Weth", infinity);
    lines.require_next("the friction of IQS_WET_DS_CLB");
    read_frictions(true);
  } else if (law.wet()) {
    law.kind += " without coht";
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
      const DatboxSight sight{{std::string(lines.text(9, 13)), std::string(lines.text(37, 41))},
                              {std::string(lines.text(16, 20)), std::string(lines.text(44, 48))},
                              std::string(lines.text(23, 27)),
                              lines.number_within(55, "alert", 1e100),
                              lines.place()};
      if (const DatboxSight* other = sight_of(datbox, sight.of(0, 0), sight.of(1, 1)); other && other->law != sight.law)
        lines.refuse("expected one law for two contactors", fmt::format("'{}' beside '{}'", sight.law, other->law));
      datbox.sights.push_back(sight);
    }
  }
}

}  // namespace

fs::path datbox_folder(const std::string& path) {
  if (const auto record = record_at(path)) return datbox_beside(record->file);
  return is_file(fs::path(path) / "BODIES.DAT") ? fs::path(path) : fs::path(path) / "DATBOX";
}

std::string datbox_beside(const std::string& file) {
  const fs::path own = fs::path(file).parent_path();
  for (const char* folder : {"", "DATBOX"})
    if (is_file(own / folder / "BODIES.DAT")) return (own / folder).string();
  return (own / ".." / "DATBOX").lexically_normal().string();
}

Datbox parse_datbox(const DatboxTexts& texts, const std::string& folder, DatboxShapes shapes) {
  const auto lines = [&](const std::string& text, const char* name) {
    return FixedColumns(text, (fs::path(folder) / name).string());
  };
  Datbox datbox;
  datbox.folder = folder;
  for (FixedColumns bodies = lines(texts.bodies, "BODIES.DAT"); bodies.find("$bdyty");) {
    datbox.bodies.push_back(read_datbox_body(bodies, datbox.dimension, datbox.bodies.empty()));
    const std::string& unmodelled = datbox.bodies.back().unmodelled;
    if (shapes == DatboxShapes::modelled && !unmodelled.empty()) fail("{}", unmodelled);
  }
  read_drives(lines(texts.driven, "DRV_DOF.DAT"), datbox, texts, folder);
  read_initial(lines(texts.initial, "DOF.INI"), datbox);
  read_bulk(lines(texts.bulk, "BULK_BEHAV.DAT"), datbox);
  read_tact(lines(texts.tact, "TACT_BEHAV.DAT"), datbox);
  datbox.command = read_datbox_command(lines(texts.command, "COMMAND.DAT"), datbox.dimension);
  return datbox;
}

bool holds_datbox(const std::string& path) {
  std::error_code ignored;
  return record_at(path) || (fs::is_directory(path, ignored) && is_file(datbox_folder(path) / "BODIES.DAT"));
}

std::vector<std::string> datbox_files(const std::string& path) {
  std::vector<std::string> files;
  if (const auto record = record_at(path)) files.push_back(record->file);
  for (const char* name :
       {"BODIES.DAT", "BULK_BEHAV.DAT", "TACT_BEHAV.DAT", "DRV_DOF.DAT", "DOF.INI", "COMMAND.DAT", "Vloc_Rloc.INI"})
    if (const fs::path file = datbox_folder(path) / name; is_there(file)) files.push_back(file.string());
  return files;
}

Datbox read_datbox(const std::string& path, DatboxShapes shapes, const std::string& initial) {
  const fs::path folder = datbox_folder(path);
  const auto record = record_at(path);
  if (record && !is_there(record->file)) fail("{}: no such file", record->file);
  const auto required = [&](const std::string& name) { return read_text((folder / name).string()); };
  const auto text = [&](const char* name) { return is_there(folder / name) ? required(name) : std::string(); };
  const std::string bodies = required("BODIES.DAT");
  if (bodies.find("$bdyty") == bodies.npos) fail("{}/BODIES.DAT: expected bodies, met none", folder.string());
  const std::string state = !initial.empty() ? read_text(initial) : record ? "" : text("DOF.INI");
  Datbox datbox = parse_datbox({bodies, required("BULK_BEHAV.DAT"), text("TACT_BEHAV.DAT"), text("DRV_DOF.DAT"), state,
                                text("COMMAND.DAT"), required},
                               folder.string(), shapes);
  if (record) read_state(*record, datbox);
  return datbox;
}

}  // namespace nscdd
