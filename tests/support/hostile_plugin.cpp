// A device in a shared library (src/device/plugin_api.h) that goes wrong as ARGUMENT says, MODE:FILE. What it
// renders is in FILE, hostile_plugin.h: also after its process has died.
#include "support/hostile_plugin.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <ctime>
#include <string>

#include "device/plugin_api.h"

namespace {

using argil::test::RenderedForce;

constexpr int kGoodSamples = 300;
constexpr double kStill = 1.0;  // [s] at first, while a session makes its scene

struct Device {
  std::string mode;
  RenderedForce* rendered = nullptr;
  double opened_at = 0.0;
  int samples = 0;  // since it began to move
  bool is(const char* wanted) const { return samples > kGoodSamples && mode == wanted; }
};

double now() {
  timespec time = {};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void wait_for_ever() {
  for (;;) pause();
}

double norm(const double v[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

int overflow_stack(int depth) {
  volatile char frame[4096];
  frame[depth % 4096] = 1;
  return depth < 0 ? 0 : overflow_stack(depth + 1) + frame[0];
}

void* open_device(const char* argument, const char** reason) {
  const std::string text = argument;
  const std::size_t colon = text.find(':');
  const int file = open(text.c_str() + colon + 1, O_RDWR);
  void* const memory = mmap(nullptr, sizeof(RenderedForce), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  *reason = "no file to write to";
  if (memory == MAP_FAILED) return nullptr;
  auto* const device = new Device{text.substr(0, colon), static_cast<RenderedForce*>(memory), now()};
  if (device->mode == "open_blocks") wait_for_ever();
  return device;
}

void describe(void* handle, argil_plugin_info* info) {
  std::strcpy(info->name, "hostile");
  info->has_force = 1;
  const std::string& mode = static_cast<Device*>(handle)->mode;
  if (mode == "weak") {
    info->max_force = 0.02;
    info->max_torque = 1e-6;
    info->max_stiffness = 100.0;
  }
  if (mode == "nan_limit") info->max_force = NAN;
}

/// Goes down on the ball of tests/unit/live, when that is made, and stays in it.
std::int32_t read_sample(void* handle, argil_plugin_sample* sample, const char**) {
  Device& device = *static_cast<Device*>(handle);
  if (now() - device.opened_at > kStill) ++device.samples;
  sample->position[0] = 0.001;
  sample->position[1] = 0.0007;
  sample->position[2] = 0.048 - std::fmin(0.0045, 3e-5 * device.samples);
  sample->orientation[3] = 1.0;
  device.rendered->is_wrong = device.samples > kGoodSamples ? 1 : 0;
  if (device.is("blocks") || (device.is("slow_write") && device.rendered->releases > 0)) wait_for_ever();
  if (device.is("throws")) throw 42;
  if (device.is("unknown")) return 7;
  if (device.is("overflows")) return overflow_stack(0);
  return ARGIL_PLUGIN_SAMPLE;
}

void write_force(void* handle, const double force[3], const double torque[3]) {
  Device& device = *static_cast<Device*>(handle);
  RenderedForce& rendered = *device.rendered;
  if (device.is("write_throws")) throw 42;
  if (device.is("write_blocks")) wait_for_ever();
  rendered.is_writing = 1;
  if (device.is("slow_write")) usleep(5000);
  for (int i = 0; i < 3; ++i) {
    rendered.force[i] = force[i];
    rendered.torque[i] = torque[i];
  }
  rendered.largest_force = std::fmax(rendered.largest_force, norm(force));
  rendered.largest_torque = std::fmax(rendered.largest_torque, norm(torque));
  rendered.is_writing = 0;
}

void release(void* handle) {
  RenderedForce& rendered = *static_cast<Device*>(handle)->rendered;
  for (int i = 0; i < 3; ++i) {
    rendered.force[i] = 0.0;
    rendered.torque[i] = 0.0;
  }
  rendered.releases = rendered.releases + 1;
}

void close_device(void* handle) {
  auto* const device = static_cast<Device*>(handle);
  munmap(device->rendered, sizeof(RenderedForce));
  delete device;
}

constexpr argil_plugin kPlugin = {ARGIL_PLUGIN_VERSION, open_device, describe,    read_sample,
                                  write_force,          release,     close_device};

}  // namespace

extern "C" const argil_plugin* argil_plugin_entry() {
  return &kPlugin;
}
