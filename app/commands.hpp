// The subcommands of `corpuscle`. Each returns the exit code (core/error.hpp) or throws.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace corpuscle::app {

struct SceneOptions {
  std::string scene;                   ///< path of the TOML file
  std::vector<std::string> overrides;  ///< key=value
  int threads = 0;                     ///< 0: Kokkos decides (OMP_NUM_THREADS)
};

struct PlanOptions : SceneOptions {
  bool json = false;
};
int plan(const PlanOptions& options);

struct RunOptions : SceneOptions {
  std::string output;
  bool overwrite = false;
  bool profile = false;  ///< print and store the time of each operator
  std::string wall_time;  ///< [DAYS-]HH:MM:SS after which it stops with a checkpoint; empty: no limit
};
int run(const RunOptions& options);

struct ResumeOptions {
  std::string directory;
  std::string until;      ///< strain=X, steps=N or duration=X: another length of the run; empty: that of the scene
  std::vector<std::string> overrides;  ///< "guards.KEY=VALUE" and "output.checkpoint_...=VALUE": what changes no step
  std::string precision;  ///< single or double: another one than the scene's; empty: that of the scene
  std::string wall_time;
  bool profile = false;
  int threads = 0;
};
int resume(const ResumeOptions& options);

struct SweepOptions {
  std::string sweep;   ///< path of the TOML file
  std::string output;
  int jobs = 0;        ///< runs at a time; 0: as the cores allow
  int threads = 0;     ///< of each run; 0: by its size
  std::string wall_time;
  bool job_array = false;  ///< write a Slurm job array instead of running
  bool dry_run = false;    ///< only print what would be done
};
/// Exit code 0: all finished, 1: some failed, 75 and 130: stopped with checkpoints.
int sweep(const SweepOptions& options);

struct TradeoffOptions : SweepOptions {
  bool no_run = false;  ///< only compare what is there
};
/// `sweep` is the path of the study. Exit code as of sweep.
int tradeoff(const TradeoffOptions& options);

struct CheckOptions {
  std::string directory;
  bool json = false;
  bool recover = false;  ///< first finish, or take back, what a killed run was writing
};
/// Exit code 0: all is well, 1: problems were found, 2: not the results of a run.
int check(const CheckOptions& options);

struct AnalyseOptions {
  std::string directory;
  double wall_layer = 4;                ///< radii
  std::string mean_flow = "measured";   ///< or "uniform"
  std::string shear_rate = "walls";     ///< or "bulk": the unit of rates
  std::optional<double> discard;        ///< strain; none: found from the series
  std::optional<double> longest_lag;    ///< strain; none: a quarter of what is left
  std::string output;                   ///< .json; empty: analysis.json in the directory
};
int analyse(const AnalyseOptions& options);

struct StabilityOptions {
  std::string output = "results/stability";  ///< directory of stability.json; a search that was interrupted goes on there
  std::vector<std::string> only;             ///< parameters; empty: all
  std::string conditions;                    ///< only cases whose conditions contain this text
  int threads = 0;
};
int stability(const StabilityOptions& options);

/// One line each on stderr, so that they stand out of what plan and run print.
void print_warnings(const std::vector<std::string>& warnings);

/// Starts Kokkos with that many threads; stops it at the end of the scope.
class KokkosSession {
 public:
  explicit KokkosSession(int threads);
  ~KokkosSession();
  KokkosSession(const KokkosSession&) = delete;
  KokkosSession& operator=(const KokkosSession&) = delete;
};

}  // namespace corpuscle::app
