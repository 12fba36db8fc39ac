#pragma once

namespace argil::study {

/// From here on SIGINT and SIGTERM are noted and no longer end the program, and a file-size limit is an error
/// of the write, like a full disk.
void watch_signals();

/// One of them came since.
bool is_interrupted();

}  // namespace argil::study
