#include "app/job_array.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <system_error>

#include "app/stop.hpp"
#include "io/durable.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

/// Runs or resumes $OUTPUT, hands it the signal of the batch system, submits the job again when there is more to do. The script in docs/cluster.md ends with
/// the same lines (tests/integration/test_cluster.py compares them), so that a single run and a point of a sweep are treated alike.
constexpr const char* run_and_resubmit = R"(if ls "$OUTPUT"/checkpoint-[ab].h5 > /dev/null 2>&1; then
  "$corpuscle" resume "$OUTPUT" --wall-time "$limit" --threads "$threads" &
else
  "$corpuscle" run "$SCENE" --output "$OUTPUT" --overwrite --wall-time "$limit" --threads "$threads" &
fi
run=$!
trap 'kill -USR1 $run' USR1         # Slurm signals the shell; the run has to hear of it
while kill -0 $run 2> /dev/null; do wait $run; done   # a signal ends a wait early
wait $run; code=$?

if [ $code -eq 75 ]; then
  sbatch --export=ALL ${SLURM_ARRAY_TASK_ID:+--array=$SLURM_ARRAY_TASK_ID} "$job"
elif [ $code -ne 0 ]; then
  echo "stopped with exit code $code" >&2
  exit $code
fi
)";

/// For the shell, whatever is in it.
std::string quoted(const fs::path& path) {
  std::string text = "'";
  for (const char c : fs::absolute(path).lexically_normal().string()) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// For a line #SBATCH, where Slurm takes no quotes for granted.
std::string escaped(const fs::path& path) {
  std::string text;
  for (const char c : fs::absolute(path).lexically_normal().string()) text += (c == ' ' ? "\\" : "") + std::string(1, c);
  return text;
}

std::string slurm_time(double seconds) {
  const auto minutes = static_cast<std::int64_t>(std::ceil(seconds / 60));
  return fmt::format("{}:{:02}:00", minutes / 60, minutes % 60);
}

}  // namespace

std::string task_list(const std::vector<std::size_t>& runs) {
  std::string text;
  for (std::size_t i = 0; i < runs.size();) {
    std::size_t end = i + 1;
    while (end < runs.size() && runs[end] == runs[end - 1] + 1) ++end;
    text += (text.empty() ? "" : ",") + std::to_string(runs[i] + 1) + (end > i + 1 ? "-" + std::to_string(runs[end - 1] + 1) : "");
    i = end;
  }
  return text;
}

void write_job_array(const SweepDirectory& directory, const std::vector<std::size_t>& runs, const JobArrayOptions& options) {
  const std::string wall_time = options.wall_time.empty() ? "11:50:00" : options.wall_time;
  std::string names;
  for (const SweepRun& run : directory.record().runs) names += run.name + "\n";
  replace_file(directory.path() / "points.txt", names, "the points");

  std::string text = "#!/bin/bash\n# Written by corpuscle sweep --job-array. Line N of points.txt is task N. Submit with: sbatch job_array.sh\n";
  const auto option = [&](const std::string& line) { text += "#SBATCH --" + line + "\n"; };
  option("job-name=sweep");
  option("array=" + task_list(runs));
  option("time=" + slurm_time(parse_wall_time(wall_time) + 600));
  option("nodes=1");
  option("ntasks=1");
  option(fmt::format("cpus-per-task={}", options.threads));
  option(fmt::format("mem={}M", static_cast<std::int64_t>(std::ceil(1.25 * options.bytes / (1 << 20))) + 64));
  if (options.on_device) option("gpus-per-task=1");
  option("output=" + escaped(directory.path() / "logs" / "task-%a.log"));
  option("open-mode=append");
  option("signal=USR1@300");  // a second line of defence: five minutes before the end
  text += fmt::format(R"(
set -u
corpuscle=${{CORPUSCLE:-{}}}
limit=${{WALL_TIME:-{}}}        # less than --time
directory={}
job=$directory/job_array.sh
threads=${{SLURM_CPUS_PER_TASK:-{}}}

name=$(sed -n "${{SLURM_ARRAY_TASK_ID}}p" "$directory/points.txt")
[ -n "$name" ] || {{ echo "points.txt has no line $SLURM_ARRAY_TASK_ID" >&2; exit 2; }}
SCENE=$directory/scenes/$name.toml
OUTPUT=$directory/$name
exec >> "$directory/logs/$name.log" 2>&1

)",
                      quoted(fs::read_symlink("/proc/self/exe")), wall_time, quoted(directory.path()), options.threads);
  const fs::path path = directory.path() / "job_array.sh";
  replace_file(path, text + run_and_resubmit, "the job script");
  std::error_code ignored;
  fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec, fs::perm_options::add, ignored);
}

}  // namespace corpuscle::app
