// Zero force when the process crashes, is told to end, or exits. The device is one of this test that writes a
// byte when it is released.
#include "device/release_guard.h"

#include <gtest/gtest.h>
#include <signal.h>  // NOLINT: kill is POSIX
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <optional>

namespace argil::device {
namespace {

class Tattler final : public HapticDevice {
 public:
  explicit Tattler(int pipe) : m_pipe(pipe) {}
  void start() override {}
  void stop() noexcept override {}
  DevicePoll poll() noexcept override { return {}; }
  void send(const Wrench&) noexcept override {}
  void release() noexcept override { m_written += write(m_pipe, "r", 1); }
  DeviceState state() const noexcept override { return DeviceState::ready; }
  DeviceInfo info() const override { return {}; }
  DeviceCounts counts() const override { return {}; }
  std::string problem() const override { return {}; }

 private:
  int m_pipe;
  ssize_t m_written = 0;
};

struct End {
  std::string released;  ///< what the device wrote
  int status;            ///< as waitpid gives it
  bool was_stopped = false;
};

Tattler* s_device = nullptr;  ///< of the child
volatile int s_depth = 0;

int overflow_stack(int depth) {
  volatile char frame[4096];
  frame[depth % 4096] = 1;
  return depth < 0 ? 0 : overflow_stack(depth + 1) + frame[0];
}

/// A child that does `something` under a guard.
End run_guarded(const std::function<void(std::optional<ReleaseGuard>&)>& something) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    // A group of its own, whose parent is in another: the system stops none that nobody could continue.
    setpgid(0, 0);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    Tattler device(ends[1]);
    s_device = &device;
    std::optional<ReleaseGuard> guard;
    guard.emplace(device);
    something(guard);
    _exit(0);
  }
  close(ends[1]);
  End end{std::string(8, ' '), 0};
  waitpid(child, &end.status, WUNTRACED);
  if (WIFSTOPPED(end.status)) {
    end.was_stopped = true;
    kill(child, SIGCONT);
    waitpid(child, &end.status, 0);
  }
  const ssize_t size = read(ends[0], end.released.data(), end.released.size());
  end.released.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  close(ends[0]);
  return end;
}

TEST(ReleaseGuard, ReleasesTheDeviceOnceAndLetsTheSignalGoOn) {
  // All that end a process by default [signal(7)] but SIGKILL and SIGPIPE.
  for (const int number : {SIGSEGV, SIGBUS,    SIGFPE,  SIGILL,  SIGABRT,   SIGSYS,  SIGTRAP, SIGINT,
                           SIGTERM, SIGHUP,    SIGQUIT, SIGALRM, SIGUSR1,   SIGUSR2, SIGXCPU, SIGXFSZ,
                           SIGPROF, SIGVTALRM, SIGPOLL, SIGPWR,  SIGSTKFLT, SIGRTMAX}) {
    const End end = run_guarded([&](auto& guard) {
      guard.reset();
      std::signal(number, SIG_DFL);  // sanitizers have handlers of their own
      Tattler* const device = s_device;
      guard.emplace(*device);
      std::raise(number);
    });
    EXPECT_EQ(end.released, "r") << number;
    EXPECT_TRUE(WIFSIGNALED(end.status)) << number;
    EXPECT_EQ(WTERMSIG(end.status), number);
  }
}

TEST(ReleaseGuard, ReleasesTheDeviceWhenTheStackOverflows) {
  const End end = run_guarded([&](auto& guard) {
    guard.reset();
    std::signal(SIGSEGV, SIG_DFL);
    guard.emplace(*s_device);
    s_depth = overflow_stack(0);
  });
  EXPECT_EQ(end.released, "r");
  EXPECT_EQ(WTERMSIG(end.status), SIGSEGV);
}

TEST(ReleaseGuard, ReleasesTheDeviceBeforeItIsStopped) {
  const End end = run_guarded([](auto&) { std::raise(SIGTSTP); });
  EXPECT_EQ(end.released, "r");
  EXPECT_TRUE(WIFEXITED(end.status));
  EXPECT_TRUE(end.was_stopped);
}

TEST(ReleaseGuard, GoesOnWhenNobodyReadsWhatTheProgramPrints) {
  const End end = run_guarded([](auto&) { std::raise(SIGPIPE); });
  EXPECT_EQ(end.released, "");
  EXPECT_TRUE(WIFEXITED(end.status));
}

TEST(ReleaseGuard, ReleasesTheDeviceAtExit) {
  const End end = run_guarded([](auto&) { std::exit(7); });  // NOLINT: a thread-safe exit is not asked for
  EXPECT_EQ(end.released, "r");
  EXPECT_EQ(WEXITSTATUS(end.status), 7);
}

TEST(ReleaseGuard, LeavesSignalsThatTheProgramHandlesToIt) {
  const End end = run_guarded([](auto& guard) {
    guard.reset();
    std::signal(SIGTERM, SIG_IGN);
    guard.emplace(*s_device);
    std::raise(SIGTERM);
  });
  EXPECT_EQ(end.released, "");
  EXPECT_TRUE(WIFEXITED(end.status));
}

TEST(ReleaseGuard, DoesNothingOnceItIsGone) {
  const End end = run_guarded([](auto& guard) {
    guard.reset();
    std::raise(SIGTERM);
  });
  EXPECT_EQ(end.released, "");
  EXPECT_EQ(WTERMSIG(end.status), SIGTERM);
}

}  // namespace
}  // namespace argil::device
