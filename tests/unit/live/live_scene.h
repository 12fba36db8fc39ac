#pragma once

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_body.h"

namespace argil::live::test {

// A block of clay, 4 × 4 × 2 cm on a table, and a sphere over it.

inline constexpr double kToolRadius = 0.008;  ///< [m]

inline sim::Params make_params(sim::BetweenFrames between_frames) {
  sim::Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.yield = 0.005;
  p.contact.vertex_face_stiffness = 50.0;
  p.contact.edge_edge_stiffness = 50.0;
  p.solid.solver.kind = linear::SolverKind::cholesky;
  p.water.diffusivity = 1e-6;
  p.water.wetting_flux = 20.0;
  p.rates.physics_period_ticks = 2;
  p.rates.water_period_ticks = 10;
  p.rates.frame_period_ticks = 40;
  p.rates.between_frames = between_frames;
  return p;
}

/// With the sphere's lowest point `gap` over the middle of the block.
inline device::DeviceSample over(double gap) {
  device::DeviceSample sample;
  sample.position = {0.0211, 0.0197, 0.02 + kToolRadius + gap};
  return sample;
}

inline sim::Simulation make_simulation(const sim::Params& params, const device::DeviceSample& start) {
  return {argil::test::make_block_body(6, 6, 3, Vec3(0.04, 0.04, 0.02)),
          contact::make_sphere_tool(kToolRadius, 2), params, start};
}

/// A device whose motion a function of the sample's number gives. Keeps what it was sent last.
class Scripted : public device::HapticDevice {
 public:
  void start() override { m_state = device::DeviceState::ready; }
  void stop() noexcept override { m_state = device::DeviceState::stopped; }
  device::DevicePoll poll() noexcept override {
    device::DevicePoll poll;
    poll.number = ++m_number;
    poll.sample = sample(m_number);
    poll.state = m_state;
    return poll;
  }
  void send(const device::Wrench& on_hand) noexcept override { m_last = on_hand; }
  void release() noexcept override {}
  device::DeviceState state() const noexcept override { return m_state; }
  device::DeviceInfo info() const override { return {}; }
  device::DeviceCounts counts() const override { return {}; }
  std::string problem() const override { return "unplugged"; }
  const device::Wrench& last() const { return m_last; }

 protected:
  /// In the hand's thread.
  virtual device::DeviceSample sample(std::int64_t number) noexcept = 0;
  device::DeviceState m_state = device::DeviceState::stopped;

 private:
  std::int64_t m_number = 0;
  device::Wrench m_last{Vec3::Ones(), Vec3::Ones()};
};

}  // namespace argil::live::test
