// A run.h5 as an analysis wants it.
#pragma once
#include <filesystem>

#include "physics/analysis/record.hpp"

namespace corpuscle {

/// Reads the numbers and series of DIRECTORY/run.h5; trajectories stay in the file and are read from there when they are visited, some megabytes at a time. Also of
/// a run that goes on: the file is opened anew for every piece, and again where it was changed meanwhile. The shortest dataset tells how many samples there are.
/// Samples off the even grid of `series_every` are left out (that of the end of a run), missing ones are NaN; what is missing otherwise is among the warnings.
/// @throws InputError when there is no run.h5, or it isn't one.
analysis::RunRecord read_run_record(const std::filesystem::path& directory);

}  // namespace corpuscle
