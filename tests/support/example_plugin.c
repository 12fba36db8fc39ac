/* An example of a device in a shared library (src/device/plugin_api.h): a point on a spring of 200 N/m that
 * rests at (0.01, 0.02, 0.03) m and yields to the force at once. ARGUMENT: "" for a well-behaved one; "none"
 * is not there; "vanishing" goes away after 50 samples; "nan" says nonsense after 50. WRONG_VERSION and
 * INCOMPLETE make plug-ins that argil refuses. */
#include "device/plugin_api.h"

#include <math.h>
#include <string.h>

struct device {
  const char* argument;
  int samples;
  double force[3];
};

static struct device s_device;

static void* open_device(const char* argument, const char** reason) {
  if (strcmp(argument, "none") == 0) {
    *reason = "no device is plugged in";
    return 0;
  }
  memset(&s_device, 0, sizeof s_device);
  s_device.argument = argument;
  return &s_device;
}

static void describe(void* handle, struct argil_plugin_info* info) {
  (void)handle;
  strcpy(info->name, "spring of 200 N/m");
  info->max_force = 5.0;
  info->max_stiffness = 2000.0;
  info->workspace[0] = info->workspace[1] = info->workspace[2] = 0.1;
  info->rate_hz = 1000.0;
  info->has_force = 1;
}

static int32_t read_sample(void* handle, struct argil_plugin_sample* sample, const char** reason) {
  struct device* device = handle;
  int i;
  ++device->samples;
  if (device->samples > 50 && strcmp(device->argument, "vanishing") == 0) {
    *reason = "the cable was pulled";
    return ARGIL_PLUGIN_LOST;
  }
  for (i = 0; i < 3; ++i) {
    sample->position[i] = 0.01 * (i + 1) + device->force[i] / 200.0;
    sample->orientation[i] = 0.0;
  }
  sample->orientation[3] = 1.0;
  if (device->samples > 50 && strcmp(device->argument, "nan") == 0) sample->position[1] = NAN;
  sample->buttons = device->samples > 20 ? 1u : 0u;
  return ARGIL_PLUGIN_SAMPLE;
}

static void write_force(void* handle, const double force[3], const double torque[3]) {
  struct device* device = handle;
  (void)torque;
  memcpy(device->force, force, sizeof device->force);
}

static void release(void* handle) {
  memset(((struct device*)handle)->force, 0, 3 * sizeof(double));
}

static void close_device(void* handle) {
  (void)handle;
}

const struct argil_plugin* argil_plugin_entry(void) {
  static struct argil_plugin plugin = {
#ifdef WRONG_VERSION
      ARGIL_PLUGIN_VERSION + 1,
#else
      ARGIL_PLUGIN_VERSION,
#endif
      open_device,
      describe,
      read_sample,
      write_force,
      release,
      close_device};
#ifdef INCOMPLETE
  plugin.write = 0;
#endif
  return &plugin;
}
