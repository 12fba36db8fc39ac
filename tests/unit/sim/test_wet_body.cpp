// What water does to the body as a whole: direction, size and weight, against closed forms of a bar.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

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

TEST(Swelling, MakesAFreeBarGrowAlikeInAllDirectionsWithoutStress) {
  // Rest volume times 1 + 0.3·S: every length times the cube root, for every law and element.
  for (const solid::StrainModel model :
       {solid::StrainModel::linear, solid::StrainModel::corotational, solid::StrainModel::neo_hookean})
    for (const solid::ElementKind element :
         {solid::ElementKind::p1, solid::ElementKind::p1_nodal, solid::ElementKind::p2}) {
      Params params = make_params();
      params.solid.model = model;
      params.solid.element = element;
      params.water.swelling = 0.3;
      Simulation simulation = make_simulation(make_bar(0.5), params);
      ASSERT_TRUE(simulation.settle().is_ok());
      const double grown = std::cbrt(1.15);
      EXPECT_LT((find_corner(simulation) - grown * Vec3(kLength, kWidth, kWidth)).norm(), 1e-9 * kLength);
      EXPECT_LT(simulation.physics_record().elastic_energy, 1e-15);  // ½ E V = 2 J
    }
}

TEST(Swelling, OfAHeldBarPressesOnItsWallsByItsBulkModulus) {
  // Held in size on all sides, the linear bar feels the volume strain of −s in each direction as pressure:
  // energy ½·9K·(1 − g)² V (1 + s), g = (1 + s)^{−1/3}, per grown volume.
  Params params = make_params();
  params.water.swelling = 0.1;
  params.moisture.softens_elasticity = false;
  Body body = make_bar(1.0);
  body.supports.push_back(make_roller(0, kLength, 0.0));
  body.supports.push_back(make_roller(1, kWidth, 0.0));
  body.supports.push_back(make_roller(2, kWidth, 0.0));
  Simulation simulation = make_simulation(std::move(body), params);
  ASSERT_TRUE(simulation.settle().is_ok());
  const double K = 1e5 / (3.0 * 0.4);
  const double g = 1.0 / std::cbrt(1.1);
  const double expected = 4.5 * K * (1.0 - g) * (1.0 - g) * 1.1 * kLength * kWidth * kWidth;
  EXPECT_NEAR(simulation.physics_record().elastic_energy, expected, 1e-9 * expected);
}

TEST(WaterMass, AddsToTheClaysAndHangsOnIt) {
  // A bar hung by one end lengthens by ρ g L²/(2E) (ν = 0): in proportion to its density.
  for (const solid::ElementKind element : {solid::ElementKind::p1, solid::ElementKind::p2}) {
    double longer[2];
    for (const bool adds : {false, true}) {
      Params params = make_params();
      params.elastic = {1e5, 0.0};
      params.solid.element = element;
      params.solid.gravity = {9.81, 0.0, 0.0};
      params.moisture.softens_elasticity = false;
      params.water.adds_mass = adds;
      Simulation simulation = make_simulation(make_bar(0.8), params);
      const double density = params.solid.density + (adds ? 0.8 * 0.4 * 1000.0 : 0.0);
      EXPECT_NEAR(simulation.solid().mass().sum(), density * kLength * kWidth * kWidth, 1e-15);
      ASSERT_TRUE(simulation.settle().is_ok());
      longer[adds] = find_corner(simulation).x() - kLength;
      const double expected = density * 9.81 * kLength * kLength / (2.0 * 1e5);
      EXPECT_NEAR(longer[adds], expected,
                  element == solid::ElementKind::p2 ? 1e-9 * expected : 0.1 * expected);
    }
    EXPECT_NEAR(longer[1] / longer[0], 1820.0 / 1500.0, 1e-9);
  }
}

device::DeviceSample at_height(double z, device::ToolMode mode) {
  device::DeviceSample sample;
  sample.position = {0.05, 0.0101, z};
  sample.mode = mode;
  return sample;
}

Body make_floor_bar() {
  Body body = make_bar(0.0);
  for (solid::Support& roller : body.supports) roller = make_roller(2, 0.0, 0.0);
  body.supports[0].fixes = {true, true, true};
  return body;
}

Params make_touch_params() {
  Params params = make_params();
  params.solid.model = solid::StrainModel::corotational;
  params.solid.rayleigh_stiffness = 0.002;
  params.rates.water_period_ticks = 1;
  params.water.diffusivity = 1e-6;
  params.water.wetting_flux = 50.0;
  params.device.max_force = 100.0;
  params.device.max_force_rate = 1e9;
  return params;
}

TEST(Rest, AWetToolLeavesAnUntouchedBodyInPlaceBitForBit) {
  Simulation simulation(make_floor_bar(), contact::make_sphere_tool(0.005, 1), make_touch_params(),
                        at_height(0.03, device::ToolMode::wet));
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(simulation.tick(at_height(0.0245, device::ToolMode::wet)).is_ok());
  EXPECT_GT(simulation.state().hand_force.z(), 0.01);
  EXPECT_GT(simulation.pore_water().mass(), 1e-6);
  EXPECT_TRUE(simulation.state().is_at_rest);
  EXPECT_EQ(simulation.state().solid.x, simulation.solid().elements().rest);
}

TEST(Rest, ABodyAtRestWakesToTheForceThatItWouldHaveGiven) {
  // Pressed, left, wetted, pressed again; with and without sleep in between.
  std::vector<double> force[2];
  int slept = 0;
  for (const bool may_rest : {false, true}) {
    Params params = make_touch_params();
    params.rest_speed = may_rest ? 1e-6 : 0.0;
    Simulation simulation(make_floor_bar(), contact::make_sphere_tool(0.005, 1), params,
                          at_height(0.03, device::ToolMode::push));
    for (int k = 0; k < 800; ++k) {
      const bool presses = k < 60 || k > 700;
      const auto mode = k > 500 && !presses ? device::ToolMode::wet : device::ToolMode::push;
      const double z = presses ? 0.0242 : (mode == device::ToolMode::wet ? 0.0245 : 0.03);
      ASSERT_TRUE(simulation.tick(at_height(z, mode)).is_ok());
      force[may_rest].push_back(simulation.state().hand_force.z());
      slept += may_rest && simulation.state().is_at_rest;
    }
  }
  EXPECT_GT(slept, 200);
  double worst = 0.0;
  for (std::size_t k = 0; k < force[0].size(); ++k)
    worst = std::max(worst, std::abs(force[0][k] - force[1][k]));
  EXPECT_LT(worst, 1e-4 * *std::max_element(force[0].begin(), force[0].end()));
}

}  // namespace
}  // namespace argil::sim
