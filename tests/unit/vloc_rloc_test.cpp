// SPDX-License-Identifier: GPL-3.0-or-later
// Contact networks of LMGC90 as contact problems: M, H and loads of bodies with corners against numbers worked out by
// hand, what is refused, and the folders of LMGC90 where NSCDD_LMGC90 names a folder of them.
#include "formats/lmgc90/vloc_rloc.hpp"

#include "../support/datbox_texts.hpp"
#include "../support/run_program.hpp"
#include "../support/spoilt.hpp"
#include "files/csv.hpp"
#include "formats/contact_problem/siconos_dat.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

FclibFile problem_of(const NetworkTexts& texts) {
  const Datbox datbox = parse_datbox(texts.datbox, "box", DatboxShapes::any);
  return contact_problem_of(datbox, parse_vloc_rloc(texts.contacts, "box/Vloc_Rloc.INI", datbox), "box/Vloc_Rloc.INI");
}

void check_close(const Matrix& met, const Matrix& expected) {
  REQUIRE(met.rows() == expected.rows());
  REQUIRE(met.cols() == expected.cols());
  CHECK((met - expected).cwiseAbs().maxCoeff() < 2e-6);
}

// The relative velocities of the state in the files, from H and, of driven unknowns, from w: without loads and biases.
struct Speeds {
  Vector met, of_file;  // of contacts that carry: the others have those of the beginning of their step
  double fastest = 0;   // unknown of a body
};
Speeds speeds_of(Datbox datbox, const DatboxNetwork& network) {
  datbox.gravity = {0, 0, 0};
  for (auto& [name, law] : datbox.laws) law.restitution = law.tangential_restitution = 0;
  for (DatboxBody& body : datbox.bodies) {
    body.forces = {};
    Eigen::Vector<double, 6> now;
    now << body.velocity, body.spin;
    for (Index k = 0; k < 6; ++k)
      if (auto& drive = body.drives[static_cast<std::size_t>(k)]) {
        drive.emplace();
        drive->constant = now[k];
        drive->initial = 1;
      }
  }
  DatboxNetwork carrying = network;
  std::erase_if(carrying.contacts, [](const DatboxContact& one) { return one.force.isZero(0); });
  for (DatboxContact& one : carrying.contacts) one.gap = std::min(one.gap, 0.0);
  const auto problem = std::get<GlobalFrictionProblem>(contact_problem_of(datbox, carrying, "network").problem);
  REQUIRE(problem.contacts() == static_cast<Index>(carrying.contacts.size()));
  const Vector v = problem.f.cwiseQuotient(Vector(problem.mass.diagonal()));
  Speeds speeds{problem.h.transpose() * v + problem.w, Vector(problem.size()), v.cwiseAbs().maxCoeff()};
  for (Index c = 0; c < problem.contacts(); ++c)
    speeds.of_file.segment(problem.dimension * c, problem.dimension) =
        carrying.contacts[static_cast<std::size_t>(c)].speed.head(problem.dimension);
  return speeds;
}

}  // namespace

TEST_CASE("vloc_rloc: M, H, loads and biases of a square on a plank and under a half-driven triangle, by hand") {
  const FclibFile file = problem_of(square_on_plank());
  const auto& problem = std::get<GlobalFrictionProblem>(file.problem);
  CHECK(problem.dimension == 2);
  // m = 3 x 4 and m (4 + 4) / 12; the triangle has 3 pi avrd^2 and m gyrd^2.
  check_close(problem.mass, Vector{{12, 12, 8, 3, 3, 0.75}}.asDiagonal().toDenseMatrix());
  // h = 0.1 s / 10. The triangle is pushed by 6 N; its x and spin are driven.
  check_close(problem.f, Vector{{12 * 0.5, -12 * 1.1, 8 * 0.25, 3 * 0.5, 3 * (-2 - 0.1 + 0.02), 0}});
  Matrix h = Matrix::Zero(6, 4);
  h.col(0) << 0, 1, 0.5, 0, 0, 0;           // at (0.5, -1) from the centre of the square, n = (0, 1)
  h.col(1) << 1, 0, 1, 0, 0, 0;             // t = (1, 0)
  h.col(2) << -0.6, -0.8, 0.02, 0, 0.8, 0;  // at (0.8, 1.1) from there and (-0.2, -0.9) from the triangle
  h.col(3) << -0.8, 0.6, 1.36, 0, -0.6, 0;  // t = (0.8, -0.6)
  check_close(problem.h, h);
  // A gap of 0.01 m closes at 1 m/s. Restitution of -0.795 and 0.94 m/s by 1/2 and 1/4; the triangle: 0.5 m/s along x.
  check_close(problem.w, Vector{{1, -0.125, -0.3975 + 0.3, 0.235 + 0.4}});
  check_close(problem.friction, Vector{{0.5, 0.3}});
  check_close(file.points, Matrix{{1.5, 1.8}, {0, 2.1}});
  REQUIRE(file.guesses.size() == 1);
  check_close(file.guesses[0].r, Vector{{0.12, 0.04, 0.03, 0}});
  CHECK(file.guesses[0].v[1] == doctest::Approx(-1.1 + (0.12 - 0.8 * 0.03) / 12));
  const LocalFrictionProblem local = reduce(problem);
  CHECK(local.w.coeff(0, 0) == doctest::Approx(1.0 / 12 + 0.25 / 8));
  CHECK(Matrix(local.w).isApprox(Matrix(local.w).transpose(), 1e-14));
}

TEST_CASE("vloc_rloc: a contact that slides has the dynamic friction of its law, another one the static one") {
  NetworkTexts texts = square_on_plank();
  texts.datbox.tact = replaced(texts.datbox.tact, "IQS_CLB                         fric= 0.5000000D+00",
                               "IQS_DS_CLB                      dfrc= 0.5000000D+00  sfrc= 0.7500000D+00");
  const auto friction = [&](const char* status) {
    NetworkTexts other = texts;
    other.contacts = replaced(texts.contacts, "stick     1", std::string(status) + "     1");
    return std::get<GlobalFrictionProblem>(problem_of(other).problem).friction[0];
  };
  CHECK(friction("stick") == 0.75);
  CHECK(friction("noctc") == 0.75);
  CHECK(friction("slifw") == 0.5);
  CHECK(friction("slibw") == 0.5);
}

TEST_CASE("vloc_rloc: a polyhedron has its volume and moments of inertia, and spins along its own axes") {
  const FclibFile file = problem_of(box_on_plane());
  const auto& problem = std::get<GlobalFrictionProblem>(file.problem);
  // m = 48, m (b^2 + c^2) / 12.
  check_close(problem.mass, Vector{{48, 48, 48, 208, 160, 80}}.asDiagonal().toDenseMatrix());
  check_close(problem.f, Vector{{48, 96, 144, 20.8, 32, 24}});
  // At r = (1, -2, -3) from the centre; r x d along the axes (0, 1, 0), (-1, 0, 0), (0, 0, 1).
  Matrix h(6, 3);
  h.col(0) << 0, 0, 1, -1, 2, 0;
  h.col(1) << 1, 0, 0, -3, 0, 2;
  h.col(2) << 0, -1, 0, 0, 3, -1;
  check_close(problem.h, h);
  check_close(problem.w, Vector{{0.1, 0, 0}});                   // the plane moves away
  check_close(file.guesses[0].r, Vector{{0.05, -0.02, -0.01}});  // h = 0.005 s, the default
  const LocalFrictionProblem local = reduce(problem);
  CHECK(Matrix(local.w).isApprox(Matrix(local.w).transpose(), 1e-14));
}

TEST_CASE("vloc_rloc: a polyhedron that lies askew has axes in which its inertia is diagonal") {
  NetworkTexts texts = box_on_plane();
  // The corners turned by 3-4-5 about z: (x, y) -> (0.6 x - 0.8 y, 0.8 x + 0.6 y).
  const auto turn = [&](const char* from, const char* to) {
    for (int twice = 0; twice < 2; ++twice) texts.datbox.bodies = replaced(texts.datbox.bodies, from, to);
  };
  turn("coo1= 0.2000000D+01  coo2= 0.0000000D+00", "coo1= 0.1200000D+01  coo2= 0.1600000D+01");
  turn("coo1= 0.2000000D+01  coo2= 0.4000000D+01", "coo1=-0.2000000D+01  coo2= 0.4000000D+01");
  turn("coo1= 0.0000000D+00  coo2= 0.4000000D+01", "coo1=-0.3200000D+01  coo2= 0.2400000D+01");
  const Datbox datbox = parse_datbox({texts.datbox.bodies, "", "", "", "", {}}, "box", DatboxShapes::any);
  const DatboxBody& body = datbox.bodies[0];
  CHECK((body.position - Vector3(4 - 1.0, 4 + 2.0, 7)).norm() < 1e-12);
  CHECK((body.inertia - Vector3(80, 160, 208)).norm() < 1e-9);  // ascending, as LAPACK has them
  const Vector3 long_side = body.frame.col(2);                  // the largest is about the side of length 2
  CHECK(std::abs(long_side.dot(Vector3(0.6, 0.8, 0))) == doctest::Approx(1));
  CHECK(body.frame.determinant() == doctest::Approx(1));
}

TEST_CASE("vloc_rloc: what does not fit is refused by file and line") {
  const auto spoil = [](std::string NetworkTexts::*text, const std::string& from, const std::string& to,
                        const Names& names) {
    NetworkTexts texts = square_on_plank();
    texts.*text = replaced(texts.*text, from, to);
    check_error([&] { problem_of(texts); }, names);
  };
  const auto contacts = &NetworkTexts::contacts;
  spoil(contacts, "RBDY2      3  POLYG", "RBDY2      4  POLYG", {"Vloc_Rloc.INI:16:", "3 bodies", "met 4"});
  spoil(contacts, "RBDY2      1  POLYG      1  ANSEG", "RBDY2      3  POLYG      1  ANSEG", {":18:", "body 3 twice"});
  spoil(contacts, "RBDY2      3  POLYG", "MAILx      3  POLYG", {":18:", "RBDY2", "MAILx"});
  spoil(contacts, "n(1)= 0.6000000D+00", "n(1)= 0.7000000D+00", {":16:", "unit", "1.06"});
  spoil(contacts, "n(1)= 0.6000000D+00", "n(1)= 0.6000000D+0x", {":22:", "n(1)=", "columns 35 to 48"});
  spoil(contacts, "rstc0", "rstc9", {":16:", "law", "rstc9"});
  spoil(contacts, "vlt = 0.1000000D+00", "xxx = 0.1000000D+00", {":7:", "'vlt ='", "none"});
  spoil(contacts, "coo1= 0.1800000D+01", "coo1= 0.9800000D+01", {":16:", "2 m", "periodic"});
  NetworkTexts none = square_on_plank();
  none.contacts.erase(none.contacts.find("$icdan"));
  check_error([&] { problem_of(none); }, {"Vloc_Rloc.INI:", "contacts", "none"});
  const auto spoil_input = [](std::string DatboxTexts::*text, const std::string& from, const std::string& to,
                              const Names& names) {
    NetworkTexts texts = square_on_plank();
    texts.datbox.*text = replaced(texts.datbox.*text, from, to);
    check_error([&] { problem_of(texts); }, names);
  };
  spoil_input(&DatboxTexts::tact, "IQS_CLB", "MAC_CZM", {"TACT_BEHAV.DAT:2:", "VEL_SGR_CLB or RST_CLB", "MAC_CZM"});
  spoil_input(&DatboxTexts::bulk, "STONE", "STEEL", {"BODIES.DAT:2:", "STONE", "RIGID"});
  NetworkTexts hollow = square_on_plank();
  hollow.datbox.driven = replaced(hollow.datbox.driven, " vlocy      3  0.0", "!vlocy      3  0.0");
  hollow.datbox.bodies =
      replaced(hollow.datbox.bodies, "JONCx      1  color  WALLx  ax1 ", "xKSID      1  color  WALLx  byrd");
  check_error([&] { problem_of(hollow); }, {"BODIES.DAT:17:", "avrd and gyrd", "0"});
  NetworkTexts two = square_on_plank();  // a disk of radius 1 at the node, which moves to the middle of both
  two.datbox.bodies = replaced(two.datbox.bodies, " POLYG      1  color  BLEUx  nb_vertex=    5",
                               " DISKx      1  color  BLEUx  byrd= 0.1000000D+01\n"
                               " POLYG      2  color  BLEUx  nb_vertex=    5");
  const Datbox weighed = parse_datbox(two.datbox, "box", DatboxShapes::any);
  CHECK(std::pow(weighed.bodies[0].average_radius, 2) == doctest::Approx(1 + 4 / std::numbers::pi));
  CHECK(weighed.bodies[0].position[0] == doctest::Approx(4 / (4 + std::numbers::pi)));
  spoil_input(&DatboxTexts::bodies, "nb_vertex=    5", "nb_vertex=    2", {"BODIES.DAT:8:", "polygon", "0 m^2"});
  spoil_input(&DatboxTexts::bodies, "coo1= 0.2000000D+01  coo2= 0.2000000D+01",
              "coo1=-0.2000000D+01  coo2=-0.1000000D+02", {"BODIES.DAT:8:", "counter-clockwise"});
}

TEST_CASE("vloc_rloc: a packing of other shapes is refused where it always was") {
  check_error([] { parse_datbox(square_on_plank().datbox, "box"); },
              {"box/BODIES.DAT:8:", "DISKx, DISKb, JONCx or xKSID", "POLYG"});
  check_error([] { parse_datbox(box_on_plane().datbox, "box"); },
              {"box/BODIES.DAT:9:", "SPHEb, PLANx, DNLYC or CYLND", "POLYR"});
}

TEST_CASE("vloc_rloc: relative velocities of LMGC90's folders follow from the velocities of its bodies") {
  const char* corpus = std::getenv("NSCDD_LMGC90");
  if (corpus == nullptr) return;
  // LMGC90's are of the last visit of its Gauss-Seidel sweeps; a step at rest is converged to the digits.
  const std::map<std::string, double> tolerance{{"2.Rigide_1.Thermique_0.MiseEnCharge_SOLUCE", 0.01},
                                                {"2.Rigide_2.Electrique_0.MiseEnCharge_SOLUCE", 0.005},
                                                {"Ddm_exemple1", 0.02},
                                                {"RIGID_2D_500PL_PerioBoxJC", 0.01},
                                                {"RIGID_2D_1024DK_BoxJC_ThermalConduction", 0.005},
                                                {"RIGID_2D_WallPL_GroundJC", 1e-6}};
  for (const auto& [of, most] : tolerance) {
    const std::string name = of;
    CAPTURE(name);
    const std::string folder = (std::filesystem::path(corpus) / name).string();
    if (!holds_datbox(folder)) continue;
    const std::string path = (std::filesystem::path(folder) / "Vloc_Rloc.INI").string();
    const Datbox datbox = read_datbox(folder, DatboxShapes::any);
    const Speeds speeds = speeds_of(datbox, parse_vloc_rloc(read_text(path), path, datbox));
    CHECK((speeds.met - speeds.of_file).cwiseAbs().maxCoeff() < most * speeds.fastest);
  }
}

TEST_CASE("vloc_rloc: LMGC90's forces hold its walls of polygons and polyhedra at rest") {
  const char* corpus = std::getenv("NSCDD_LMGC90");
  if (corpus == nullptr) return;
  // The forces in space belong to a density of 2500 kg/m^3, that of TEXxx, not to the 4000 of its blocks.
  for (const auto& [of, denser] : {std::pair("RIGID_2D_WallPL_GroundJC", 1.0), {"RIGID_3D_Wall_PR", 1.6}}) {
    const std::string name = of;
    CAPTURE(name);
    const std::string folder = (std::filesystem::path(corpus) / name).string();
    if (!holds_datbox(folder)) continue;
    const std::string path = (std::filesystem::path(folder) / "Vloc_Rloc.INI").string();
    Datbox datbox = read_datbox(folder, DatboxShapes::any);
    const DatboxNetwork network = parse_vloc_rloc(read_text(path), path, datbox);
    for (DatboxBody& body : datbox.bodies) body.velocity.setZero(), body.spin.setZero();
    const FclibFile file = contact_problem_of(datbox, network, path);
    const auto& problem = std::get<GlobalFrictionProblem>(file.problem);
    CHECK((problem.f + denser * problem.h * file.guesses[0].r).norm() < 1e-5 * problem.f.norm());
  }
}

TEST_CASE("vloc_rloc: a file is read with the state of its step beside it and the bodies of ../DATBOX") {
  const TemporaryFolder folder;
  const NetworkTexts texts = square_on_plank();
  write_file(folder / "run/DATBOX/BODIES.DAT", texts.datbox.bodies);
  write_file(folder / "run/DATBOX/BULK_BEHAV.DAT", texts.datbox.bulk);
  write_file(folder / "run/DATBOX/TACT_BEHAV.DAT", texts.datbox.tact);
  write_file(folder / "run/DATBOX/DRV_DOF.DAT", texts.datbox.driven);
  write_file(folder / "run/DATBOX/Vloc_Rloc.INI", texts.contacts);
  write_file(folder / "run/OUTBOX/DOF.OUT.10", texts.datbox.initial);
  write_file(folder / "run/OUTBOX/Vloc_Rloc.OUT.10", texts.contacts);
  const std::string output = (folder / "run/OUTBOX/Vloc_Rloc.OUT.10").string();
  const FclibFile file = read_contact_problem(output);
  CHECK(Matrix(std::get<GlobalFrictionProblem>(file.problem).h) ==
        Matrix(std::get<GlobalFrictionProblem>(problem_of(texts).problem).h));
  for (const char* name : {"run/OUTBOX", "run/DATBOX/", "run", "run/OUTBOX/.."})
    CHECK(datbox_name((folder / name).string()) == "run");
  const std::string here = std::filesystem::current_path().filename().string();
  for (const char* name : {"lmgc90.h5:ID_2", "DATBOX", "."}) CHECK(datbox_name(name) == here);
  // Without DOF.INI the state is that of time 0.
  check_error([&] { read_contact_problem((folder / "run").string()); }, {"Vloc_Rloc.INI:", "DOF.INI", "0 s", "0.1 s"});
}
