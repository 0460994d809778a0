// SPDX-License-Identifier: GPL-3.0-or-later
#include "moving_case.hpp"

#include "spoilt.hpp"

namespace nscdd::testing {

std::string moving_case() {
  return R"(title = "small shear test"
[packing]
generator = "deposit"
grains = 120
width = 3.0
radius_max = 0.198
[masses]
density = 2500
[partition]
grid = [2, 1]
[interaction]
friction = 0.3
[dynamics]
step = 0.005
steps = 20
[solver]
algorithm = "generic"
warm_start = true
maximum_iterations = 40
order = "natural"
criterion = "zeta"
tolerance = 1e-4
[[boundary]]
name = "floor"
shape = "disks"
from = [-0.198, -0.198]
to = [3.198, -0.198]
radius = 0.198
[[boundary]]
name = "left"
shape = "disks"
from = [-0.198, 0.198]
to = [-0.198, 5]
radius = 0.198
centre = [-0.198, -0.198]
spin = -0.075
[[boundary]]
name = "right"
shape = "wall"
from = [3, 0]
to = [3, 1]
centre = [3, 0]
motion = [[0, 0, 0, 0], [0.02, 0, 0, -0.075]]
)";
}

std::string small_moving_case() {
  return replaced(replaced(moving_case(), "grains = 120", "grains = 30"), "steps = 20", "steps = 12");
}

std::string case_text(const std::string& packing, const std::string& grid, const std::string& more) {
  const std::size_t end = std::min(packing.find('\n'), packing.size());
  const std::string first = packing.substr(0, end), parameters = packing.substr(end);
  return "[packing]\n" + std::string(first.find_first_of("./") == std::string::npos ? "generator" : "file") + " = \"" +
         first + "\"" + parameters + "\n[partition]\ngrid = [" + grid + "]\n" + more;
}

std::string wall_text(const std::string& name, const std::string& point, const std::string& normal,
                      const std::string& more) {
  return "[[boundary]]\nname = \"" + name + "\"\nshape = \"wall\"\npoint = " + point + "\nnormal = " + normal + "\n" +
         more;
}

std::string line_text(const std::string& name, const std::string& from, const std::string& to,
                      const std::string& more) {
  return "[[boundary]]\nname = \"" + name + "\"\nshape = \"wall\"\nfrom = " + from + "\nto = " + to + "\n" + more;
}

std::string drum_case() {
  return case_text(
             "cubic\ncolumns = 3\nrows = 3\nlayers = 3\ndisorder = 0.1", "2, 2, 1",
             "[masses]\ndensity = 2500\n[dynamics]\nstep = 0.005\nsteps = 80\n[solver]\nalgorithm = \"generic\"\n"
             "[[boundary]]\nname = \"drum\"\nshape = \"cylinder\"\nfrom = [1, 0, 1]\nto = [1, 1, 1]\nradius = 2.2\n"
             "centre = [1, 0, 1]\nspin = [0, 2, 0]\n") +
         wall_text("end", "[0, -0.6, 0]", "[0, 1, 0]");
}

}  // namespace nscdd::testing
