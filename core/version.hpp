#pragma once

#include <string>

namespace corpuscle {

/// The release, for example "0.1.0".
std::string version_string();

/// The git revision this program was built from, with "-dirty" when files were changed since; "unknown" outside git.
std::string git_revision();

}  // namespace corpuscle
