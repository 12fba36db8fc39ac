// What finding contacts costs a tick on skins of 1 k, 20 k and 330 k triangles: broad and narrow phase,
// forces.
//   build/bin/bench_contact
// approach: the tool passes 1 mm above the skin · press: it slides 0.5 mm deep; the skin near it moves by 10
// µm a tick and the caller says so · unknown_motion: the same without a word, so that all vertices are looked
// at.
#include <benchmark/benchmark.h>

#include <cmath>

#include "contact/contact.h"
#include "contact/tool_shape.h"

namespace argil::contact {
namespace {

constexpr double kBodyRadius = 0.05, kToolRadius = 0.005;  // [m]

enum class Case { approach, press, unknown_motion };

void find_contacts(benchmark::State& state, Case what) {
  const mesh::TriangleMesh body = make_sphere_tool(kBodyRadius, static_cast<int>(state.range(0)));
  ContactParams params;
  params.vertex_face_stiffness = params.edge_edge_stiffness = 100.0;
  ContactDetector detector(body.triangles, body.num_vertices(), make_sphere_tool(kToolRadius, 2), params);
  const double depth = what == Case::approach ? -1e-3 : 5e-4;
  const auto place = [&](double angle, double d) {
    Pose pose;
    pose.position =
        (kBodyRadius + kToolRadius - d) * Vec3(std::sin(angle), 0.1, std::cos(angle)).normalized();
    return pose;
  };
  Points from = body.vertices, to = from;
  std::vector<Eigen::Index> near;
  for (Eigen::Index v = 0; v < from.cols(); ++v)
    if (from(2, v) > 0.9 * kBodyRadius) near.push_back(v);
  Contacts contacts;
  Pose pose = place(0.0, -1e-3);
  int tick = 0;
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
  for (int i = 0; i < 400; ++i) run();
  for (auto _ : state) run();
  state.counters["triangles"] = static_cast<double>(body.num_triangles());
  state.counters["contacts"] = static_cast<double>(contacts.contacts.size());
}

void set_sizes(benchmark::internal::Benchmark* bench) {
  for (const int level : {3, 5, 7}) bench->Arg(level);  // 1280, 20 480 and 327 680 triangles
  bench->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(find_contacts, approach, Case::approach)->Apply(set_sizes);
BENCHMARK_CAPTURE(find_contacts, press, Case::press)->Apply(set_sizes);
BENCHMARK_CAPTURE(find_contacts, unknown_motion, Case::unknown_motion)->Apply(set_sizes);

}  // namespace
}  // namespace argil::contact

BENCHMARK_MAIN();
