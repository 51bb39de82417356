// Any file as each of our HDF5 files: readers refuse it with their kind of error or give what was expected, and `corpuscle check` finds
// words for it. The HDF5 library itself isn't compiled with the sanitizers; where it crashes, `corpuscle check` has a child process to lose.
#include "core/error.hpp"
#include "io/output_check.hpp"
#include "io/packing_file.hpp"
#include "io/run_file.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace corpuscle;
  static InputFile file("run.h5");
  const auto& path = file.write(bytes, size);
  // What corpus/hdf5/packing.h5 was saved with.
  const Packing expected{{16, 16, 16}, {{"red", 4.0, 4, 2}, {"white", 5.0, 5, 1}}, {}};
  try {
    const Packing packing = load_packing(path, expected);
    CORPUSCLE_REQUIRE(packing.positions.size() == 3 * (2 * 4 + 5) && packing.types.size() == 2);
  } catch (const InputError&) {
  }
  try {
    for (const Sample& sample : read_series(path)) CORPUSCLE_REQUIRE(sample.cells.empty());
  } catch (const OutputError&) {
  }
  const auto folder = path.parent_path();
  for (const char* name : {"cells.vtkhdf", "fluid.vtkhdf", "packing.h5", "summary.json", "scene.toml"}) {
    std::error_code exists;
    std::filesystem::create_symlink("run.h5", folder / name, exists);
  }
  const OutputCheck result = check_output_files(folder);
  CORPUSCLE_REQUIRE(result.is_output && !result.problems.empty());  // one file can't be all of them
  return 0;
}
