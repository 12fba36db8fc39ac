// A hand of one's own, without a trace: a sphere goes 3 mm into a ball of clay and the force at each 5 ms is
// printed. Usage: press_ball SCENARIO.json (its trace says where the hand starts)

#include <cstdio>
#include <exception>

#include "device/trace.h"
#include "scenario/build.h"
#include "scenario/scenario.h"
#include "sim/simulation.h"

using namespace argil;

int press(const char* file) {
  const scenario::Scenario s = scenario::load_scenario(file, {});
  scenario::Scene scene = scenario::build_scene(s);
  device::DeviceSample hand = device::interpolate(scene.trace, s.trace.start);
  hand.mode = device::ToolMode::push;
  sim::Simulation simulation(scene.body, scene.tool, s.params, hand);
  std::puts("time_s,force_N");
  for (int tick = 1; tick <= 50; ++tick) {
    hand.position.z() -= 0.2e-3;  // 0.2 m/s downwards
    const StepStatus status = simulation.tick(hand);
    if (!status.is_ok()) {
      std::fprintf(stderr, "%s\n", to_string(status.failure()).c_str());
      return 3;
    }
    const sim::HapticRecord record = simulation.haptic_record();
    if (tick % 5 == 0) std::printf("%.3f,%.4f\n", record.time, record.force.norm());
  }
  return 0;
}

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: press_ball SCENARIO.json\n"), 2;
  try {
    return press(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "press_ball: %s\n", error.what());
    return 2;
  }
}
