// No allocation in the calls of a water step.
#include <gtest/gtest.h>

#include "support/block_mesh.h"
#include "support/heap_count.h"
#include "water/water.h"

#ifdef ARGIL_COUNTS_HEAP

namespace argil::water {
namespace {

TEST(PoreWater, AllocatesNothingOnceItIsMade) {
  const mesh::TetMesh mesh = test::make_block(6, 6, 6, Vec3(0.1, 0.1, 0.1));
  const mesh::Topology topology = mesh::make_topology(mesh);
  for (const UptakeForm uptake : {UptakeForm::flux, UptakeForm::increment}) {
    WaterParams params;
    params.diffusivity = 5e-6;
    params.uptake = uptake;
    params.wetting_flux = 1.0;
    params.saturation_increment = 0.1;
    PoreWater water(mesh, topology, params, Field::Zero(mesh.num_tets()));
    const std::vector<int> tets = {topology.boundary_tet[5], topology.boundary_tet[17]};
    const double area[] = {1e-4, 1e-4};
    double mass = 0.0;
    const std::size_t before = test::count_allocations();
    for (int i = 0; i < 200; ++i) {
      water.move({tets, area, i < 100 ? 1 : -1}, 2.0);
      water.commit();
      mass += water.mass() + water.ledger_error();
    }
    EXPECT_EQ(test::count_allocations() - before, 0U);
    EXPECT_GT(mass, 0.0);
    EXPECT_EQ(water.num_active(), mesh.num_tets());  // the front went through the whole body meanwhile
  }
}

TEST(AllocationCount, SeesAnAllocation) {
  const std::size_t before = test::count_allocations();
  const Field field = Field::Zero(1000);
  const std::vector<int> list(1000, 1);
  EXPECT_GE(test::count_allocations() - before, 2U);
  EXPECT_EQ(field.sum() + list[3], 1.0);
}

}  // namespace
}  // namespace argil::water

#endif
