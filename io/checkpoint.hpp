// Checkpoints: DIR/checkpoint-a.h5 and checkpoint-b.h5, from which a run goes on bit for bit. The last two are kept; each is written under another name first
// and carries a hash of all its bytes behind the HDF5 data, so that one that is cut or damaged is known before anything of it is believed.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5.hpp"
#include "physics/suspension_state.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// What a checkpoint holds beside the populations of the fluid.
struct Checkpoint {
  std::string scene;             ///< the merged scene, TOML
  std::string version, git_revision;
  std::vector<double> lattice;   ///< `lattice_numbers` of the run
  std::array<int, 3> nodes{};
  double seconds = 0;            ///< time of the steps so far
  std::vector<double> summary;   ///< SeriesSummary::save
  std::vector<double> statistics;  ///< LiveStatistics::save; empty without
  SuspensionState state;
};

/// All lattice parameters that a step depends on: a run goes on with the same ones only.
std::vector<double> lattice_numbers(const LatticeParameters& lattice);

/// How many samples or snapshots a run has written before `step` when it writes one every so many steps, from step 0 on.
inline std::int64_t written_before(std::int64_t step, std::int64_t every) { return (step + every - 1) / every; }

/// A checkpoint that has been opened; populations are read when they are asked for.
class CheckpointFile {
 public:
  /// @throws OutputError that says what is wrong with the file, when it is missing, cut, damaged or contradicts itself
  explicit CheckpointFile(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return file_.path(); }
  const Checkpoint& contents() const { return contents_; }
  /// Grows with each checkpoint of a run.
  std::int64_t sequence() const { return sequence_; }
  bool double_precision() const { return double_precision_; }
  /// @throws OutputError
  Population population(int direction) const;

 private:
  hdf5::File file_;
  Checkpoint contents_;
  bool double_precision_ = false;
  std::int64_t sequence_ = 0;
};

/// The checkpoints of a run's directory.
class CheckpointStore {
 public:
  explicit CheckpointStore(std::filesystem::path directory) : directory_(std::move(directory)) {}

  /// Writes one in place of the older one, or of a damaged one: to a temporary name, to disk, then renamed.
  /// @throws OutputError; both old ones are then still there.
  void write(const Checkpoint& checkpoint, const PopulationSource& population);
  /// Goes on after this one: the next `write` keeps it.
  void go_on_after(const CheckpointFile& file);

  static constexpr std::array<const char*, 2> names{"checkpoint-a.h5", "checkpoint-b.h5"};
  static constexpr const char* temporary_name = "checkpoint.tmp";

 private:
  std::filesystem::path directory_;
  int newest_ = 1;           ///< number of the file that is kept
  std::int64_t sequence_ = 0;
};

/// The newest checkpoint of a directory that is whole. `notes` gets a sentence for each that is not.
/// @throws InputError when there is none
CheckpointFile open_newest_checkpoint(const std::filesystem::path& directory, std::vector<std::string>& notes);

/// Puts the hash of a file's bytes behind them and waits until all of it is on disk: what makes an HDF5 file a whole checkpoint. @throws OutputError
void seal_checkpoint(const std::filesystem::path& path);
/// Compares the hash at the end of a file with its bytes. @throws OutputError that says what is wrong.
void verify_checkpoint(const std::filesystem::path& path);

}  // namespace corpuscle
