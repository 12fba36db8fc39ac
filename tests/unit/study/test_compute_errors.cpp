// Errors of one result against another, by closed forms: both are written here with known forces and fields.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "output/result_file.h"
#include "study/displacement_field.h"
#include "study/measure.h"
#include "support/block_mesh.h"
#include "support/temp_folder.h"

namespace argil::study {
namespace {

using Map = std::function<Vec3(const Vec3&)>;
using solid::ElementKind;

/// What a result holds that errors are made of.
struct Made {
  mesh::TetMesh mesh = test::make_block(2, 2, 2, Vec3::Ones());
  double period = 1e-3;  // [s] of the ticks
  std::vector<Vec3> forces = {Vec3(0, 0, 1)};
  std::vector<Tick> frames = {1};  // ticks
  Map displacement = [](const Vec3&) { return Vec3(0, 0, 0.1); };
  std::function<double(Eigen::Index)> saturation = [](Eigen::Index) { return 0.5; };
  Points skin = Points::Identity(3, 3);
  Triangles skin_triangles = Eigen::Vector3i(0, 1, 2);
  Vec3 skin_shift = Vec3(0.1, 0, 0);
  double dissipation = 2.0;  // [J] at the end
};

class Errors : public testing::Test {
 protected:
  test::TempFolder folder;

  /// A result whose ticks are 1, 2, …, and whose frame 0 is at rest.
  std::string write(const std::string& name, const Made& made) const {
    output::ResultHeader header;
    header.rest_position = made.mesh.vertices;
    header.tets = made.mesh.tets;
    header.surface_triangles = Triangles(3, 0);
    header.skin_triangles = made.skin_triangles;
    header.haptic_period = made.period;
    output::ResultFile file(folder / name, header);
    std::vector<Tick> ticks = made.frames;
    ticks.insert(ticks.begin(), 0);
    for (const Tick tick : ticks) {
      sim::Frame frame;
      frame.tick = tick;
      frame.time = static_cast<double>(tick) * made.period;
      frame.position = made.mesh.vertices;
      frame.skin_position = made.skin;
      if (tick > 0) {
        for (Eigen::Index v = 0; v < frame.position.cols(); ++v)
          frame.position.col(v) += made.displacement(made.mesh.vertices.col(v));
        frame.skin_position.colwise() += made.skin_shift;
      }
      frame.saturation.resize(made.mesh.num_tets());
      for (Eigen::Index t = 0; t < frame.saturation.size(); ++t) frame.saturation(t) = made.saturation(t);
      frame.plastic_strain = TensorField::Zero(6, made.mesh.num_tets());
      frame.skin_saturation = frame.skin_influence = Field::Zero(made.skin.cols());
      frame.state_hash = std::string(64, '0');
      file.append(frame);
    }
    for (std::size_t k = 0; k < made.forces.size(); ++k) {
      sim::HapticRecord haptic;
      haptic.tick = static_cast<Tick>(k) + 1;
      haptic.time = static_cast<double>(k + 1) * made.period;
      haptic.force = made.forces[k];
      file.append(haptic);
      sim::PhysicsRecord physics;
      physics.tick = haptic.tick;
      physics.time = haptic.time;
      physics.plastic_dissipation =
          made.dissipation * static_cast<double>(k + 1) / static_cast<double>(made.forces.size());
      file.append(physics);
    }
    file.finish(std::nullopt);
    return folder / name;
  }
  RunErrors compare(const Made& run, const Made& truth, const ComparedElements& elements = {}) const {
    const output::ResultReader a(write("run.h5", run));
    const output::ResultReader b(write("truth.h5", truth));
    return compute_errors(a, b, elements);
  }
};

/// u = A x of the unit block, and its like.
Map linear(const Mat3& A) {
  return [A](const Vec3& x) -> Vec3 { return A * x; };
}
Mat3 some_gradient() {
  Mat3 A;
  A << 0.1, -0.2, 0.3, 0.05, 0.4, -0.1, 0.2, 0.1, -0.3;
  return A;
}

TEST_F(Errors, OfARunWithItselfAreNone) {
  const RunErrors e = compare({}, {});
  for (const double error : {e.force, e.peak_force, e.above_7_percent, e.above_10_percent, e.displacement,
                             e.skin, e.saturation, e.dissipation})
    EXPECT_EQ(error, 0.0);
}

TEST_F(Errors, OfForcesGoByTheirTicks) {
  // The truth is k N in tick k of 100; the run 5 % more up to 50, 8 % up to 75, 20 % beyond.
  Made run, truth;
  run.forces.clear();
  truth.forces.clear();
  for (int k = 1; k <= 100; ++k) {
    truth.forces.emplace_back(0, 0, k);
    run.forces.emplace_back(0, 0, k * (k <= 50 ? 1.05 : k <= 75 ? 1.08 : 1.2));
  }
  const auto squares = [](double n) { return n * (n + 1) * (2 * n + 1) / 6; };  // 1 + 4 + … + n²
  const double difference =
      0.0025 * squares(50) + 0.0064 * (squares(75) - squares(50)) + 0.04 * (squares(100) - squares(75));
  const RunErrors e = compare(run, truth);
  EXPECT_NEAR(e.force, std::sqrt(difference / squares(100)), 1e-14);
  EXPECT_NEAR(e.peak_force, 0.2, 1e-14);
  // In touch is what is above a twentieth of the peak: 6 to 100.
  EXPECT_NEAR(e.above_7_percent, 50.0 / 95.0, 1e-14);
  EXPECT_NEAR(e.above_10_percent, 25.0 / 95.0, 1e-14);
}

TEST_F(Errors, OfForcesAreOfVectors) {
  // Beside the truth, not beyond it: the peak hardly tells.
  Made run, truth;
  truth.forces = {Vec3(0, 0, 3), Vec3(0, 0, 4)};
  run.forces = {Vec3(3, 0, 3), Vec3(0, 0, 4)};
  const RunErrors e = compare(run, truth);
  EXPECT_NEAR(e.force, 3.0 / 5.0, 1e-15);
  EXPECT_NEAR(e.peak_force, (std::sqrt(18.0) - 4.0) / 4.0, 1e-15);
  EXPECT_EQ(e.above_10_percent, 0.5);
}

TEST_F(Errors, AreTakenAtTheRunsTicksAndTheFramesThatBothHave) {
  Made run, truth;
  truth.period = 0.5e-3;
  truth.forces = {Vec3(9, 9, 9), Vec3(0, 0, 1), Vec3(9, 9, 9), Vec3(0, 0, 2)};
  truth.frames = {1, 2, 4};
  run.forces = {Vec3(0, 0, 1), Vec3(0, 0, 1)};
  run.frames = {2};
  run.displacement = [](const Vec3&) { return Vec3(0, 0, 0.11); };
  const RunErrors e = compare(run, truth);
  EXPECT_NEAR(e.force, 1.0 / std::sqrt(5.0), 1e-15);
  EXPECT_NEAR(e.displacement, 0.1, 1e-12);
  std::swap(run, truth);
  EXPECT_THROW(compare(run, truth), InputError);  // the truth lacks every other tick
}

TEST_F(Errors, OfTranslationsAndLinearFieldsDoNotDependOnTheMeshes) {
  Made run, truth;
  truth.mesh = test::make_block(3, 4, 3, Vec3::Ones());
  run.displacement = [](const Vec3&) { return Vec3(0.03, 0, 0.1); };
  for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2}) {
    run.displacement = [](const Vec3&) { return Vec3(0.03, 0, 0.1); };
    truth.displacement = [](const Vec3&) { return Vec3(0, 0, 0.1); };
    EXPECT_NEAR(compare(run, truth, {element, ElementKind::p1}).displacement, 0.3, 1e-12);
    EXPECT_NEAR(compare(run, truth, {ElementKind::p1, element}).displacement, 0.3, 1e-12);
    run.displacement = linear(1.25 * some_gradient());
    truth.displacement = linear(some_gradient());
    EXPECT_NEAR(compare(run, truth, {element, element}).displacement, 0.25, 1e-12);
  }
}

TEST_F(Errors, OfAFieldWeighByVolume) {
  // Tets of 1/6 and 1/2 m³ with a common face; the run differs in the larger alone, by its own corner.
  Made run;
  run.mesh.vertices.resize(3, 5);
  run.mesh.vertices << 0, 1, 0, 0, 0,  //
      0, 0, 1, 0, 0,                   //
      0, 0, 0, 1, -3;
  run.mesh.tets.resize(4, 2);
  run.mesh.tets << 0, 0,  //
      1, 2,               //
      2, 1,               //
      3, 4;
  Made truth = run;
  run.displacement = [](const Vec3& x) { return Vec3(x.z() < -1 ? 0.4 : 0, 0, 0.1); };
  truth.displacement = [](const Vec3&) { return Vec3(0, 0, 0.1); };
  run.saturation = [](Eigen::Index t) { return t == 0 ? 0.5 : 0.4; };
  const RunErrors e = compare(run, truth);
  // A quarter of 0.4 m at its centroid, against 0.1 m.
  EXPECT_NEAR(e.displacement, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(e.saturation, 0.2 * std::sqrt(0.75), 1e-12);
}

TEST_F(Errors, OfTenNodeTetsDoNotComeFromWhatLiesBetweenTheirCorners) {
  Made run, truth;
  run.mesh = test::make_block(2, 2, 3, Vec3::Ones());
  truth.mesh = test::make_block(4, 5, 4, Vec3::Ones());
  run.displacement = truth.displacement = [](const Vec3& x) {
    return Vec3(0.1 * x.x() * x.x() - 0.2 * x.y() * x.z(), 0.3 * x.z() * x.z() + 0.1 * x.x(),
                0.05 + 0.1 * x.x() * x.y() - 0.1 * x.y() * x.y());
  };
  const ComparedElements both{ElementKind::p2, ElementKind::p2};
  EXPECT_LT(compare(run, truth, both).displacement, 1e-12);
  EXPECT_GT(compare(run, truth).displacement, 1e-2);  // four-node tets are linear between their corners
}

TEST(DisplacementField, OfAFewVerticesIsAffine) {
  // One cell: eight vertices do not tell nine terms.
  const mesh::TetMesh cell = test::make_block(1, 1, 1, Vec3(1, 2, 3));
  DisplacementField field(cell.vertices, cell.tets, ElementKind::p2);
  field.set(some_gradient() * cell.vertices);
  const Vec4 weights(0.1, 0.2, 0.3, 0.4);
  Vec3 x = Vec3::Zero();
  for (int i = 0; i < 4; ++i) x += weights(i) * cell.vertices.col(cell.tets(i, 2));
  EXPECT_LT((field.find(2, weights) - some_gradient() * x).norm(), 1e-14);
}

TEST_F(Errors, OfTheSkinNeedTheSameSkin) {
  Made run, truth;
  run.skin_shift = Vec3(0.1, 0.03, 0);
  run.skin = 2.0 * run.skin;  // where it was at rest does not count
  EXPECT_NEAR(compare(run, truth).skin, 0.3, 1e-12);
  run.skin_triangles = Eigen::Vector3i(0, 2, 1);
  EXPECT_TRUE(std::isnan(compare(run, truth).skin));
  run.skin_triangles = truth.skin_triangles = Triangles(3, 0);
  run.skin = truth.skin = Points(3, 0);
  EXPECT_TRUE(std::isnan(compare(run, truth).skin));
}

TEST_F(Errors, OfDissipationAreThatOfTheEnd) {
  Made run, truth;
  run.dissipation = 3.0;
  run.forces = truth.forces = {Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 0, 1)};
  EXPECT_NEAR(compare(run, truth).dissipation, 0.5, 1e-15);
}

TEST_F(Errors, OfWhatTheTruthHasNoneOfAreUnknown) {
  Made run, truth;
  truth.forces = {Vec3::Zero()};
  truth.displacement = [](const Vec3&) -> Vec3 { return Vec3::Zero(); };
  truth.saturation = [](Eigen::Index) { return 0.0; };
  truth.skin_shift.setZero();
  truth.dissipation = 0.0;
  const RunErrors e = compare(run, truth);
  for (const double error : {e.force, e.peak_force, e.above_7_percent, e.above_10_percent, e.displacement,
                             e.skin, e.saturation, e.dissipation})
    EXPECT_TRUE(std::isnan(error));
}

TEST_F(Errors, OfFieldsWithoutACommonFrameAreUnknown) {
  Made run, truth;
  run.forces = truth.forces = {Vec3(0, 0, 1), Vec3(0, 0, 1)};
  run.frames = {1};
  truth.frames = {2};
  truth.saturation =
      run.saturation = [](Eigen::Index) { return 0.0; };  // frame 0, which both have, says nothing
  const RunErrors e = compare(run, truth);
  EXPECT_EQ(e.force, 0.0);
  for (const double error : {e.displacement, e.skin, e.saturation}) EXPECT_TRUE(std::isnan(error));
}

TEST_F(Errors, OfFieldsNeedBodiesInTheSamePlace) {
  // The truth's centroids stand in planes 1/24 m apart, of a third of a layer of cells each: of 18, the run's
  // mesh may lack one, but not three.
  Made run, truth;
  truth.mesh = test::make_block(6, 6, 6, Vec3::Ones());
  run.displacement = [](const Vec3&) { return Vec3(0, 0, 0.15); };
  run.mesh.vertices.row(0).array() += 0.08;
  EXPECT_NEAR(compare(run, truth).displacement, 0.5, 1e-12);
  EXPECT_EQ(compare(run, truth).saturation, 0.0);
  run.mesh.vertices.row(0).array() += 0.12;
  const RunErrors e = compare(run, truth);
  EXPECT_TRUE(std::isnan(e.displacement));
  EXPECT_TRUE(std::isnan(e.saturation));
  EXPECT_EQ(e.force, 0.0);
  EXPECT_EQ(e.skin, 0.0);
}

}  // namespace
}  // namespace argil::study
