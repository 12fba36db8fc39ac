// The 3D Systems Touch (once Phantom Omni) as a device of argil: --device plugin:touch.so[,NAME]. NAME is the
// device's in the vendor's setup program; without one it is the default device. README.md says how to build
// it.
//
// Two threads meet here. OpenHaptics calls serve() a thousand times a second in a thread of its own: it reads
// the pen, tells the motors of the newest force, and never waits. argil's device thread calls read and write.
// Lengths are mm in OpenHaptics and m in argil; both have the device's own axes: x right, y up, z to the
// user.

#include <HD/hd.h>
#include <semaphore.h>

#include <Eigen/Geometry>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>
#include <string>

#include "base/latest_value.h"
#include "device/plugin_api.h"

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Vec3 = Eigen::Vector3d;

constexpr double kMillimetre = 1e-3;                // [m]
constexpr milliseconds kForceLifetime{50};          // without a new one the motors rest
constexpr milliseconds kServoPatience{1000};        // without a call of serve(): the scheduler has stopped
constexpr milliseconds kCalibrationPatience{2500};  // argil waits 5 s for a first sample
constexpr milliseconds kReleasePatience{5};         // some periods of the servo loop
constexpr long kReadPatience = 5'000'000;           // [ns]; plugin_api.h allows 10 ms

struct PenState {
  HDdouble transform[16] = {};  // column after column, lengths in mm
  HDint buttons = 0;
};

struct Order {
  Vec3 force = Vec3::Zero();  // [N]
  Clock::time_point time;
  unsigned releases = 0;  // of those that came before it
};

struct Limits {
  HDdouble max_force = 0.0;      // [N]
  HDdouble max_stiffness = 0.0;  // [N/mm]
  HDdouble workspace[6] = {};    // lowest x, y, z, then highest [mm]
};

struct Touch {
  HHD handle = HD_INVALID_HANDLE;
  HDSchedulerHandle servo = 0;
  bool is_serving = false;  // serve() is scheduled
  Limits limits;
  std::string name;
  std::string reason;                 // argil's device thread
  Clock::time_point last_sample;      // argil's device thread
  argil::LatestValue<PenState> pens;  // from the servo loop
  argil::LatestValue<Order> orders;   // to it
  Order order;                        // the servo loop's
  sem_t has_news;                     // posted once a servo period
  std::atomic<HDerror> fault = HD_SUCCESS;
  std::atomic<unsigned> releases = 0;        // how often the hand was let go
  std::atomic<unsigned> releases_heard = 0;  // of them, those after which the motors were told of zero

  Touch() { sem_init(&has_news, 0, 0); }
  ~Touch() { sem_destroy(&has_news); }
};
static_assert(std::atomic<unsigned>::is_always_lock_free && std::atomic<HDerror>::is_always_lock_free);

/// What a user can do about it.
std::string explain(HDerror fault) {
  switch (fault) {
    case HD_DEVICE_FAULT:
      return "the device reports a fault: check its power and its cable, then run the vendor's diagnostic";
    case HD_COMM_ERROR:
      return "the connection to the device is lost: check its cable and its power";
    case HD_COMM_CONFIG_ERROR:
      return "the device does not answer where it was set up: run the vendor's setup program";
    case HD_DEVICE_ALREADY_INITIATED:
      return "another program uses the device: end that one";
    case HD_TIMER_ERROR:
      return "the device's 1 kHz timer failed: start the computer anew";
    case HD_WARM_MOTORS:
      return "the motors are too warm: let the device rest for some minutes";
    case HD_EXCEEDED_MAX_FORCE:
    case HD_EXCEEDED_MAX_FORCE_IMPULSE:
      return "the force was more than the device renders: lower /haptics/device/max_force_N";
    case HD_EXCEEDED_MAX_VELOCITY:
      return "the pen was moved faster than the device allows: move it more slowly";
    case HD_FORCE_ERROR:
      return "the device could not render the force: lower /haptics/device/max_force_N";
    default:
      return std::string("OpenHaptics says: ") + hdGetErrorString(fault);
  }
}

/// The oldest of the errors that the library has kept, which is the cause of the others.
HDerror take_fault() {
  constexpr int kMost = 64;  // a library that always finds another one does not hold up the servo loop
  HDerror oldest = HD_SUCCESS;
  for (int i = 0; i < kMost; ++i) {
    const HDerror code = hdGetError().errorCode;
    if (code == HD_SUCCESS) break;
    oldest = code;
  }
  return oldest;
}

/// What the motors are to render in this period.
Vec3 find_force(Touch& touch, unsigned releases) {
  touch.orders.take(touch.order);
  const bool is_alive = Clock::now() - touch.order.time <= kForceLifetime;
  const bool is_held = touch.order.releases == releases && touch.fault == HD_SUCCESS;
  return is_alive && is_held ? touch.order.force : Vec3::Zero();
}

/// Once a servo period, in OpenHaptics' thread.
HDCallbackCode HDCALLBACK serve(void* data) {
  Touch& touch = *static_cast<Touch*>(data);
  const unsigned releases = touch.releases;
  const Vec3 force = find_force(touch, releases);
  PenState pen;
  hdBeginFrame(touch.handle);
  hdGetDoublev(HD_CURRENT_TRANSFORM, pen.transform);
  hdGetIntegerv(HD_CURRENT_BUTTONS, &pen.buttons);
  hdSetDoublev(HD_CURRENT_FORCE, force.data());
  hdEndFrame(touch.handle);
  const HDerror fault = take_fault();
  HDerror none = HD_SUCCESS;
  if (fault != HD_SUCCESS)
    touch.fault.compare_exchange_strong(none, fault);  // the first is the one that is told
  if (fault == HD_SUCCESS) touch.pens.put(pen);
  touch.releases_heard = releases;
  int waiting = 0;
  if (sem_getvalue(&touch.has_news, &waiting) == 0 && waiting == 0) sem_post(&touch.has_news);
  return HD_CALLBACK_CONTINUE;
}

/// One look at calibration and limits, in OpenHaptics' thread.
struct Look {
  Touch* touch;
  HDenum calibration = HD_CALIBRATION_NEEDS_MANUAL_INPUT;
  HDint styles = 0;
  HDerror fault = HD_SUCCESS;
};

HDCallbackCode HDCALLBACK look(void* data) {
  Look& look = *static_cast<Look*>(data);
  Limits& limits = look.touch->limits;
  hdBeginFrame(look.touch->handle);
  look.calibration = hdCheckCalibration();
  hdGetIntegerv(HD_CALIBRATION_STYLE, &look.styles);
  hdGetDoublev(HD_NOMINAL_MAX_FORCE, &limits.max_force);
  hdGetDoublev(HD_NOMINAL_MAX_STIFFNESS, &limits.max_stiffness);
  hdGetDoublev(HD_USABLE_WORKSPACE_DIMENSIONS, limits.workspace);
  hdEndFrame(look.touch->handle);
  look.fault = take_fault();
  return HD_CALLBACK_DONE;
}

/// A device offers one or several; automatic needs nothing of the user.
HDenum choose_style(HDint styles) {
  for (const HDenum style : {HD_CALIBRATION_AUTO, HD_CALIBRATION_INKWELL})
    if ((static_cast<HDenum>(styles) & style) != 0) return style;
  return HD_CALIBRATION_ENCODER_RESET;
}

constexpr const char* kAsk[] = {
    "put the pen into its inkwell (the hole in the device's foot), leave it there for two seconds",
    "put the arm into the position that the vendor's manual shows for its calibration"};

/// Empty when the device is calibrated, else what stands in the way.
std::string calibrate(Touch& touch) {
  const char* ask = kAsk[0];
  bool has_asked = false;
  for (const auto end = Clock::now() + kCalibrationPatience; Clock::now() < end;) {
    Look now{&touch};
    hdScheduleSynchronous(look, &now, HD_DEFAULT_SCHEDULER_PRIORITY);
    if (now.fault != HD_SUCCESS) return explain(now.fault);
    if (now.calibration == HD_CALIBRATION_OK) return "";
    const HDenum style = choose_style(now.styles);
    ask = kAsk[style == HD_CALIBRATION_ENCODER_RESET ? 1 : 0];
    if (now.calibration == HD_CALIBRATION_NEEDS_UPDATE) {
      hdUpdateCalibration(style);
    } else if (!has_asked) {
      has_asked = true;
      std::fprintf(stderr, "touch: the device is not calibrated: %s\n", ask);
    }
    const timespec pause{0, 20'000'000};
    nanosleep(&pause, nullptr);
  }
  return std::string("the device is not calibrated: ") + ask + ", and start again";
}

/// Lets go of the hand. Async-signal-safe: it sets a number and looks, for some servo periods, whether the
/// motors were told.
void release(void* handle) {
  Touch& touch = *static_cast<Touch*>(handle);
  const unsigned releases = ++touch.releases;
  const timespec pause{0, 200'000};
  for (const auto end = Clock::now() + kReleasePatience;
       touch.releases_heard != releases && Clock::now() < end;)
    nanosleep(&pause, nullptr);
}

void close_device(void* handle) {
  const std::unique_ptr<Touch> touch(static_cast<Touch*>(handle));
  if (touch->is_serving) release(handle);
  hdStopScheduler();
  if (touch->is_serving) hdUnschedule(touch->servo);
  hdDisableDevice(touch->handle);
  take_fault();
}

/// Empty when serve() runs, else what stands in the way.
std::string begin_serving(Touch& touch) {
  hdMakeCurrentDevice(touch.handle);
  const HDstring model = hdGetString(HD_DEVICE_MODEL_TYPE);
  touch.name = model != nullptr ? model : "3D Systems Touch";
  hdEnable(HD_FORCE_OUTPUT);
  hdStartScheduler();
  if (const HDerror fault = take_fault(); fault != HD_SUCCESS) return explain(fault);
  if (std::string problem = calibrate(touch); !problem.empty()) return problem;
  if (!(touch.limits.max_force > 0.0)) return "the device does not say how much force it renders";
  touch.last_sample = Clock::now();
  touch.servo = hdScheduleAsynchronous(serve, &touch, HD_MAX_SCHEDULER_PRIORITY);
  touch.is_serving = true;
  if (const HDerror fault = take_fault(); fault != HD_SUCCESS) return explain(fault);
  return "";
}

void* open_device(const char* argument, const char** reason) {
  static std::string problem;  // argil reads it before it calls again
  auto touch = std::make_unique<Touch>();
  touch->handle = hdInitDevice(argument[0] != '\0' ? argument : HD_DEFAULT_DEVICE);
  const HDerror fault = take_fault();
  if (touch->handle == HD_INVALID_HANDLE || fault != HD_SUCCESS) {
    problem = fault != HD_SUCCESS ? explain(fault) : "no device: check its cable, its power and its name";
    if (touch->handle != HD_INVALID_HANDLE) hdDisableDevice(touch->handle);
    *reason = problem.c_str();
    return nullptr;
  }
  problem = begin_serving(*touch);
  if (problem.empty()) return touch.release();
  *reason = problem.c_str();
  close_device(touch.release());
  return nullptr;
}

void describe(void* handle, argil_plugin_info* info) {
  const Touch& touch = *static_cast<Touch*>(handle);
  std::strncpy(info->name, touch.name.c_str(), sizeof info->name - 1);
  info->max_force = touch.limits.max_force;
  info->max_stiffness = touch.limits.max_stiffness / kMillimetre;
  for (int i = 0; i < 3; ++i)
    info->workspace[i] = (touch.limits.workspace[i + 3] - touch.limits.workspace[i]) * kMillimetre;
  info->rate_hz = 1000.0;  // the scheduler's, which this plug-in leaves as it is
  info->has_force = 1;
}

argil_plugin_sample make_sample(const PenState& pen) {
  argil_plugin_sample sample{};
  const Eigen::Map<const Eigen::Matrix4d> transform(pen.transform);  // Eigen's order is OpenHaptics', too
  Eigen::Map<Vec3>(sample.position) = transform.topRightCorner<3, 1>() * kMillimetre;
  const Eigen::Matrix3d rotation = transform.topLeftCorner<3, 3>();
  Eigen::Map<Eigen::Vector4d>(sample.orientation) = Eigen::Quaterniond(rotation).normalized().coeffs();
  const HDint buttons[] = {HD_DEVICE_BUTTON_1, HD_DEVICE_BUTTON_2, HD_DEVICE_BUTTON_3, HD_DEVICE_BUTTON_4};
  for (unsigned i = 0; i < 4; ++i)
    if ((pen.buttons & buttons[i]) != 0) sample.buttons |= 1U << i;
  return sample;
}

int32_t lose(Touch& touch, const std::string& why, const char** reason) {
  touch.reason = why;
  *reason = touch.reason.c_str();
  return ARGIL_PLUGIN_LOST;
}

int32_t read_sample(void* handle, argil_plugin_sample* sample, const char** reason) {
  Touch& touch = *static_cast<Touch*>(handle);
  timespec until{};
  clock_gettime(CLOCK_MONOTONIC, &until);
  until.tv_nsec += kReadPatience;
  constexpr long kSecond = 1'000'000'000;  // [ns]
  if (until.tv_nsec >= kSecond) until = {until.tv_sec + 1, until.tv_nsec - kSecond};
  sem_clockwait(&touch.has_news, CLOCK_MONOTONIC, &until);
  if (const HDerror fault = touch.fault; fault != HD_SUCCESS) return lose(touch, explain(fault), reason);
  PenState pen;
  if (touch.pens.take(pen)) {
    touch.last_sample = Clock::now();
    *sample = make_sample(pen);
    return ARGIL_PLUGIN_SAMPLE;
  }
  if (Clock::now() - touch.last_sample > kServoPatience)
    return lose(touch, "OpenHaptics' servo loop has stopped: start the vendor's service anew", reason);
  return ARGIL_PLUGIN_NONE;
}

void write_force(void* handle, const double force[3], const double /*torque*/[3]) {
  Touch& touch = *static_cast<Touch*>(handle);
  Order order;
  order.releases = touch.releases;
  order.time = Clock::now();
  const Vec3 wanted = Eigen::Map<const Vec3>(force);
  const double most = touch.limits.max_force;
  if (wanted.allFinite())
    order.force = wanted.norm() > most ? Vec3(wanted.stableNormalized() * most) : wanted;
  touch.orders.put(order);
}

}  // namespace

extern "C" const argil_plugin* argil_plugin_entry() {
  static constexpr argil_plugin plugin = {ARGIL_PLUGIN_VERSION, open_device, describe,    read_sample,
                                          write_force,          release,     close_device};
  return &plugin;
}
