// corpuscle check DIR. The files are read by a child process: the HDF5 library may crash or hang on a damaged file, and that is a finding
// like any other. The child says which file it reads; when it dies there, another one goes on with the rest.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "app/commands.hpp"
#include "core/error.hpp"
#include "io/hdf5_transaction.hpp"
#include "io/lock.hpp"
#include "io/output_check.hpp"

namespace corpuscle::app {
namespace {

constexpr unsigned patience = 120;  // seconds for one piece of a file, which is 8 MB

constexpr rlim_t most_memory = rlim_t{16} << 30;  // of addresses; what is read at a time takes 8 MB

void write_line(int pipe, const nlohmann::json& line) {
  const std::string text = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(pipe, text.data() + done, text.size() - done);
    if (n <= 0) return;
    done += static_cast<std::size_t>(n);
  }
}

[[noreturn]] void be_child(int pipe, const std::string& directory, const std::set<std::string>& skip) {
  // A damaged length must not make the library ask for all the memory there is.
  const rlimit memory{most_memory, most_memory}, no_core{0, 0};
#ifndef __SANITIZE_ADDRESS__  // which needs terabytes of addresses
  ::setrlimit(RLIMIT_AS, &memory);
#else
  (void)memory;
#endif
  ::setrlimit(RLIMIT_CORE, &no_core);
  std::string current;
  const OutputCheck result = check_output_files(directory, skip, [&](const std::string& file) {
    ::alarm(patience);
    if (file != current) write_line(pipe, {{"reading", file}});
    current = file;
  });
  ::alarm(0);
  nlohmann::json problems = nlohmann::json::array();
  for (const auto& p : result.problems) problems.push_back({{"file", p.file}, {"problem", p.what}, {"advice", p.advice}});
  write_line(pipe, {{"is_output", result.is_output}, {"problems", problems}, {"notes", result.notes}, {"samples", result.samples},
                    {"last_step", result.last_step}, {"snapshots", result.snapshots}, {"resumes_at", result.resumes_at}});
  ::_exit(0);
}

std::string read_all(int pipe) {
  std::string text;
  char buffer[4096];
  for (ssize_t n; (n = ::read(pipe, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<std::size_t>(n));
  return text;
}

/// One child; what it reports, or an object with `crashed`: the file that it read when it died.
nlohmann::json attempt(const std::string& directory, const std::set<std::string>& skip) {
  int ends[2];
  if (::pipe(ends) != 0) throw OutputError(std::string("check: no pipe: ") + std::strerror(errno));
  const pid_t child = ::fork();
  if (child < 0) throw OutputError(std::string("check: no process: ") + std::strerror(errno));
  if (child == 0) {
    ::close(ends[0]);
    be_child(ends[1], directory, skip);
  }
  ::close(ends[1]);
  const std::string text = read_all(ends[0]);
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  nlohmann::json last;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (const auto line = nlohmann::json::parse(text.substr(begin, end - begin), nullptr, false); line.is_object()) last = line;
    begin = end + 1;
  }
  if (last.contains("problems")) return last;
  const bool hung = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
  return {{"crashed", last.value("reading", std::string())}, {"how", hung ? "reading it does not end" : "reading it crashes the HDF5 library"}};
}

void print(const nlohmann::json& report, const std::string& directory) {
  for (const auto& text : report["notes"]) fmt::print("note: {}\n", text.get<std::string>());
  for (const auto& p : report["problems"])
    fmt::print("problem: {}: {} ({})\n", p["file"].get<std::string>(), p["problem"].get<std::string>(), p["advice"].get<std::string>());
  fmt::print("{}: {} samples{}, {} snapshots; {}\n", directory, report["samples"].get<std::int64_t>(),
             report["samples"].get<std::int64_t>() > 0 ? fmt::format(" up to step {}", report["last_step"].get<std::int64_t>()) : "",
             report["snapshots"].get<std::int64_t>(), report["problems"].empty() ? "all is well" : fmt::format("{} problems", report["problems"].size()));
}

}  // namespace

int check(const CheckOptions& options) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(options.directory, ignored))
    throw InputError(fmt::format("check {}: there is no such directory; give the one that `corpuscle run --output` wrote.", options.directory));
  if (options.recover) {
    const DirectoryLock lock(options.directory);
    for (const char* name : {"run.h5", "cells.vtkhdf", "fluid.vtkhdf"}) hdf5::recover(std::filesystem::path(options.directory) / name);
  }
  std::set<std::string> skip;
  nlohmann::json crashes = nlohmann::json::array(), report;
  for (;;) {
    report = attempt(options.directory, skip);
    if (!report.contains("crashed")) break;
    const auto file = report["crashed"].get<std::string>();
    if (file.empty() || !skip.insert(file).second) throw OutputError("check: the process that reads the files died: " + report["how"].get<std::string>());
    crashes.push_back({{"file", file}, {"problem", report["how"]}, {"advice", "the file is damaged; the others can be used"}});
  }
  if (!report["is_output"].get<bool>())
    throw InputError(fmt::format("check {}: holds no file of a run (run.h5, summary.json, ...); give the directory that `corpuscle run --output` wrote.",
        options.directory));
  for (const auto& p : report["problems"]) crashes.push_back(p);
  report["problems"] = crashes;
  if (options.json) fmt::print("{}\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  else print(report, options.directory);
  return report["problems"].empty() ? exit_code::success : exit_code::failure;
}

}  // namespace corpuscle::app
