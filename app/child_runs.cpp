#include "app/child_runs.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "core/error.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> environment_of(const ChildCommand& command) {
  std::vector<std::string> environment;
  const auto set_here = [&](std::string_view variable) {
    return variable.starts_with("OMP_NUM_THREADS=") || (!command.alone && (variable.starts_with("OMP_PROC_BIND=") || variable.starts_with("OMP_WAIT_POLICY=")));
  };
  for (char** variable = environ; *variable != nullptr; ++variable)
    if (!set_here(*variable)) environment.emplace_back(*variable);
  environment.push_back(fmt::format("OMP_NUM_THREADS={}", command.threads));
  if (!command.alone) {  // bound threads of all runs would meet on the same cores
    environment.emplace_back("OMP_PROC_BIND=false");
    environment.emplace_back("OMP_WAIT_POLICY=passive");
  }
  return environment;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> list;
  for (std::string& text : texts) list.push_back(text.data());
  list.push_back(nullptr);
  return list;
}

/// Between fork and exec: only what a signal handler may do.
[[noreturn]] void become(char* const* arguments, char* const* environment, int log, pid_t parent) {
#ifdef __linux__
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
  if (::getppid() != parent) ::_exit(exit_code::interrupted);
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(log, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  ::execve("/proc/self/exe", arguments, environment);
  constexpr char message[] = "error: the program could not be started again from /proc/self/exe\n";
  (void)!::write(STDERR_FILENO, message, sizeof message - 1);
  ::_exit(127);
}

}  // namespace

std::string last_error(const fs::path& log, std::uintmax_t begin) {
  constexpr std::uintmax_t most = 64 << 10;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(log, error);
  if (error || size <= begin) return {};
  std::ifstream file(log, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(std::max(begin, size > most ? size - most : 0)));
  std::string found;
  constexpr std::string_view mark = "error: ";
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(mark)) found = line.substr(mark.size());
  return found;
}

void ChildRuns::start(std::size_t run, const ChildCommand& command) {
  const int log = ::open(command.log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (log < 0) throw OutputError(fmt::format("{} can't be written: {}", command.log.string(), std::strerror(errno)));
  std::error_code ignored;
  Child child{run, 0, command.log, fs::file_size(command.log, ignored)};
  const std::string title = fmt::format("$ corpuscle {}\n", fmt::join(command.arguments, " "));
  (void)!::write(log, title.data(), title.size());
  std::vector<std::string> arguments{"corpuscle"}, environment = environment_of(command);
  arguments.insert(arguments.end(), command.arguments.begin(), command.arguments.end());
  const auto argument_list = pointers(arguments), environment_list = pointers(environment);
  const pid_t parent = ::getpid();
  child.process = ::fork();
  if (child.process == 0) become(argument_list.data(), environment_list.data(), log, parent);
  const int failed = errno;
  ::close(log);
  if (child.process < 0) throw OutputError(fmt::format("no process for a run: {}", std::strerror(failed)));
  children_.push_back(child);
}

std::vector<ChildEnd> ChildRuns::ended() {
  std::vector<ChildEnd> ends;
  std::erase_if(children_, [&](const Child& child) {
    int status = 0;
    const pid_t process = ::waitpid(child.process, &status, WNOHANG);
    if (process == 0 || (process < 0 && errno == EINTR)) return false;
    ChildEnd end{child.run, exit_code::failure, last_error(child.log, child.log_begin)};
    if (process > 0 && WIFEXITED(status)) end.code = WEXITSTATUS(status);
    if (process > 0 && WIFSIGNALED(status)) {
      end.code = 128 + WTERMSIG(status);
      end.message = fmt::format("killed by signal {} ({}){}", WTERMSIG(status), ::strsignal(WTERMSIG(status)),
                                WTERMSIG(status) == SIGKILL ? "; the system does so when memory runs out" : "");
    }
    ends.push_back(end);
    return true;
  });
  return ends;
}

void ChildRuns::signal(int number) const {
  for (const Child& child : children_) ::kill(child.process, number);
}

std::vector<std::size_t> ChildRuns::running() const {
  std::vector<std::size_t> runs;
  for (const Child& child : children_) runs.push_back(child.run);
  return runs;
}

ChildRuns::~ChildRuns() {
  while (!children_.empty()) {
    signal(SIGTERM);  // again and again: one that has just been started may miss the first
    ::usleep(200'000);
    (void)ended();
  }
}

}  // namespace corpuscle::app
