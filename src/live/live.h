#pragma once

#include <string>

#include "run/run.h"

namespace argil::live {

/// How `argil live` was called. Of `run` all but trace, resume and dry_run counts.
struct LiveOptions {
  run::RunOptions run;
  std::string device;     ///< as device::make_device takes it
  double duration = 0.0;  ///< [s]; 0: a simulated hand's trace to its end, any other device until a signal
  std::string watch;      ///< file that grows while others read it; empty: none
};

/// Runs a scenario with a device in the place of its trace and writes its result, which is also the session:
/// `argil run SCENARIO --trace RESULT` makes the same bits of it. Returns kDone, kRunFailed, kIoFailed (the
/// device was lost, or the disk too slow) or kInterrupted; the file is complete up to the last tick in each
/// case. Throws InputError before anything is written, IoError.
int run_live(const LiveOptions& options);

}  // namespace argil::live
