// A ball in a dent whose surface is cut into other triangles: it goes on pressing as hard, and where it did.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/kept_pressure.h"

namespace argil::sim {
namespace {

constexpr double kRadius = 0.006;   // [m] of the ball, about the origin
constexpr double kPatch = 0.003;    // [m] of the dent that it presses on
constexpr double kPerArea = 3e9;    // κ [Pa/m]: the pressures below are depths of micrometres
constexpr double kPressure = 60e3;  // [Pa] in the middle

/// A square of 12 mm that follows the ball from below within `bend` of the axis and is flat beyond, in
/// triangles of one size, turned by `angle`.
mesh::TriangleMesh make_dent(int cells, double angle) {
  constexpr double kEdge = 0.012, kBend = 0.004;
  mesh::TriangleMesh dent;
  dent.vertices.resize(3, (cells + 1) * (cells + 1));
  dent.triangles.resize(3, 2 * cells * cells);
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const double u = kEdge * (static_cast<double>(i) / cells - 0.5);
      const double v = kEdge * (static_cast<double>(j) / cells - 0.5);
      const double x = std::cos(angle) * u - std::sin(angle) * v,
                   y = std::sin(angle) * u + std::cos(angle) * v;
      const double r = std::min(std::hypot(x, y), kBend);
      dent.vertices.col(j * (cells + 1) + i) = Vec3(x, y, -std::sqrt(kRadius * kRadius - r * r));
    }
  int t = 0;
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      dent.triangles.col(t++) << a, b, d;
      dent.triangles.col(t++) << a, d, c;
    }
  return dent;
}

/// Hertz's pressure, on points of the ball that lie in a square grid.
std::vector<PressedPoint> make_pressure() {
  constexpr double kSpacing = 3e-4;
  std::vector<PressedPoint> points;
  for (int i = -10; i <= 10; ++i)
    for (int j = -10; j <= 10; ++j) {
      const double x = kSpacing * i, y = kSpacing * j, share = (x * x + y * y) / (kPatch * kPatch);
      if (share >= 1.0) continue;
      const double down = std::sqrt(kRadius * kRadius - x * x - y * y);
      const double area = kSpacing * kSpacing * kRadius / down;
      points.push_back({{x, y, -down}, kPressure * std::sqrt(1.0 - share) * area, area});
    }
  return points;
}

struct Pressed {
  Vec3 force = Vec3::Zero();
  double spread = 0.0;  ///< mean distance from the axis, by force [m]
};

Pressed press(const Points& x, contact::PressureContact& law) {
  contact::Contacts contacts;
  law.prepare(x);
  law.find_contacts(x, {}, {}, contact::Yielding::yes, contacts);
  Pressed pressed;
  double sum = 0.0;
  for (const contact::Contact& c : contacts.contacts) {
    pressed.force += c.force;
    pressed.spread += c.force.norm() * c.point.head<2>().norm();
    sum += c.force.norm();
  }
  pressed.spread /= sum;
  return pressed;
}

class KeptPressure : public testing::TestWithParam<int> {};

TEST_P(KeptPressure, IsThatOfTheSurfaceBefore) {
  // Over a flat disc: ⅔ π a² p, as far as the ball's slope is small; its mean distance is 3π/16 a of Hertz's.
  const std::vector<PressedPoint> before = make_pressure();
  double force = 0.0;
  for (const PressedPoint& p : before) force -= p.force * p.place.z() / kRadius;
  ASSERT_NEAR(force, 2.0 / 3.0 * std::numbers::pi * kPatch * kPatch * kPressure, 0.02 * force);

  const mesh::TriangleMesh surface = make_dent(GetParam(), 0.3);
  contact::ToolSolid ball(contact::RoundTool{kRadius, 0.0, kRadius, false});
  const Field per_area = Field::Constant(surface.num_triangles(), kPerArea);
  contact::PressureContact law(surface.triangles, surface.num_vertices(),
                               contact::ToolSolid(contact::RoundTool{kRadius, 0.0, kRadius, false}),
                               {per_area, Field::Constant(surface.num_triangles(), 1e6)}, true);
  // As it lies it is pressed by nothing, or by what facets lie in the ball between their corners.
  ASSERT_GT(std::abs(press(surface.vertices, law).force.norm() - force), 0.5 * force);
  const Points laid = keep_pressure(before, {ball, {}, force}, surface.triangles, surface.vertices, law);
  const Pressed now = press(laid, law);
  EXPECT_NEAR(now.force.z(), -force, 0.02 * force);
  EXPECT_LT(now.force.head<2>().norm(), 0.02 * force);
  EXPECT_NEAR(now.spread, 3.0 * std::numbers::pi / 16.0 * kPatch, 0.12 * kPatch);
  EXPECT_LT((laid - surface.vertices).colwise().norm().maxCoeff(), 0.1 * 0.012 / GetParam());
}

INSTANTIATE_TEST_SUITE_P(Cells, KeptPressure, testing::Values(16, 24, 40));

}  // namespace
}  // namespace argil::sim
