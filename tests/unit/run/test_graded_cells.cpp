// Cells that are small where the tool comes: where, how small, how many, and what stays as it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "contact/tool_solid.h"
#include "embed/triangle_tree.h"
#include "scenario/build.h"
#include "scenario/cell_sizes.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

class GradedCells : public testing::Test {
 protected:
  test::TempFolder folder;

  /// A ball of clay of 40 mm, pressed from above by one of 6 mm; the tool's tip goes down to 38 mm.
  scenario::Scene build(const std::vector<std::string>& settings, double bottom = 0.044) {
    const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, bottom, 0.1, "push");
    return scenario::build_scene(load(test::make_ball_scenario(trace), settings));
  }
  scenario::Scenario load(const std::string& text, const std::vector<std::string>& settings) {
    std::vector<scenario::Setting> list;
    for (const std::string& setting : settings) list.push_back(scenario::parse_setting(setting));
    return scenario::load_scenario(folder.write("scenario.json", text), list);
  }
};

double find_size(const sim::Body& body, int tet) {
  return mesh::compute_cell_size(mesh::compute_volumes(body.mesh.vertices, body.mesh.tets.col(tet))(0));
}

Vec3 find_centre(const sim::Body& body, int tet) {
  return body.mesh.vertices(Eigen::all, body.mesh.tets.col(tet)).rowwise().mean();
}

const std::string* find_note(const scenario::Scene& scene, const std::string& words) {
  for (const std::string& note : scene.notes)
    if (note.find(words) != std::string::npos) return &note;
  return nullptr;
}

/// Area of the body's lower faces whose corners all are held, over that of the block [–].
double find_held_share(const sim::Body& body, double edge) {
  const std::vector<int> held = solid::find_nodes(body.mesh.vertices, std::span(&body.supports[0].region, 1));
  double area = 0.0;
  for (const auto& v : body.topology.boundary.colwise()) {
    const Vec3 a = body.mesh.vertices.col(v(0));
    const Vec3 normal = (body.mesh.vertices.col(v(1)) - a).cross(body.mesh.vertices.col(v(2)) - a);
    const bool is_held = std::all_of(v.begin(), v.end(),
                                     [&](int n) { return std::binary_search(held.begin(), held.end(), n); });
    if (is_held && normal.z() < 0.0) area -= 0.5 * normal.z();
  }
  return area / (edge * edge);
}

TEST_F(GradedCells, OfABlockAreHeldByThePlaneOfItsFaceWhetherTheyFollowItExactlyOrASkin) {
  // The cells of a skin follow a flat face to a share of their size, all of them to one side of it.
  constexpr double kEdge = 0.03;
  for (const char* skin : {"0", "800", "8000"}) {
    const scenario::Scene scene =
        build({"/body/shape/kind=box", "/body/shape/size_m=0.03", "/body/shape/fit=surface",
               "/body/cells/kind=graded", "/body/shape/target_tets=3000",
               std::string("/body/shape/skin_triangles=") + skin,
               R"(/body/fixed=[{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}])"},
              0.034);
    EXPECT_NEAR(find_held_share(scene.body, kEdge), 1.0, 0.1) << skin;
  }
}

TEST_F(GradedCells, ArePlacedAtTheDeepestContactWithHertzsRadius) {
  const scenario::Scene scene = build({"/body/cells/kind=graded", "/body/cells/near_tool_m=0.0004"});
  // A ball of 6 mm whose middle goes to 44 mm above the floor, 1.2 mm beside the axis, meets one of 20 mm:
  // it is 26 mm - |c - m| deep, m the clay's middle.
  const double depth = 0.026 - Vec3(0.001, 0.0007, 0.024).norm();
  ASSERT_EQ(scene.body.touched_places.size(), 1U);
  const sim::TouchedPlace& place = scene.body.touched_places[0];
  EXPECT_NEAR(place.radius, std::sqrt(0.006 * depth), 0.05 * place.radius);  // the mesh is not quite a ball
  EXPECT_NEAR((place.position - Vec3(0.0, 0.0, 0.02)).norm(), 0.02, 2e-4);
  EXPECT_LT((place.position - Vec3(0.0, 0.0, 0.04)).norm(), 0.002);
  for (int t = 0; t < scene.body.mesh.num_tets(); ++t)
    if ((find_centre(scene.body, t) - place.position).norm() < place.radius) {
      EXPECT_LE(find_size(scene.body, t), 0.0004);
    }
}

TEST_F(GradedCells, ArePlacedWhereALargeBallBarelyTouches) {
  constexpr double kBall = 0.1, kTop = 0.03, kDeep = 1e-5;
  const std::string trace =
      test::write_press_trace(folder / "press.csv", kTop + kBall + 0.002, kTop + kBall - kDeep, 0.1, "push");
  const scenario::Scene scene = scenario::build_scene(
      load(test::make_ball_scenario(trace),
           {"/body/shape/kind=box", "/body/shape/size_m=0.03", "/body/cells/kind=graded",
            "/body/cells/near_tool_m=0.0005", "/tool/shape/radius_m=" + std::to_string(kBall)}));
  ASSERT_EQ(scene.body.touched_places.size(), 1U);
  const double radius = std::sqrt(kBall * kDeep);
  EXPECT_NEAR(scene.body.touched_places[0].radius, radius, 0.05 * radius);
  EXPECT_LT((scene.body.touched_places[0].position - Vec3(0.001, 0.0007, kTop)).norm(), 1e-6);
}

/// A block of 30 mm and a cube of 10 mm over it, a mesh as all tools that are not round.
class GradedUnderACube : public GradedCells {
 protected:
  static constexpr double kTop = 0.03;
  static constexpr double kHalf = 0.005;  // of the cube's edge
  static constexpr double kDepth = 0.002;

  /// The cube turned, its lowest point pressed this deep.
  scenario::Scene press(const Quat& turn, double depth = kDepth) {
    std::ofstream out(folder / "cube.obj");
    out.precision(17);
    double lowest = 0.0;
    for (int v = 0; v < 8; ++v) {
      const Vec3 x = turn * (kHalf * Vec3(v & 1 ? 1 : -1, v & 2 ? 1 : -1, v & 4 ? 1 : -1));
      out << "v " << x.transpose() << '\n';
      lowest = std::min(lowest, x.z());
    }
    out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    out.close();
    return build({"/body/shape/kind=box", "/body/shape/size_m=0.03", "/body/cells/kind=graded",
                  "/body/cells/near_tool_m=0.0008",
                  R"(/tool/shape={"kind": "mesh", "file": ")" + (folder / "cube.obj") + "\"}"},
                 kTop - lowest - depth);
  }
};

TEST_F(GradedUnderACube, ItsFaceCoversOnePlaceAsLargeAsTheFace) {
  const sim::TouchedPlace& place = press(Quat::Identity()).body.touched_places.at(0);
  EXPECT_LT((place.position - Vec3(0.001, 0.0007, kTop)).norm(), 0.3 * kHalf);  // a quarter is seen
  // A ball that covers as much has √2 times Hertz's radius there.
  const double radius = std::sqrt(4.0 * kHalf * kHalf / std::numbers::pi / 2.0);
  EXPECT_NEAR(place.radius, radius, 0.15 * radius);
}

TEST_F(GradedUnderACube, ItsFaceCoversAsMuchWhereItBarelyTouches) {
  const sim::TouchedPlace& place = press(Quat::Identity(), 1e-5).body.touched_places.at(0);
  const double radius = std::sqrt(4.0 * kHalf * kHalf / std::numbers::pi / 2.0);
  EXPECT_NEAR(place.radius, radius, 0.15 * radius);
}

TEST_F(GradedUnderACube, ItsCornerCoversATriangle) {
  const Quat turn = Quat::FromTwoVectors(Vec3(-1, -1, -1), Vec3(0, 0, -1));
  const scenario::Scene scene = press(turn);
  ASSERT_FALSE(scene.body.touched_places.empty());
  const auto largest = std::max_element(scene.body.touched_places.begin(), scene.body.touched_places.end(),
                                        [](const auto& a, const auto& b) { return a.radius < b.radius; });
  EXPECT_LT((largest->position - Vec3(0.001, 0.0007, kTop)).norm(), 0.5 * kDepth);
  const double radius = std::sqrt(1.5 * std::sqrt(3.0) * kDepth * kDepth / std::numbers::pi / 2.0);
  EXPECT_NEAR(largest->radius, radius, 0.15 * radius);
  EXPECT_FALSE(scene.contact_cells.empty());  // the run does not say that the motion misses
}

TEST_F(GradedUnderACube, ItsEdgeCoversARowOfPlaces) {
  const Quat turn(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitX()));
  const scenario::Scene scene = press(turn);
  for (const sim::TouchedPlace& place : scene.body.touched_places) {
    EXPECT_LT(place.radius, 1.3 * kDepth);  // the strip is two depths wide, five times as long
    EXPECT_LT(std::abs(place.position.y() - 0.0007), kDepth);
  }
  constexpr double kSmall = 1.5;  // radii, within which cells are small
  for (double along = -kHalf; along <= kHalf; along += 0.1 * kHalf) {
    const Vec3 x(0.001 + along, 0.0007, kTop);
    EXPECT_TRUE(
        std::any_of(scene.body.touched_places.begin(), scene.body.touched_places.end(),
                    [&](const auto& place) { return (x - place.position).norm() < kSmall * place.radius; }))
        << along;
  }
}

TEST_F(GradedCells, AreAsManyAsWanted) {
  for (const int target : {2000, 6000}) {
    const scenario::Scene scene =
        build({"/body/cells/kind=graded", "/body/shape/target_tets=" + std::to_string(target)});
    EXPECT_NEAR(scene.body.mesh.num_tets(), target, 0.15 * target);
    const sim::TouchedPlace& place = scene.body.touched_places.at(0);
    double near = std::numeric_limits<double>::infinity();
    double far = 0.0;
    for (int t = 0; t < scene.body.mesh.num_tets(); ++t) {
      const double distance = (find_centre(scene.body, t) - place.position).norm();
      if (distance < place.radius) near = std::min(near, find_size(scene.body, t));
      if (distance > 0.03) far = std::max(far, find_size(scene.body, t));
    }
    EXPECT_LT(near, 0.3 * far);
  }
}

/// The size where the tool comes [m] and the cells along the radius of contact, as the note has them.
std::pair<double, double> read_note_of_cells(const scenario::Scene& scene) {
  const std::string* note = find_note(scene, " mm where the tool comes, ");
  if (!note) return {};
  const std::size_t size = note->find(", ", note->find("become ")) + 2;
  return {1e-3 * std::stod(note->substr(size)), std::stod(note->substr(note->find("comes, ") + 7))};
}

TEST_F(GradedCells, OfElasticClayGrowAsThePowerOfTheDistanceThatMakesTheErrorLeast) {
  // Strains fall as r^-2 and their gradients as r^-3; the error of linear tets is h² times that squared a
  // volume, and h^-3 are there. For their number the sum is least where h^5 ~ r^6.
  const std::vector<std::string> settings = {"/body/cells/kind=graded", "/body/shape/target_tets=8000",
                                             "/body/shape/kind=box", "/body/shape/size_m=0.04"};
  std::vector<std::string> elastic = settings;
  elastic.emplace_back("/material/plasticity/enabled=false");
  const scenario::Scene scene = build(elastic);
  const auto [near, cells] = read_note_of_cells(scene);
  ASSERT_GT(near, 0.0);
  ASSERT_EQ(scene.body.touched_places.size(), 1U);
  const sim::TouchedPlace& place = scene.body.touched_places[0];
  const double a = place.radius;
  double largest = 0.0, sum = 0.0;
  int count = 0;
  for (int t = 0; t < scene.body.mesh.num_tets(); ++t) {
    const double r = (find_centre(scene.body, t) - place.position).norm();
    const double ratio = find_size(scene.body, t) / (near * std::pow(1.0 + std::max(0.0, r / a - 1.5), 1.2));
    largest = std::max(largest, ratio);
    if (r < 2.0 * a || r > 4.0 * a) continue;
    sum += ratio;
    ++count;
  }
  EXPECT_LE(largest, 1.1);  // the search may make the places a little smaller; linear sizes reach 1.4
  ASSERT_GT(count, 500);
  EXPECT_GT(sum / count, 0.7);  // halves have 0.79 to 1 of the size, fewer where a neighbour's edge is longer
  // Clay that flows has more of them below the tool.
  EXPECT_GT(read_note_of_cells(build(settings)).second, 1.1 * cells);
}

TEST_F(GradedCells, AreAsManyAsWantedBelowATinyTip) {
  // Round a small tip on a regular lattice a change of size halves all the tets around it at once.
  for (const int target : {2200, 3000, 4000}) {
    const scenario::Scene scene = build(
        {"/body/cells/kind=graded", "/body/shape/target_tets=" + std::to_string(target),
         "/body/shape/kind=box", "/body/shape/size_m=0.2", "/material/plasticity/enabled=false",
         "/tool/shape/radius_m=0.001", "/trace/device_to_world/translation_m=[-0.001, -0.0007, 0.1568]"});
    EXPECT_NEAR(scene.body.mesh.num_tets(), target, 0.15 * target);
  }
}

TEST_F(GradedCells, AreCountedAlongTheRadiusOfContactWithTheErrorThatTheyMake) {
  const std::string words = "along the radius of contact, ";
  const scenario::Scene coarse = build({"/body/shape/target_tets=300"});
  const std::string* note = &coarse.contact_cells;
  ASSERT_NE(note->find(words), std::string::npos);
  EXPECT_NE(note->find("set /body/cells/kind to graded"), std::string::npos) << *note;
  const scenario::Scene fine = build({"/body/cells/kind=graded", "/body/cells/near_tool_m=0.0004"});
  note = &fine.contact_cells;
  ASSERT_NE(note->find(words), std::string::npos);
  EXPECT_EQ(note->find("set "), std::string::npos) << *note;
  // 0.4 mm are asked for at most, so that more cells than a/0.4 mm lie there: below ½ c^(−3/2).
  const double cells = std::stod(note->substr(note->find("cells: ") + 7));
  EXPECT_GE(cells, 0.95 * fine.body.touched_places[0].radius / 0.0004);
  const double percent = std::stod(note->substr(note->find("some ") + 5));
  EXPECT_NEAR(percent, 50.0 * std::pow(cells, -1.5), 0.1 * percent);
  EXPECT_TRUE(build({}, 0.0475).contact_cells.empty());  // never touched
}

TEST_F(GradedCells, AreTheSameTwice) {
  const scenario::Scene one = build({"/body/cells/kind=graded"});
  const scenario::Scene other = build({"/body/cells/kind=graded"});
  EXPECT_EQ(one.body.mesh.vertices, other.body.mesh.vertices);
  EXPECT_EQ(one.body.mesh.tets, other.body.mesh.tets);
}

TEST_F(GradedCells, OfAReplayComeFromItsPlacesAlone) {
  const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.044, 0.1, "push");
  scenario::Scenario s = load(test::make_ball_scenario(trace), {"/body/cells/kind=graded"});
  const scenario::Scene scene = scenario::build_scene(s);
  s.trace = {};
  const scenario::Scene again = scenario::build_scene(s, &scene.body.touched_places);
  EXPECT_EQ(scene.body.mesh.vertices, again.body.mesh.vertices);
  EXPECT_EQ(scene.body.mesh.tets, again.body.mesh.tets);
}

TEST_F(GradedCells, AreEvenWhereTheMotionDoesNotReach) {
  const scenario::Scene scene = build({"/body/cells/kind=graded"}, 0.0475);
  const scenario::Scene even = build({"/body/cells/kind=even"}, 0.0475);
  EXPECT_EQ(scene.body.mesh.tets, even.body.mesh.tets);
  ASSERT_FALSE(scene.notes.empty());
  EXPECT_EQ(scene.notes.back(), "cells: even, as the motion does not reach the body at rest");
}

TEST_F(GradedCells, AreEvenWhereFewTetsAreWanted) {
  const scenario::Scene scene = build({"/body/cells/kind=graded", "/body/shape/target_tets=300"});
  const scenario::Scene even = build({"/body/cells/kind=even", "/body/shape/target_tets=300"});
  EXPECT_EQ(scene.body.mesh.tets, even.body.mesh.tets);
  EXPECT_TRUE(find_note(scene, "cells: even, as 300 tets leave none to halve"));
}

/// The first cells, which are a sixth of those that are wanted here, need not be had to the number.
TEST_F(GradedCells, OfASlenderBlockBeginWithTheNearestNumberThatItCanHave) {
  const std::vector<std::string> block = {"/body/shape/kind=box", "/body/shape/slenderness=5"};
  const auto with = [&](const std::string& setting) {
    std::vector<std::string> all = block;
    all.push_back(setting);
    return all;
  };
  EXPECT_THROW(build(with("/body/shape/target_tets=300")), InputError);
  const scenario::Scene scene = build(with("/body/shape/target_tets=1000"));
  EXPECT_NEAR(scene.body.mesh.num_tets(), 1000, 100);
}

TEST_F(GradedCells, AreRefusedWhereTheyAreTooMany) {
  try {
    build({"/body/cells/kind=graded", "/body/cells/near_tool_m=1e-6"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("scenario.json: /body/cells: asks for cells that make more"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(GradedCells, AreSmallInARegion) {
  const scenario::Scene scene =
      build({"/body/cells/kind=graded", "/body/cells/near_tool_m=0.004",
             R"(/body/cells/regions=[{"centre_m": [0.02, 0, 0.02], "radius_m": 0.003, "size_m": 0.0008}])"});
  int num_within = 0;
  for (int t = 0; t < scene.body.mesh.num_tets(); ++t) {
    if ((find_centre(scene.body, t) - Vec3(0.02, 0.0, 0.02)).norm() > 0.003) continue;
    ++num_within;
    EXPECT_LE(find_size(scene.body, t), 0.0008);
  }
  EXPECT_GT(num_within, 100);
}

TEST_F(GradedCells, OfAFittedBodyHaveTheirBoundaryOnTheSkin) {
  const scenario::Scene scene =
      build({"/body/cells/kind=graded", "/body/shape/fit=surface", "/body/shape/skin_triangles=5000",
             "/body/shape/target_tets=6000", "/contact/law=pressure"});
  const sim::TouchedPlace& place = scene.body.touched_places.at(0);
  const embed::TriangleTree skin(scene.body.skin);
  int num_on = 0;
  int num_all = 0;
  for (const int v : scene.body.topology.boundary.reshaped()) {
    const Vec3 x = scene.body.mesh.vertices.col(v);
    if ((x - place.position).norm() > 2.0 * place.radius) continue;
    ++num_all;
    if (skin.find_nearest(x, 1.0).distance < 1e-9) ++num_on;
  }
  EXPECT_GT(num_all, 100);
  EXPECT_GT(num_on, 0.8 * num_all);  // the first vertices lie where the volume is right
  EXPECT_GT(scene.body.skin_embedding.weights.minCoeff(), -2.0);
}

TEST(GradedCage, IsFineNearAMotionAndRefusesOneThatIsFar) {
  const mesh::TriangleMesh ball = shapes::make_shape_skin({shapes::ShapeKind::sphere, 0.04}, 2000);
  const embed::Cage cage = embed::make_cage(ball, {1000, embed::Fit::surface}, "ball");
  device::Trace trace;
  for (int k = 0; k <= 20; ++k) {
    trace.time.push_back(0.001 * k);
    trace.samples.push_back({.position = Vec3(0.0005 * k, 0.0, 0.045)});
  }
  const mesh::TetMesh fine = scenario::grade_cage(cage, embed::Fit::surface, ball, trace, 0.001);
  const Field volume = mesh::compute_volumes(fine.vertices, fine.tets);
  int num_near = 0;
  for (int t = 0; t < fine.num_tets(); ++t) {
    const Vec3 centre = fine.vertices(Eigen::all, fine.tets.col(t)).rowwise().mean();
    if ((centre - Vec3(0.004, 0.0, 0.0395)).norm() > 0.002) continue;
    EXPECT_LE(mesh::compute_cell_size(volume(t)), 0.002);
    ++num_near;
  }
  EXPECT_GT(num_near, 50);
  for (device::DeviceSample& sample : trace.samples) sample.position(2) = 1.0;
  EXPECT_THROW(scenario::grade_cage(cage, embed::Fit::surface, ball, trace, 0.001), InputError);
}

class GradedFile : public GradedCells {
 protected:
  mesh::TetMesh ball = shapes::make_shape_mesh({shapes::ShapeKind::sphere, 0.04}, 600);

  std::string write(const std::string& more_mesh) {
    const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.044, 0.1, "push");
    std::string text = test::make_ball_scenario(trace);
    const std::string shape =
        R"("shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 0})";
    return text.replace(
        text.find(shape), shape.size(),
        R"("mesh": {"file": ")" + test::write_vtk(folder / "ball.vtk", ball) + "\"" + more_mesh + "}");
  }
};

TEST_F(GradedFile, HasTwoCellsAlongTheRadiusOfContactAndItsFields) {
  Field& E = ball.cell_fields["E"];
  E.resize(ball.num_tets());
  for (int t = 0; t < ball.num_tets(); ++t)  // stiff at x > 0
    E(t) = ball.vertices(0, ball.tets.col(t)).mean() > 0.0 ? 2e5 : 5e4;
  const scenario::Scene scene =
      scenario::build_scene(load(write(R"(, "youngs_modulus_field": "E")"), {"/body/cells/kind=graded"}));
  const sim::Body& body = scene.body;
  ASSERT_GT(body.mesh.num_tets(), 2 * ball.num_tets());
  const sim::TouchedPlace& place = body.touched_places.at(0);
  double stiff_volume = 0.0;
  const Field volume = mesh::compute_volumes(body.mesh.vertices, body.mesh.tets);
  for (int t = 0; t < body.mesh.num_tets(); ++t) {
    if ((find_centre(body, t) - place.position).norm() < place.radius) {
      EXPECT_LE(find_size(body, t), 0.5 * place.radius);
    }
    if (body.youngs_modulus(t) == 2e5) stiff_volume += volume(t);
  }
  const Field coarse_volume = mesh::compute_volumes(ball.vertices, ball.tets);
  EXPECT_NEAR(stiff_volume, (E.array() == 2e5).select(coarse_volume, 0.0).sum(), 1e-18);
}

TEST_F(GradedFile, HoldsWhatIsBetweenHeldNodes) {
  ball.cell_fields["none"] = Field::Zero(ball.num_tets());
  std::string nodes;
  for (int v = 0; v < ball.num_vertices(); ++v)
    if (ball.vertices(2, v) > 0.028) nodes += (nodes.empty() ? "" : ", ") + std::to_string(v);
  const scenario::Scene scene = scenario::build_scene(
      load(write(""), {"/body/cells/kind=graded", "/body/cells/near_tool_m=0.001",
                       R"(/body/fixed=[{"kind": "nodes", "nodes": [)" + nodes + "]}]"}));
  const std::vector<int>& held = scene.body.supports.at(0).region.nodes;
  const auto is_held = [&](int v) { return std::find(held.begin(), held.end(), v) != held.end(); };
  int num_held = 0;
  for (int v = 0; v < scene.body.mesh.num_vertices(); ++v) {
    if (scene.body.mesh.vertices(2, v) > 0.037) {
      EXPECT_TRUE(is_held(v)) << v;
      ++num_held;
    }
    if (scene.body.mesh.vertices(2, v) <= 0.028) {
      EXPECT_FALSE(is_held(v)) << v;
    }
  }
  EXPECT_GT(num_held, 50);
}

TEST_F(GradedFile, LoadsTheNodesThatTheFileNames) {
  ball.cell_fields["none"] = Field::Zero(ball.num_tets());
  const scenario::Scene scene = scenario::build_scene(
      load(write(""),
           {"/body/cells/kind=graded", R"(/body/loads/nodal=[{"nodes": [3, 101], "force_N": [0, 0, -1]}])"}));
  const std::vector<int>& nodes = scene.body.loads.nodal.at(0).nodes;
  ASSERT_EQ(nodes.size(), 2U);
  EXPECT_LT((scene.body.mesh.vertices.col(nodes[0]) - ball.vertices.col(3)).norm(), 1e-9);
  EXPECT_LT((scene.body.mesh.vertices.col(nodes[1]) - ball.vertices.col(101)).norm(), 1e-9);
}

TEST_F(GradedFile, NamesTheFilesTetsInErrors) {
  Field& S = ball.cell_fields["S"];
  S = Field::Zero(ball.num_tets());
  S(17) = 1.5;
  const scenario::Scenario s = load(write(R"(, "saturation_field": "S")"), {"/body/cells/kind=graded"});
  try {
    scenario::build_scene(s);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("tet 17"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace argil
