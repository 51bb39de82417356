#pragma once
// Checks what a refusal tells the user; the same with Catch2 2 and 3, whose substring matchers have different names.
#include <string>
#include <vector>

#include "core/error.hpp"

/// Runs `action`, which must throw InputError with a message that contains all `words`. Empty when so, else what happened:
/// CHECK(complaint_lacks([&] { read_off(path, 1); }, {"line 3", "finite"}) == "");
template <class Action>
std::string complaint_lacks(const Action& action, const std::vector<const char*>& words) {
  try {
    action();
  } catch (const corpuscle::InputError& error) {
    const std::string message = error.what();
    for (const char* word : words)
      if (message.find(word) == std::string::npos) return "no '" + std::string(word) + "' in: " + message;
    return "";
  }
  return "no InputError";
}
