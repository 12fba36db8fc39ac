// What a tick's contact costs by the pressure law: the tool, the motion and the body of the dry
// demonstration, whose places in 200 steps are kept and met again and again, with no step between.
//   build/bin/bench_pressure
// press: as it was · beside: the tool 1.5 mm farther out, so that it comes near and does not touch. Counters:
// contacts, and points near the tool, of a tick; `mean_force`, equal before and after a change that is meant
// to be faster.
#include <benchmark/benchmark.h>

#include <memory>
#include <optional>
#include <vector>

#include "scenario/build.h"
#include "sim/contact_load.h"
#include "sim/simulation.h"

namespace argil {
namespace {

constexpr double kApproach = 0.45;  // [s] into the motion, where the tool is off the body
constexpr Tick kTicksBefore = 300;  // then it presses
constexpr int kTicks = 200;

/// Surface and tool, tick by tick.
class Recorded {
 public:
  Recorded() {
    scenario::Scenario s = scenario::load_scenario(
        ARGIL_SOURCE_DIR "/scenarios/demo_dino_dry.json",
        {{"/haptics/physics_period_ticks", "1"}, {"/haptics/frame_period_ticks", "100"}});
    s.params.threads = 1;
    m_params = s.params;
    scenario::Scene scene = scenario::build_scene(s);
    const auto sample = [&](Tick tick) {
      device::DeviceSample at =
          device::interpolate(scene.trace, s.trace.start + kApproach + 0.001 * static_cast<double>(tick));
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
            m_params.solid.takes_contact_at_end(),
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

void find_pressure(benchmark::State& state, double gap) {
  static Recorded recorded;
  if (!recorded.fault().empty()) return state.SkipWithError(recorded.fault().c_str());
  contact::PressureContact pressure = recorded.make_contact();
  sim::LoadCollector load(recorded.params(), recorded.surface(),
                          recorded.simulation().solid().model.elements);
  contact::Contacts contacts;
  contacts.with_touched = false;
  // The way out of the body, which the tool comes from.
  const Vec3 out = (recorded.pose_at(0).position - recorded.surface_at(0).rowwise().mean()).normalized();
  const auto pose = [&](int tick) {
    contact::Pose at = recorded.pose_at(tick);
    at.position += gap * Vec3(0.0, out.y() < 0.0 ? -1.0 : 1.0, 0.0);
    return at;
  };
  double force = 0.0, pressed = 0.0, near = 0.0;
  std::int64_t ticks = 0;
  int last = 0, way = 1;
  pressure.prepare(recorded.surface_at(0));
  for (auto _ : state) {
    if (last + way < 0 || last + way > kTicks) way = -way;
    const int next = last + way;
    const Points& x = recorded.surface_at(next);
    pressure.advance(recorded.surface_at(last), x, std::nullopt);
    pressure.find_contacts(x, pose(last), pose(next), contact::Yielding::yes, contacts);
    for (const contact::Contact& c : contacts.contacts) {
      load.add_force(c, c.force);
      load.add_pressure(c, false, x);
    }
    for (const contact::Contact& c : contacts.near) load.add_pressure(c, true, x);
    load.roll_back();
    last = next;
    if (++ticks > kTicks) continue;
    force += contacts.force_on_tool.norm();
    pressed += static_cast<double>(contacts.contacts.size());
    near += static_cast<double>(contacts.near.size());
  }
  ticks = std::min<std::int64_t>(ticks, kTicks);
  state.counters["triangles"] = static_cast<double>(recorded.surface().triangles().cols());
  state.counters["contacts"] = pressed / static_cast<double>(ticks);
  state.counters["near"] = near / static_cast<double>(ticks);
  state.counters["mean_force"] = force / static_cast<double>(ticks);
}
BENCHMARK_CAPTURE(find_pressure, press, 0.0)->Unit(benchmark::kMicrosecond)->Iterations(4000);
BENCHMARK_CAPTURE(find_pressure, beside, 1.5e-3)->Unit(benchmark::kMicrosecond)->Iterations(4000);

}  // namespace
}  // namespace argil

BENCHMARK_MAIN();
