// run.h5: what was run, and every measured series (docs/outputs.md lists each dataset).
#pragma once
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "io/hdf5.hpp"
#include "physics/sample.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// What makes a run repeatable. No host or user name: output files get passed on.
struct RunMetadata {
  std::string scene;                 ///< the merged scene, TOML
  std::string version;               ///< of corpuscle
  std::string git_revision;
  std::string cpu_model;
  std::int64_t cores = 0;
  std::string operating_system;
  std::string kokkos_configuration;  ///< version, backends, threads, architecture
};

struct RunFileOptions {
  bool trajectories = true;          ///< write /cells: one row per cell and sample
  std::chrono::duration<double> flush_every = std::chrono::seconds(10);
  std::size_t buffer_bytes = std::size_t{64} << 20;  ///< flush earlier when this much is waiting
};

/// Writes run.h5. Samples wait in memory and are written together; between flushes the file is closed, so that it can be read
/// at any time while the run goes on, and a run that is killed leaves everything up to its last flush.
class RunFile {
 public:
  /// Creates the file (replacing an older one) with all metadata and empty series.
  /// @throws OutputError when the file can't be written.
  RunFile(std::filesystem::path path, const RunMetadata& metadata, const LatticeParameters& lattice, RunFileOptions options = {});
  /// Continues the file of an interrupted run after `step`: later samples are cut off. Whether /cells is written is taken from the file; a dataset that an
  /// older version did not write is added, with NaN until now.
  /// @throws OutputError when the file is missing or isn't a run.h5.
  static RunFile resume(std::filesystem::path path, std::int64_t step, RunFileOptions options = {});

  RunFile(RunFile&&) = default;
  RunFile& operator=(RunFile&&) = delete;
  /// Writes what is waiting; errors are swallowed, so call flush() at the end of a run.
  ~RunFile();

  /// Takes one sample; cheap, but flushes at the cadence of the options. With trajectories `sample.cells` must hold every cell.
  /// @throws OutputError from the flush; the samples stay in memory and the next flush tries again.
  void append(const Sample& sample);
  /// Samples in the file and waiting.
  std::size_t samples() const { return rows_written_ + steps_.size(); }
  /// Replaces what the file says about the length of the run.
  void set_length(const std::string& scene, std::int64_t steps);
  /// Writes all waiting samples to disk. @throws OutputError (disk full ...).
  void flush();

 private:
  RunFile(std::filesystem::path path, RunFileOptions options);
  void cut(hdf5::File& file) const;  ///< every dataset to rows_written_ rows
  void add_missing(hdf5::File& file) const;

  std::filesystem::path path_;
  RunFileOptions options_;
  std::size_t cell_count_ = 0;
  std::vector<std::int64_t> steps_;
  std::vector<std::vector<double>> series_;  ///< waiting rows of each dataset of /series
  std::vector<std::vector<double>> cells_;   ///< likewise of /cells
  std::size_t waiting_bytes_ = 0;
  std::size_t rows_written_ = 0;
  std::chrono::steady_clock::time_point last_flush_;
};

/// Absolute names of the datasets with a row for every sample: "/series/step", ..., with `trajectories` also "/cells/centre", ...
std::vector<std::string> run_file_rows(bool trajectories);

/// Reads /series (not /cells) of a run.h5 back, in order. @throws OutputError when the file can't be read.
std::vector<Sample> read_series(const std::filesystem::path& path);

}  // namespace corpuscle
