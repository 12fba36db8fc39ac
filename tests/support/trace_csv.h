#pragma once

#include <array>
#include <charconv>
#include <string>

#include "base/hash.h"
#include "device/trace.h"

namespace argil::test {

/// A motion in world coordinates as a CSV trace with 17 digits, enough for every double to be read back as
/// itself. `is_finished`: has the body's hash in its header, which a recording that was killed has not.
inline std::string print_trace_csv(const device::Trace& trace, double rate_hz, bool is_finished = true) {
  const auto print = [](double value) {
    std::array<char, 32> text{};
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 17).ptr;
    return std::string(text.data(), end);
  };
  std::string body = "t,x,y,z,qx,qy,qz,qw,mode\n";
  for (std::size_t i = 0; i < trace.time.size(); ++i) {
    const device::DeviceSample& sample = trace.samples[i];
    const Vec3& x = sample.position;
    const Quat& q = sample.orientation;
    body += print(trace.time[i]);
    for (const double value : {x.x(), x.y(), x.z(), q.x(), q.y(), q.z(), q.w()}) body += "," + print(value);
    body += "," + std::string(to_string(sample.mode)) + "\n";
  }
  Sha256 hash;
  hash.add(body);
  std::string head = "# argil-trace: 1\n";
  if (!trace.device.empty()) head += "# device: " + trace.device + "\n";
  return head + "# units: m\n# rate_hz: " + print(rate_hz) +
         "\n# sha256: " + (is_finished ? hash.hex_digest() : std::string(64, '-')) + "\n" + body;
}

}  // namespace argil::test
