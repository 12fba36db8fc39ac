// Cages of 40 000 tets: the same demands as in test_cage.cpp, too slow for the quick set.
#include <gtest/gtest.h>

#include "mesh_files/readers.h"
#include "support/shared_data.h"
#include "unit/embed/cage_checks.h"

namespace argil::embed {
namespace {

TEST(MakeLargeCage, EnclosesAStandingFigure) {
  ARGIL_NEED_SHARED_DATA("surface/Animated_Human.obj");
  expect_good_cage(mesh_files::read_triangle_mesh(test::shared_data("surface/Animated_Human.obj")), 40000,
                   "Animated_Human.obj");
}

TEST(MakeLargeCage, EnclosesADinosaurWithHolesAndDegenerateFaces) {
  ARGIL_NEED_SHARED_DATA("surface/Stegosaurus.obj");
  expect_good_cage(mesh_files::read_triangle_mesh(test::shared_data("surface/Stegosaurus.obj")), 40000,
                   "Stegosaurus.obj");
}

TEST(MakeLargeCage, EnclosesABladeMuchThinnerThanItsLattice) {
  ARGIL_NEED_SHARED_DATA("surface/sword.obj");
  expect_good_cage(mesh_files::read_triangle_mesh(test::shared_data("surface/sword.obj")), 2000, "sword.obj");
}

}  // namespace
}  // namespace argil::embed
