// What water does to the body as a whole: direction, size and weight, against closed forms of a bar.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_mesh.h"

namespace argil::sim {
namespace {

constexpr double kLength = 0.1;  // of the bar, along x [m]
constexpr double kWidth = 0.02;

Params make_params() {
  Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.enabled = false;
  p.kernel.form = material::KernelForm::off;
  p.contact = {50.0, 50.0};
  p.solid.model = solid::StrainModel::linear;
  p.solid.solver.kind = linear::SolverKind::cholesky;
  return p;
}

solid::Support make_roller(int direction, double at, double displacement) {
  solid::Support roller;
  roller.region.kind = solid::Region::Kind::plane;
  roller.region.normal = Vec3::Unit(direction);
  roller.region.offset = at;
  for (int k = 0; k < 3; ++k) roller.fixes[static_cast<std::size_t>(k)] = k == direction;
  roller.displacement = displacement * Vec3::Unit(direction);
  return roller;
}

/// Saturated bar on three smooth walls.
Body make_bar(double saturation) {
  Body body;
  body.mesh = test::make_block(5, 2, 2, Vec3(kLength, kWidth, kWidth));
  body.topology = mesh::make_topology(body.mesh);
  for (int k = 0; k < 3; ++k) body.supports.push_back(make_roller(k, 0.0, 0.0));
  body.initial_saturation = Field::Constant(body.mesh.num_tets(), saturation);
  return body;
}

Simulation make_simulation(Body body, const Params& params) {
  device::DeviceSample away;
  away.position = {0.0, 0.0, 1.0};
  return Simulation(std::move(body), contact::make_sphere_tool(0.005, 1), params, away);
}

/// Position of the corner that is farthest from the walls.
Vec3 find_corner(const Simulation& simulation) {
  Eigen::Index corner = 0;
  simulation.body().mesh.vertices.colwise().sum().maxCoeff(&corner);
  return simulation.state().solid.x.col(corner);
}

TEST(AlignedPores, GiveABarTheModuliOfTheirDirection) {
  // Pulled by 1 %, a bar whose pores are aligned contracts by S₁₂/S₁₁ and S₁₃/S₁₁ of its compliance. The same
  // pores, given once by the material's axis and once tet by tet.
  Params params = make_params();
  params.moisture.medium.aspect = 0.1;
  params.moisture.medium.orientation = material::Orientation::aligned;
  const double porosity = params.water.porosity;
  const Mat6 S = material::compute_effective_medium(params.elastic, params.moisture.medium, porosity)
                     .stiffness.inverse();
  const double pull = 0.01 * kLength;
  struct Case {
    Vec3 axis;
    double along, y, z;  // entries of S
  };
  for (const Case& c :
       {Case{Vec3::UnitX(), S(2, 2), S(0, 2), S(0, 2)}, Case{Vec3::UnitY(), S(0, 0), S(0, 2), S(0, 1)},
        Case{Vec3::UnitZ(), S(0, 0), S(0, 1), S(0, 2)}})
    for (const bool tet_by_tet : {false, true}) {
      Body body = make_bar(1.0);
      body.supports.push_back(make_roller(0, kLength, pull));
      if (tet_by_tet)
        body.pore_axis = (-c.axis).replicate(1, body.mesh.num_tets());  // the sign does not matter
      else
        params.moisture.medium.axis = c.axis;
      Simulation simulation = make_simulation(std::move(body), params);
      ASSERT_TRUE(simulation.settle().is_ok());
      const Vec3 moved = find_corner(simulation) - Vec3(kLength, kWidth, kWidth);
      EXPECT_NEAR(moved.x(), pull, 1e-15);
      EXPECT_NEAR(moved.y(), 0.01 * kWidth * c.y / c.along, 1e-9 * kWidth);
      EXPECT_NEAR(moved.z(), 0.01 * kWidth * c.z / c.along, 1e-9 * kWidth);
      const double energy = simulation.physics_record().elastic_energy;  // ½ E ε² V
      EXPECT_NEAR(energy, 0.5 / c.along * 1e-4 * kLength * kWidth * kWidth, 1e-9 * energy);
    }
  EXPECT_GT(S(2, 2), 1.5 * S(0, 0));  // flat pores: far softer along their axis
}

}  // namespace
}  // namespace argil::sim
