// Haply Inverse Service, simulation channel: a WebSocket on which the service first lists its devices and
// then answers each command with one state. See the README for the fields and their sources.

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <optional>
#include <stdexcept>

#include "device/attached.h"
#include "device/backends.h"
#include "device/haply_message.h"

namespace argil::device::internal {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using ErrorCode = boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr double kFarewell = 0.2;             // [s] for the service to take the last command
constexpr std::size_t kMaxMessage = 1 << 20;  // [bytes]; an inventory of a dozen devices has some 20 kB

/// A whole text or close frame as a client sends it [RFC 6455 §5.2], masked with zeros.
std::string make_frame(unsigned char opcode, const std::string& payload) {
  std::string frame(1, static_cast<char>(0x80 | opcode));
  const std::size_t size = payload.size();
  if (size < 126) {
    frame += static_cast<char>(0x80 | size);
  } else {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(size >> 8 & 0xff);
    frame += static_cast<char>(size & 0xff);
  }
  return frame + std::string(4, '\0') + payload;
}

std::string explain(const ErrorCode& error) {
  if (error != websocket::error::buffer_overflow) return error.message();
  return "a message of more than " + std::to_string(kMaxMessage >> 20) + " MiB";
}

class HaplyDevice final : public AttachedDevice {
 public:
  HaplyDevice(const DeviceOptions& options, std::string host, std::string port)
      : AttachedDevice(options), m_host(std::move(host)), m_port(std::move(port)) {
    set_info(make_info("", ""));
  }
  ~HaplyDevice() override { stop(); }

 private:
  using Socket = websocket::stream<beast::tcp_stream>;

  void work() override;
  void interrupt() noexcept override;
  void release_device() noexcept override;

  void connect();
  void on_message(const std::string& text);
  void on_inventory(const HaplyMessage& message);
  void read();
  void tick();
  void write_when_due();
  void say_farewell() noexcept;
  DeviceInfo make_info(const std::string& kind, const std::string& id) const;
  /// A handler for Asio: goes on with `next`, or loses the device with the reason.
  template <class Next>
  auto or_lose(const char* what, Next next);

  std::string m_host;
  std::string m_port;
  asio::io_context m_io{1};
  int m_session = 0;  ///< counts connections
  // One connection's worth, made anew by work().
  std::optional<asio::ip::tcp::resolver> m_resolver;
  std::optional<Socket> m_socket;
  std::optional<asio::steady_timer> m_timer;
  beast::flat_buffer m_received{kMaxMessage};
  std::string m_sent;
  std::string m_id;             ///< of the Inverse3; empty before the inventory
  std::atomic<int> m_owed = 0;  ///< commands that have not been answered yet
  bool m_is_writing = false;    ///< a command is with Asio
  bool m_is_due = false;        ///< the next command, as soon as nothing is owed
  double m_deadline = 0.0;      ///< of the tick that is awaited [s]
  double m_last_good = 0.0;     ///< when a usable sample came [s]
  std::string m_last_fault;     ///< of what came since
  std::string m_zero_frame;     ///< final before m_descriptor is set
  std::atomic<int> m_descriptor = -1;
};

DeviceInfo HaplyDevice::make_info(const std::string& kind, const std::string& id) const {
  DeviceInfo info;
  info.kind = "haply";
  info.name = kind.empty() ? "Inverse Service at " + m_host + ":" + m_port : kind + " " + id;
  info.rate_hz = 1.0 / period();
  info.has_force = true;
  return info;
}

template <class Next>
auto HaplyDevice::or_lose(const char* what, Next next) {
  return [this, what, next, session = m_session](const ErrorCode& error, auto&&... results) {
    if (session != m_session) return;  // left over from a connection that has ended
    if (is_stopping()) return m_io.stop();
    if (error)
      throw std::runtime_error("Haply Inverse Service at " + m_host + ":" + m_port + ": " + what + ": " +
                               explain(error) + "; see that the service runs, or name haply:HOST:PORT");
    next(results...);
  };
}

void HaplyDevice::work() {
  m_io.restart();
  ++m_session;
  m_resolver.emplace(m_io);
  m_socket.emplace(m_io);
  m_timer.emplace(m_io);
  m_received.clear();
  m_id.clear();
  m_owed = 0;
  m_is_writing = m_is_due = false;
  m_deadline = m_last_good = monotonic_now();
  m_last_fault.clear();
  // Also when a handler throws: the last word to the device is zero force.
  struct Farewell {
    HaplyDevice* device;
    ~Farewell() { device->say_farewell(); }
  } const farewell{this};
  connect();
  tick();
  if (!is_stopping()) m_io.run();
}

void HaplyDevice::interrupt() noexcept {
  asio::post(m_io, [this] {
    if (is_stopping()) m_io.stop();
  });
}

void HaplyDevice::connect() {
  const auto shake_hands = [this](const auto&...) {
    m_socket->next_layer().socket().set_option(asio::ip::tcp::no_delay(true));
    m_socket->read_message_max(0);  // m_received has the limit, which leaves the channel for the farewell
    m_socket->async_handshake(m_host + ":" + m_port, "/", or_lose("no WebSocket", [this] { read(); }));
  };
  const auto reach = [this, shake_hands](const asio::ip::tcp::resolver::results_type& found) {
    m_socket->next_layer().async_connect(found, or_lose("cannot connect", shake_hands));
  };
  m_resolver->async_resolve(m_host, m_port, or_lose("unknown host", reach));
}

void HaplyDevice::read() {
  const auto take = [this](std::size_t) {
    const std::string text = beast::buffers_to_string(m_received.data());
    m_received.consume(m_received.size());
    on_message(text);
    read();
  };
  m_socket->async_read(m_received, or_lose("connection lost", take));
}

void HaplyDevice::on_message(const std::string& text) {
  const HaplyMessage message = read_haply_message(text, m_id);
  if (m_id.empty()) return on_inventory(message);
  if (m_owed == 0) return count_repeated();  // the service owes one state a command, and no more
  --m_owed;
  if (!message.problem.empty()) {
    count_refused();
    m_last_fault = message.problem;
  } else if (deliver(message.position, message.orientation, message.buttons)) {
    m_last_good = monotonic_now();
  } else {
    m_last_fault = "position or quaternion is none";
  }
  write_when_due();
}

void HaplyDevice::on_inventory(const HaplyMessage& message) {
  if (message.device_id.empty())
    throw std::runtime_error("Haply Inverse Service at " + m_host + ":" + m_port +
                             ": first message: " + message.problem);
  m_id = message.device_id;
  set_info(make_info(message.kind.empty() ? "inverse3" : message.kind, m_id));
  m_zero_frame = make_frame(1, print_haply_force(m_id, Vec3::Zero()));
  m_descriptor = m_socket->next_layer().socket().native_handle();
  m_last_good = monotonic_now();
}

/// Once a period a command is due.
void HaplyDevice::tick() {
  if (monotonic_now() - m_last_good > kPatience)
    throw std::runtime_error("Haply Inverse Service at " + m_host + ":" + m_port + ": no usable sample for " +
                             std::to_string(static_cast<int>(kPatience)) + " s" +
                             (m_last_fault.empty() ? "" : ": " + m_last_fault));
  m_is_due = true;
  write_when_due();
  m_deadline = find_next_deadline(m_deadline, period(), monotonic_now());
  m_timer->expires_at(Clock::time_point(std::chrono::duration_cast<Clock::duration>(Seconds(m_deadline))));
  m_timer->async_wait(or_lose("timer", [this] { tick(); }));
}

/// When every command before it was answered.
void HaplyDevice::write_when_due() {
  if (m_id.empty() || !m_is_due || m_is_writing || m_owed > 0) return;
  m_is_due = false;
  m_is_writing = true;
  ++m_owed;
  m_sent = print_haply_force(m_id, begin_rendering().force);
  m_socket->async_write(asio::buffer(m_sent), or_lose("connection lost", [this](std::size_t) {
                          end_rendering();
                          m_is_writing = false;
                          write_when_due();
                        }));
}

/// A short message goes in one piece, between those that Asio writes. It is answered like them.
void HaplyDevice::release_device() noexcept {
  const int descriptor = m_descriptor;
  if (descriptor < 0) return;
  ++m_owed;
  const ssize_t sent =
      ::send(descriptor, m_zero_frame.data(), m_zero_frame.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent < 0) --m_owed;
}

/// Zero force and a close frame; then waits until the service has read them, for a socket that is closed with
/// data unread takes back what it sent last.
void HaplyDevice::say_farewell() noexcept {
  release_device();
  const int descriptor = m_descriptor.exchange(-1);
  wait_for_releases();
  if (descriptor >= 0) {
    const std::string close = make_frame(8, "");
    ::send(descriptor, close.data(), close.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    ::shutdown(descriptor, SHUT_WR);
    const double end = monotonic_now() + kFarewell;
    std::array<char, 4096> rest;
    for (pollfd waited{descriptor, POLLIN, 0}; monotonic_now() < end;) {
      if (::poll(&waited, 1, 20) > 0 && ::recv(descriptor, rest.data(), rest.size(), MSG_DONTWAIT) <= 0)
        break;
    }
  }
  m_timer.reset();
  m_socket.reset();
  m_resolver.reset();
}

}  // namespace

std::unique_ptr<HapticDevice> make_haply(const std::string& host, const std::string& port,
                                         const DeviceOptions& options) {
  return std::make_unique<HaplyDevice>(options, host, port);
}

}  // namespace argil::device::internal
