// The order in which a file holds its tets is no one's concern but the file's: a run has the same bits, and
// what it says of tets is in the file's order.
#include <gtest/gtest.h>

#include <numeric>
#include <string>

#include "base/error.h"
#include "base/rng.h"
#include "output/result_reader.h"
#include "run/run.h"
#include "shapes/shapes.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

class TetOrder : public testing::Test {
 protected:
  test::TempFolder folder;
  mesh::TetMesh ball = shapes::make_shape_mesh({shapes::ShapeKind::sphere, 0.04}, 600);
  mesh::TetMesh other;     // the same in another order
  std::vector<int> place;  // of the other's tets in the ball

  void SetUp() override {
    ball.cell_fields["S"].resize(ball.num_tets());
    ball.cell_fields["E"].resize(ball.num_tets());
    Rng rng(7);
    for (int t = 0; t < ball.num_tets(); ++t) {
      ball.cell_fields["S"](t) = rng.uniform(0.0, 0.8);
      ball.cell_fields["E"](t) = rng.uniform(5e4, 2e5);
    }
    place.resize(static_cast<std::size_t>(ball.num_tets()));
    std::iota(place.begin(), place.end(), 0);
    for (std::size_t t = place.size() - 1; t > 0; --t)
      std::swap(place[t], place[static_cast<std::size_t>(rng.uniform() * static_cast<double>(t + 1))]);
    other = ball;
    other.tets = Tets(ball.tets(Eigen::all, place));
    for (auto& [name, field] : other.cell_fields) field = Field(ball.cell_fields[name](place));
  }

  /// What the run of a mesh ends with, and what it says.
  std::pair<int, std::string> run(const mesh::TetMesh& mesh, const std::string& name,
                                  const std::vector<std::string>& settings) {
    const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.042, 0.1, "push");
    std::string text = test::make_ball_scenario(trace);
    const std::string shape =
        R"("shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 0})";
    text.replace(text.find(shape), shape.size(),
                 R"("mesh": {"file": ")" + test::write_vtk(folder / (name + ".vtk"), mesh) +
                     R"(", "saturation_field": "S", "youngs_modulus_field": "E"})");
    run::RunOptions options;
    options.quiet = true;
    options.settings = settings;
    options.scenario = folder.write(name + ".json", text);
    options.output = folder / (name + ".h5");
    testing::internal::CaptureStderr();
    const int code = run::run(options);
    return {code, testing::internal::GetCapturedStderr()};
  }
};

TEST_F(TetOrder, OfTheFileLeavesARunAsItIs) {
  ASSERT_EQ(run(ball, "ball", {}).first, run::kDone);
  ASSERT_EQ(run(other, "other", {}).first, run::kDone);
  const output::ResultReader a(folder / "ball.h5"), b(folder / "other.h5");
  EXPECT_TRUE((a.read_header().tets.array() == ball.tets.array()).all());
  EXPECT_TRUE((b.read_header().tets.array() == other.tets.array()).all());
  const auto forces = a.read_haptic();
  const auto other_forces = b.read_haptic();
  ASSERT_EQ(forces.size(), other_forces.size());
  double peak = 0.0;
  for (std::size_t k = 0; k < forces.size(); ++k) {
    EXPECT_EQ(forces[k].force, other_forces[k].force) << k;
    peak = std::max(peak, forces[k].force.norm());
  }
  EXPECT_GT(peak, 0.1);
  const sim::Frame first = a.read_frame(a.read_frame_list().front());
  EXPECT_TRUE((first.saturation.array() == ball.cell_fields["S"].array()).all());
  const sim::Frame last = a.read_frame(a.read_frame_list().back());
  const sim::Frame other_last = b.read_frame(b.read_frame_list().back());
  EXPECT_GT(last.plastic_strain.norm(), 0.0);
  EXPECT_TRUE((last.position.array() == other_last.position.array()).all());
  EXPECT_TRUE((last.saturation(place).array() == other_last.saturation.array()).all());
  EXPECT_TRUE((last.plastic_strain(Eigen::all, place).array() == other_last.plastic_strain.array()).all());
}

TEST_F(TetOrder, OfTheFileIsThatOfMessages) {
  const auto find_element = [&](const mesh::TetMesh& mesh, const std::string& name) {
    const auto [code, text] = run(mesh, name, {"/dynamics/min_volume_ratio=0.97", "/dynamics/strict=true"});
    EXPECT_EQ(code, run::kRunFailed) << text;
    const std::size_t at = text.find("element ");
    return at == std::string::npos ? -1 : std::stoi(text.substr(at + 8));
  };
  const int element = find_element(ball, "ball");
  const int other_element = find_element(other, "other");
  ASSERT_GE(element, 0);
  ASSERT_GE(other_element, 0);
  EXPECT_EQ(element, place[static_cast<std::size_t>(other_element)]);
  ball.cell_fields["E"](17) = -1.0;
  ARGIL_EXPECT_THROW_WITH(run(ball, "ball", {}), InputError, "tet 17");
  testing::internal::GetCapturedStderr();
}

}  // namespace
}  // namespace argil
