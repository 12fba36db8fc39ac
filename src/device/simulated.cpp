// A hand model as a device: virtual time, one tick with every poll.

#include <atomic>
#include <optional>

#include "base/error.h"
#include "device/backends.h"

namespace argil::device::internal {
namespace {

class SimulatedDevice final : public HapticDevice {
 public:
  explicit SimulatedDevice(const DeviceOptions& options) : m_options(options) { make_hand(); }

  void start() override {
    make_hand();
    m_force.setZero();
    m_number = 0;
    m_is_released = false;
    m_state = DeviceState::ready;
  }
  void stop() noexcept override { m_state = DeviceState::stopped; }

  DevicePoll poll() noexcept override {
    DevicePoll poll;
    poll.state = m_state;
    if (poll.state != DeviceState::ready) return poll;
    if (m_is_released) m_force.setZero();
    poll.sample = m_number == 0 ? m_hand->sample() : m_hand->advance(m_force);
    poll.number = ++m_number;
    poll.time = m_hand->time();
    return poll;
  }
  void send(const Wrench& on_hand) noexcept override { m_force = finite_or_zero(on_hand.force); }
  void release() noexcept override { m_is_released = true; }

  DeviceState state() const noexcept override { return m_state; }
  DeviceInfo info() const override {
    DeviceInfo info;
    info.kind = "simulated";
    info.name = "hand model";
    info.rate_hz = 1.0 / m_options.period;
    info.has_force = true;
    return info;
  }
  DeviceCounts counts() const override { return {m_number, 0, 0}; }
  std::string problem() const override { return {}; }

 private:
  void make_hand() { m_hand.emplace(m_options.hand, m_options.intent, m_options.period); }

  DeviceOptions m_options;
  std::optional<HandModel> m_hand;
  Vec3 m_force = Vec3::Zero();  ///< held until the next [N]
  std::atomic<std::int64_t> m_number = 0;
  std::atomic<bool> m_is_released = false;
  std::atomic<DeviceState> m_state = DeviceState::stopped;
};

void require(bool in_range, const char* name, double value, const char* range) {
  if (in_range) return;
  throw InputError("--device simulated", name, std::to_string(value), std::string("give ") + range);
}

}  // namespace

std::unique_ptr<HapticDevice> make_simulated(const DeviceOptions& options) {
  const HandParams& hand = options.hand;
  require(hand.mass >= 1e-4 && hand.mass < 100.0, "mass", hand.mass, "0.0001 or more, less than 100 kg");
  require(hand.stiffness > 0.0 && hand.stiffness < 1e6, "stiffness", hand.stiffness,
          "more than 0 and less than 1e6 N/m");
  require(hand.damping >= 0.0 && hand.damping < 1e5, "damping", hand.damping,
          "0 or more, less than 1e5 N s/m");
  require(hand.reaction_delay >= 0.0 && hand.reaction_delay < 10.0, "reaction delay", hand.reaction_delay,
          "0 or more, less than 10 s");
  require(hand.tremor >= 0.0 && hand.tremor < 0.1, "tremor", hand.tremor, "0 or more, less than 0.1 m");
  require(hand.tremor_frequency > 0.0 && hand.tremor_frequency < 100.0, "tremor frequency",
          hand.tremor_frequency, "more than 0 and less than 100 Hz");
  if (options.intent.samples.empty())
    throw InputError("--device simulated", "", "the hand has nothing to do", "give it a trace to follow");
  return std::make_unique<SimulatedDevice>(options);
}

}  // namespace argil::device::internal
