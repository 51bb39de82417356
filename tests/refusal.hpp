#pragma once
// What `to_lattice` says to a problem.
#include <string>

#include "core/error.hpp"
#include "physics/units.hpp"

/// The message of the InputError, or "accepted".
inline std::string refusal(const corpuscle::Problem& problem) {
  try {
    corpuscle::to_lattice(problem);
  } catch (const corpuscle::InputError& error) {
    return error.what();
  }
  return "accepted";
}

inline bool mentions(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
