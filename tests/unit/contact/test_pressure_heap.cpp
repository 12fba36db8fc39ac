// Pressure takes nothing from the heap once it has met what it will meet.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/pressure.h"
#include "contact/tool_shape.h"
#include "support/heap_count.h"
#include "unit/contact/scenes.h"

namespace argil::contact {
namespace {

#ifdef ARGIL_COUNTS_HEAP
TEST(Pressure, TakesNothingFromTheHeapAfterItsWarmUp) {
  constexpr double kRadius = 0.008;
  const mesh::TriangleMesh plane = test::make_flat_slab(20);
  const Field ones = Field::Ones(plane.triangles.cols());
  for (const Yielding yielding : {Yielding::yes, Yielding::no})
    for (const bool is_mesh : {false, true}) {
      const mesh::TriangleMesh drawn = make_sphere_tool(kRadius, 2);
      PressureContact pressure(
          plane.triangles, plane.num_vertices(),
          is_mesh ? ToolSolid(drawn) : ToolSolid(RoundTool{kRadius, 0.0, kRadius, false}),
          SurfaceStiffness{1e8 * ones, 1e5 * ones});
      Contacts contacts;
      const auto lap = [&] {
        Vec3 last(0.0, 0.001, kRadius + 1e-4);
        for (int i = 1; i <= 40; ++i) {
          const Vec3 next(0.001 * std::sin(0.3 * i), 0.001, kRadius + 1e-4 - 1e-4 * std::min(i, 40 - i));
          pressure.advance(plane.vertices, plane.vertices, 0.0);
          pressure.find_contacts(plane.vertices, Pose{last}, Pose{next}, yielding, contacts);
          last = next;
        }
      };
      lap();
      lap();
      const std::size_t before = argil::test::count_allocations();
      lap();
      EXPECT_EQ(argil::test::count_allocations() - before, 0U) << is_mesh;
    }
}
#endif

}  // namespace
}  // namespace argil::contact
