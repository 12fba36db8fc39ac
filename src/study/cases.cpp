#include "study/cases.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "output/result_reader.h"
#include "output/schema.h"
#include "run/files.h"
#include "run/identity.h"
#include "run/interrupt.h"
#include "run/run.h"

namespace argil::study {
namespace {

namespace fs = std::filesystem;

/// The result of one case as it is kept beside its file: a line a figure, the reason last.
void write_result(const CaseResult& result, const std::string& file) {
  const std::string part = file + ".part";
  std::ofstream out(part);
  out.precision(17);
  out << "exit " << result.exit_code << "\nmemory " << result.peak_memory_MiB << "\ninstructions "
      << result.instructions << "\ncpu";
  for (const double seconds : result.cpu_seconds) out << ' ' << seconds;
  out << "\nreason " << result.reason << '\n';
  out.close();
  std::error_code error;
  fs::rename(part, file, error);
  if (!out || error) throw IoError(file, "could not be written");
}

bool read_result(const std::string& file, CaseResult& result) {
  std::ifstream in(file);
  std::string word, line;
  if (!(in >> word >> result.exit_code >> word >> result.peak_memory_MiB >> word >> result.instructions))
    return false;
  std::getline(in, line);
  std::getline(in, line);
  std::istringstream list(line);
  list >> word;
  for (double seconds = 0.0; list >> seconds;) result.cpu_seconds.push_back(seconds);
  if (!std::getline(in, line) || line.rfind("reason ", 0) != 0) return false;
  result.reason = line.substr(7);
  return true;
}

/// Last line that says something of what a process wrote, without the program's name.
std::string read_last_words(const std::string& log) {
  std::ifstream in(log);
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  constexpr std::string_view kName = "argil: ";
  return last.rfind(kName, 0) == 0 ? last.substr(kName.size()) : last;
}

/// A message without the folder of the scenario that it names, so that tables are the same on every machine.
std::string leave_out_folder(std::string text, const std::string& scenario) {
  const std::string folder = fs::path(scenario).parent_path().string() + "/";
  for (std::size_t at = text.find(folder); folder.size() > 1 && at != std::string::npos;
       at = text.find(folder, at))
    text.erase(at, folder.size());
  return text;
}

/// Does a file hold a run that reached its end, well or not?
bool is_whole(const std::string& file) {
  try {
    const output::ResultReader reader(file);
    return reader.outcome() == output::Outcome::done || reader.outcome() == output::Outcome::failed;
  } catch (const std::runtime_error&) {
    return false;
  }
}

/// Replaces this process by the program, which dies with its parent; only what is allowed after a fork.
[[noreturn]] void become(char* const* arguments, int log, pid_t parent, const run::SignalPause& pause) {
  const int nothing = open("/dev/null", O_WRONLY);
  dup2(nothing, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  pause.end_in_child();
  if (getppid() == parent) execv(arguments[0], arguments);
  constexpr std::string_view kWhy = "argil: the program could not be started\n";
  if (::write(STDERR_FILENO, kWhy.data(), kWhy.size()) < 0) _exit(126);
  _exit(127);
}

/// One case under way.
struct Job {
  std::size_t place = 0;  // in the list of cases
  int repeat = 0;
};

/// Starts, awaits and keeps the runs of a list of cases.
class Runner {
 public:
  Runner(const std::vector<Case>& cases, const CaseOptions& options)
      : m_cases(cases), m_options(options), m_results(cases.size()) {}

  std::vector<CaseResult> run() {
    std::error_code error;
    fs::create_directories(m_options.folder, error);
    if (error) throw IoError(m_options.folder, "cannot be made (" + error.message() + ")");
    remove_what_died();
    for (const Case& c : m_cases) m_repeats.push_back(c.repeats);
    std::vector<std::size_t> accepted, waiting;
    for (std::size_t i = 0; i < m_cases.size(); ++i) {
      check_interrupt(m_options);
      if (prepare(i)) accepted.push_back(i);
    }
    std::copy_if(accepted.begin(), accepted.end(), std::back_inserter(waiting),
                 [this](std::size_t i) { return must_run(i); });
    for (const std::size_t i : waiting) {
      while (m_running.size() >= static_cast<std::size_t>(m_options.jobs)) await();
      if (run::is_interrupted()) break;
      start({i, 0});
    }
    while (!m_running.empty()) await();
    check_interrupt(m_options);
    for (std::size_t i = 0; i < m_cases.size(); ++i)  // what stands twice in the list has run once
      if (const auto first = m_first.find(m_results[i].id); first != m_first.end() && first->second != i)
        m_results[i] = m_results[first->second];
    return std::move(m_results);
  }

 private:
  std::string path(std::size_t i, const char* suffix) const {
    return (fs::path(m_options.folder) / (m_results[i].id + suffix)).string();
  }

  /// Files of runs whose study is no more: ID.part.PROCESS…, ID.again.PROCESS…, ID.PROCESS.log. A day old, as
  /// the process may be another machine's.
  void remove_what_died() const {
    std::error_code ignored;
    std::vector<fs::path> dead;
    for (const fs::directory_entry& entry : fs::directory_iterator(m_options.folder, ignored)) {
      std::istringstream words(entry.path().filename().string());
      std::string word;
      std::getline(words, word, '.');  // the id
      while (std::getline(words, word, '.')) {
        const bool is_process =
            word.size() < 10 && !word.empty() && word.find_first_not_of("0123456789") == word.npos;
        if (!is_process || fs::exists("/proc/" + word)) continue;
        if (fs::file_time_type::clock::now() - entry.last_write_time(ignored) > std::chrono::hours(24))
          dead.push_back(entry.path());
      }
    }
    for (const fs::path& file : dead) fs::remove(file, ignored);
  }

  /// Of this process alone: another study may run the same case into the same folder.
  std::string part(const Job& job) const {
    return path(job.place, job.repeat == 0 ? ".part." : ".again.") + std::to_string(getpid());
  }
  std::string log_of(std::size_t i) const { return path(i, ".") + std::to_string(getpid()) + ".log"; }

  /// Names the case; true for the first of its id.
  bool prepare(std::size_t i) {
    CaseResult& result = m_results[i];
    try {
      const run::Identity identity =
          run::find_identity(run::load(make_run_options(m_cases[i].scenario, m_cases[i].settings)));
      result.id = identity.id().substr(0, 16);
      result.inputs = identity.inputs;
    } catch (const InputError& refused) {
      result.exit_code = run::kInputRefused;
      result.reason = leave_out_folder(refused.what(), m_cases[i].scenario);
      return false;
    }
    if (const auto [first, is_new] = m_first.emplace(result.id, i); !is_new) {
      m_repeats[first->second] = std::max(m_repeats[first->second], m_cases[i].repeats);
      return false;
    }
    return true;
  }

  /// True when what is kept will not do.
  bool must_run(std::size_t i) {
    CaseResult& result = m_results[i];
    CaseResult kept;
    kept.id = result.id;
    kept.inputs = result.inputs;
    const bool is_kept =
        read_result(path(i, ".case"), kept) && static_cast<int>(kept.cpu_seconds.size()) >= m_repeats[i];
    const bool has_file = is_whole(path(i, ".h5"));
    if (!(is_kept && has_file) &&
        !(read_result(path(i, ".case"), kept) && kept.exit_code == run::kInputRefused))
      return true;
    result = kept;
    result.file = has_file ? path(i, ".h5") : "";
    return false;
  }

  void start(const Job& job) {
    const std::size_t i = job.place;
    std::vector<std::string> words = {m_options.program, "run", m_cases[i].scenario, "--quiet",
                                      "--threads",       "1",   "--output",          part(job) + ".h5"};
    for (const std::string& text : make_run_options(m_cases[i].scenario, m_cases[i].settings).settings) {
      words.emplace_back("--set");
      words.push_back(text);
    }
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const std::string log = log_of(i);
    const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (out < 0) throw IoError(log, std::string("could not be written (") + std::strerror(errno) + ")");
    const pid_t parent = getpid();
    const run::SignalPause pause;  // a child that still had our handlers would not end
    const pid_t child = fork();
    if (child == 0) become(arguments.data(), out, parent, pause);
    const int error = errno;
    close(out);
    if (child < 0)
      throw IoError(m_options.program, std::string("could not be started (") + std::strerror(error) + ")");
    m_running.emplace(child, job);
  }

  /// Of the next one that ends. When the study is to end, all are told to.
  pid_t wait_for_child(int& status, rusage& usage) {
    const run::SignalPause pause;
    while (true) {
      if (run::is_interrupted() && !std::exchange(m_is_ending, true))
        for (const auto& [child, job] : m_running) kill(child, SIGTERM);
      if (const pid_t child = wait4(-1, &status, WNOHANG, &usage); child != 0) return child;
      pause.sleep();
    }
  }

  void await() {
    int status = 0;
    rusage usage = {};
    const pid_t child = wait_for_child(status, usage);
    const auto found = m_running.find(child);
    if (found == m_running.end()) return;
    const Job job = found->second;
    m_running.erase(found);
    CaseResult& result = m_results[job.place];
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.peak_memory_MiB = static_cast<double>(usage.ru_maxrss) / 1024.0;
    take(job, result);
    const bool is_whole = !is_accident(result.exit_code) &&
                          (result.exit_code == run::kInputRefused || job.repeat + 1 >= m_repeats[job.place]);
    if (!is_whole && !is_accident(result.exit_code) && !run::is_interrupted())
      return start({job.place, job.repeat + 1});
    if (is_whole) write_result(result, path(job.place, ".case"));
    std::error_code ignored;
    fs::remove(log_of(job.place), ignored);
    print(job.place);
  }

  /// Reads what a run left and puts its first file in its place.
  void take(const Job& job, CaseResult& result) {
    std::error_code error;
    const std::string stem = part(job);
    fs::remove(stem + ".xdmf", error);  // it names a file that moves
    const std::string file = stem + ".h5";
    fs::remove(file + ".part", error);  // of a run that was killed while it made the file
    if (!fs::exists(file)) {
      result.reason = leave_out_folder(read_last_words(log_of(job.place)), m_cases[job.place].scenario);
      return;
    }
    try {
      const output::ResultReader reader(file);
      result.cpu_seconds.push_back(0.0);
      for (const auto& [name, value] : reader.read_timing()) {
        if (name == "cpu" || name == output::schema::kCpuOfPasses) result.cpu_seconds.back() += value;
        if (name == "instructions") result.instructions = value;
      }
      if (reader.find_accuracy()) result.instructions = 0.0;  // those of the last pass alone were counted
      if (const auto failure = reader.read_failure()) result.reason = to_string(*failure);
    } catch (const std::runtime_error& broken) {  // a killed run's file
      result.reason = broken.what();
    }
    if (result.exit_code == run::kInterrupted)
      result.reason = "interrupted";
    else if (result.exit_code > 128)
      result.reason = "killed by signal " + std::to_string(result.exit_code - 128);
    if (job.repeat > 0 || (run::is_interrupted() && is_accident(result.exit_code))) {
      fs::remove(file, error);
      return;
    }
    result.file = path(job.place, ".h5");
    fs::rename(file, result.file, error);
    if (error) throw IoError(result.file, "could not be written (" + error.message() + ")");
  }

  void print(std::size_t i) {
    ++m_ended;
    if (m_options.quiet) return;
    const CaseResult& result = m_results[i];
    std::fprintf(stderr, "argil: run %d of %zu (%s): %s\n", m_ended, m_first.size(), result.id.c_str(),
                 result.reason.empty() ? "done" : result.reason.c_str());
  }

  const std::vector<Case>& m_cases;
  const CaseOptions& m_options;
  std::vector<CaseResult> m_results;
  std::vector<int> m_repeats;                  // of each; of those with one id, the most
  std::map<std::string, std::size_t> m_first;  // place of each id's first case
  std::map<pid_t, Job> m_running;
  int m_ended = 0;
  bool m_is_ending = false;  // all that run were told to end
};

}  // namespace

run::RunOptions make_run_options(const std::string& scenario,
                                 const std::vector<scenario::Setting>& settings) {
  run::RunOptions options;
  options.scenario = scenario;
  options.settings.emplace_back("/dynamics/strict=true");         // a study asks where methods fail
  options.settings.emplace_back("/body/cells/remesh=\"never\"");  // and compares places by their cells
  for (const scenario::Setting& setting : settings)
    options.settings.push_back(setting.pointer + "=" + setting.value);
  return options;
}

bool is_accident(int exit_code) {
  return exit_code != run::kDone && exit_code != run::kInputRefused && exit_code != run::kRunFailed;
}

void check_interrupt(const CaseOptions& options) {
  if (run::is_interrupted())
    throw run::Interrupted("interrupted; what has ended is kept in " + options.folder +
                           ", and the same command goes on from there");
}

std::vector<CaseResult> run_cases(const std::vector<Case>& cases, const CaseOptions& options) {
  run::watch_signals();
  return Runner(cases, options).run();
}

double compute_median_cpu(const CaseResult& result) {
  std::vector<double> sorted = result.cpu_seconds;
  if (sorted.empty()) return 0.0;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace argil::study
