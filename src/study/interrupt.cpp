#include "study/interrupt.h"

#include <csignal>

namespace argil::study {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;  // the one thing a signal handler may touch

void on_signal(int) {
  g_interrupted = 1;
}

}  // namespace

void watch_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool is_interrupted() {
  return g_interrupted != 0;
}

}  // namespace argil::study
