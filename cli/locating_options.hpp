#pragma once
/// \file
/// Options of the verbs that locate beads: locate, track and match have the same.

#include <memory>
#include <string>

#include "imaging/track/locating_request.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

struct Common;

/// Adds the options of a request to a verb.
void add_locating_options(CLI::App& verb, LocatingRequest& request);

/// Opens the stack with the request's frames, flat field and background (prepare_frames), and prints its
/// notes.
std::unique_ptr<FrameSource> open_for_locating(const std::string& stack, const LocatingRequest& request,
                                               const LocatorOptions& locator, const Common& common);

}  // namespace twincell::cli
