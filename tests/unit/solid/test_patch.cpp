// Patch tests: where an affine motion is the solution, every element and model must find it to round-off,
// whatever the mesh. And rigid turns, which are affine motions without force.
#include <Eigen/Cholesky>

#include <numbers>
#include <set>

#include "solid/loads.h"
#include "support/laws.h"
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kE = 2e5;
constexpr double kNu = 0.37;
constexpr double kRounding = 1e-11;  // of the motion: 1e-10 of the forces is where Newton's method stops

struct PatchCase {
  StrainModel model;
  ElementKind element;
  bool is_anisotropic;
};

/// Positive definite stiffness without any symmetry.
Mat6 make_triclinic_stiffness() {
  Rng rng(5);
  Mat6 a;
  for (int i = 0; i < 36; ++i) a(i) = rng.uniform(-0.4, 0.4);
  return kE * (a * a.transpose() + make_isotropic_stiffness(0.4, 0.3));
}

/// Gradient of the affine motion: stretched, sheared and, but for the small strain of the linear model,
/// turned.
Mat3 make_affine_gradient(StrainModel model) {
  Mat3 H;
  H << 0.06, 0.05, -0.02, 0.01, -0.07, 0.04, 0.03, -0.02, 0.05;
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(2, -1, 2) / 3.0).toRotationMatrix();
  return (find_law(model).is_linear ? Mat3(Mat3::Identity()) : turn) * (Mat3::Identity() + H);
}

class Patch : public testing::TestWithParam<PatchCase> {
 protected:
  Patch() : F(make_affine_gradient(GetParam().model)) {
    params.model = GetParam().model;
    params.element = GetParam().element;
    params.newton_tolerance = 1e-13;
    params.solver.kind = linear::SolverKind::cholesky;
    mesh = test::make_irregular_block(3, 3, 3, Vec3(0.3, 0.2, 0.25));
    topology = mesh::make_topology(mesh);
    elements = make_elements(mesh, topology, params.element);
  }
  Scene make_scene(std::vector<Support> supports) {
    Scene scene(mesh, std::move(supports), params, kE, kNu);
    if (GetParam().is_anisotropic)
      for (int t = 0; t < mesh.num_tets(); ++t) set_stiffness(scene.solid, t, make_triclinic_stiffness());
    return scene;
  }
  Support place(int node, std::array<bool, 3> fixes = {true, true, true}) const {
    Support support = test::hold_nodes({node}, fixes);
    support.displacement = (F - Mat3::Identity()) * elements.rest.col(node);
    return support;
  }
  std::vector<Support> place_boundary() const {
    std::vector<Support> supports;
    const std::vector<int> nodes(elements.surface.reshaped().begin(), elements.surface.reshaped().end());
    for (const int node : std::set<int>(nodes.begin(), nodes.end())) supports.push_back(place(node));
    return supports;
  }
  /// Consistent forces of the dead traction P N on the boundary.
  Points make_traction(const Mat3& P) const {
    Points force = Points::Zero(3, elements.num_nodes());
    const int per_face = elements.surface_per_face;
    for (Eigen::Index f = per_face - 1; f < elements.surface.cols(); f += per_face) {
      const Eigen::Vector3i n = elements.surface.col(f);
      const Vec3 a = elements.rest.col(n(0));
      const Vec3 area =
          0.5 * per_face * Vec3(elements.rest.col(n(1)) - a).cross(Vec3(elements.rest.col(n(2)) - a));
      for (const int node : n) force.col(node) += P * area / 3.0;
    }
    return force;
  }
  double error(const Scene& scene) const {
    return (scene.state.x - F * elements.rest).cwiseAbs().maxCoeff() / 0.3;
  }

  Mat3 F;
  SolidParams params;
  mesh::TetMesh mesh;
  mesh::Topology topology;
  Elements elements;
};

TEST_P(Patch, StaticBodyFollowsItsBoundary) {
  Scene scene = make_scene(place_boundary());
  const StepStatus status = scene.find_equilibrium();
  ASSERT_TRUE(status.is_ok()) << status.failure().quantity << status.failure().value;
  EXPECT_LT(error(scene), kRounding);
}

TEST_P(Patch, DampedBodyComesToRestThere) {
  params.rayleigh_mass = 300.0;
  params.rayleigh_stiffness = 1e-3;
  Scene scene = make_scene(place_boundary());
  scene.state.x = F * elements.rest;
  Rng rng(3);
  for (int n = 0; n < scene.num_nodes(); ++n)
    if (scene.solid.model.constraints.is_free(n))
      scene.state.x.col(n) += 1e-3 * Vec3(rng.uniform(), rng.uniform(), rng.uniform());
  ASSERT_TRUE(update_kinematics(scene.solid, scene.region, scene.state.x, 0).is_ok());
  for (int k = 0; k < 60; ++k) ASSERT_TRUE(scene.step(0.02).is_ok());
  EXPECT_LT(error(scene), kRounding);
  EXPECT_LT(scene.state.v.norm(), 1e-9);
}

TEST_P(Patch, StaticBodyUnderTheTractionsOfConstantStress) {
  // Six components of three nodes keep the body from moving as a whole.
  const auto at = [&](const Vec3& x) {
    Eigen::Index node = 0;
    (elements.rest.colwise() - x).colwise().norm().minCoeff(&node);
    return static_cast<int>(node);
  };
  Scene scene = make_scene({place(at(Vec3(0, 0, 0))), place(at(Vec3(0.3, 0, 0)), {false, true, true}),
                            place(at(Vec3(0, 0.2, 0)), {false, false, true})});
  const PointMotion motion = make_motion(params.model, F);
  const Mat6 C = make_triclinic_stiffness();
  const TetMaterial material = test::make_material(kE, kNu);
  Elasticity e{material.lambda, material.mu};
  if (GetParam().is_anisotropic) e.C = &C;
  scene.load = make_traction(compute_piola(params.model, motion, Vec6::Zero(), e));
  // The law's stress is checked against its energy elsewhere; the start lies aside, with the same turn.
  scene.state.x = motion.R * elements.rest;
  const StepStatus status = scene.find_equilibrium();
  ASSERT_TRUE(status.is_ok()) << status.failure().quantity << status.failure().value;
  EXPECT_LT(error(scene), 1e-9);  // held by three nodes only, the body is a hundred times softer
}

TEST_P(Patch, AnyRigidTurnIsWithoutForce) {
  if (find_law(params.model).is_linear) GTEST_SKIP() << "the linear model feels turns";
  Scene scene = make_scene({});
  for (const double angle : {0.1, 1.0, 2.0, 3.0, std::numbers::pi}) {
    const Mat3 Q = Eigen::AngleAxisd(angle, Vec3(1, -2, 2) / 3.0).toRotationMatrix();
    const Points f = scene.compute_force((Q * elements.rest).colwise() + Vec3(0.1, 0.2, 0.3));
    EXPECT_LT(f.cwiseAbs().maxCoeff(), 1e-13 * kE * 0.3 * 0.3) << angle;
  }
}

std::string name_case(const testing::TestParamInfo<PatchCase>& info) {
  const char* const elements[] = {"p1", "p1_nodal", "p2"};
  return std::string(find_law(info.param.model).name) + "_" + elements[static_cast<int>(info.param.element)] +
         (info.param.is_anisotropic ? "_triclinic" : "");
}

std::vector<PatchCase> make_cases() {
  std::vector<PatchCase> cases;
  for (const StrainModel model : test::every_model())
    for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2})
      for (const bool is_anisotropic : {false, true})
        if (!is_anisotropic || (find_law(model).takes_full_stiffness && element != ElementKind::p1_nodal))
          cases.push_back({model, element, is_anisotropic});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Every, Patch, testing::ValuesIn(make_cases()), name_case);

TEST(LinearModel, FeelsATurnByItsClosedForm) {
  // ε = sym(Q) − 1 = (cos θ − 1)(1 − a⊗a) for a turn θ about a; P = λ tr ε 1 + 2μ ε.
  const Vec3 a = Vec3(1, -2, 2) / 3.0;
  for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2}) {
    SolidParams params;
    params.model = StrainModel::linear;
    params.element = element;
    params.min_volume_ratio = -10.0;
    Scene scene(test::make_irregular_block(2, 2, 2, Vec3(0.3, 0.2, 0.25)), std::vector<Support>{}, params, kE,
                kNu);
    for (const double angle : {0.3, 1.2, 3.0}) {
      const Mat3 Q = Eigen::AngleAxisd(angle, a).toRotationMatrix();
      const double c = std::cos(angle) - 1.0;
      const TetMaterial m = test::make_material(kE, kNu);
      const Mat3 P =
          2.0 * m.lambda * c * Mat3::Identity() + 2.0 * m.mu * c * (Mat3::Identity() - a * a.transpose());
      // Total force on the half x < centre is the stress through it; on all corners: Σ f ⊗ X = V P.
      const Points f = scene.compute_force(Q * scene.rest());
      const Mat3 moment = f * scene.rest().transpose();
      EXPECT_LT((moment - 0.3 * 0.2 * 0.25 * P).norm(), 1e-12 * P.norm()) << angle;
    }
  }
}

TEST(PressureLoad, OnAllSidesIsHydrostaticStress) {
  for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2}) {
    SolidParams params;
    params.model = StrainModel::linear;
    params.element = element;
    params.solver.kind = linear::SolverKind::cholesky;
    Scene scene(test::make_irregular_block(3, 3, 3, Vec3(0.3, 0.2, 0.25)),
                {test::hold_nodes({0}), test::hold_nodes({3}, {false, true, true}),
                 test::hold_nodes({12}, {false, false, true})},
                params, kE, kNu);
    PressureLoad pressure;
    pressure.region.lower = Vec3::Constant(-1.0);
    pressure.region.upper = Vec3::Constant(1.0);
    pressure.pressure = 300.0;
    Loads loads;
    loads.pressure.push_back(pressure);
    scene.load =
        compute_load_force(scene.solid.model.elements, mesh::make_topology(scene.mesh).boundary, loads);
    ASSERT_TRUE(scene.find_equilibrium().is_ok());
    const double strain = -300.0 * (1.0 - 2.0 * kNu) / kE;  // −p/(3K)
    EXPECT_LT((scene.displacement() - strain * scene.rest()).cwiseAbs().maxCoeff(), 1e-9 * std::abs(strain));
  }
}

}  // namespace
}  // namespace argil::solid
