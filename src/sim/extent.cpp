#include "sim/extent.h"

#include <algorithm>

#include "material/moisture.h"
#include "solid/law.h"

namespace argil::sim {
namespace {

/// A region needs elements that go in lanes and a solve of part of the rows.
std::optional<RegionObstacle> find_obstacle(const solid::SolidParams& p, bool is_isotropic) {
  using linear::SolverKind;
  if (p.element == solid::ElementKind::p1_nodal || !solid::find_law(p.model).lanes.forces || !is_isotropic)
    return {{"is for p1 and p2 elements of the isotropic linear, corotational, hencky and curnier laws",
             "change /dynamics or /material"}};
  if (p.integrator != solid::Integrator::backward_euler || p.iteration != solid::Iteration::one)
    return {{"takes one linearised solve of backward_euler",
             "change /dynamics/integrator and /dynamics/iteration"}};
  const bool is_pcg = p.solver.kind == SolverKind::pcg || p.solver.kind == SolverKind::pcg_jacobi;
  if (!is_pcg || !(p.solver.tolerance >= linear::kRoomForFloats))
    return {{"is solved by pcg or pcg_jacobi to a tolerance of 1e-4 or more", "change /dynamics/solver"}};
  return std::nullopt;
}

}  // namespace

std::optional<RegionObstacle> find_region_obstacle(const Params& params,
                                                   const std::vector<solid::Support>& supports) {
  // Whether a contact sticks or slides may hang on less than what a region leaves out.
  if (params.extent == Extent::automatic && params.contact.friction > 0.0)
    return {{"is not taken unasked with friction", "set /contact/friction to 0"}};
  if (const auto obstacle = find_obstacle(params.solid, material::is_isotropic(params.moisture)))
    return obstacle;
  if (params.deflects_between_steps())
    return {{"does not go with a surface that yields between frames", "use re_evaluate"}};
  if (params.water.swelling != 0.0)
    return {{"does not go with clay that swells", "set /water/swelling to 0"}};
  const auto moves = [](const solid::Support& support) { return support.displacement.norm() > 0.0; };
  if (std::any_of(supports.begin(), supports.end(), moves))
    return {{"needs supports that stay", "leave out their displacement"}};
  return std::nullopt;
}

bool restricts_to_region(const Params& params, const std::vector<solid::Support>& supports, int num_free) {
  constexpr int kLarge = 1500;  // nodes; with fewer, keeping the lists costs what a smaller solve saves
  if (params.extent != Extent::automatic) return params.extent == Extent::local;
  return params.fidelity.mode != FidelityMode::full && num_free >= kLarge &&
         !find_region_obstacle(params, supports);
}

}  // namespace argil::sim
