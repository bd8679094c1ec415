#pragma once
/// \file
/// Checks that an action is refused, and the wording of the error.

#include <gtest/gtest.h>

#include <string>

#include "core/error.hpp"

namespace twincell {

/// Expects `action` to throw an E whose message contains all of `wanted`.
template <class E, class Action, class... Words>
void expect_refusal(Action action, const Words&... wanted) {
  try {
    action();
    ADD_FAILURE() << "accepted, though it should say: " << (std::string() + ... + std::string(wanted));
  } catch (const E& e) {
    const std::string said = e.what();
    for (const std::string& words : {std::string(wanted)...})
      EXPECT_NE(said.find(words), std::string::npos) << "wanted: " << words << "\nsaid:   " << said;
  }
}

/// The message of the error that an action throws; empty if it throws none.
template <class Action>
std::string complaint_of(Action action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

}  // namespace twincell
