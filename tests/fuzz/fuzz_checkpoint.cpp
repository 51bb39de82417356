// Any file as a checkpoint. Without the hash at its end it's refused before HDF5 sees it; with it, as a file that was made to deceive has it, the reader
// refuses it with OutputError or gives a state whose arrays fit together. The HDF5 library itself isn't compiled with the sanitizers.
#include "core/error.hpp"
#include "io/checkpoint.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/require.hpp"

namespace {

void require_consistent(const corpuscle::CheckpointFile& file) {
  const auto& nodes = file.contents().nodes;
  const auto& state = file.contents().state;
  CORPUSCLE_REQUIRE(file.sequence() >= 0 && state.step >= 0 && state.motion.steps >= 0 && state.motion.stages >= 1);
  CORPUSCLE_REQUIRE(state.positions.size() % 3 == 0 && state.velocities.size() == state.positions.size());
  for (const auto& values : {state.motion.before, state.motion.before_that}) CORPUSCLE_REQUIRE(values.empty() || values.size() == state.positions.size());
  std::size_t node_count = 1;
  for (const int n : nodes) {
    CORPUSCLE_REQUIRE(n > 0);
    node_count *= static_cast<std::size_t>(n);
  }
  for (int q = 0; q < 19; ++q) {
    const auto population = file.population(q);
    CORPUSCLE_REQUIRE(std::holds_alternative<std::vector<double>>(population) == file.double_precision());
    CORPUSCLE_REQUIRE(std::visit([](const auto& values) { return values.size(); }, population) == node_count);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace corpuscle;
  static InputFile file("checkpoint-a.h5");
  const auto& path = file.write(bytes, size);
  try {
    require_consistent(CheckpointFile(path));
  } catch (const OutputError&) {
  }
  seal_checkpoint(path);
  try {
    require_consistent(CheckpointFile(path));
  } catch (const OutputError&) {
  }
  return 0;
}
