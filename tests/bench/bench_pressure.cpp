// What a tick's contact costs by pressure and by pairs, on the same places of a body under a tool: 200 ticks
// are recorded, and met again and again with no step between.
//   build/bin/bench_pressure --benchmark_enable_random_interleaving=true --benchmark_repetitions=9
// tip: the dry demonstration · ball: the soft dinosaur on 5000 even tets · press: as it was · beside: the
// tool 1.5 mm farther out, so that it comes near and does not touch. Counters: contacts, and points near the
// tool, of a tick; `mean_force`, equal before and after a change that is meant to be faster.
#include <benchmark/benchmark.h>

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "scenario/build.h"
#include "sim/contact_load.h"
#include "sim/simulation.h"

namespace argil {
namespace {

/// What is run to have places of a body under a tool.
struct Scene {
  const char* scenario;
  double approach;  ///< [s] into the motion, where the tool is off the body
  std::vector<scenario::Setting> settings = {};
};
const Scene kTip = {"demo_dino_dry.json", 0.45};
const Scene kBall = {
    "study_soft_dino.json", 0.55, {{"/body/cells/kind", "even"}, {"/body/shape/target_tets", "5000"}}};

constexpr Tick kTicksBefore = 300;  // then it presses
constexpr int kTicks = 200;
constexpr double kBeside = 1.5e-3;  // [m]

/// Surface and tool, tick by tick.
class Recorded {
 public:
  explicit Recorded(const Scene& of) {
    std::vector<scenario::Setting> settings = of.settings;
    settings.push_back({"/haptics/physics_period_ticks", "1"});
    settings.push_back({"/haptics/frame_period_ticks", "100"});
    scenario::Scenario s =
        scenario::load_scenario(std::string(ARGIL_SOURCE_DIR "/scenarios/") + of.scenario, settings);
    s.params.threads = 1;
    m_params = s.params;
    scenario::Scene scene = scenario::build_scene(s);
    const auto sample = [&](Tick tick) {
      device::DeviceSample at =
          device::interpolate(scene.trace, s.trace.start + of.approach + 0.001 * static_cast<double>(tick));
      at.mode = device::ToolMode::push;
      return at;
    };
    m_tool = scene.tool;
    m_simulation = std::make_unique<sim::Simulation>(std::move(scene.body), m_tool, m_params, sample(0));
    for (Tick tick = 1; tick <= kTicksBefore + kTicks && m_fault.empty(); ++tick) {
      const device::DeviceSample at = sample(tick);
      const StepStatus status = m_simulation->tick(at);
      if (!status.is_ok()) m_fault = to_string(status.failure());
      if (tick < kTicksBefore) continue;
      m_surface.push_back(m_simulation->surface_now());
      m_pose.push_back({at.position, at.orientation});
    }
  }
  const std::string& fault() const { return m_fault; }
  const mesh::TriangleMesh& tool() const { return m_tool; }
  const sim::ContactSurface& surface() { return m_simulation->body_side().surface(); }
  const Points& surface_at(int tick) const { return m_surface[static_cast<std::size_t>(tick)]; }
  const contact::Pose& pose_at(int tick) const { return m_pose[static_cast<std::size_t>(tick)]; }
  const sim::Params& params() const { return m_params; }
  sim::Simulation& simulation() { return *m_simulation; }
  contact::PressureContact make_contact() {
    return {surface().triangles(),
            surface().num_vertices(),
            contact::make_tool_solid(m_params.contact.round_tool, m_tool),
            m_simulation->body_side().find_surface_stiffness(),
            m_params.solid.solves_contact(),
            m_params.contact.penalty};
  }

 private:
  sim::Params m_params;
  mesh::TriangleMesh m_tool;
  std::unique_ptr<sim::Simulation> m_simulation;
  std::vector<Points> m_surface;
  std::vector<contact::Pose> m_pose;
  std::string m_fault;
};

/// A body's surface that goes from one recorded place to the next and back again. Places are written anew for
/// each tick, as a step writes them.
class Playback {
 public:
  explicit Playback(Recorded& recorded, double gap) : m_recorded(recorded), m_gap(gap) {
    // The way out of the body, which the tool comes from.
    const Vec3 out = (recorded.pose_at(0).position - recorded.surface_at(0).rowwise().mean()).normalized();
    m_out = Vec3(0.0, out.y() < 0.0 ? -1.0 : 1.0, 0.0);
    from = to = recorded.surface_at(0);
    begin = end = place(0);
  }
  void advance() {
    if (m_tick + m_way < 0 || m_tick + m_way > kTicks) m_way = -m_way;
    m_tick += m_way;
    from.swap(to);
    to = m_recorded.surface_at(m_tick);
    begin = end;
    end = place(m_tick);
  }

  Points from, to;
  contact::Pose begin, end;

 private:
  contact::Pose place(int tick) const {
    contact::Pose at = m_recorded.pose_at(tick);
    at.position += m_gap * m_out;
    return at;
  }

  Recorded& m_recorded;
  double m_gap;
  Vec3 m_out;
  int m_tick = 0, m_way = 1;
};

/// Contacts of a tick, and what the body is told of them.
class ByPressure {
 public:
  explicit ByPressure(Recorded& recorded)
      : m_pressure(recorded.make_contact()),
        m_load(recorded.params(), recorded.surface(), recorded.simulation().solid().model.elements) {
    contacts.with_touched = false;
    m_pressure.prepare(recorded.surface_at(0));
  }
  void find(const Playback& now) {
    m_pressure.advance(now.from, now.to, std::nullopt);
    m_pressure.find_contacts(now.to, now.begin, now.end, contact::Yielding::yes, contacts);
    for (const contact::Contact& c : contacts.contacts) {
      m_load.add_force(c, c.force);
      m_load.add_pressure(c, false, now.to);
    }
    for (const contact::Contact& c : contacts.near) m_load.add_pressure(c, true, now.to);
    m_load.roll_back();
  }
  contact::Contacts contacts;

 private:
  contact::PressureContact m_pressure;
  sim::LoadCollector m_load;
};

/// The same by pairs of features, as the paper finds them.
class ByPairs {
 public:
  explicit ByPairs(Recorded& recorded)
      : m_detector(recorded.surface().triangles(), recorded.surface().num_vertices(), recorded.tool(),
                   make_params()),
        m_load(recorded.params(), recorded.surface(), recorded.simulation().solid().model.elements) {
    contacts.with_touched = false;
    m_detector.prepare(recorded.surface_at(0), recorded.pose_at(0));
  }
  void find(const Playback& now) {
    m_detector.find_contacts(now.from, now.to, now.begin, now.end, contacts);
    for (const contact::Contact& c : contacts.contacts) {
      m_load.add_force(c, c.force);
      m_load.add_stiffness(c, c.force, true, now.to);
    }
    m_load.roll_back();
  }
  contact::Contacts contacts;

 private:
  static contact::ContactParams make_params() {
    contact::ContactParams params;
    params.vertex_face_stiffness = params.edge_edge_stiffness = 100.0;  // [N/m]
    return params;
  }
  contact::ContactDetector m_detector;
  sim::LoadCollector m_load;
};

template <class Law>
void find_contacts(benchmark::State& state, Recorded& recorded, double gap) {
  if (!recorded.fault().empty()) return state.SkipWithError(recorded.fault().c_str());
  Playback now(recorded, gap);
  Law law(recorded);
  double force = 0.0, pressed = 0.0, near = 0.0;
  for (auto _ : state) {
    now.advance();
    const auto start = std::chrono::steady_clock::now();
    law.find(now);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    state.SetIterationTime(spent.count());
    force += law.contacts.force_on_tool.norm();
    pressed += static_cast<double>(law.contacts.contacts.size());
    near += static_cast<double>(law.contacts.near.size());
  }
  const auto ticks = static_cast<double>(state.iterations());
  state.counters["triangles"] = static_cast<double>(recorded.surface().triangles().cols());
  state.counters["contacts"] = pressed / ticks;
  state.counters["near"] = near / ticks;
  state.counters["mean_force"] = force / ticks;
}
Recorded& tip() {
  static Recorded recorded(kTip);
  return recorded;
}
Recorded& ball() {
  static Recorded recorded(kBall);
  return recorded;
}
void find_by_pressure(benchmark::State& state, Recorded& (&scene)(), double gap) {
  find_contacts<ByPressure>(state, scene(), gap);
}
void find_by_pairs(benchmark::State& state, Recorded& (&scene)(), double gap) {
  find_contacts<ByPairs>(state, scene(), gap);
}
void set_times(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMicrosecond)->Iterations(4000)->UseManualTime();
}
BENCHMARK_CAPTURE(find_by_pressure, tip_press, tip, 0.0)->Apply(set_times);
BENCHMARK_CAPTURE(find_by_pressure, tip_beside, tip, kBeside)->Apply(set_times);
BENCHMARK_CAPTURE(find_by_pairs, tip_press, tip, 0.0)->Apply(set_times);
BENCHMARK_CAPTURE(find_by_pairs, tip_beside, tip, kBeside)->Apply(set_times);
BENCHMARK_CAPTURE(find_by_pressure, ball_press, ball, 0.0)->Apply(set_times);
BENCHMARK_CAPTURE(find_by_pressure, ball_beside, ball, kBeside)->Apply(set_times);
BENCHMARK_CAPTURE(find_by_pairs, ball_press, ball, 0.0)->Apply(set_times);
BENCHMARK_CAPTURE(find_by_pairs, ball_beside, ball, kBeside)->Apply(set_times);

}  // namespace
}  // namespace argil

BENCHMARK_MAIN();
