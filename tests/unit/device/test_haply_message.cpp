// Messages of the Haply Inverse Service: fields as its documentation shows them, and bytes that are no
// message.
#include "device/haply_message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace argil::device::internal {
namespace {

// Made up after the documented form: a first message with two devices and a grip of each kind.
constexpr const char* kInventory = R"({
  "session_id": 7,
  "inverse3": [
    {"device_id": "049D", "config": {"type": "inverse3", "handedness": "right"},
     "state": {"cursor_position": {"x": 0.25, "y": -0.125, "z": 0.5}, "control_mode": "idle"}},
    {"device_id": "04BA", "config": {"type": "minverse"},
     "state": {"cursor_position": {"x": 1, "y": 2e-3, "z": -0.0}}}],
  "wireless_verse_grip": [
    {"device_id": "61548", "state": {"orientation": {"w": 0.5, "x": -0.5, "y": 0.5, "z": -0.5},
                                     "buttons": {"a": false, "b": true, "c": true}}}],
  "verse_grip": [{"device_id": "1", "state": {"orientation": {"w": 0, "x": 1, "y": 0, "z": 0}, "button": true}}]})";

std::string with_grip(const std::string& grip) {
  return R"({"inverse3": [{"device_id": "A", "state": {"cursor_position": {"x": 0, "y": 0, "z": 0}}}], )" +
         grip + "}";
}

TEST(HaplyMessage, NamesTheFirstDeviceAndItsState) {
  const HaplyMessage message = read_haply_message(kInventory, "");
  EXPECT_EQ(message.problem, "");
  EXPECT_EQ(message.device_id, "049D");
  EXPECT_EQ(message.kind, "inverse3");
  EXPECT_EQ(message.position, Vec3(0.25, -0.125, 0.5));
  EXPECT_EQ(message.orientation.coeffs(), Vec4(-0.5, 0.5, -0.5, 0.5));
  EXPECT_EQ(message.buttons, 6U);
}

TEST(HaplyMessage, FindsTheDeviceThatIsWanted) {
  const HaplyMessage message = read_haply_message(kInventory, "04BA");
  EXPECT_EQ(message.device_id, "04BA");
  EXPECT_EQ(message.kind, "minverse");
  EXPECT_EQ(message.position, Vec3(1.0, 0.002, 0.0));
  EXPECT_EQ(read_haply_message(kInventory, "0000").problem, "Inverse3 0000 is not connected any more");
}

TEST(HaplyMessage, ReadsAGripWithACable) {
  const HaplyMessage message =
      read_haply_message(with_grip(R"("verse_grip": [{"device_id": "1", "state": {"button": true, "hall": 0,
                 "orientation": {"x": 1, "y": 0, "z": 0, "w": 0}}}])"),
                         "");
  EXPECT_EQ(message.problem, "");
  EXPECT_EQ(message.orientation.coeffs(), Vec4(1, 0, 0, 0));
  EXPECT_EQ(message.buttons, 1U);
}

TEST(HaplyMessage, NeedsNoGrip) {
  const HaplyMessage message = read_haply_message(with_grip(R"("verse_grip": [])"), "");
  EXPECT_EQ(message.problem, "");
  EXPECT_EQ(message.orientation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(message.buttons, 0U);
}

TEST(HaplyMessage, SaysWhatIsWrong) {
  const auto problem = [](const std::string& text) { return read_haply_message(text, "").problem; };
  for (const char* text : {"", "}{", "[1, 2]", "7", "{\"a\": NaN}", "{\"a\": 1e999}", "\xff\xfe", "{\"a\": "})
    EXPECT_EQ(problem(text), "no JSON object") << text;
  EXPECT_EQ(problem(std::string(100000, '[')), "no JSON object");
  for (const char* text : {"{}", "{\"inverse3\": 3}", "{\"inverse3\": []}",
                           "{\"inverse3\": [{\"device_id\": 5}]}", "{\"inverse3\": [{\"device_id\": \"\"}]}"})
    EXPECT_EQ(problem(text), "no Inverse3 is connected to the service") << text;
  for (const char* position : {"null", "[0, 0, 0]", R"({"x": 0, "y": 0})", R"({"x": 0, "y": "0", "z": 0})",
                               R"({"x": 0, "y": null, "z": 0})"})
    EXPECT_EQ(problem(R"({"inverse3": [{"device_id": "A", "state": {"cursor_position": )" +
                      std::string(position) + "}}]}"),
              "state.cursor_position has not three numbers")
        << position;
  EXPECT_EQ(
      problem(with_grip(R"("verse_grip": [{"device_id": "1", "state": {"orientation": [0, 0, 0, 1]}}])")),
      "state.orientation of the grip has not four numbers");
}

TEST(HaplyMessage, CommandsAForceInNewtons) {
  EXPECT_EQ(print_haply_force("049D", Vec3(1.5, -0.25, 0.1)),
            R"({"inverse3":[{"commands":{"set_cursor_force":{"vector":{"x":1.5,"y":-0.25,"z":0.1}}},)"
            R"("device_id":"049D"}]})");
}

}  // namespace
}  // namespace argil::device::internal
