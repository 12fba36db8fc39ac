#pragma once

/* What a shared library offers to be a haptic device of argil: --device plugin:FILE[,ARGUMENT]. Plain C.
 *
 * argil calls argil_plugin_entry once, then open, and from then on one thread calls read and write in turn
 * until it calls close; release alone comes from other threads too. That thread may run before all ordinary
 * ones (SCHED_FIFO); those that the library starts are ordinary. Lengths in m, forces in N, torques in N m,
 * quaternions x y z w, all in the device's own right-handed axes; argil turns them into the world's and
 * limits the force before. No function may throw, none may be null. */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ARGIL_PLUGIN_VERSION 1u

/* What the device declares; 0 where it declares nothing, and never less. No more force or torque is written.
 */
struct argil_plugin_info {
  char name[64];
  double max_force;     /* [N] */
  double max_torque;    /* [N m] */
  double max_stiffness; /* that it renders stably [N/m] */
  double workspace[3];  /* edges of the box that its point reaches [m] */
  double rate_hz;       /* samples a second */
  int32_t has_force;    /* 0: it renders none, and write is not called */
};

struct argil_plugin_sample {
  double position[3];    /* [m] */
  double orientation[4]; /* x y z w, unit length; 0 0 0 1 where the device has none */
  uint32_t buttons;      /* bit i: button i is down */
};

enum argil_plugin_result {
  ARGIL_PLUGIN_LOST = -1, /* gone for good; *reason says why */
  ARGIL_PLUGIN_NONE = 0,  /* no new sample yet; say so rather than give the last one again */
  ARGIL_PLUGIN_SAMPLE = 1
};

struct argil_plugin {
  uint32_t version; /* ARGIL_PLUGIN_VERSION */
  /* The device that `argument` names ("" when none was given), or null and a reason. */
  void* (*open)(const char* argument, const char** reason);
  void (*describe)(void* device, struct argil_plugin_info* info);
  /* May wait for the next sample, 10 ms at most: after 0.1 s argil releases the device, after 2 s it is lost.
   * An argil_plugin_result; any other loses the device. */
  int32_t (*read)(void* device, struct argil_plugin_sample* sample, const char** reason);
  /* From now on the hand feels this, also after a release. */
  void (*write)(void* device, const double force[3], const double torque[3]);
  /* Zero force at once, until the next write. Called at any time between open and close by any thread, also
   * while another is in read or write, and by a signal handler: it takes no lock. It may wait for 5 ms until a
   * thread of the library has told the device, because the process may end right after it. */
  void (*release)(void* device);
  void (*close)(void* device);
};

/* The only name that argil looks up. What it points to stays as it is. */
const struct argil_plugin* argil_plugin_entry(void);

#ifdef __cplusplus
}
#endif
