// A library that does what OpenHaptics' documentation says of the functions in openhaptics/HD/hd.h, without a
// device. Its pen presses the ball of tests/unit/live, in the device's axes (y up, mm), once a second from
// one second on. The environment says what goes wrong and where it is written down:
//
//   ARGIL_STAND_IN_LOG   file of the size of ServoLog, openhaptics_stand_in.h
//   ARGIL_STAND_IN       words with a blank between them: "absent"; "uncalibrated" (the pen is in no
//   inkwell),
//                        "outdated" (its calibration is to be updated); "fault=CODE@SECONDS";
//                        "stalls@SECONDS"; "buttons" (each pressed for 0.2 s, one after the other);
//                        "limitless"
#include "support/openhaptics_stand_in.h"

#include <HD/hd.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <list>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using argil::test::ServoLog;

constexpr HHD kHandle = 7;
constexpr double kStill = 1.0;  // [s] at first, while a session makes its scene

struct Task {
  HDSchedulerHandle number;
  HDSchedulerCallback call;
  void* data;
  bool* is_done;  // of a synchronous one
};

struct StandIn {
  ServoLog* log = nullptr;
  std::string script;
  bool is_open = false, is_calibrated = true, is_outdated = false;
  bool is_in_frame = false, is_running = false;
  double force[3] = {};  // set in this frame
  std::vector<HDerror> errors;
  std::list<Task> tasks;
  HDSchedulerHandle last_task = 0;
  Clock::time_point start;
  std::thread servo;
  std::mutex mutex;  // of all above
  std::condition_variable done;
  std::atomic<bool> is_ending = false;
};

StandIn& here() {
  static StandIn stand_in;
  return stand_in;
}

thread_local bool t_is_servo = false;

double now(const StandIn& s) {
  return std::chrono::duration<double>(Clock::now() - s.start).count();
}

void misuse(StandIn& s) {
  if (s.log != nullptr) s.log->num_misuses = s.log->num_misuses + 1;
  s.errors.push_back(HD_INVALID_OPERATION);
}

/// What stands behind `word` in the script, in seconds; infinite where it does not stand there.
double find_time(const StandIn& s, const std::string& word) {
  const std::size_t place = s.script.find(word);
  if (place == std::string::npos) return INFINITY;
  return std::strtod(s.script.c_str() + s.script.find('@', place) + 1, nullptr);
}

bool has_fault(const StandIn& s) {
  return now(s) >= find_time(s, "fault=");
}

/// The library notes the error that the script has for this place, as start_error=770.
void fail_where_asked(StandIn& s, const std::string& place) {
  const std::size_t at = s.script.find(place + "_error=");
  if (at == std::string::npos) return;
  const char* const code = s.script.c_str() + at + place.size() + std::strlen("_error=");
  s.errors.push_back(static_cast<HDerror>(std::strtoul(code, nullptr, 10)));
}

/// From 2 mm over the ball 2.5 mm into it and out again.
double find_height(double t) {
  const double share = t < kStill ? 0.0 : 0.5 - 0.5 * std::cos(2.0 * 3.14159265358979323846 * (t - kStill));
  return 48.0 - 4.5 * share;
}

HDint find_buttons(const StandIn& s, double t) {
  if (s.script.find("buttons") == std::string::npos) return 0;
  if (t > 2.0 && t < 2.2) return HD_DEVICE_BUTTON_1;
  if (t > 2.4 && t < 2.6) return HD_DEVICE_BUTTON_2;
  return 0;
}

void map_log(StandIn& s) {
  const char* const name = std::getenv("ARGIL_STAND_IN_LOG");
  const int file = name != nullptr ? open(name, O_RDWR) : -1;
  if (file < 0) return;
  void* const memory = mmap(nullptr, sizeof(ServoLog), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  if (memory != MAP_FAILED) s.log = static_cast<ServoLog*>(memory);
}

void write_row(StandIn& s) {
  if (s.log == nullptr || s.log->num_rows >= argil::test::kMostServoRows) return;
  const double t = now(s);
  auto& row = s.log->rows[s.log->num_rows];
  row.time = t;
  row.pen_height = find_height(t);
  for (int i = 0; i < 3; ++i) row.force[i] = s.force[i];
  row.buttons = find_buttons(s, t);
  row.fault = has_fault(s) ? 1 : 0;
  s.log->num_rows = s.log->num_rows + 1;
}

void run_tasks(StandIn& s) {
  for (auto task = s.tasks.begin(); task != s.tasks.end();) {
    const bool goes_on = task->call(task->data) == HD_CALLBACK_CONTINUE;
    if (goes_on) {
      ++task;
      continue;
    }
    if (task->is_done != nullptr) *task->is_done = true;
    task = s.tasks.erase(task);
    s.done.notify_all();
  }
}

/// Callbacks run under the lock, which they take again through the functions that they call: so those look
/// whether they are in this thread.
void serve(StandIn& s) {
  t_is_servo = true;
  for (auto next = Clock::now(); !s.is_ending;) {
    next += std::chrono::milliseconds(1);
    std::this_thread::sleep_until(next);
    const std::lock_guard<std::mutex> lock(s.mutex);
    if (now(s) < find_time(s, "stalls")) run_tasks(s);
  }
}

struct Lock {
  explicit Lock(StandIn& s) : lock(s.mutex, std::defer_lock) {
    if (!t_is_servo) lock.lock();
  }
  std::unique_lock<std::mutex> lock;
};

HDSchedulerHandle schedule(StandIn& s, HDSchedulerCallback call, void* data, bool* is_done) {
  s.tasks.push_back({++s.last_task, call, data, is_done});
  return s.last_task;
}

}  // namespace

HHD hdInitDevice(HDstring name) {
  StandIn& s = here();
  const Lock lock(s);
  const char* const script = std::getenv("ARGIL_STAND_IN");
  s.script = script != nullptr ? script : "";
  s.errors.clear();
  map_log(s);
  const bool is_known = name == nullptr || std::strcmp(name, "Default Device") == 0;
  if (s.script.find("absent") != std::string::npos || !is_known) {
    s.errors.push_back(HD_COMM_ERROR);
    return HD_INVALID_HANDLE;
  }
  if (s.is_open) misuse(s);
  s.is_open = true;
  s.is_calibrated = s.script.find("uncalibrated") == std::string::npos;
  s.is_outdated = s.script.find("outdated") != std::string::npos;
  if (s.log != nullptr) s.log->is_disabled = 0;
  fail_where_asked(s, "open");
  return kHandle;
}

void hdDisableDevice(HHD handle) {
  StandIn& s = here();
  const Lock lock(s);
  if (!s.is_open || handle != kHandle || s.is_running || !s.tasks.empty()) misuse(s);
  s.is_open = false;
  if (s.log != nullptr) s.log->is_disabled = 1;
}

void hdMakeCurrentDevice(HHD handle) {
  StandIn& s = here();
  const Lock lock(s);
  if (handle != kHandle) s.errors.push_back(HD_BAD_HANDLE);
}

void hdBeginFrame(HHD handle) {
  StandIn& s = here();
  const Lock lock(s);
  if (!t_is_servo || s.is_in_frame || handle != kHandle) misuse(s);
  s.is_in_frame = true;
  for (double& component : s.force) component = 0.0;
}

void hdEndFrame(HHD) {
  StandIn& s = here();
  const Lock lock(s);
  if (!t_is_servo || !s.is_in_frame) misuse(s);
  s.is_in_frame = false;
  if (has_fault(s)) {
    const std::size_t place = s.script.find("fault=") + std::strlen("fault=");
    s.errors.push_back(static_cast<HDerror>(std::strtoul(s.script.c_str() + place, nullptr, 10)));
    s.errors.push_back(HD_FORCE_ERROR);  // what follows from it
  }
  write_row(s);
}

void hdEnable(HDenum) {
  StandIn& s = here();
  const Lock lock(s);
  if (s.log != nullptr) s.log->is_enabled = 1;
}

void hdGetDoublev(HDenum name, HDdouble* values) {
  StandIn& s = here();
  const Lock lock(s);
  if (name == HD_NOMINAL_MAX_FORCE) {
    *values = s.script.find("limitless") != std::string::npos ? 0.0 : 3.3;
  } else if (name == HD_NOMINAL_MAX_STIFFNESS) {
    *values = 1.0;
  } else if (name == HD_USABLE_WORKSPACE_DIMENSIONS) {
    const HDdouble box[6] = {-80.0, -60.0, -35.0, 80.0, 60.0, 35.0};
    std::memcpy(values, box, sizeof box);
  } else if (name == HD_CURRENT_TRANSFORM && s.is_in_frame) {
    // Turned by 30° about y; column after column.
    const double c = std::sqrt(3.0) / 2.0;
    const HDdouble turned[16] = {c, 0, -0.5, 0, 0, 1, 0, 0, 0.5, 0, c, 0, 1.0, find_height(now(s)), -0.7, 1};
    std::memcpy(values, turned, sizeof turned);
  } else {
    misuse(s);
  }
}

void hdGetIntegerv(HDenum name, HDint* values) {
  StandIn& s = here();
  const Lock lock(s);
  if (name == HD_CALIBRATION_STYLE) {
    *values = HD_CALIBRATION_INKWELL;
  } else if (name == HD_CURRENT_BUTTONS && s.is_in_frame) {
    *values = find_buttons(s, now(s));
  } else {
    misuse(s);
  }
}

void hdSetDoublev(HDenum name, const HDdouble* values) {
  StandIn& s = here();
  const Lock lock(s);
  if (name != HD_CURRENT_FORCE || !s.is_in_frame) return misuse(s);
  std::memcpy(s.force, values, sizeof s.force);
  const double norm = std::hypot(values[0], values[1], values[2]);
  if (!(norm <= 3.3 * (1.0 + 1e-12))) s.errors.push_back(HD_EXCEEDED_MAX_FORCE);
}

HDstring hdGetString(HDenum) {
  return "Stand-in for a Touch";
}

HDErrorInfo hdGetError() {
  StandIn& s = here();
  const Lock lock(s);
  HDErrorInfo info{HD_SUCCESS, 0, kHandle};
  if (s.errors.empty()) return info;
  info.errorCode = s.errors.back();  // the newest first
  s.errors.pop_back();
  return info;
}

HDstring hdGetErrorString(HDerror) {
  return "an error of the stand-in";
}

HDenum hdCheckCalibration() {
  StandIn& s = here();
  const Lock lock(s);
  if (!s.is_in_frame) misuse(s);
  fail_where_asked(s, "look");
  if (!s.is_calibrated && now(s) < find_time(s, "put_in@")) return HD_CALIBRATION_NEEDS_MANUAL_INPUT;
  return s.is_outdated ? HD_CALIBRATION_NEEDS_UPDATE : HD_CALIBRATION_OK;
}

void hdUpdateCalibration(HDenum style) {
  StandIn& s = here();
  const Lock lock(s);
  if (style != HD_CALIBRATION_INKWELL || !s.is_outdated) misuse(s);
  s.is_outdated = false;
  if (s.log != nullptr) s.log->num_updates = s.log->num_updates + 1;
}

void hdStartScheduler() {
  StandIn& s = here();
  const Lock lock(s);
  if (s.is_running) return misuse(s);
  s.is_running = true;
  s.is_ending = false;
  s.start = Clock::now();
  if (s.log != nullptr) s.log->is_stopped = 0;
  fail_where_asked(s, "start");
  s.servo = std::thread([&s] { serve(s); });
}

void hdStopScheduler() {
  StandIn& s = here();
  s.is_ending = true;
  if (s.servo.joinable()) s.servo.join();
  s.is_running = false;
  if (s.log != nullptr) s.log->is_stopped = 1;
}

HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback call, void* data, HDushort) {
  StandIn& s = here();
  const Lock lock(s);
  fail_where_asked(s, "schedule");
  return schedule(s, call, data, nullptr);
}

void hdScheduleSynchronous(HDSchedulerCallback call, void* data, HDushort) {
  StandIn& s = here();
  Lock lock(s);
  if (!s.is_running || t_is_servo) return misuse(s);
  bool is_done = false;
  schedule(s, call, data, &is_done);
  s.done.wait(lock.lock, [&] { return is_done; });
}

void hdUnschedule(HDSchedulerHandle number) {
  StandIn& s = here();
  const Lock lock(s);
  const std::size_t before = s.tasks.size();
  s.tasks.remove_if([&](const Task& task) { return task.number == number; });
  if (s.tasks.size() == before) misuse(s);
}
