#include "scenario/motion_table.h"

namespace argil::scenario {

namespace {

void bind_angles(Binder& b, device::TraceOptions& options) {
  using device::AngleOrder;
  using device::AngleUnit;
  b.choice<AngleOrder>(
      "/trace/angle_order", options.angle_order,
      {{AngleOrder::none, "none"},
       {AngleOrder::xyz, "xyz"},
       {AngleOrder::xzy, "xzy"},
       {AngleOrder::yxz, "yxz"},
       {AngleOrder::yzx, "yzx"},
       {AngleOrder::zxy, "zxy"},
       {AngleOrder::zyx, "zyx"},
       {AngleOrder::XYZ, "XYZ"},
       {AngleOrder::XZY, "XZY"},
       {AngleOrder::YXZ, "YXZ"},
       {AngleOrder::YZX, "YZX"},
       {AngleOrder::ZXY, "ZXY"},
       {AngleOrder::ZYX, "ZYX"},
       {AngleOrder::vector, "vector"}},
      "CSV: how the columns rx ry rz (roll pitch yaw) turn the tool: about fixed axes, xyz with x "
      "first; about the axes as they turn, XYZ; vector: axis times angle; none: they are not read.");
  b.choice<AngleUnit>("/trace/angle_unit", options.angle_unit,
                      {{AngleUnit::automatic, "auto"}, {AngleUnit::rad, "rad"}, {AngleUnit::deg, "deg"}},
                      "Unit of those angles; auto: as the columns' names say.");
}

}  // namespace

void bind_trace(Binder& b, TraceSpec& t, const std::string& folder) {
  using device::ButtonMode;
  using device::LengthUnit;
  using device::QuaternionOrder;
  using device::TimeUnit;
  b.path("/trace/file", t.file, folder,
         "Recorded motion (CSV, NPY or HDF5); a device and a hand of a program's own need none.")
      .required = true;
  b.choice<device::ToolMode>("/trace/default_mode", t.options.default_mode,
                             {{device::ToolMode::push, "push"},
                              {device::ToolMode::pull, "pull"},
                              {device::ToolMode::wet, "wet"},
                              {device::ToolMode::dry, "dry"}},
                             "Mode when the file has no column for it.");
  b.number("/trace/default_rate_hz", t.options.default_rate_hz, not_negative(), "Hz",
           "Rate when the file has no time; 0: it must.");
  b.strings("/trace/columns", t.options.columns,
            "CSV, NPY: names of the columns from the left, in place of a header row.");
  b.choice<TimeUnit>("/trace/time_unit", t.options.time_unit,
                     {{TimeUnit::automatic, "auto"},
                      {TimeUnit::s, "s"},
                      {TimeUnit::ms, "ms"},
                      {TimeUnit::us, "us"},
                      {TimeUnit::ns, "ns"}},
                     "Unit of the file's times; auto: as the file says, else s.");
  b.choice<LengthUnit>("/trace/length_unit", t.options.length_unit,
                       {{LengthUnit::automatic, "auto"},
                        {LengthUnit::m, "m"},
                        {LengthUnit::cm, "cm"},
                        {LengthUnit::mm, "mm"},
                        {LengthUnit::um, "um"}},
                       "Unit of the file's places; auto: as the file says, else m.");
  b.number("/trace/max_gap_s", t.options.max_gap, not_negative(), "s",
           "Pauses between samples up to this, or up to ten median intervals, are bridged by a straight "
           "line; longer "
           "ones are refused.");
  b.choice<QuaternionOrder>(
      "/trace/quaternion_order", t.options.quaternion_order,
      {{QuaternionOrder::by_name, "by_name"},
       {QuaternionOrder::wxyz, "wxyz"},
       {QuaternionOrder::xyzw, "xyzw"}},
      "CSV: what the quaternion's columns hold where they are only numbered (q0 to q3).");
  bind_angles(b, t.options);
  b.text("/trace/button/column", t.options.button_column, "CSV: column of a button; empty: none is read.");
  b.choice<ButtonMode>(
      "/trace/button/mode", t.options.button_mode,
      {{ButtonMode::none, "none"},
       {ButtonMode::push, "push"},
       {ButtonMode::pull, "pull"},
       {ButtonMode::wet, "wet"},
       {ButtonMode::dry, "dry"}},
      "What the tool does while the button is pressed (not 0, or true). Needed with a button.");
  b.number("/trace/start_s", t.start, not_negative(), "s", "Where in the trace the run starts.");
  b.number("/trace/duration_s", t.duration, not_negative(), "s", "How long it runs; 0: to the trace's end.");
  device::DeviceToWorld& to_world = t.options.device_to_world;
  b.number("/trace/device_to_world/scale", to_world.scale, positive(), "", "World metres per device metre.");
  b.quaternion("/trace/device_to_world/rotation_xyzw", to_world.rotation,
               "Unit quaternion, device to world.");
  b.vector("/trace/device_to_world/translation_m", to_world.translation, "m",
           "World position of the device's origin.");
  b.quaternion(
      "/trace/device_to_world/tool_rotation_xyzw", to_world.tool_rotation,
      "Unit quaternion, the scene's tool to the device's: for a device whose tip looks along another axis. "
      "Orientations are rotation · device's · this.");
}

void bind_hand(Binder& b, HandSpec& hand) {
  b.choice<HandKind>(
      "/hand/kind", hand.kind, {{HandKind::prescribed, "prescribed"}, {HandKind::simulated, "simulated"}},
      "The tool is where the trace is; or the trace is what a hand means to do, a mass on a spring that "
      "yields to the force.");
  const auto simulated = [&hand] { return hand.kind == HandKind::simulated; };
  device::HandParams& h = hand.params;
  b.number("/hand/mass_kg", h.mass, positive(), "kg", "Finger and stylus.").applies = simulated;
  b.number("/hand/damping_N_s_per_m", h.damping, not_negative(), "N s/m", "Of the hand's spring.").applies =
      simulated;
  b.number("/hand/stiffness_N_per_m", h.stiffness, positive(), "N/m",
           "Of the spring between the trace and the hand.")
      .applies = simulated;
  b.number("/hand/reaction_delay_s", h.reaction_delay, not_negative(), "s",
           "The trace reaches the muscles so much later.")
      .applies = simulated;
  b.number("/hand/tremor_m", h.tremor, not_negative(), "m",
           "Root mean square of the intended point's tremor, each axis.")
      .applies = simulated;
  b.number("/hand/tremor_frequency_Hz", h.tremor_frequency, positive(), "Hz",
           "Where the tremor is strongest.")
      .applies = simulated;
  b.integer("/hand/seed", h.seed, between(0, 2147483647), "Of the tremor.").applies = simulated;
}

}  // namespace argil::scenario
