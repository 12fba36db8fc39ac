// Forces of the whole body are the derivative of its energy, for every model, element and history.
#include <Eigen/Eigenvalues>

#include <ostream>
#include <string>
#include <vector>

#include "support/laws.h"
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

struct GradientCase {
  StrainModel model;
  ElementKind element;
  bool is_anisotropic;
  bool is_plastic;
  bool is_swollen;
};

std::string name_element(ElementKind element) {
  if (element == ElementKind::p2) return "p2";
  return element == ElementKind::p1_nodal ? "p1_nodal" : "p1";
}

std::string name_case(const GradientCase& c) {
  return std::string(find_law(c.model).name) + "_" + name_element(c.element) +
         (c.is_anisotropic ? "_anisotropic" : "") + (c.is_plastic ? "_plastic" : "") +
         (c.is_swollen ? "_swollen" : "");
}

void PrintTo(const GradientCase& c, std::ostream* out) {
  *out << name_case(c);
}

/// Every combination that a body may have: some laws are isotropic or elastic only, and so is p1_nodal
/// isotropic.
std::vector<GradientCase> make_cases() {
  std::vector<GradientCase> cases;
  for (const StrainModel model : test::every_model())
    for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2})
      for (const bool is_anisotropic : {false, true})
        for (const bool is_plastic : {false, true})
          for (const bool is_swollen : {false, true}) {
            const ElasticLaw& law = find_law(model);
            if (is_anisotropic && (!law.takes_full_stiffness || element == ElementKind::p1_nodal)) continue;
            cases.push_back({model, element, is_anisotropic, is_plastic, is_swollen});
          }
  return cases;
}

class Gradient : public testing::TestWithParam<GradientCase> {};

TEST_P(Gradient, ForceIsTheDerivativeOfTheEnergy) {
  const auto [model, element, is_anisotropic, is_plastic, is_swollen] = GetParam();
  SolidParams params;
  params.model = model;
  params.element = element;
  Scene scene(test::make_irregular_block(2, 2, 2, Vec3(1.0, 0.8, 0.9)), {}, params, 10.0, 0.46);
  Rng rng(2);
  for (int t = 0; t < scene.mesh.num_tets(); ++t) {
    set_material(scene.solid, scene.region, t,
                 test::make_material(rng.uniform(5, 20), rng.uniform(0.25, 0.48)));
    Mat6 C = make_isotropic_stiffness(3.0, 4.0);
    C(0, 1) = C(1, 0) = C(0, 1) + rng.uniform(-1, 1);
    C(2, 4) = C(4, 2) = rng.uniform(-1, 1);
    if (is_anisotropic) set_stiffness(scene.solid, t, C);
  }
  if (is_plastic)
    for (Eigen::Index i = 0; i < scene.state.plastic_strain.size(); ++i)
      scene.state.plastic_strain(i) = rng.uniform(-0.05, 0.05);
  if (is_swollen)
    for (int t = 0; t < scene.mesh.num_tets(); ++t) set_swelling(scene.solid, t, 1.0 + rng.uniform(0.0, 0.3));
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(2, 1, -2) / 3.0).toRotationMatrix();
  const auto random_points = [&](double scale) {
    Points u(3, scene.num_nodes());
    for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = rng.uniform(-scale, scale);
    return u;
  };
  const Points x = (find_law(model).is_linear ? Mat3(Mat3::Identity()) : turn) *
                   (scene.rest() + random_points(element == ElementKind::p2 ? 0.015 : 0.04));
  const auto energy = [&](const Points& at) {
    EXPECT_TRUE(update_kinematics(scene.solid, scene.region, at, 0).is_ok());
    return scene.compute_elastic_energy();
  };
  const Points f = scene.compute_force(x);
  for (int i = 0; i < 5; ++i) {
    const Points u = random_points(1.0);
    const double d = 1e-4;  // fourth-order differences: error some 1e-13 by d⁴, 1e-12 by rounding
    const double slope =
        (8.0 * (energy(x + d * u) - energy(x - d * u)) - (energy(x + 2 * d * u) - energy(x - 2 * d * u))) /
        (12.0 * d);
    EXPECT_NEAR(f.cwiseProduct(u).sum(), slope, 1e-8 * f.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Gradient, testing::ValuesIn(make_cases()),
                         [](const auto& each) { return name_case(each.param); });

TEST(ElasticEnergy, FollowsTheMaterialWithoutAStepBetween) {
  SolidParams params;
  params.element = ElementKind::p1_nodal;
  Scene scene(test::make_block(2, 2, 2, Vec3(1, 1, 1)), {}, params, 10.0, 0.3);
  ASSERT_TRUE(update_kinematics(scene.solid, scene.region, 1.1 * scene.rest(), 0).is_ok());
  for (int t = 0; t < scene.mesh.num_tets(); ++t)
    set_material(scene.solid, scene.region, t, test::make_material(10.0, 0.49));
  // ½ K θ² V with θ = 3·0.1 in the corotational measure, K = E/(3(1 − 2ν)).
  const double K = 10.0 / (3.0 * 0.02);
  EXPECT_NEAR(scene.compute_elastic_energy(), 0.5 * K * 0.09, 1e-12 * K);
}

TEST(AnisotropicStiffness, EndsWhenTheTetBecomesIsotropicAgain) {
  SolidParams params;
  Scene scene(test::make_block(1, 1, 1, Vec3(1, 1, 1)), {}, params, 10.0, 0.3);
  const Points x = Vec3(1.1, 0.9, 1.0).asDiagonal() * scene.rest();
  const Points expected = scene.compute_force(x);
  for (int t = 0; t < scene.mesh.num_tets(); ++t) {
    set_stiffness(scene.solid, t, make_isotropic_stiffness(1.0, 1.0));
    set_material(scene.solid, scene.region, t, test::make_material(10.0, 0.3));
  }
  EXPECT_LT((scene.compute_force(x) - expected).norm(), 1e-14 * expected.norm());
}

}  // namespace
}  // namespace argil::solid
