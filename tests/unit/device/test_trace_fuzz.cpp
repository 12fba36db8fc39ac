// Whatever is done to a trace's text, reading it ends in a checked motion or in an InputError, never in
// anything else.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/rng.h"
#include "device/trace.h"
#include "support/temp_folder.h"

namespace argil::device {
namespace {

const char* const kTrace =
    "# argil-trace: 1\n# device: hand\n# units: m\n# device_to_world_scale: 2\n# "
    "device_to_world_translation_m: 0 1 2\n"
    "t,x,y,z,qx,qy,qz,qw,mode\n0,0.5,1e-3,-2,0,0,0,1,push\n0.001,0.6,2e-3,-2,0,0,1,0,pull\n"
    "0.002,0.7,3e-3,-2,0,\"1\",0,0,2\n0.003,0.8,4e-3,-2,1,0,0,0,dry\n";

std::string mutate(std::string text, Rng& rng) {
  const std::string_view pieces[] = {"nan", "inf", "-",        ",",   "\n",   "\"",   "1e999",         "#",
                                     ":",   "\r",  "",         "0",   "e",    "\xff", "# sha256: x\n", ";",
                                     "\t",  " ",   "12:00:00", "_ms", "[mm]", "%"};
  const std::uint64_t changes = 1 + rng.next_bits() % 4;
  for (std::uint64_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = rng.next_bits() % text.size();
    const std::size_t length = rng.next_bits() % 12;
    switch (rng.next_bits() % 4) {
      case 0:
        text[at] = static_cast<char>(rng.next_bits());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, pieces[rng.next_bits() % std::size(pieces)]);
        break;
      default:
        text.insert(at, text.substr(rng.next_bits() % text.size(), length));
        break;
    }
  }
  return text;
}

TEST(ReadTraceFuzz, EndsInACheckedMotionOrAnInputError) {
  const test::TempFolder folder;
  Rng rng(2024, "trace fuzz");
  int accepted = 0;
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    const std::string text = mutate(kTrace, rng);
    try {
      const Trace trace = read_trace(folder.write("t.csv", text), {});
      ++accepted;
      ASSERT_GE(trace.samples.size(), 2U);
      ASSERT_EQ(trace.samples.size(), trace.time.size());
      for (std::size_t k = 0; k < trace.time.size(); ++k) {
        ASSERT_TRUE(k == 0 || trace.time[k] > trace.time[k - 1]) << text;
        ASSERT_TRUE(trace.samples[k].position.allFinite()) << text;
        ASSERT_NEAR(trace.samples[k].orientation.norm(), 1.0, 1e-14) << text;
        ASSERT_LT(static_cast<int>(trace.samples[k].mode), kNumToolModes);
      }
    } catch (const InputError& error) {
      ++refused;
      ASSERT_NE(std::string(error.what()).find("t.csv"), std::string::npos);
    }
  }
  EXPECT_GT(accepted, 200);  // both ends are reached
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace argil::device
