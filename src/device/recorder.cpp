#include "device/recorder.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "base/error.h"

namespace argil::device {
namespace {

constexpr std::size_t kHashDigits = 64;

std::string print(double value) {
  std::array<char, 32> text{};
  constexpr int kDigits = 17;  // enough for every double to be read back as itself
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, kDigits);
  static_cast<void>(error);  // 32 bytes hold any double with 17 digits
  return {text.data(), end};
}

}  // namespace

TraceRecorder::TraceRecorder(const std::string& file, const std::string& device, double rate_hz)
    : m_file(file) {
  if (device.find_first_of("\r\n") != std::string::npos)
    throw InputError(file, "header", "the device's name has a line break", "give a name of one line");
  errno = 0;
  m_stream.open(file, std::ios::binary | std::ios::trunc);
  m_stream << "# argil-trace: 1\n";
  if (!device.empty()) m_stream << "# device: " << device << '\n';
  m_stream << "# units: m\n# rate_hz: " << print(rate_hz) << "\n# sha256: ";
  m_hash_position = m_stream.tellp();
  m_stream << std::string(kHashDigits, '-') << '\n';
  if (!m_stream) fail();
  write("t,x,y,z,qx,qy,qz,qw,mode\n");
}

void TraceRecorder::fail() const {
  throw IoError(m_file, std::string("cannot be written: ") + std::strerror(errno != 0 ? errno : EIO));
}

void TraceRecorder::write(const std::string& text) {
  m_body.add(text);
  m_stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!m_stream) fail();
}

void TraceRecorder::append(double time, const DeviceSample& sample) {
  std::string row = print(time);
  for (const double value :
       {sample.position.x(), sample.position.y(), sample.position.z(), sample.orientation.x(),
        sample.orientation.y(), sample.orientation.z(), sample.orientation.w()})
    row.append(",").append(print(value));
  row.append(",").append(to_string(sample.mode)).append("\n");
  write(row);
}

void TraceRecorder::finish() {
  m_stream.seekp(m_hash_position);
  m_stream << m_body.hex_digest();
  m_stream.close();
  if (!m_stream) fail();
}

void write_trace_csv(const std::string& file, const Trace& trace, double rate_hz) {
  TraceRecorder recorder(file, trace.device, rate_hz);
  for (std::size_t i = 0; i < trace.time.size(); ++i) recorder.append(trace.time[i], trace.samples[i]);
  recorder.finish();
}

}  // namespace argil::device
