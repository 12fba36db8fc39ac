// What finding contacts costs a tick on skins of 1 k, 20 k and 200 k triangles: broad and narrow phase,
// forces.
//   build/bin/bench_contact
// approach: the tool passes 1 mm above the skin · press: it slides 0.5 mm deep; the skin near it moves by 10
// µm a tick and the caller says so · touched: the same, and the touched area is asked for, as when water is
// due · unknown_motion: nobody says how far the skin moves, so that all vertices are looked at · fine_tool:
// the demonstration's tool, which is finer than the skin, on as many triangles as 10 k tets have.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <utility>

#include "contact/contact.h"
#include "contact/tool_shape.h"

namespace argil::contact {
namespace {

constexpr double kBodyRadius = 0.05, kToolRadius = 0.005;  // [m]

enum class Case { approach, press, touched, unknown_motion, fine_tool };

/// Icosahedron's faces in frequency² triangles each, on the sphere.
mesh::TriangleMesh make_geodesic(double radius, int frequency) {
  const mesh::TriangleMesh coarse = make_sphere_tool(1.0, 0);
  std::map<std::array<std::int64_t, 3>, int> number_of;  // of a place, so that faces share their edges
  std::vector<Vec3> points;
  std::vector<Eigen::Vector3i> faces;
  for (Eigen::Index f = 0; f < coarse.triangles.cols(); ++f) {
    const auto at = [&](int i, int j) {
      const Eigen::Vector3i c = coarse.triangles.col(f);
      const Vec3 p = (double(frequency - i - j) * coarse.vertices.col(c(0)) +
                      double(i) * coarse.vertices.col(c(1)) + double(j) * coarse.vertices.col(c(2)))
                         .normalized();
      const auto round = [](double x) { return std::int64_t(std::llround(1e9 * x)); };
      const auto [place, is_new] =
          number_of.try_emplace({round(p.x()), round(p.y()), round(p.z())}, int(points.size()));
      if (is_new) points.push_back(radius * p);
      return place->second;
    };
    for (int i = 0; i < frequency; ++i)
      for (int j = 0; i + j < frequency; ++j) {
        faces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < frequency) faces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  mesh::TriangleMesh mesh;
  mesh.vertices.resize(3, Eigen::Index(points.size()));
  mesh.triangles.resize(3, Eigen::Index(faces.size()));
  for (std::size_t i = 0; i < points.size(); ++i) mesh.vertices.col(Eigen::Index(i)) = points[i];
  for (std::size_t i = 0; i < faces.size(); ++i) mesh.triangles.col(Eigen::Index(i)) = faces[i];
  return mesh;
}

void find_contacts(benchmark::State& state, Case what) {
  const mesh::TriangleMesh body = make_geodesic(kBodyRadius, static_cast<int>(state.range(0)));
  ContactParams params;
  params.vertex_face_stiffness = params.edge_edge_stiffness = 100.0;
  const bool is_fine = what == Case::fine_tool;
  const double tool_radius = is_fine ? 0.008 : kToolRadius;
  ContactDetector detector(body.triangles, body.num_vertices(),
                           make_sphere_tool(tool_radius, is_fine ? 3 : 2), params);
  const double depth = what == Case::approach ? -1e-3 : is_fine ? 1.5e-3 : 5e-4;
  const auto place = [&](double angle, double d) {
    Pose pose;
    pose.position =
        (kBodyRadius + tool_radius - d) * Vec3(std::sin(angle), 0.1, std::cos(angle)).normalized();
    return pose;
  };
  Points from = body.vertices, to = from;
  std::vector<Eigen::Index> near;
  for (Eigen::Index v = 0; v < from.cols(); ++v)
    if (from(2, v) > 0.9 * kBodyRadius) near.push_back(v);
  Contacts contacts;
  contacts.with_touched = what == Case::touched;
  Pose pose = place(0.0, -1e-3);
  int tick = 0;
  double sum = 0.0;
  const auto run = [&] {
    ++tick;
    const double lift = tick % 2 == 0 ? -1e-5 : 1e-5;
    for (const Eigen::Index v : near) {
      from(2, v) = to(2, v);
      to(2, v) = from(2, v) + lift;
    }
    const Pose next = place(0.1 * std::sin(0.02 * tick), depth);
    detector.find_contacts(from, to, pose, next, contacts,
                           what == Case::unknown_motion ? std::optional<double>() : 1.001e-5);
    pose = next;
  };
  for (int i = 0; i < 400; ++i) {
    run();
    sum += contacts.force_on_tool.norm();
  }
  for (auto _ : state) run();
  state.counters["triangles"] = static_cast<double>(body.num_triangles());
  state.counters["contacts"] = static_cast<double>(contacts.contacts.size());
  state.counters["mean_force"] = sum / 400.0;  // equal before and after a change that is meant to be faster
}

void set_sizes(benchmark::internal::Benchmark* bench) {
  for (const int frequency : {7, 32, 100}) bench->Arg(frequency);  // 980, 20 480 and 200 000 triangles
  bench->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(find_contacts, approach, Case::approach)->Apply(set_sizes);
BENCHMARK_CAPTURE(find_contacts, press, Case::press)->Apply(set_sizes);
BENCHMARK_CAPTURE(find_contacts, touched, Case::touched)->Apply(set_sizes);
BENCHMARK_CAPTURE(find_contacts, unknown_motion, Case::unknown_motion)->Apply(set_sizes);
BENCHMARK_CAPTURE(find_contacts, fine_tool, Case::fine_tool)->Arg(12)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace argil::contact

BENCHMARK_MAIN();
