#pragma once

// What is asked of a motion's times and places as a whole, and what a user should know of them.

#include <string>
#include <vector>

#include "device/trace_raw.h"

namespace argil::device::internal {

/// "line 12", or "row 12" of arrays.
std::string print_place(const RawTrace& raw, std::size_t sample);
/// With nine digits.
std::string print_number(double value);

/// Throws InputError for times that do not increase, pauses longer than options.max_gap and ten median
/// intervals, a stated rate that is not the samples', and a rate out of all reason in a unit that nobody
/// gave. Shorter pauses go to the notes.
void check_times(const std::string& file, const TraceOptions& options, RawTrace& raw);

/// Throws InputError where a hand would be faster or go farther than hands do, or be farther from the
/// device's origin, and nobody gave the unit of places or a scale. Places somewhat far away go to the notes.
void check_path(const std::string& file, const RawTrace& raw, Trace& trace);

/// Says it where samples are a second or more apart and the motion is slower than any hand's: the unit that
/// the file says may be a slip.
void note_slow_motion(Trace& trace);

/// Says it where a motion goes in steps: places in whole steps of a coarse sensor, or held for several
/// samples. `metres` per unit of the file's places in the world.
void note_steps(const RawTrace& raw, double metres, std::vector<std::string>& notes);

}  // namespace argil::device::internal
