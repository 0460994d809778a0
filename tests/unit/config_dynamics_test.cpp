// SPDX-License-Identifier: GPL-3.0-or-later
// The sections of a case file that make it move.
#include "../support/moving_case.hpp"
#include "../support/spoilt.hpp"
#include "formats/case/case_file.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

CaseSpec parse_moving(const std::string& text) { return parse_case(text, "c.toml"); }

void refused_file(const std::string& text, const Names& names) {
  CAPTURE(text);
  check_error([&] { parse_moving(text); }, names);
}

void refused_when_built(const std::string& text, const Names& names) {
  check_error([&] { simulation_of(resolve(parse_moving(text))); }, names);
}

const Spoilt spoilt_case{moving_case(), parse_moving};

}  // namespace

TEST_CASE("moving case: everything read") {
  const CaseSpec one = parse_moving(moving_case());
  REQUIRE(one.dynamics.has_value());
  const Dynamics& dynamics = *one.dynamics;
  CHECK((dynamics.interaction.friction == 0.3 && dynamics.time.steps == 20));
  CHECK(dynamics.solver.algorithm == "generic");
  CHECK(dynamics.solver.warm_start);
  REQUIRE(dynamics.boundaries.size() == 3);
  CHECK(dynamics.boundaries[0].shape == BoundaryShape::disks);
  CHECK(dynamics.boundaries[0].motion.velocity.empty());
  CHECK(dynamics.boundaries[1].motion.velocity.front().spin == -0.075);
  CHECK(dynamics.boundaries[1].motion.centre == std::array<double, 3>{-0.198, -0.198, 0});
  CHECK(dynamics.boundaries[2].shape == BoundaryShape::wall);
  CHECK(dynamics.boundaries[2].motion.time == std::vector<double>{0, 0.02});
  CHECK(dynamics.boundaries[2].motion.velocity[1].spin == -0.075);
  CHECK(!parse_moving(case_text("strip")).dynamics);
}

TEST_CASE("moving case: oscillations, initial velocities and spins, written and read back") {
  const std::string text = replaced(moving_case(), "[dynamics]\n", "[dynamics]\nboundary_instant = \"end\"\n") +
                           "[[boundary]]\nname = \"plate\"\nshape = \"grains\"\nfirst = 3\nlast = 3\n"
                           "initial_velocity = [1, 2]\ninitial_spin = 3\n"
                           "[[boundary.oscillation]]\nvelocity = [4, 5]\nomega = 6\nphase = 0.5\nramp = 0\ngrowth = 2\n"
                           "[[boundary.oscillation]]\nspin = 7\nomega = 8\n"
                           "[[prescribed]]\ngrain = 0\nvelocity = [0.5, 0]\nspin = -9\n";
  const CaseSpec one = parse_moving(text), back = parse_moving(to_toml(one));
  CHECK(to_toml(back) == to_toml(one));
  const Motion& motion = back.dynamics->boundaries.at(3).motion;
  CHECK(motion.velocity.empty());
  CHECK((motion.initial->y == 2 && motion.initial->spin == 3));
  CHECK(motion.at(0.25).x == doctest::Approx(4 * std::cos(2.0) / 2).epsilon(1e-14));
  CHECK(motion.at(0.25).spin == doctest::Approx(7 * std::cos(2.0)).epsilon(1e-14));
  CHECK(back.prescribed.at(0).spin == std::array<double, 3>{0, 0, -9});
  const Spoilt other{text, parse_moving};
  other("omega = 8", "", {"boundary[3].oscillation[1].omega"});
  other("growth = 2", "growth = -2", {"boundary[3].oscillation[0].growth:", ">= 0"});
  other("ramp = 0", "ramp = 2", {"boundary[3].oscillation[0].ramp:", "<= 1"});
  other("spin = -9", "spin = inf", {"prescribed[0].spin:"});
  other("boundary_instant = \"end\"", "", {"boundary[3].initial_velocity:", "boundary_instant"});
  other("spin = 7\n", "", {"boundary[3].oscillation[1].velocity:", "amplitudes"});
  other("velocity = [4, 5]", "velocity = [4, 5, 6]", {"boundary[3].oscillation:", "numbers for the plane"});
  other("spin = -9", "spin = [1, 2, 3]", {"prescribed[0].spin:", "one number in the plane"});
  refused_file(case_text("strip") + "[[prescribed]]\ngrain = 0\nvelocity = [0.5, 0]\nspin = -9\n",
               {"c.toml:", "prescribed:", "a spin only with [dynamics]"});
}

TEST_CASE("moving case: written and read back it is the same case") {
  CaseSpec one = parse_moving(moving_case() +
                              "[[boundary]]\nname = \"piston\"\nshape = \"grains\"\nfirst = 3\nlast = -7\n"
                              "velocity = [0.1, -1e-9]\norientation = \"fixed\"\n");
  one.dynamics->time.rest_speed = 1.0 / 3;
  one.dynamics->solver.algorithm = "enriched";
  one.dynamics->solver.eta = "optimal";
  const CaseSpec back = parse_moving(to_toml(one));
  CHECK(to_toml(back) == to_toml(one));
  CHECK(back.dynamics->time.rest_speed == 1.0 / 3);
  const BoundarySpec& piston = back.dynamics->boundaries.at(3);
  CHECK(std::pair(piston.first, piston.last) == std::pair<Index, Index>(3, -7));
  CHECK(piston.motion.velocity.front().y == -1e-9);
  CHECK(piston.orientation == Orientation::fixed);
  CHECK(back.dynamics->boundaries.at(1).orientation == Orientation::turning);
}

TEST_CASE("moving case: every error names file, line and key") {
  spoilt_case("friction = 0.3", "frictions = 0.3", {"c.toml:12: unknown key 'interaction.frictions'"});
  spoilt_case("friction = 0.3", "friction = -1", {"c.toml:12: interaction.friction"});
  spoilt_case("friction = 0.3", "law = \"glue\"", {"c.toml:12: interaction.law"});
  spoilt_case("steps = 20", "steps = 2.5", {"c.toml:15: dynamics.steps:", "integer"});
  spoilt_case("step = 0.005", "step = 0", {"c.toml:14: dynamics.step:"});
  spoilt_case("step = 0.005", "theta = 0.4", {"c.toml:14: dynamics.theta"});
  spoilt_case("\"generic\"", "\"gauss\"", {"c.toml:17: solver.algorithm:", "one of"});
  spoilt_case("warm_start = true", "warm_start = 1", {"c.toml:18: solver.warm_start"});
  spoilt_case("warm_start = true", "eta = \"best\"", {"c.toml:18: solver.eta:", "\"optimal\"", "30 W", "met \"best\""});
  spoilt_case("warm_start = true", "eta = true", {"30 W", "met the boolean 'true'"});
  spoilt_case("warm_start = true", "eta = \"0\"", {"c.toml:18: solver.eta"});
  spoilt_case("warm_start = true", "eta = 0", {"c.toml:18: solver.eta"});
  spoilt_case("friction = 0.3", "law = \"linear_viscous\"\nepsilon = \"-1 W\"",
              {"c.toml:13: interaction.epsilon:", ">= 0", "met -1"});
  spoilt_case("friction = 0.3", "law = \"linear_viscous\"\nepsilon = \"2 V\"",
              {"c.toml:13: interaction.epsilon:", "30 W", "met \"2 V\""});
  spoilt_case("[dynamics]\nstep = 0.005\nsteps = 20\n", "", {"c.toml:11: interaction:", "[dynamics]", "met none"});
  spoilt_case("[dynamics]", "[dynamic]", {"unknown key 'dynamic'"});
  spoilt_case("name = \"floor\"", "name = \"left\"", {"boundary[1].name:", "met \"left\" again"});
  spoilt_case("name = \"floor\"\n", "", {"boundary[0].name:", "met none"});
  for (const std::string name : {"", "a\\nb", "tab\\t", "\\u007f"})
    spoilt_case("name = \"floor\"", "name = \"" + name + "\"", {"boundary[0].name:", "text of one line"});
  spoilt_case("shape = \"wall\"", "shape = \"spheres\"",
              {"boundary[2].shape:", "wall", "disks", "grains", "cylinder", "met \"spheres\""});
  spoilt_case("shape = \"disks\"", "shape = \"wall\"", {"unknown key 'boundary[0].radius'"});
  spoilt_case("shape = \"wall\"", "shape = \"grains\"", {"boundary[2].first:", "met none"});
  spoilt_case("spin = -0.075\n", "orientation = \"free\"\n",
              {"boundary[1].orientation:", "turning", "fixed", "met \"free\""});
  spoilt_case("centre = [3, 0]", "orientation = \"fixed\"", {"unknown key 'boundary[2].orientation'"});
  spoilt_case("to = [3, 1]", "to = [3, 0]", {"boundary[2].to:", "point"});
  spoilt_case("radius = 0.198\n[[", "radius = -1\n[[", {"boundary[0].radius"});
  spoilt_case("centre = [3, 0]", "centre = [3, inf]", {"boundary[2].centre"});
  spoilt_case("centre = [3, 0]", "spin = 1", {"boundary[2].motion:", "met both"});
  spoilt_case("[0.02, 0, 0, -0.075]", "[0, 0, 0, 1]", {"boundary[2].motion:", "met 0 s after 0 s"});
  spoilt_case("[0.02, 0, 0, -0.075]", "[0.02, 0, 0]", {"boundary[2].motion"});
  spoilt_case("[0.02, 0, 0, -0.075]", "[0.02, 0, 0, nan]", {"boundary[2].motion"});
  spoilt_case("[[0, 0, 0, 0], [0.02, 0, 0, -0.075]]", "[]", {"met an empty array"});
}

TEST_CASE("moving case: a value without effect is refused, and written as its default") {
  const std::string good = moving_case();
  spoilt_case("warm_start = true", "eta = \"3\"",
              {"c.toml:18: solver.eta:", "solver.algorithm enriched", "met generic"});
  spoilt_case("warm_start = true", "enrichment = \"semi_implicit\"", {"c.toml:18: solver.enrichment"});
  spoilt_case("warm_start = true", "seed = 7", {"c.toml:18: solver.seed:", "solver.order random", "met natural"});
  refused_file(replaced(replaced(good, "\"generic\"", "\"nlgs\""), "warm_start = true", "redecompose = 3"),
               {"c.toml:18: solver.redecompose:", "solver.algorithm generic", "two_stage_admm", "met nlgs"});
  spoilt_case("friction = 0.3", "cohesion = 3",
              {"c.toml:12: interaction.cohesion:", "interaction.law cohesive", "met coulomb"});
  spoilt_case("friction = 0.3", "boundary_friction = -0.5",
              {"c.toml:12: interaction.boundary_friction:", ">= 0", "<= 100", "-1"});
  CHECK(parse_moving(replaced(good, "friction = 0.3", "boundary_friction = -1")).dynamics.has_value());
  spoilt_case("warm_start = true", "switch_after = 3", {"c.toml:18: solver.switch_after:", "solver.switch linear"});
  spoilt_case("warm_start = true", "switch = \"linear\"\ninterface_method = \"conjugate_gradient\"",
              {"c.toml:18: solver.switch:", "solver.interface_method richardson"});
  refused_file(replaced(replaced(good, "\"generic\"", "\"nlgs\""), "warm_start = true", "switch = \"linear\""),
               {"c.toml:18: solver.switch:", "solver.algorithm generic", "met nlgs"});
  refused_file(replaced(replaced(good, "friction = 0.3", "law = \"linear_viscous\"\nepsilon = 1"), "warm_start = true",
                        "switch = \"linear\""),
               {"solver.switch:", "interaction.law coulomb"});
  CaseSpec one = parse_moving(good);
  one.dynamics->solver.interface_preconditioner = "bddc";
  check_dynamics(one);  // of no effect
  one.dynamics->solver.algorithm = "two_stage_newton";
  CHECK_THROWS_WITH_AS(check_dynamics(one), doctest::Contains("not symmetric"), Error);
  CHECK_NOTHROW(parse_case(replaced(good, "warm_start = true", "interface_network = \"all\""), "old.toml", true));
  one.dynamics->solver.algorithm = "two_stage_admm";
  one.dynamics->solver.coarse_space = "rigid";
  check_error([&] { check_dynamics(one); }, {"solver.coarse_space", "expected none or geneo", "met rigid"});
  one.dynamics->solver.interface_preconditioner = "dirichlet";
  CHECK_NOTHROW(check_dynamics(one));
  one = parse_moving(good);
  one.dynamics->solver.eta = "3";
  CHECK(to_toml(one) == to_toml(parse_moving(good)));
  one.dynamics->solver.switch_after = 3;  // a case that switches nothing is written as if there were no such thing
  CHECK(to_toml(one) == to_toml(parse_moving(good)));
  CHECK(to_toml(one).find("switch") == std::string::npos);
  one.dynamics->solver.model = SwitchedModel::linear;
  CHECK(parse_moving(to_toml(one)).dynamics->solver.switch_after == 3);
  // In the case of a trajectory values without effect may be other defaults.
  const std::string text = replaced(good, "\"zeta\"", "\"none\"");  // with a tolerance of 1e-4
  refused_file(text, {"c.toml:22: solver.tolerance:", "solver.criterion zeta"});
  const CaseSpec earlier = parse_case(text, "run.h5: case", true);
  CHECK(earlier.dynamics->solver.criterion == "none");
  CHECK(to_toml(parse_moving(to_toml(earlier))) == to_toml(earlier));
}

TEST_CASE("moving case: without [solver] every step is solved by auto to a natural map of 1e-8") {
  const std::string good = moving_case();
  const auto begin = good.find("[solver]"), end = good.find("[[boundary]]");
  const std::string bare = good.substr(0, begin) + good.substr(end);
  const CaseSpec one = parse_moving(bare);
  const StepSolver& solver = one.dynamics->solver;
  CHECK((solver.algorithm == "auto" && solver.criterion == "natural_map"));
  CHECK(solver.warm_start);
  CHECK(to_toml(parse_moving(to_toml(one))) == to_toml(one));
  Simulation simulation = simulation_of({one});  // the partition of two subdomains has no part in it
  for (int k = 0; k < 3; ++k) {
    const GranularStep<2> step = solve_step(simulation);
    CHECK(step.report.status == SolverStatus::converged);
    if (k > 0) CHECK(step.report.residual.relative_natural_map() <= 1e-8);  // in step 0 all fall alike
    CHECK(step.report.interface_size == 0);
    CHECK(std::isnan(step.report.last.zeta));  // auto knows none
    const bool starts_from_zero = std::ranges::all_of(
        step.problem.contacts, [](const GrainContact<2>& c) { return c.impulse.n == 0 && c.impulse.t == 0; });
    CHECK(starts_from_zero == (k == 0));
    take_step(simulation, step);
  }
}

TEST_CASE("moving case: where no algorithm is stated, keys that auto has no use for are refused at any value") {
  const auto with = [](const std::string& line) {
    return replaced(moving_case(),
                    "algorithm = \"generic\"\nwarm_start = true\nmaximum_iterations = 40\norder = "
                    "\"natural\"\ncriterion = \"zeta\"\n",
                    line + "\n");
  };
  const auto refused_by_auto = [&](const std::string& line, const std::string& key, const std::string& algorithm) {
    refused_file(with(line),
                 {"c.toml:17: solver." + key + ":", "solver.algorithm " + algorithm, "met auto, the default"});
  };
  refused_by_auto("gauss_seidel_sweeps = 1", "gauss_seidel_sweeps", "nlgs");
  refused_by_auto("order = \"interleaved\"", "order", "nlgs");
  refused_by_auto("criterion = \"zeta\"", "criterion", "nlgs");
  refused_by_auto("gluing_tolerance = 0.01", "gluing_tolerance", "generic");
  refused_by_auto("switch = \"none\"", "switch", "generic");
  refused_by_auto("eta = \"30 W\"", "eta", "enriched");
  CHECK(parse_moving(with("criterion = \"natural_map\"\ncontact_relaxation = 1.2")).dynamics->solver.algorithm ==
        "auto");
  CHECK(parse_moving(with("algorithm = \"auto\"\norder = \"interleaved\"")).dynamics.has_value());  // as it is written
  refused_file(with("algorithm = \"auto\"\ncriterion = \"zeta\""),
               {"c.toml:18: solver.criterion:", "solver.algorithm nlgs", "met auto"});
}

TEST_CASE("moving case: parameters are overridden by their path") {
  CaseSpec one = parse_moving(moving_case());
  override_case(one, "dynamics.steps", "7");
  override_case(one, "solver.tolerance", "1e-7");
  override_case(one, "solver.eta", "0.25");
  override_case(one, "interaction.friction", "0.5");
  CHECK((one.dynamics->time.steps == 7 && one.dynamics->solver.tolerance == 1e-7));
  CHECK((one.dynamics->solver.eta == "0.25" && one.dynamics->interaction.friction == 0.5));
  CHECK_THROWS_WITH_AS(override_case(one, "solver.eta", "-1"), doctest::Contains("solver.eta"), Error);
  CHECK_THROWS_WITH_AS(override_case(one, "dynamics.stepps", "7"), doctest::Contains("dynamics.step,"), Error);
  one.dynamics.reset();
  check_error([&] { override_case(one, "dynamics.steps", "7"); }, {"[dynamics]"});
}

TEST_CASE("settled packing: read and written by the name of its case, not settled by reading") {
  const std::string text = "[packing]\nsettled = \"bed\"\n[partition]\ngrid = [1, 1]\n";
  CaseSpec spec = parse_moving(text);
  CHECK(std::get<SettledFrom>(spec.packing).name == "bed");
  CHECK(to_toml(parse_moving(to_toml(spec))) == to_toml(spec));
  CHECK_THROWS_WITH_AS(override_case(spec, "packing.grains", "7"), doctest::Contains("is settled"), Error);
  check_error([&] { resolve(spec); }, {"c.toml:2: packing.settled:", "file"});
  const Case settled{spec, {{0.5}, {1}, {0.25}, {3}}};
  CHECK(packing_of(settled).mass == std::vector<double>{3});
  refused_file("[packing]\nsettled = \"bed\"\nfile = \"a.csv\"\n[partition]\ngrid = [1, 1]\n", {"met more"});
}

TEST_CASE("moving case: what grains and criteria refuse names file, line and key") {
  const std::string good = moving_case();
  refused_when_built(good + "[[prescribed]]\ngrain = 120\nvelocity = [0, 1]\n",
                     {"c.toml:45: prescribed[0].grain:", "0..119"});
  refused_when_built(good + "[[boundary]]\nname = \"piston\"\nshape = \"grains\"\nfirst = 130\nlast = 3\n",
                     {"c.toml:47: boundary[3].first:", "0..119"});
  const std::string plain = replaced(replaced(good, "\"generic\"", "\"nlgs\""), "\"zeta\"", "\"gluing\"");
  refused_when_built(plain, {"c.toml:21: solver.criterion:", "solver.algorithm generic"});
  const std::string undivided =
      replaced(replaced(good, "\"generic\"\nwarm_start = true", "\"auto\""), "criterion = \"zeta\"\n", "");
  refused_file(undivided, {"solver.order:", "solver.algorithm nlgs", "met auto"});
  refused_when_built(replaced(replaced(undivided, "order = \"natural\"\n", ""), "friction = 0.3",
                              "law = \"linear_viscous\"\nepsilon = 1"),
                     {"c.toml:18: solver.algorithm:", "met auto"});
  CaseSpec one_subdomain = parse_moving(good);  // where a loop over their numbers begins
  override_case(one_subdomain, "solver.criterion", "gluing");
  override_case(one_subdomain, "partition.grid", "1,1");
  CHECK_NOTHROW(simulation_of({one_subdomain}));
  one_subdomain.dynamics->solver.algorithm = StepAlgorithm::two_stage_newton;
  one_subdomain.dynamics->solver.coarse_space = CoarseSpace::geneo;
  check_error([&] { check_dynamics(one_subdomain); }, {"solver.coarse_space", "expected none with one subdomain"});
}

TEST_CASE("moving case: flexibilities are numbers, multiples of W or optimal, and are written as they were read") {
  const std::string enriched = replaced(moving_case(), "\"generic\"", "\"enriched\"");
  const auto with_eta = [&](const std::string& value) {
    return parse_moving(replaced(enriched, "warm_start = true", "eta = " + value));
  };
  CHECK(parse_moving(enriched).dynamics->solver.eta == EtaChoice("30 W"));
  for (const std::string eta : {"10.0", "10", "\"10\"", "\"1e1\""}) {
    CAPTURE(eta);
    CHECK(with_eta(eta).dynamics->solver.eta.value == Flexibility{10, false});
    CHECK(to_toml(with_eta(eta)).find("\neta = 10\n") != std::string::npos);
  }
  CHECK(with_eta("\"0.5W\"").dynamics->solver.eta.value == Flexibility{0.5, true});
  CHECK(Flexibility{0.5, true}.at_scale(4) == 2);
  CHECK(Flexibility{0.5, false}.at_scale(4) == 0.5);
  CHECK(with_eta("\"optimal\"").dynamics->solver.eta.optimal);
  CaseSpec spec = parse_moving(replaced(enriched, "friction = 0.3", "law = \"linear_viscous\"\nepsilon = \"0.25W\""));
  CHECK(spec.dynamics->interaction.epsilon == Flexibility{0.25, true});
  override_case(spec, "solver.eta", "3W");
  const CaseSpec back = parse_moving(to_toml(spec));
  CHECK(back.dynamics->solver.eta == EtaChoice("3 W"));
  CHECK(back.dynamics->interaction.epsilon == spec.dynamics->interaction.epsilon);
}

TEST_CASE("moving case in space: boundaries are read, written and read again; mixed numbers are refused") {
  const std::string text =
      "[packing]\ngenerator = \"fcc\"\n[partition]\ngrid = [2, 2, 2]\n[dynamics]\nsteps = 3\n"
      "[[boundary]]\nname = \"side\"\nshape = \"wall\"\npoint = [1, 2, 3]\nnormal = [0, 0, 2]\n"
      "centre = [4, 5, 6]\nvelocity = [7, 8, 9]\nspin = [0.1, 0.2, 0.3]\n"
      "[[boundary]]\nname = \"drum\"\nshape = \"cylinder\"\nfrom = [0, 0, 1]\nto = [0, 1, 1]\nradius = 1.5\n"
      "side = \"outside\"\nmotion = [[0, 0, 0, 0, 0, 0, 0], [0.5, 1, 2, 3, 4, 5, 6]]\n"
      "[[boundary]]\nname = \"plate\"\nshape = \"grains\"\nfirst = 0\nlast = 3\norientation = \"fixed\"\n"
      "spin = [0, 0, 1]\n";
  const CaseSpec one = parse_moving(text), back = parse_moving(to_toml(one));
  CHECK(to_toml(back) == to_toml(one));
  const std::vector<BoundarySpec>& found = back.dynamics->boundaries;
  REQUIRE(found.size() == 3);
  for (const BoundarySpec& each : found) CHECK(each.dimension == 3);
  CHECK(found[0].point == std::array<double, 3>{1, 2, 3});
  CHECK(found[0].normal == std::array<double, 3>{0, 0, 2});
  CHECK(found[0].motion.centre == std::array<double, 3>{4, 5, 6});
  const RigidVelocity v = found[0].motion.at(0);
  CHECK(std::array{v.x, v.y, v.z, v.spin_x, v.spin_y, v.spin} == std::array{7.0, 8.0, 9.0, 0.1, 0.2, 0.3});
  const RigidVelocity half = found[1].motion.at(0.25);
  CHECK(std::array{half.x, half.y, half.z, half.spin_x, half.spin_y, half.spin} ==
        std::array{0.5, 1.0, 1.5, 2.0, 2.5, 3.0});
  CHECK(found[1].side == CylinderSide::outside);
  CHECK(found[1].radius == 1.5);
  CHECK(found[2].orientation == Orientation::fixed);
  const Spoilt in_space{text, parse_moving};
  in_space("velocity = [7, 8, 9]", "velocity = [7, 8]", {"boundary[0].velocity:", "met numbers for the plane"});
  in_space("spin = [0.1, 0.2, 0.3]", "spin = 0.1", {"boundary[0].spin:", "met numbers for the plane"});
  in_space("[0.5, 1, 2, 3, 4, 5, 6]", "[0.5, 1, 2, 3]", {"boundary[1].motion:", "numbers"});
  in_space("point = [1, 2, 3]\nnormal", "from = [1, 2, 3]\nto", {"boundary[0].from:", "met from and to"});
  in_space("radius = 1.5", "radius = 0", {"boundary[1].radius"});
  in_space("normal = [0, 0, 2]", "normal = [0, 0, 0]", {"normal:", "direction"});
}

TEST_CASE("moving case in space: boundaries and gravity of the other dimension are refused by name") {
  const std::string space = case_text("fcc", "1, 1, 1", "[masses]\ndensity = 1\n[dynamics]\nsteps = 1\n");
  refused_when_built(space + "gravity = [0, -9.81]\n", {"dynamics.gravity:", "space"});
  refused_when_built(space + line_text("f", "[0, 0]", "[1, 0]"), {"boundary[0]: boundary 'f':", "normal"});
  refused_when_built(space + "[[boundary]]\nname = \"f\"\nshape = \"disks\"\nfrom = [0, 0]\nto = [1, 0]\nradius = 1\n",
                     {"boundary 'f':", "met disks"});
  refused_when_built(space + "[[boundary]]\nname = \"f\"\nshape = \"grains\"\nfirst = 0\nlast = 0\nspin = 1\n",
                     {"boundary 'f':", "met two"});
  refused_when_built(space + "[solver]\nalgorithm = \"generic\"\nswitch = \"homogenised\"\n",
                     {"solver.switch:", "linear"});
  const std::string plane = replaced(replaced(space, "fcc", "hexagonal"), "[1, 1, 1]", "[1, 1]");
  refused_when_built(plane + "gravity = [0, 0, -9.81]\n", {"dynamics.gravity:", "plane"});
  refused_when_built(plane + "[solver]\nalgorithm = \"generic\"\nswitch = \"homogenised\"\nswitch_cells = [2, 2, 2]\n",
                     {"solver.switch_cells:", "two integers for a packing in the plane", "met [2, 2, 2]"});
  refused_when_built(
      plane + "[[boundary]]\nname = \"d\"\nshape = \"cylinder\"\nfrom = [0, 0, 0]\nto = [0, 1, 0]\nradius = 9\n",
      {"boundary 'd':", "two components"});
  refused_when_built(plane + wall_text("f", "[0, 0, 0]", "[0, 0, 1]"), {"boundary 'f':", "from"});
}
