#include "live/live.h"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "base/error.h"
#include "base/realtime.h"
#include "device/devices.h"
#include "device/release_guard.h"
#include "live/figures.h"
#include "live/recorder.h"
#include "output/info.h"
#include "run/files.h"
#include "run/loop.h"
#include "run/replay.h"
#include "run/start.h"
#include "scenario/build.h"

namespace argil::live {
namespace {

using run::ExitCode;

std::atomic<Session*> g_session =
    nullptr;  // what a signal ends; the pointer and what it does are free of locks
static_assert(std::atomic<Session*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

void on_signal(int) {
  if (Session* session = g_session.load()) session->request_stop();
}

constexpr std::array kEndingSignals = {SIGINT, SIGTERM, SIGHUP};

/// As long as this object is there, signals end the session. Then they do what they did before.
class SignalScope {
 public:
  explicit SignalScope(Session& session) {
    g_session = &session;
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART | SA_ONSTACK;
    for (std::size_t i = 0; i < kEndingSignals.size(); ++i)
      sigaction(kEndingSignals[i], &action, &m_before[i]);
  }
  ~SignalScope() {
    for (std::size_t i = 0; i < kEndingSignals.size(); ++i)
      sigaction(kEndingSignals[i], &m_before[i], nullptr);
    g_session = nullptr;
  }
  SignalScope(const SignalScope&) = delete;
  SignalScope& operator=(const SignalScope&) = delete;

 private:
  std::array<struct sigaction, kEndingSignals.size()> m_before;
};

/// What batch can do and a hand that does not wait cannot.
void require_live(const scenario::Scenario& s) {
  if (s.mode == scenario::Mode::equilibrium)
    throw InputError(s.file, "/dynamics/mode", "\"static\" has no ticks", "run it with argil run");
  if (s.params.deflects_between_steps())
    throw InputError(
        s.file, "/haptics/between_frames",
        "\"compliant\" pairs look into the body between its steps, which a hand that does not wait cannot",
        "set re_evaluate or hold");
  const double step = s.params.rates.physics_period_ticks * s.params.rates.haptic_period;
  const double oldest = s.params.device.watchdog.max_physics_age;
  std::ostringstream problem;
  problem << s.params.rates.physics_period_ticks << " ticks between steps are " << step
          << " s, longer than the " << oldest << " s after which the watchdog lets the hand go";
  if (step > oldest)
    throw InputError(s.file, "/haptics/physics_period_ticks", problem.str(),
                     "make it shorter, or raise /haptics/device/watchdog/max_physics_age_s");
}

device::DeviceOptions make_device_options(const scenario::Scenario& s, const device::Trace& trace) {
  device::DeviceOptions options;
  options.device_to_world = s.trace.options.device_to_world;
  options.mode = run::find_fixed_mode(s).value_or(s.trace.options.default_mode);
  options.period = s.params.rates.haptic_period;
  options.intent = trace;
  options.hand = s.hand.params;
  return options;
}

/// Started, and with a first sample.
std::unique_ptr<device::HapticDevice> attach(const std::string& name, const device::DeviceOptions& options) {
  constexpr double kPatience = 5.0;  // [s]
  std::unique_ptr<device::HapticDevice> device = device::make_device(name, options);
  device->start();
  const device::DeviceState state = device::wait_until_ready(*device, kPatience);
  if (state == device::DeviceState::lost) throw IoError("--device " + name, device->problem());
  if (state != device::DeviceState::ready)
    throw IoError("--device " + name, "gave no valid sample within 5 s: is it switched on and calibrated?");
  return device;
}

/// The smaller of two limits, of which 0 is none.
double find_tighter(double a, double b) {
  return a > 0.0 && b > 0.0 ? std::min(a, b) : std::max(a, b);
}

/// Where the session begins; `sample` was taken from the device, which is ready.
output::SessionHead make_head(const scenario::Scenario& s, const device::DeviceInfo& info,
                              const device::DeviceSample& sample) {
  const device::DeviceLimits& limits = s.params.device;
  output::SessionHead head{info.name, sample, find_tighter(limits.max_force, info.max_force),
                           find_tighter(limits.max_torque, info.max_torque)};
  head.start.mode = run::find_fixed_mode(s).value_or(sample.mode);
  return head;
}

void warn_of_stiffness(const scenario::Scenario& s, const device::DeviceInfo& info) {
  const contact::ContactParams& contact = s.params.contact;
  const double stiffness = std::max(contact.vertex_face_stiffness, contact.edge_edge_stiffness);
  if (!(info.max_stiffness > 0.0 && stiffness > info.max_stiffness)) return;
  std::fprintf(stderr,
               "argil: warning: %s: /contact: a stiffness of %g N/m is more than the %g N/m that %s declares "
               "to render stably: lower it, or set /haptics/passivity to time_domain\n",
               s.file.c_str(), stiffness, info.max_stiffness, info.name.c_str());
}

void check_watch_name(const scenario::Scenario& s, const std::string& watch, const std::string& result) {
  run::check_result_name(s, watch, "--watch");
  for (const std::string& written : {result, run::name_xdmf(result)})
    if (std::filesystem::weakly_canonical(watch) == std::filesystem::weakly_canonical(written))
      throw InputError(watch, "", "is what the result is written to", "give another name to --watch");
}

double find_water_capacity(const sim::Simulation& simulation) {
  double capacity = 0.0;  // [kg]
  for (int t = 0; t < simulation.body().mesh.num_tets(); ++t) capacity += simulation.pore_water().capacity(t);
  return capacity;
}

Tick find_num_ticks(const scenario::Scenario& s, const LiveOptions& options, const device::Trace& trace) {
  constexpr double kMost = 1e15;
  const double period = s.params.rates.haptic_period;
  if (options.duration == 0.0) return options.device == "simulated" ? run::count_ticks(s, trace) : 0;
  const bool is_countable = options.duration > 0.0 && options.duration <= kMost * period;
  const Tick ticks = is_countable ? run::count_ticks(s, options.duration) : 0;
  std::ostringstream problem;
  problem << options.duration << " s is not from one tick (" << period << " s) to 1e15 ticks";
  if (ticks < 1) throw InputError("--duration", "", problem.str(), "give a duration in that range");
  return ticks;
}

/// Would a few words be written at once? Not to a terminal that a user has stopped.
bool takes_text(int descriptor) {
  pollfd look = {descriptor, POLLOUT, 0};
  return poll(&look, 1, 0) == 1 && (look.revents & POLLOUT) != 0;
}

/// Drains until both threads have ended, and shows how it goes.
void attend(Session& session, Recorder& recorder, const Figures& figures, double water_capacity,
            bool is_quiet) {
  constexpr double kLook = 0.005, kRedraw = 0.1;  // [s]
  const bool draws = !is_quiet && isatty(STDERR_FILENO) == 1;
  const double start = monotonic_now();
  double drawn = start;
  while (session.is_running()) {
    recorder.drain(session);
    const double now = monotonic_now();
    if (draws && now - drawn >= kRedraw && takes_text(STDERR_FILENO)) {
      std::fprintf(stderr, "\r%s ", figures.print_now(now - start, water_capacity).c_str());
      drawn = now;
    }
    sleep_until(now + kLook);
  }
  session.join();
  recorder.drain(session);
  if (draws && takes_text(STDERR_FILENO)) std::fputc('\n', stderr);
}

int print_end(const Session& session, const device::HapticDevice& device, const std::string& result,
              const Figures& figures, bool is_quiet) {
  if (!is_quiet) std::printf("%s:\n%s", result.c_str(), figures.print().c_str());
  if (const auto failure = session.failure()) {
    std::fprintf(stderr, "argil: run failed: %s\n", output::describe_failure(*failure).c_str());
    return ExitCode::kRunFailed;
  }
  switch (session.end()) {
    case SessionEnd::lost:
      std::fprintf(stderr, "argil: the device was lost: %s\n", device.problem().c_str());
      return ExitCode::kIoFailed;
    case SessionEnd::overflow:
      std::fprintf(stderr, "argil: %s could not be written as fast as the hand moves\n", result.c_str());
      return ExitCode::kIoFailed;
    case SessionEnd::asked:
      std::fprintf(stderr, "argil: interrupted; %s is complete up to there\n", result.c_str());
      return ExitCode::kInterrupted;
    default:
      return ExitCode::kDone;
  }
}

/// The session from its first tick to the end of its file.
int conduct(sim::Simulation& simulation, device::HapticDevice& device, const SessionOptions& session_options,
            output::ResultFile& file, Watch* watch, const std::string& result, const LiveOptions& options) {
  Figures figures;
  Recorder recorder(file, figures, watch);
  Session session(simulation, device, session_options);
  const double water_capacity = find_water_capacity(simulation);
  {
    const SignalScope signals(session);
    session.start();
    if (!session.warning().empty()) std::fprintf(stderr, "argil: warning: %s\n", session.warning().c_str());
    attend(session, recorder, figures, water_capacity, options.run.quiet);
  }
  device.stop();
  run::end_session(simulation, file);
  file.append_timing(figures.list());
  const SessionEnd end = session.end();
  file.finish(session.failure(), end != SessionEnd::done && end != SessionEnd::failed);
  output::write_xdmf(result, run::name_xdmf(result));
  return print_end(session, device, result, figures, options.run.quiet);
}

}  // namespace

int run_live(const LiveOptions& options) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit is then an error of the write, like a full disk
  run::RunOptions run_options = options.run;
  run_options.has_own_hand = true;
  const scenario::Scenario s = run::load(run_options);
  if (s.accuracy > 0.0)
    throw InputError(s.file, "/fidelity/accuracy", "is given, but cells are chosen by a motion that is known",
                     "argil plan makes a patch of it by a recorded one; give the session that with --patch");
  require_live(s);
  if (options.device == "simulated" && s.trace.file.empty())
    throw InputError(s.file, "/trace/file", "is missing: it is what a simulated hand means to do",
                     "add it, or take another --device");
  const std::string result = run::name_result(s, options.run);
  run::check_result_name(s, result);
  if (!options.watch.empty()) check_watch_name(s, options.watch, result);
  scenario::Scene scene = scenario::build_scene(s);
  scene.contact_cells.clear();  // of a motion that is the hand's
  const auto device = attach(options.device, make_device_options(s, scene.trace));
  const device::ReleaseGuard guard(*device);
  const Tick num_ticks = find_num_ticks(s, options, scene.trace);
  scene.trace = {};
  const mesh::TriangleMesh tool = scene.tool;
  const auto head_now = [&](const device::DevicePoll& poll) {
    return make_head(s, device->info(), poll.sample);
  };
  device::DevicePoll first = device->poll();
  output::SessionHead head = head_now(first);
  sim::Simulation simulation(std::move(scene.body), tool, run::session_params(head, s.params), head.start);
  run::print_notes(scene, options.run);
  warn_of_stiffness(s, device->info());
  std::unique_ptr<Watch> watch;
  if (!options.watch.empty()) watch = std::make_unique<Watch>(options.watch, simulation);
  // To make all this took a while, in which the hand may have moved.
  if (const device::DevicePoll now = device->poll(); now.is_valid()) first = now;
  head = head_now(first);
  simulation.hand().begin_at(head.start);
  run::require_free_start(simulation, tool, "--device " + options.device, "", "move the device away from it");
  const scenario::Scenario bare = run::without_trace(s);
  output::ResultFile file(result, run::make_header(bare, simulation, scene, tool, run::find_identity(bare)));
  file.begin_session(head, true);
  file.append(simulation.make_frame());
  const SessionOptions session_options{
      .num_ticks = num_ticks, .mode = run::find_fixed_mode(s), .first_sample = first.number};
  return conduct(simulation, *device, session_options, file, watch.get(), result, options);
}

}  // namespace argil::live
