// Bodies and a hand's motion that no one here made: each body is pressed from above with a recorded motion,
// placed by a device-to-world transform. The run ends well, the hand feels the body push back, and contact
// gives the body no energy but the work it does. The clay kernel is left out: it scales velocities after the
// solve and so keeps no balance of energy.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "device/trace.h"
#include "embed/cage.h"
#include "mesh_files/readers.h"
#include "output/result_reader.h"
#include "run/run.h"
#include "support/scene_files.h"
#include "support/shared_data.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

constexpr const char* kMotion = "traces/unscrewing_prim02_02.csv";
const std::vector<std::string> kColumns = {"t", "x", "y", "z", "-", "-", "-", "qw", "qx", "qy", "qz"};

struct PublicBody {
  const char* file;
  double size;  // height or length to which it is scaled [m]
};

class PressedBody : public testing::TestWithParam<PublicBody> {};

/// The window of the motion around its lowest point: from `above` over it, going down, for `seconds`.
struct Window {
  double start = 0.0;
  Vec3 lowest = Vec3::Zero();
};

Window find_window(const device::Trace& trace, double above) {
  std::size_t lowest = 0;
  for (std::size_t i = 0; i < trace.samples.size(); ++i)
    if (trace.samples[i].position.z() < trace.samples[lowest].position.z()) lowest = i;
  const Vec3 bottom = trace.samples[lowest].position;
  std::size_t first = lowest;
  while (first > 0 && trace.samples[first].position.z() < bottom.z() + above) --first;
  return {trace.time[first] - trace.time[0], bottom};
}

std::string make_scenario(const std::string& body, const Vec3& translation, double start, double floor) {
  const auto text = [](double x) { return std::to_string(x); };
  return R"({"about": "a public body pressed with a recorded motion", "body": {)" + body +
         R"(, "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": )" + text(floor) + R"(}]},
  "material": {"youngs_modulus_Pa": 2e5, "poissons_ratio": 0.3,
    "plasticity": {"yield": 0.02, "creep_per_s": 10, "max": 0.5},
    "clay_kernel": {"form": "off"}},
  "tool": {"shape": {"kind": "sphere", "radius_m": 0.008, "subdivisions": 2}, "mode": "push"},
  "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 50, "edge_edge_stiffness_N_per_m": 50},
  "dynamics": {"rayleigh_stiffness_s": 0.001, "solver": {"tolerance": 1e-6}},
  "haptics": {"physics_period_ticks": 10, "frame_period_ticks": 100},
  "trace": {"file": ")" +
         test::shared_data(kMotion) +
         R"(", "columns": ["t","x","y","z","-","-","-","qw","qx","qy","qz"], "start_s": )" + text(start) +
         R"(, "duration_s": 0.6, "device_to_world": {"translation_m": [)" + text(translation.x()) + ", " +
         text(translation.y()) + ", " + text(translation.z()) + "]}}}";
}

TEST_P(PressedBody, PushesBackAndKeepsItsWits) {
  const PublicBody& body = GetParam();
  ARGIL_NEED_SHARED_DATA(body.file);
  ARGIL_NEED_SHARED_DATA(kMotion);
  const test::TempFolder folder;
  const std::string file = test::shared_data(body.file);
  const bool is_surface = file.ends_with(".obj");
  const Points raw =
      is_surface ? mesh_files::read_triangle_mesh(file).vertices : mesh_files::read_tet_mesh(file).vertices;
  const Vec3 extent = raw.rowwise().maxCoeff() - raw.rowwise().minCoeff();
  const double scale = body.size / extent.maxCoeff();
  std::string key = R"("mesh": {"file": ")" + file + R"(", "scale": )" + std::to_string(scale) + "}";
  Points vertices = std::stod(std::to_string(scale)) * raw;
  if (is_surface) {
    key = R"("surface": {"file": ")" + file + R"(", "target_tets": 5000, "scale": )" + std::to_string(scale) +
          "}";
    mesh::TriangleMesh surface = mesh_files::read_triangle_mesh(file, std::stod(std::to_string(scale)));
    vertices = embed::make_cage(surface, {5000}, file).mesh.vertices;
  }
  Eigen::Index top = 0;
  vertices.row(2).maxCoeff(&top);
  device::TraceOptions options;
  options.columns = kColumns;
  const double depth = 0.003;
  const Window window = find_window(device::read_trace(test::shared_data(kMotion), options), depth + 0.001);
  const Vec3 target = vertices.col(top) + Vec3(0, 0, 0.008 - depth);
  const double floor = vertices.row(2).minCoeff() + 0.25 * body.size * extent.z() / extent.maxCoeff();

  run::RunOptions run;
  run.quiet = true;
  run.scenario = test::write_text(folder / "scene.json",
                                  make_scenario(key, target - window.lowest, window.start, floor));
  run.output = folder / "out.h5";
  ASSERT_EQ(run::run(run), run::kDone);
  const output::ResultReader result(run.output);
  double largest = 0.0;
  double lift = 0.0;
  for (const sim::HapticRecord& record : result.read_haptic()) {
    ASSERT_TRUE(record.force.allFinite());
    if (record.force.norm() > largest) {
      largest = record.force.norm();
      lift = record.force.z();
    }
  }
  EXPECT_GT(largest, 0.02);        // the tool was 3 mm in the body's way
  EXPECT_GT(lift, 0.5 * largest);  // and is pushed up, out of it
  for (const sim::PhysicsRecord& record : result.read_physics()) {
    EXPECT_GT(record.min_volume_ratio, 0.0);
    EXPECT_GE(record.plastic_dissipation, 0.0);
    // What is stored and lost in the body came through the contact; rounding of the solve's tolerance apart.
    EXPECT_LE(record.elastic_energy + record.kinetic_energy + record.plastic_dissipation,
              record.contact_work + 1e-4 * std::abs(record.contact_work) + 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, PressedBody,
                         testing::Values(PublicBody{"tets/dinosaur.msh", 0.2},
                                         PublicBody{"tets/alien.msh", 0.2},
                                         PublicBody{"surface/Animated_Human.obj", 0.2},
                                         PublicBody{"surface/Stegosaurus.obj", 0.2}));

}  // namespace
}  // namespace argil
