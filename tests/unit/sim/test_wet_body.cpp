// What water does to the body as a whole: direction, size and weight, against closed forms of a bar.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_mesh.h"
#include "support/laws.h"

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

/// Wet bar of `cells` along its length on three smooth walls.
Body make_bar(double saturation, int cells = 5) {
  Body body;
  body.mesh = test::make_block(cells, 2, 2, Vec3(kLength, kWidth, kWidth));
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
  return simulation.body_state().solid.x.col(corner);
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
      ASSERT_TRUE(simulation.find_equilibrium().is_ok());
      const Vec3 moved = find_corner(simulation) - Vec3(kLength, kWidth, kWidth);
      EXPECT_NEAR(moved.x(), pull, 1e-15);
      EXPECT_NEAR(moved.y(), 0.01 * kWidth * c.y / c.along, 1e-9 * kWidth);
      EXPECT_NEAR(moved.z(), 0.01 * kWidth * c.z / c.along, 1e-9 * kWidth);
      const double energy = simulation.physics_record().elastic_energy;  // ½ E ε² V
      EXPECT_NEAR(energy, 0.5 / c.along * 1e-4 * kLength * kWidth * kWidth, 1e-9 * energy);
    }
  EXPECT_GT(S(2, 2), 1.5 * S(0, 0));  // flat pores: far softer along their axis
}

/// A bar held between six smooth walls and pulled: its halves are two springs in a row, each as stiff as clay
/// in uniaxial strain, and the middle goes C₂/(C₁ + C₂) of the way.
double find_middle(Body body, const Params& params) {
  body.supports.push_back(make_roller(0, kLength, 0.01 * kLength));
  for (const int k : {1, 2}) body.supports.push_back(make_roller(k, kWidth, 0.0));
  const Points rest = body.mesh.vertices;
  Simulation simulation = make_simulation(std::move(body), params);
  EXPECT_TRUE(simulation.find_equilibrium().is_ok());
  Eigen::Index node = 0;
  (rest.colwise() - Vec3(0.5 * kLength, 0.5 * kWidth, 0.5 * kWidth)).colwise().norm().minCoeff(&node);
  EXPECT_LT(std::abs(rest(0, node) - 0.5 * kLength), 1e-15);
  return (simulation.body_state().solid.x(0, node) - rest(0, node)) / (0.01 * kLength);
}

/// Is the tet in the half at the wall x = 0?
bool is_in_first_half(const mesh::TetMesh& mesh, int tet) {
  double x = 0.0;
  for (int i = 0; i < 4; ++i) x += 0.25 * mesh.vertices(0, mesh.tets(i, tet));
  return x < 0.5 * kLength;
}

TEST(AlignedPores, OfEachHalfOfABarGiveThatHalfItsStiffness) {
  Params params = make_params();
  params.moisture.medium.aspect = 0.1;
  params.moisture.medium.orientation = material::Orientation::aligned;
  const Mat6 C = material::compute_effective_medium(params.elastic, params.moisture.medium, 0.4).stiffness;
  EXPECT_GT(C(0, 0), 1.5 * C(2, 2));
  for (const bool first : {false, true}) {
    Body body = make_bar(1.0, 6);
    body.pore_axis.resize(3, body.mesh.num_tets());
    for (int t = 0; t < body.mesh.num_tets(); ++t)
      body.pore_axis.col(t) =
          is_in_first_half(body.mesh, t) == first ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitZ());
    const double soft = C(2, 2) / (C(0, 0) + C(2, 2));  // along x lies the soft direction of the marked half
    EXPECT_NEAR(find_middle(std::move(body), params), first ? 1.0 - soft : soft, 1e-10);
  }
}

TEST(YoungsModulus, OfEachTetIsTheDryOneThatItsWaterIsAddedTo) {
  // Halves of 100 and 300 kPa. Drained clay: their moduli stay as 1 to 3. With water of 1 MPa the stiffness
  // of each is that of eq. 6's relatives for its own E; the same for aligned pores.
  for (const material::Orientation orientation :
       {material::Orientation::random, material::Orientation::aligned})
    for (const double K_I : {0.0, 1e6}) {
      Params params = make_params();
      params.moisture.medium.aspect = 0.2;
      params.moisture.medium.orientation = orientation;
      params.moisture.medium.axis = Vec3::UnitX();
      params.moisture.medium.fluid_bulk_modulus = K_I;
      const auto compute_stiffness = [&](double E) {
        const Mat6 C = material::compute_effective_medium({E, 0.3}, params.moisture.medium, 0.4).stiffness;
        return C(2, 2);  // axis 3 of the pores, along x
      };
      Body body = make_bar(1.0, 6);
      body.youngs_modulus.resize(body.mesh.num_tets());
      for (int t = 0; t < body.mesh.num_tets(); ++t)
        body.youngs_modulus(t) = is_in_first_half(body.mesh, t) ? 1e5 : 3e5;
      const double C1 = compute_stiffness(1e5);
      const double C2 = compute_stiffness(3e5);
      EXPECT_NEAR(find_middle(std::move(body), params), C2 / (C1 + C2), 1e-10);
      if (K_I == 0.0)
        EXPECT_NEAR(C2 / C1, 3.0, 1e-13);
      else
        EXPECT_LT(C2 / C1, 2.8);
    }
}

TEST(YoungsModulus, OfAMeshReplacesTheMaterialsWhateverThatWas) {
  // The same field over a material of 100 kPa and of 1 MPa: the same bar, under every law of moisture.
  const auto sag = [](const Params& base, double material_E) {
    Params params = base;
    params.elastic.youngs_modulus = material_E;
    params.solid.gravity = {9.81, 0.0, 0.0};
    if (params.moisture.law ==
        material::MoistureLaw::table)  // a curve is the material's own, from dry to wet
      params.moisture.table_youngs_modulus = {material_E, 0.7 * material_E, 0.2 * material_E};
    Body body = make_bar(0.377);
    body.youngs_modulus = Field::Constant(body.mesh.num_tets(), 1e5);
    Simulation simulation = make_simulation(std::move(body), params);
    EXPECT_TRUE(simulation.find_equilibrium().is_ok());
    return Points(simulation.body_state().solid.x - simulation.body().mesh.vertices);
  };
  std::vector<Params> laws(4, make_params());
  laws[0].moisture.medium.fluid_bulk_modulus = 1e6;
  laws[1].moisture.medium.fluid_bulk_modulus = 1e6;
  laws[1].moisture.medium.aspect = 0.2;
  laws[1].moisture.medium.orientation = material::Orientation::aligned;
  laws[2].moisture.law = material::MoistureLaw::liquidity_index;
  laws[3].moisture.law = material::MoistureLaw::table;
  laws[3].moisture.table_saturation = {0.0, 0.4, 1.0};
  laws[3].moisture.table_yield = {0.02, 0.02, 0.02};
  for (const Params& params : laws) {
    const Points soft = sag(params, 1e5);
    EXPECT_GT(soft.norm(), 1e-4);
    EXPECT_LT((sag(params, 1e6) - soft).norm(), 1e-12 * soft.norm());
  }
}

TEST(Swelling, MakesAFreeBarGrowAlikeInAllDirectionsWithoutStress) {
  // Rest volume times 1 + 0.3·S: every length times the cube root, for every law and element.
  for (const solid::StrainModel model : test::every_model())
    for (const solid::ElementKind element :
         {solid::ElementKind::p1, solid::ElementKind::p1_nodal, solid::ElementKind::p2}) {
      Params params = make_params();
      params.solid.model = model;
      params.solid.element = element;
      params.water.swelling = 0.3;
      Simulation simulation = make_simulation(make_bar(0.5), params);
      ASSERT_TRUE(simulation.find_equilibrium().is_ok());
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
  ASSERT_TRUE(simulation.find_equilibrium().is_ok());
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
      EXPECT_NEAR(simulation.solid().materials.mass().sum(), density * kLength * kWidth * kWidth, 1e-15);
      ASSERT_TRUE(simulation.find_equilibrium().is_ok());
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

TEST(Uptake, IsFluxTimesTheFootprintOfAFlatToolTimesTime) {
  // A box of 30 mm × 10 mm, flat on the middle of the bar's upper side: its footprint is 3 cm², however the
  // faces below are cut. One tick of 1 ms; a dry tool takes at its own rate. Wholly wet tets would take less.
  const mesh::TetMesh block = test::make_block(1, 1, 1, Vec3(0.03, 0.01, 0.01));
  const mesh::TriangleMesh tool{block.vertices, mesh::make_topology(block).boundary};
  for (const solid::ElementKind element : {solid::ElementKind::p1, solid::ElementKind::p2})
    for (const bool wet : {true, false}) {
      Params params = make_touch_params();
      params.solid.element = element;
      params.water.wetting_flux = 2.0;
      params.water.drying_flux = 0.7;
      Body body = make_floor_bar();
      body.initial_saturation.setConstant(0.5);
      const device::ToolMode mode = wet ? device::ToolMode::wet : device::ToolMode::dry;
      device::DeviceSample sample;
      sample.position = {0.031, 0.0047, 0.021};
      sample.mode = mode;
      Simulation simulation(std::move(body), tool, params, sample);
      sample.position.z() = 0.0195;
      ASSERT_TRUE(simulation.tick(sample).is_ok());
      const water::WaterLedger ledger = simulation.pore_water().ledger();
      const double moved = (wet ? 2.0 : 0.7) * 0.03 * 0.01 * 0.001;
      EXPECT_NEAR(ledger.added, wet ? moved : 0.0, 1e-12 * moved);
      EXPECT_NEAR(ledger.removed, wet ? 0.0 : moved, 1e-12 * moved);
    }
}

TEST(Rest, AWetToolLeavesAnUntouchedBodyInPlaceBitForBit) {
  Simulation simulation(make_floor_bar(), contact::make_sphere_tool(0.005, 1), make_touch_params(),
                        at_height(0.03, device::ToolMode::wet));
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(simulation.tick(at_height(0.0245, device::ToolMode::wet)).is_ok());
  EXPECT_GT(simulation.hand_state().hand_force.z(), 0.01);
  EXPECT_GT(simulation.pore_water().mass(), 1e-7);
  EXPECT_TRUE(simulation.body_state().is_at_rest);
  EXPECT_EQ(simulation.body_state().solid.x, simulation.solid().model.elements.rest);
}

TEST(Rest, ContactTakesTheBodyFromWhereTheLastDetectionLeftIt) {
  // No motion of the body is skipped and none seen twice, whether it rests or not: a detection ends at the
  // body before the tick's own step, and there the next begins.
  Params params = make_touch_params();
  params.rest_speed = 1e-6;
  Simulation simulation(make_floor_bar(), contact::make_sphere_tool(0.005, 1), params,
                        at_height(0.03, device::ToolMode::push));
  int moved = 0, slept = 0;
  for (int k = 0; k < 800; ++k) {
    const Points x = simulation.body_state().solid.x;
    const bool presses = k < 60 || k > 700;
    ASSERT_TRUE(simulation.tick(at_height(presses ? 0.0242 : 0.03, device::ToolMode::push)).is_ok());
    ASSERT_EQ(simulation.hand().surface_x(), x) << k;
    moved += simulation.body_state().solid.x != x;
    slept += simulation.body_state().is_at_rest;
  }
  EXPECT_GT(moved, 100);
  EXPECT_GT(slept, 200);
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
      force[may_rest].push_back(simulation.hand_state().hand_force.z());
      slept += may_rest && simulation.body_state().is_at_rest;
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
