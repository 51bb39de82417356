// Text files that are always whole.
#pragma once
#include <filesystem>
#include <string>

namespace corpuscle {

/// Writes `text` to a temporary name first, then renames: the file holds the old or the new text, also after a kill. `what` is for the message.
/// @throws OutputError with the system's reason.
void write_text_file(const std::filesystem::path& path, const std::string& text, const std::string& what);

}  // namespace corpuscle
